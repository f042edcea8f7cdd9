// SPDX-License-Identifier: MIT
#include "cli/bench/cover.h"

static const uint32_t INDICES[3] = {0, 1, 2};
const vplMesh COVER = {INDICES, 3, 1};

void coverVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const float* depth = uniforms;
    for (int i = 0; i < count; i++) {
        out->x[i] = first + i == 1 ? 3 : -1;
        out->y[i] = first + i == 2 ? 3 : -1;
        out->z[i] = *depth;
        out->w[i] = 1;
    }
}

void coverFragments(const void* uniforms, vplFragments* f)
{
    (void)uniforms;
    for (int p = 0; p < 4; p++) {
        for (int l = 0; l < VPL_LANES; l++) {
            f->plane[p][l] = (float)(p + 1);
        }
    }
}
