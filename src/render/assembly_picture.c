// SPDX-License-Identifier: MIT
// The picture of all pieces of an assembly, and its layers.
#include "render/assembly.h"

#include "render/renderer.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

// Names the first piece that is missing.
static vplResult failIncomplete(const vplAssembly* a)
{
    const vplPieceGrid* g = &a->first.grid;
    int index = 0;
    while (index < g->count && vplAssembly_Has(a, index)) {
        index++;
    }
    if (g->count == 0) {
        return vplFail(a->context, VPL_INVALID_ARGUMENT, "there is no part of the picture");
    }
    const vplPiecePlace place = vplPieceGrid_Place(g, index);
    return vplFail(a->context, VPL_INVALID_ARGUMENT,
                   "%d of %d pieces of the picture are missing; the first is pass %d of rows %d to %d",
                   a->missing, g->count, place.pass, place.firstRow, place.endRow - 1);
}

// Computes value k of a finished image from the sums of the passes and their total weight, by the formulas of
// vplRenderer_GetLayers: addMean that of the picture, addDirect that of direct light alone.
typedef float ResolveFcn(const vplAssembly* a, size_t k, double weight);

static float addMean(const vplAssembly* a, size_t k, double weight)
{
    return a->first.mean ? (float)((double)a->base->pixels[k] + a->sums[k] / weight) : a->base->pixels[k];
}

static float addDirect(const vplAssembly* a, size_t k, double weight)
{
    const float added = a->direct != NULL ? a->direct->pixels[k] : 0;
    return a->first.mean ? a->base->pixels[k] + added / (float)weight : added;
}

static vplResult resolve(const vplAssembly* a, ResolveFcn* valueOf, vplImage** imageOut)
{
    const vplPieceGrid* g = &a->first.grid;
    TRY(vplImage_Create(a->context, g->width, g->height, imageOut));
    for (int band = 0; band < g->bands; band++) {
        const vplPiecePlace place = vplPieceGrid_Place(g, band * g->passes);
        const size_t first = 3 * (size_t)place.firstRow * (size_t)g->width;
        for (size_t k = first; k < first + place.values; k++) {
            (*imageOut)->pixels[k] = valueOf(a, k, a->weights[band]);
        }
    }
    return VPL_SUCCESS;
}

vplResult vplAssembly_GetImage(const vplAssembly* a, vplImage** imageOut)
{
    REQUIRE(CONTEXT_OF(a), a, imageOut);
    if (a->first.grid.count == 0 || a->missing > 0) {
        return failIncomplete(a);
    }
    return resolve(a, addMean, imageOut);
}

vplResult vplAssembly_GetLayers(const vplAssembly* assembly, vplRenderer* renderer, vplLayers** layersOut)
{
    REQUIRE(vplRenderer_ContextOf(renderer) ?: CONTEXT_OF(assembly), assembly, renderer, layersOut);
    vplImage *picture = NULL, *direct = NULL;
    TRY(vplAssembly_CheckRenderer(assembly, renderer));
    TRY(vplRunner_RunPlan(&renderer->runner, renderer->plan, VPL_STAGE_GEOMETRY));
    TRY(vplAssembly_GetImage(assembly, &picture));
    const vplResult result =
        renderer->plan->splitsLight ? resolve(assembly, addDirect, &direct) : VPL_SUCCESS;
    if (result != VPL_SUCCESS) {
        vplImage_Destroy(picture);
        return result;
    }
    return vplMakeLayers(&renderer->runner.run, picture, direct, layersOut);
}
