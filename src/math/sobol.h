// SPDX-License-Identifier: MIT
// Points of Sobol's sequence with Owen's scrambling, four dimensions at a time; any point of any stream by itself.
#ifndef VPL_MATH_SOBOL_H
#define VPL_MATH_SOBOL_H

#include <stdint.h>

enum { VPL_SOBOL_DIMENSIONS = 4 };

// What index bits contribute to a point, four of them at a time. Indices and fractions have their bits in reverse,
// because that is how scrambling needs them.
typedef struct vplSobol {
    uint32_t share[8][16][VPL_SOBOL_DIMENSIONS];
} vplSobol;

vplSobol vplSobol_Make(void);

// Point `index` as 32-bit fractions, not scrambled.
void vplSobol_Point(const vplSobol* sobol, uint32_t index, uint32_t fractionsOut[VPL_SOBOL_DIMENSIONS]);

// Owen's scrambling by a hash: flips each bit as `seed` and the bits above it say.
uint32_t vplOwenScramble(uint32_t fraction, uint32_t seed);

// Point `index` of stream `stream` of seed `seed`, in [0, 1)^4. Each stream is scrambled and shuffled by itself, so
// streams can be put side by side to cover more dimensions. The first 2^k points of a stream cover each pair of
// its first two dimensions like a grid and each dimension like 2^k strata.
void vplSobol_Sample(const vplSobol* sobol, uint64_t seed, uint64_t stream, uint32_t dimension,
                     uint32_t index, float sampleOut[VPL_SOBOL_DIMENSIONS]);

#endif
