// SPDX-License-Identifier: MIT
// Passes are draws that change neither depth nor owner and shade the visible fragments, as Franchi and
// Ferrante draw the scene once per virtual light with depth EQUAL. All passes over a mesh see the same
// fragments, so coverage, depth and interpolation are done once per tile; each pass only runs its shader. A
// pixel has one owner, so the order of the meshes does not matter, only that of the passes.
//
// A row is a run of passes in the list of commands; a chain is the passes of a row over one mesh. The passes
// of a chain are fused, that is shaded by one call, where they share a shader that takes several passes.
#include "raster/raster.h"

bool vplIsPass(const vplPipeline* p)
{
    return p->ownerTest && p->depthCompare == VPL_DEPTH_EQUAL && !p->depthWrite && !p->writesDepth &&
           (p->fragment != NULL || p->passes != NULL) && p->cull == VPL_CULL_NONE;
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

// Collects the uniforms of a chain and decides whether one call may shade all of it.
static void fuseChain(vplRaster* r, int first, int* used)
{
    vplCommand* start = &r->commands[first];
    const vplPipeline* p = &r->pipelines[start->pipeline];
    bool same = p->passes != NULL;
    start->uniforms = *used;
    for (int i = first; i >= 0; i = r->commands[i].chainNext) {
        const vplPipeline* other = &r->pipelines[r->commands[i].pipeline];
        same = same && other->passes == p->passes && other->planeMask == p->planeMask;
        r->passUniforms[(*used)++] = other->fragmentUniforms;
    }
    start->fused = same ? *used - start->uniforms : 0;
}

static void findRows(vplRaster* r, int* last)
{
    int used = 0;
    for (int i = 0, end; i < r->commandCount; i = end) {
        for (end = i; end < r->commandCount && r->commands[end].isPass; end++) {
        }
        r->commands[i].passesEnd = end;
        linkRow(r, i, end, last);
        for (int k = i; k < end; k++) {
            if (r->commands[k].chainStart == k) {
                fuseChain(r, k, &used);
            }
        }
        end = end > i ? end : i + 1;
    }
}

vplResult vplFindPasses(vplRaster* raster)
{
    int epoch = 0;
    raster->keepsOwners = raster->framebuffer.triangles != NULL;
    raster->keepsPasses = raster->hasTasks = false;
    for (int i = 0; i < raster->commandCount; i++) {
        vplCommand* c = &raster->commands[i];
        const vplPipeline* p = c->shaded < 0 ? NULL : &raster->pipelines[c->pipeline];
        c->isPass = p != NULL && vplIsPass(p);
        epoch += p != NULL && p->depthWrite;
        c->epoch = epoch;
        raster->keepsOwners |= p != NULL && p->ownerTest;
        raster->keepsPasses |= c->isPass;
        raster->hasTasks |= p == NULL;
    }
    if (!raster->keepsPasses) {
        return VPL_SUCCESS;
    }
    int* last = vplArena_Alloc(raster->run, (size_t)raster->shadedCount, sizeof *last);
    raster->passUniforms =
        vplArena_Alloc(raster->run, (size_t)raster->commandCount, sizeof *raster->passUniforms);
    TRY(vplArena_Check(raster->run));
    findRows(raster, last);
    return VPL_SUCCESS;
}
