// SPDX-License-Identifier: MIT
// Sobol's sequence with Owen scrambling, four dimensions at a time, with random access to any point of any
// stream.
#ifndef VPL_MATH_SOBOL_H
#define VPL_MATH_SOBOL_H

#include <stdint.h>

enum { VPL_SOBOL_DIMENSIONS = 4 };

// The contribution of each 4 bits of an index to each dimension. Indices and fractions are bit-reversed, as
// scrambling needs them.
typedef struct vplSobol {
    uint32_t table[8][16][VPL_SOBOL_DIMENSIONS];
} vplSobol;

vplSobol vplSobol_Make(void);

// Point `index` without scrambling, as 32-bit fractions.
void vplSobol_Point(const vplSobol* sobol, uint32_t index, uint32_t fractionsOut[VPL_SOBOL_DIMENSIONS]);

// Point `index` of stream (seed, stream, dimension), in [0, 1)^4. Each stream is scrambled and shuffled
// independently, so that streams can be combined to cover more dimensions. The first 2^k points of a stream
// are stratified in each dimension and, in its first two dimensions, in every elementary interval.
void vplSobol_Sample(const vplSobol* sobol, uint64_t seed, uint64_t stream, uint32_t dimension,
                     uint32_t index, float sampleOut[VPL_SOBOL_DIMENSIONS]);

#endif
