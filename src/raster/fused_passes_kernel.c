// SPDX-License-Identifier: MIT
// Shades kept blocks by all passes over them; see fused_passes.c. Compiled once per instruction set; all give
// the same bits.
#include "raster/kernels.h"
#include "raster/shaders.h"

// Fused passes of a block between two questions whether the task goes on: about a millisecond.
enum { PASSES_PER_QUESTION = 1 << 16 };

void VPL_KERNEL(vplRunPasses)(vplTileState* state, const vplRaster* raster, int first)
{
    vplFragments* f = &state->block;
    const vplCommand* start = &raster->commands[first];
    const int mesh = start->shaded, planeCount = raster->framebuffer.planeCount;
    const size_t varyings = (size_t)keptVaryings(state);
    float* planes[VPL_MAX_PLANES];
    memcpy(planes, state->tile.planes, sizeof planes);
    int64_t fragments = 0, unasked = 0;
    for (int i = state->keptStart[mesh]; i < state->keptEnd[mesh]; i++) {
        const vplKeptBlock* kept = (const vplKeptBlock*)(state->kept + (size_t)i * state->keptStride);
        const float* from = (const float*)(kept + 1);
        unasked += 1 + start->fused;
        if (unasked > PASSES_PER_QUESTION) {
            unasked = 0;
            if (!vplTask_GoesOn(raster->context)) {
                return;
            }
        }
        f->x = kept->x;
        f->y = kept->y;
        f->element = kept->element;
        f->primitive = kept->primitive;
        memcpy(f->covered, kept->covered, sizeof f->covered);
        memcpy(f->depth, from, sizeof f->depth);
        memcpy(f->w, from + VPL_LANES, sizeof f->w);
        memcpy(f->varying, from + 2 * VPL_LANES, varyings * sizeof f->varying[0]);
        if (start->fused > 0) {
            runPassShader(&raster->pipelines[start->pipeline], raster->passUniforms + start->uniforms,
                          start->fused, f, planes, planeCount);
            fragments += (int64_t)kept->count * start->fused;
            continue;
        }
        for (int c = first; c >= 0; c = raster->commands[c].chainNext) {
            const vplPipeline* p = &raster->pipelines[raster->commands[c].pipeline];
            if (p->passes != NULL) {
                runPassShader(p, &p->fragmentUniforms, 1, f, planes, planeCount);
            } else {
                runFragmentShader(p, f, planes, planeCount);
                blendPlanes(p, f, planes, planeCount);
            }
            fragments += kept->count;
        }
    }
    state->fragments += fragments;
}
