// SPDX-License-Identifier: MIT
// Passes: draws that change neither depth nor owner and shade what the depth test left, one after another, as
// Franchi and Ferrante draw the scene once per virtual light with depth EQUAL. All passes over a mesh see the
// same fragments, so coverage, depth and interpolation are done once per tile; each pass only runs its shader.
// A pixel has one owner, so the order in which meshes are taken does not matter, only that of the passes.
#include "raster/raster.h"

static bool isPass(const vplPipeline* p)
{
    return p->ownerTest && p->depthCompare == VPL_DEPTH_EQUAL && !p->depthWrite && !p->writesDepth &&
           p->fragment != NULL && p->cull == VPL_CULL_NONE;
}

// Links the passes from `first` to `end` - 1 mesh by mesh. `last` is scratch, one int per mesh.
static void linkRow(vplRaster* r, int first, int end, int* last)
{
    for (int i = first; i < end; i++) {
        last[r->commands[i].shaded] = -1;
    }
    for (int i = first; i < end; i++) {
        vplCommand* c = &r->commands[i];
        const int before = last[c->shaded];
        c->chainNext = -1;
        c->chainStart = before < 0 ? i : r->commands[before].chainStart;
        if (before >= 0) {
            r->commands[before].chainNext = i;
        }
        last[c->shaded] = i;
    }
}

vplResult vplFindPasses(vplRaster* raster)
{
    int* last = vplAlloc(raster->context, (size_t)raster->shadedCount, sizeof *last);
    if (last == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    int epoch = 0;
    raster->keepsOwners = raster->keepsPasses = false;
    for (int i = 0; i < raster->commandCount; i++) {
        vplCommand* c = &raster->commands[i];
        const vplPipeline* p = c->shaded < 0 ? NULL : &raster->pipelines[c->pipeline];
        c->repeats = p != NULL && isPass(p);
        epoch += p != NULL && p->depthWrite;
        c->epoch = epoch;
        raster->keepsOwners |= p != NULL && p->ownerTest;
        raster->keepsPasses |= c->repeats;
    }
    for (int i = 0, end; i<raster->commandCount; i = end> i ? end : i + 1) {
        for (end = i; end < raster->commandCount && raster->commands[end].repeats; end++) {
        }
        raster->commands[i].passesEnd = end;
        linkRow(raster, i, end, last);
    }
    vplFree(raster->context, last);
    return VPL_SUCCESS;
}
