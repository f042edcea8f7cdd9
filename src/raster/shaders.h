// SPDX-License-Identifier: MIT
// Runs shaders on a block and blends their results. Included by kernels only.
#ifndef VPL_RASTER_SHADERS_H
#define VPL_RASTER_SHADERS_H

#include "raster/raster.h"

#include <string.h>

static inline void blendPlane(vplBlend blend, const int32_t covered[VPL_LANES], const float* drawn,
                              float* plane)
{
    float from[VPL_LANES], to[VPL_LANES];
    memcpy(from, drawn, sizeof from);
    memcpy(to, plane, sizeof to);
    for (int l = 0; l < VPL_LANES; l++) {
        const float kept = to[l],
                    sum = kept + from[l]; // for all lanes, so that the next line needs no branch
        to[l] = covered[l] ? (blend == VPL_BLEND_ADD ? sum : from[l]) : kept;
    }
    memcpy(plane, to, sizeof to);
}

static inline void blendPlanes(const vplPipeline* p, const vplFragments* f, float* const planes[],
                               int planeCount)
{
    int32_t covered[VPL_LANES];
    memcpy(covered, f->covered, sizeof covered);
    for (int k = 0; k < planeCount; k++) {
        if ((p->planeMask >> k & 1) == 0) {
            continue;
        }
        if (p->blend == VPL_BLEND_ADD) {
            blendPlane(VPL_BLEND_ADD, covered, f->plane[k], planes[k] + f->element);
        } else {
            blendPlane(VPL_BLEND_REPLACE, covered, f->plane[k], planes[k] + f->element);
        }
    }
}

static inline void readPlanes(vplFragments* f, float* const planes[], uint32_t mask, int planeCount)
{
    for (int k = 0; k < planeCount; k++) {
        if (mask >> k & 1) {
            memcpy(f->plane[k], planes[k] + f->element, sizeof f->plane[k]);
        }
    }
}

static inline void runFragmentShader(const vplPipeline* p, vplFragments* f, float* const planes[],
                                     int planeCount)
{
    if (p->readsPlanes) {
        readPlanes(f, planes, UINT32_MAX, planeCount);
    }
    p->fragment(p->fragmentUniforms, f);
}

// Runs `count` fused passes.
static inline void runPassShader(const vplPipeline* p, const void* const* uniforms, int count,
                                 vplFragments* f, float* const planes[], int planeCount)
{
    readPlanes(f, planes, p->planeMask, planeCount);
    p->passes(uniforms, count, f);
    for (int k = 0; k < planeCount; k++) {
        if (p->planeMask >> k & 1) {
            blendPlane(VPL_BLEND_REPLACE, f->covered, f->plane[k], planes[k] + f->element);
        }
    }
}

// The number of varyings of a kept block.
static inline int keptVaryings(const vplTileState* state)
{
    return (int)((state->keptStride - sizeof(vplKeptBlock)) / sizeof(float)) / VPL_LANES - 2;
}

#endif
