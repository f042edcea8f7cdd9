// SPDX-License-Identifier: MIT
// Based on: I. M. Sobol', On the distribution of points in a cube and the approximate evaluation of
// integrals, 1967; Stephen Joe and Frances Y. Kuo, Constructing Sobol sequences with better two-dimensional
// projections, SIAM J. Sci. Comput. 2008 (primitive polynomials and initial numbers from their file
// new-joe-kuo-6.21201); Brent Burley, Practical Hash-based Owen Scrambling, JCGT 2020 (scrambling, shuffling,
// padding).
#include "math/sobol.h"
#include "base/rng.h"
#include "math/sampling.h"

// Degree, inner coefficients and initial numbers m of dimensions 2 to 4. Dimension 1 is van der Corput's
// sequence.
static const struct {
    int degree, coefficients;
    uint32_t m[3];
} POLYNOMIALS[VPL_SOBOL_DIMENSIONS - 1] = {{1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}};

// The columns of one dimension's generator matrix, one per bit of the index.
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
            sobol.table[i / 16][i % 16][d] = vplReverseBits(sum);
        }
    }
    return sobol;
}

// Point of a bit-reversed index, as bit-reversed fractions.
static void reversedPoint(const vplSobol* sobol, uint32_t index, uint32_t x[VPL_SOBOL_DIMENSIONS])
{
    for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
        x[d] = sobol->table[0][index & 15][d];
    }
    for (int i = 1; i < 8; i++) {
        const uint32_t* part = sobol->table[i][index >> (4 * i) & 15];
        for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
            x[d] ^= part[d];
        }
    }
}

void vplSobol_Point(const vplSobol* sobol, uint32_t index, uint32_t fractionsOut[VPL_SOBOL_DIMENSIONS])
{
    reversedPoint(sobol, vplReverseBits(index), fractionsOut);
    for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
        fractionsOut[d] = vplReverseBits(fractionsOut[d]);
    }
}

// Owen scrambling of a bit-reversed fraction: flips each bit depending on the seed and the bits below it.
// Sums and products carry upwards only, and even factors keep a bit from affecting itself.
static uint32_t scrambleReversed(uint32_t x, uint32_t seed)
{
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

void vplSobol_Sample(const vplSobol* sobol, uint64_t seed, uint64_t stream, uint32_t dimension,
                     uint32_t index, float sampleOut[VPL_SOBOL_DIMENSIONS])
{
    const vplRandom4 seeds = vplRandomAt(seed, dimension, stream);
    uint32_t x[VPL_SOBOL_DIMENSIONS];
    // Scrambling the index, too, shuffles the points but keeps each aligned block of 2^k together, and so
    // stratified.
    const uint32_t shuffle = seeds.v[0] ^ (seeds.v[1] << 16 | seeds.v[2] >> 16);
    reversedPoint(sobol, scrambleReversed(vplReverseBits(index), shuffle), x);
    for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
        sampleOut[d] = vplUnitFloat(vplReverseBits(scrambleReversed(x[d], seeds.v[d])));
    }
}
