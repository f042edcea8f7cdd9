// SPDX-License-Identifier: MIT
// First-bounce lights of SSVP: samples of reflective shadow maps.
// Based on: Vitor Aranha, Márcio Macedo and Antônio Apolinário, Screen-Space Virtual Point Light Propagation
// for Real-Time Global Illumination, section II-A: texels at the points of the 2D Hammersley sequence.
// Departs: the flux of a light, which the document does not state; several emitters share the lights by
// power; the six faces of a point light lie side by side in the unit square.
#include "base/arena.h"
#include "base/rng.h"
#include "geometry/emission.h"
#include "lights/light_set.h"
#include "math/sampling.h"
#include "math/vec.h"

#include <math.h>

enum { RSM_SAMPLE_COOKIE = 0x56504c63, SHIFT_STREAM = 0x52534d01, CHUNK = 256 };

vplRsmSampleDef vplDefaultRsmSampleDef(void)
{
    return (vplRsmSampleDef){256, 0, RSM_SAMPLE_COOKIE};
}

typedef struct Sampling {
    const vplGeometry* geometry;
    const vplReflectiveMap* const* maps;
    int mapCount, count;
    uint64_t shift;
    int* first;             // per map: its first sample; the last entry ends the last map
    vplVirtualLight* slots; // one per sample; weight 0: none
    int64_t escaped;
} Sampling;

// ---- shares

// W through all texels, mean of the channels.
static double powerOf(const vplReflectiveMap* map)
{
    if (map == NULL) {
        return 0;
    }
    const vplEmitterDef* e = &map->emitter;
    const double share = e->type == VPL_EMITTER_POINT  ? 4 * VPL_PI
                         : e->type == VPL_EMITTER_SPOT ? vplSpot_SolidAngle(e)
                                                       : 4 * map->extent[0] * map->extent[1];
    return share * vplRgbMean(e->intensity);
}

// Each map with power gets one sample, if there are so many, so that its light is not lost; the others are
// shared by power. Rounding cumulative sums makes the shares add up.
static void shareSamples(Sampling* s)
{
    double total = 0, sum = 0;
    int powered = 0, before = 0;
    for (int i = 0; i < s->mapCount; i++) {
        total += powerOf(s->maps[i]);
        powered += powerOf(s->maps[i]) > 0;
    }
    const bool one = powered <= s->count;
    const int rest = one ? s->count - powered : s->count;
    s->first[0] = 0;
    for (int i = 0; i < s->mapCount; i++) {
        sum += powerOf(s->maps[i]);
        before += one && powerOf(s->maps[i]) > 0;
        s->first[i + 1] = before + (total > 0 ? (int)floor(rest * (sum / total) + 0.5) : 0);
    }
}

// ---- samples

// The one of `cells` equal parts of [0, 1) that holds numerator / denominator + shift, modulo 1. Rounding
// moves no unshifted point to another cell: its quotient is an integer, or at least 2^-24 below the next one.
static int64_t cellOf(double numerator, double denominator, double shift, int64_t cells)
{
    double at = numerator * (double)cells / denominator + shift * (double)cells;
    at -= at >= (double)cells ? (double)cells : 0;
    return at < (double)cells ? (int64_t)at : cells - 1;
}

// Texel of sample k of n.
static int64_t texelOf(const Sampling* s, const vplReflectiveMap* map, int emitter, int k, int n)
{
    const int64_t size = map->size;
    double shiftX = 0, shiftY = 0;
    if (s->shift != 0) {
        const vplRandom4 r = vplRandomAt(s->shift, SHIFT_STREAM, (uint64_t)emitter);
        shiftX = (double)vplUnitFloat(r.v[0]);
        shiftY = (double)vplUnitFloat(r.v[1]);
    }
    const int64_t column = cellOf(k, n, shiftX, map->faceCount * size);
    const int64_t row = cellOf((double)vplVanDerCorput((uint32_t)k), 1, shiftY, size);
    return (column / size * size + row) * size + column % size;
}

