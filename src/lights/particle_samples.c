// SPDX-License-Identifier: MIT
// The numbers of particles. Only the first floor(rho^k N) particles reach step k, so the first few must cover
// all directions, too. Random and Halton points do. Hammersley points are sorted by their first coordinate,
// so particle i takes point (i + 1) * stride mod N, where stride/N is near the golden ratio: any first few of
// those are spread evenly. Counting starts at 1 because point 0 is 0 in every dimension, and particle 0 makes
// the most steps: all light of the last ones left along one edge (145 % error in cornell-area with 100
// particles).
#include "lights/particles.h"
#include "base/rng.h"
#include "math/sampling.h"

#include <math.h>

enum { EMITTER_STREAM = 0x80000000u, SHIFT_STREAM = 0x80000001u };

static int64_t commonDivisor(int64_t a, int64_t b)
{
    while (b != 0) {
        int64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

vplSampleSource vplSampleSource_Make(const vplParticleDef* def)
{
    const int count = def->particleCount;
    const bool keller = def->start == VPL_START_EMITTER;
    vplSampleSource source = {def->sampler, def->seed, def->firstParticle, count, 1, 0};
    if (source.sampler == VPL_SAMPLER_AUTO) {
        source.sampler = keller ? VPL_SAMPLER_HALTON : VPL_SAMPLER_RANDOM;
    }
    source.reserved = keller && source.sampler == VPL_SAMPLER_HALTON;
    if (source.sampler == VPL_SAMPLER_HAMMERSLEY && source.first > 0) {
        // A Hammersley set cannot be extended: another N points are the same ones, shifted.
        vplRandom4 r = vplRandomAt(source.seed, SHIFT_STREAM, (uint64_t)source.first);
        source.seed = (uint64_t)r.v[0] << 32 | r.v[1];
    }
    if (count > 2) {
        source.stride = (int64_t)rint(count * 0.61803398874989484820);
        while (commonDivisor(source.stride, count) != 1) {
            source.stride++;
        }
    }
    return source;
}

// Cranley-Patterson rotation: seed 0 leaves the sequence as published.
static float shifted(float value, uint64_t seed, int dimension)
{
    if (seed == 0) {
        return value;
    }
    vplRandom4 r = vplRandomAt(seed, SHIFT_STREAM, (uint64_t)dimension);
    float sum = value + vplUnitFloat(r.v[0]);
    sum = sum >= 1 ? sum - 1 : sum;
    return sum < 1 ? sum : 0x1.fffffep-1f;
}

static float coordinate(const vplSampleSource* s, int particle, int dimension)
{
    if (s->sampler == VPL_SAMPLER_HALTON) {
        return vplHalton((uint64_t)(s->first + particle) + 1, dimension);
    }
    int64_t point = ((int64_t)particle + 1) * s->stride % s->count;
    return dimension == 0 ? (float)((double)point / s->count) : vplHalton((uint64_t)point, dimension - 1);
}

static void pairOf(const vplSampleSource* s, int particle, int pair, float* u, float* v)
{
    *u = shifted(coordinate(s, particle, 2 * pair), s->seed, 2 * pair);
    *v = shifted(coordinate(s, particle, 2 * pair + 1), s->seed, 2 * pair + 1);
}

void vplSampleSource_Direction(const vplSampleSource* source, int particle, int step, float* u, float* v)
{
    // Halton points in primes beyond the 64th are uniform only for more points than there are particles.
    const int pair = step + source->reserved;
    if (source->sampler == VPL_SAMPLER_RANDOM || 2 * pair + 1 >= VPL_PRIME_COUNT) {
        vplRandom4 r = vplRandomAt(source->seed, (uint32_t)step, (uint64_t)(source->first + particle));
        *u = vplUnitFloat(r.v[0]);
        *v = vplUnitFloat(r.v[1]);
        return;
    }
    pairOf(source, particle, pair, u, v);
}

float vplSampleSource_Emitter(const vplSampleSource* source, int particle)
{
    if (source->sampler == VPL_SAMPLER_RANDOM) {
        const uint64_t index = (uint64_t)(source->first + particle);
        return vplUnitFloat(vplRandomAt(source->seed, EMITTER_STREAM, index).v[0]);
    }
    double turns = ((double)(source->first + particle) + 0.5) * 0.61803398874989484820;
    return (float)(turns - floor(turns)) * 0x1.fffffep-1f;
}

void vplSampleSource_Place(const vplSampleSource* source, int particle, float* u, float* v)
{
    if (source->sampler == VPL_SAMPLER_RANDOM) {
        vplRandom4 r = vplRandomAt(source->seed, EMITTER_STREAM, (uint64_t)(source->first + particle));
        *u = vplUnitFloat(r.v[1]);
        *v = vplUnitFloat(r.v[2]);
        return;
    }
    if (source->reserved) {
        pairOf(source, particle, 0, u, v);
        return;
    }
    // R2: powers of the inverse plastic number.
    const double i = (double)(source->first + particle) + 0.5;
    const double x = i * 0.75487766624669276, y = i * 0.56984029099805327;
    *u = shifted((float)(x - floor(x)) * 0x1.fffffep-1f, source->seed, VPL_PRIME_COUNT);
    *v = shifted((float)(y - floor(y)) * 0x1.fffffep-1f, source->seed, VPL_PRIME_COUNT + 1);
}
