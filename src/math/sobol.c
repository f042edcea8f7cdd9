// SPDX-License-Identifier: MIT
// Based on: I. M. Sobol', On the distribution of points in a cube and the approximate evaluation of integrals, 1967;
// Stephen Joe and Frances Y. Kuo, Constructing Sobol sequences with better two-dimensional projections, SIAM J. Sci.
// Comput. 2008 (primitive polynomials and first numbers of file new-joe-kuo-6.21201); Brent Burley, Practical
// Hash-based Owen Scrambling, JCGT 2020 (scrambling, shuffling, padding).
#include "math/sobol.h"
#include "base/rng.h"

// Degree, inner coefficients and first numbers m of dimensions 2 to 4; dimension 1 is van der Corput's.
static const struct {
    int degree, coefficients;
    uint32_t m[3];
} POLYNOMIALS[VPL_SOBOL_DIMENSIONS - 1] = {{1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}};

vplSobol vplSobol_Make(void)
{
    vplSobol sobol;
    for (int bit = 0; bit < 32; bit++) {
        sobol.columns[bit][0] = UINT32_C(1) << (31 - bit);
    }
    for (int d = 1; d < VPL_SOBOL_DIMENSIONS; d++) {
        int degree = POLYNOMIALS[d - 1].degree, inner = POLYNOMIALS[d - 1].coefficients;
        for (int bit = 0; bit < 32; bit++) {
            if (bit < degree) {
                sobol.columns[bit][d] = POLYNOMIALS[d - 1].m[bit] << (31 - bit);
                continue;
            }
            uint32_t before = sobol.columns[bit - degree][d], v = before ^ (before >> degree);
            for (int k = 1; k < degree; k++) {
                v ^= inner >> (degree - 1 - k) & 1 ? sobol.columns[bit - k][d] : 0;
            }
            sobol.columns[bit][d] = v;
        }
    }
    return sobol;
}

void vplSobol_Point(const vplSobol* sobol, uint32_t index, uint32_t fractionsOut[VPL_SOBOL_DIMENSIONS])
{
    uint32_t x[VPL_SOBOL_DIMENSIONS] = {0};
    for (int bit = 0; index != 0; bit++, index >>= 1) {
        uint32_t mask = -(index & 1);
        for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
            x[d] ^= sobol->columns[bit][d] & mask;
        }
    }
    for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
        fractionsOut[d] = x[d];
    }
}

static uint32_t reverseBits(uint32_t x)
{
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

// Sums and products carry upwards only, and the factors are even: a bit depends on those below it alone.
static uint32_t permuteUpwards(uint32_t x, uint32_t seed)
{
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

uint32_t vplOwenScramble(uint32_t fraction, uint32_t seed)
{
    return reverseBits(permuteUpwards(reverseBits(fraction), seed));
}

void vplSobol_Sample(const vplSobol* sobol, uint64_t seed, uint64_t stream, uint32_t dimension,
                     uint32_t index, float sampleOut[VPL_SOBOL_DIMENSIONS])
{
    vplRandom4 seeds = vplRandomAt(seed, dimension, stream);
    uint32_t x[VPL_SOBOL_DIMENSIONS];
    // Shuffling keeps each aligned block of 2^k indices together: it stays as evenly spread as it was.
    uint32_t shuffled = vplOwenScramble(index, seeds.v[0] ^ (seeds.v[1] << 16 | seeds.v[2] >> 16));
    vplSobol_Point(sobol, shuffled, x);
    for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
        sampleOut[d] = vplUnitFloat(vplOwenScramble(x[d], seeds.v[d]));
    }
}