// A sample stands for the n-th part of its map's texels and carries the light of the whole map: the weight N
// / n accounts for the samples of other maps.
static void takeSample(Sampling* s, int emitter, int particle)
{
    const vplReflectiveMap* map = s->maps[emitter];
    const int n = s->first[emitter + 1] - s->first[emitter];
    const double texels = (double)map->faceCount * map->size * map->size;
    vplVirtualLight* light = &s->slots[particle];
    vplReflectiveTexel t;
    *light = (vplVirtualLight){.weight = 0};
    if (!vplReflectiveMap_GetTexel(map, s->geometry,
                                   texelOf(s, map, emitter, particle - s->first[emitter], n), &t)) {
        __atomic_fetch_add(&s->escaped, 1, __ATOMIC_RELAXED);
        return;
    }
    const vplRgb flux = vplScaleRadiometric(texels, vplRgbMul(t.albedo, t.flux));
    if (flux.r > 0 || flux.g > 0 || flux.b > 0) {
        *light = (vplVirtualLight){.position = t.position,
                                   .normal = t.normal,
                                   .light = flux,
                                   .weight = (float)((double)s->count / n),
                                   .particle = particle,
                                   .object = s->geometry->owners[t.triangle]};
    }
}

static void takeSamples(void* data, int chunk, int worker)
{
    (void)worker;
    Sampling* s = data;
    const int all = s->first[s->mapCount], end = all - chunk * CHUNK < CHUNK ? all : (chunk + 1) * CHUNK;
    for (int i = chunk * CHUNK, emitter = 0; i < end; i++) {
        while (i >= s->first[emitter + 1]) {
            emitter++;
        }
        takeSample(s, emitter, i);
    }
}

// ---- the set

static vplResult fillSet(Sampling* s, const vplLightArrays* arrays, vplLightSet* set)
{
    shareSamples(s);
    const int taken = s->first[s->mapCount];
    TRY(vplParallelForAsking(set->context, (taken + CHUNK - 1) / CHUNK, takeSamples, s));
    for (int i = 0; i < taken; i++) {
        if (s->slots[i].weight > 0) {
            s->slots[set->lightCount++] = s->slots[i];
        }
    }
    set->particleCount = s->count;
    set->escaped = (int)s->escaped;
    if (set->stepCount > 0) {
        arrays->stepCounts[0] = s->count;
        arrays->lightsInStep[0] = set->lightCount;
    }
    return VPL_SUCCESS;
}

vplResult vplSampleReflectiveMaps(const vplGeometry* geometry, const vplReflectiveMap* const* maps,
                                  int mapCount, const vplRsmSampleDef* def, vplLightSet** setOut)
{
    REQUIRE(CONTEXT_OF(geometry), geometry, def, setOut);
    REQUIRE_ARRAY(CONTEXT_OF(geometry), maps, mapCount);
    vplContext* context = geometry->context;
    if (def->cookie != RSM_SAMPLE_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplRsmSampleDef was not made by vplDefaultRsmSampleDef");
    }
    if (def->count < 0 || def->count > VPL_MAX_LIGHTS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplRsmSampleDef.count is %d, must be in [0, %d]",
                       def->count, VPL_MAX_LIGHTS);
    }
    if (mapCount < 0) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "mapCount is %d, must be at least 0", mapCount);
    }
    Sampling s = {
        .geometry = geometry, .maps = maps, .mapCount = mapCount, .count = def->count, .shift = def->shift};
    vplLightArrays arrays;
    vplLightSet* set;
    TRY(vplLightSet_Make(context, def->count, def->count > 0 ? 1 : 0, &arrays, &set));
    s.slots = arrays.lights;
    s.first = vplAlloc(context, (size_t)mapCount + 1, sizeof *s.first);
    const vplResult result = s.first != NULL ? fillSet(&s, &arrays, set) : VPL_OUT_OF_MEMORY;
    vplFree(context, s.first);
    return vplArena_Deliver(set->arena, result, set, setOut);
}
