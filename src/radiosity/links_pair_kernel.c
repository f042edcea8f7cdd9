// SPDX-License-Identifier: MIT
// cos cos / (pi r^2) between points, 16 pairs at a time. Compiled once per instruction set; all give the same bits.
#include "base/isa.h"
#include "radiosity/links.h"

#include <vpl/vecmath.h>

enum { LANES = VPL_SIDE_LANES };

vplPairKernelFcn VPL_KERNEL(vplPairKernel);

void VPL_KERNEL(vplPairKernel)(const vplPointPairs* restrict pairs, float kernelOut[restrict LANES])
{
    const float scale = (float)(1 / VPL_PI);
    for (int l = 0; l < LANES; l++) {
        const float dx = pairs->y[0][l] - pairs->x[0][l], dy = pairs->y[1][l] - pairs->x[1][l],
                    dz = pairs->y[2][l] - pairs->x[2][l];
        const float square = dx * dx + dy * dy + dz * dz;
        const float there = dx * pairs->nx[0][l] + dy * pairs->nx[1][l] + dz * pairs->nx[2][l];
        const float back = -(dx * pairs->ny[0][l] + dy * pairs->ny[1][l] + dz * pairs->ny[2][l]);
        const float least = square > 1e-37f ? square : 1e-37f;
        const float kernel = scale * (there / least) * (back / least);
        const bool facing = (there > 0) & (back > 0);
        kernelOut[l] = facing ? kernel : 0.0f;
    }
}
