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

static uint32_t reverseBits(uint32_t x)
{
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

// Columns of one dimension's generating matrix, one for each bit of the index.
static void makeColumns(int dimension, uint32_t columns[32])
{
    for (int bit = 0; bit < 32; bit++) {
        columns[bit] = UINT32_C(1) << (31 - bit);
    }
    if (dimension == 0) {
        return;
    }
    const int degree = POLYNOMIALS[dimension - 1].degree, inner = POLYNOMIALS[dimension - 1].coefficients;
    for (int bit = 0; bit < 32; bit++) {
        if (bit < degree) {
            columns[bit] = POLYNOMIALS[dimension - 1].m[bit] << (31 - bit);
            continue;
        }
        uint32_t before = columns[bit - degree], v = before ^ (before >> degree);
        for (int k = 1; k < degree; k++) {
            v ^= inner >> (degree - 1 - k) & 1 ? columns[bit - k] : 0;
        }
        columns[bit] = v;
    }
}

vplSobol vplSobol_Make(void)
{
    vplSobol sobol;
    for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
        uint32_t columns[32];
        makeColumns(d, columns);
        for (int i = 0; i < 8 * 16; i++) {
            uint32_t sum = 0;
            for (int k = 0; k < 4; k++) {
                sum ^= i >> k & 1 ? columns[31 - (i / 16 * 4 + k)] : 0;
            }
            sobol.share[i / 16][i % 16][d] = reverseBits(sum);
        }
    }
    return sobol;
}

// Both the index and the fractions in reverse.
static void pointInReverse(const vplSobol* sobol, uint32_t index, uint32_t x[VPL_SOBOL_DIMENSIONS])
{
    for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
        x[d] = sobol->share[0][index & 15][d];
    }
    for (int i = 1; i < 8; i++) {
        const uint32_t* share = sobol->share[i][index >> (4 * i) & 15];
        for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
            x[d] ^= share[d];
        }
    }
}

void vplSobol_Point(const vplSobol* sobol, uint32_t index, uint32_t fractionsOut[VPL_SOBOL_DIMENSIONS])
{
    pointInReverse(sobol, reverseBits(index), fractionsOut);
    for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
        fractionsOut[d] = reverseBits(fractionsOut[d]);
    }
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
    const vplRandom4 seeds = vplRandomAt(seed, dimension, stream);
    uint32_t x[VPL_SOBOL_DIMENSIONS];
    // Shuffling keeps each aligned block of 2^k indices together: it stays as evenly spread as it was.
    const uint32_t shuffle = seeds.v[0] ^ (seeds.v[1] << 16 | seeds.v[2] >> 16);
    pointInReverse(sobol, permuteUpwards(reverseBits(index), shuffle), x);
    for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
        sampleOut[d] = vplUnitFloat(reverseBits(permuteUpwards(x[d], seeds.v[d])));
    }
}
