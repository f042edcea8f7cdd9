// SPDX-License-Identifier: MIT
// Puts pieces together. Passes are added in their order, as vplRenderer_Step adds them, so a pass that comes before its
// turn waits.
#include "base/context.h"
#include "render/piece_file.h"
#include "render/renderer.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <string.h>

// A pass that waits for those before it.
typedef struct Waiting {
    float* values; // of the pass, then of its direct light if pieces have it; NULL: the pass does not wait
    double share;
} Waiting;

struct vplAssembly {
    vplContext* context;
    vplPieceHeader first; // of the first piece that was added; grid.count 0: none was
    vplImage* base;       // direct light of a mean, else the picture
    double* sums;         // of the passes of a mean
    vplImage* direct;     // direct light alone, of a mean the sum over passes; NULL: no piece has it
    double* weights;      // of each band
    int* next;            // the pass of each band that is added next
    Waiting* waiting;     // of each piece
    int missing;
};

vplResult vplAssembly_Create(vplContext* context, vplAssembly** assemblyOut)
{
    REQUIRE(context, context, assemblyOut);
    vplAssembly* a = vplAllocZero(context, 1, sizeof *a);
    if (a == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    a->context = context;
    *assemblyOut = a;
    return VPL_SUCCESS;
}

static void empty(vplAssembly* a)
{
    for (int i = 0; a->waiting != NULL && i < a->first.grid.count; i++) {
        vplFree(a->context, a->waiting[i].values);
    }
    vplImage_Destroy(a->base);
    vplImage_Destroy(a->direct);
    vplFree(a->context, a->sums);
    vplFree(a->context, a->weights);
    vplFree(a->context, a->next);
    vplFree(a->context, a->waiting);
    *a = (vplAssembly){.context = a->context};
}

void vplAssembly_Destroy(vplAssembly* a)
{
    if (a != NULL) {
        vplContext* context = a->context;
        empty(a);
        vplFree(context, a);
    }
}

static vplResult startPicture(vplAssembly* a, const vplPieceHeader* h)
{
    const vplPieceGrid* g = &h->grid;
    vplContext* c = a->context;
    TRY(vplImage_Create(c, g->width, g->height, &a->base));
    TRY(h->splits ? vplImage_Create(c, g->width, g->height, &a->direct) : VPL_SUCCESS);
    a->first = *h;
    a->sums = h->mean ? vplAllocZero(c, vplValueCount(a->base), sizeof *a->sums) : NULL;
    a->weights = vplAllocZero(c, (size_t)g->bands, sizeof *a->weights);
    a->next = vplAllocZero(c, (size_t)g->bands, sizeof *a->next);
    a->waiting = vplAllocZero(c, (size_t)g->count, sizeof *a->waiting);
    a->missing = g->count;
    const bool whole =
        (a->sums != NULL || !h->mean) && a->weights != NULL && a->next != NULL && a->waiting != NULL;
    return whole ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static vplResult checkSame(const vplAssembly* a, const vplPieceHeader* h, const char* name)
{
    const vplPieceHeader* f = &a->first;
    if (h->scene != f->scene || h->options != f->options) {
        return vplFail(a->context, VPL_INVALID_ARGUMENT,
                       "%s: a part of another picture than the first: %s differ", name,
                       h->scene != f->scene ? "scene or camera" : "options");
    }
    if (memcmp(&h->grid, &f->grid, sizeof h->grid) != 0 || h->mean != f->mean || h->splits != f->splits) {
        return vplFail(a->context, VPL_INVALID_ARGUMENT,
                       "%s: divided in %d bands of %d rows and %d passes, must be in %d of %d and %d as the "
                       "first part",
                       name, h->grid.bands, h->grid.rows, h->grid.passes, f->grid.bands, f->grid.rows,
                       f->grid.passes);
    }
    return VPL_SUCCESS;
}

vplResult vplAssembly_CheckRenderer(const vplAssembly* assembly, const vplRenderer* renderer)
{
    REQUIRE(vplRenderer_ContextOf(renderer) ?: CONTEXT_OF(assembly), assembly, renderer);
    vplPieceHeader own = assembly->first;
    if (assembly->first.grid.count == 0) {
        return VPL_SUCCESS;
    }
    own.scene = vplRenderer_HashScene(renderer);
    TRY(vplRenderer_HashOptions(renderer, &own.options));
    return checkSame(assembly, &own, "this render");
}

// Adds the passes of a band whose turn it is.
static void addPasses(vplAssembly* a, int band)
{
    const vplPieceGrid* g = &a->first.grid;
    for (; a->next[band] < g->passes; a->next[band]++) {
        const int index = band * g->passes + a->next[band];
        Waiting* w = &a->waiting[index];
        if (w->values == NULL) {
            return;
        }
        const vplPiecePlace place = vplPieceGrid_Place(g, index);
        const size_t first = 3 * (size_t)place.firstRow * (size_t)g->width;
        for (size_t k = 0; k < place.values; k++) {
            a->sums[first + k] += w->share * (double)w->values[k];
        }
        for (size_t k = 0; k < place.values && a->direct != NULL; k++) {
            a->direct->pixels[first + k] += (float)w->share * w->values[place.values + k];
        }
        a->weights[band] += w->share;
        vplFree(a->context, w->values);
        w->values = NULL;
    }
}

bool vplAssembly_Has(const vplAssembly* a, int index)
{
    if (a == NULL) {
        return false;
    }
    const vplPieceGrid* g = &a->first.grid;
    return index >= 0 && index < g->count &&
           (index % g->passes < a->next[index / g->passes] || a->waiting[index].values != NULL);
}

// Takes the floats of a piece over.
static vplResult take(vplAssembly* a, const vplPieceHeader* h, const uint8_t* bytes, const char* name)
{
    const vplPiecePlace place = vplPieceGrid_Place(&h->grid, h->index);
    vplStream s = {.bytes = (uint8_t*)bytes, .at = VPL_PIECE_HEADER_BYTES, .finite = true};
    const size_t first = 3 * (size_t)place.firstRow * (size_t)h->grid.width;
    const size_t count = place.values * (1 + (size_t)h->splits);
    float* values = h->mean ? vplAlloc(a->context, count, sizeof *values) : NULL;
    if (h->mean && values == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    if (!h->mean || place.pass == 0) {
        vplStream_Floats(&s, a->base->pixels + first, place.values);
    }
    if (h->mean) {
        vplStream_Floats(&s, values, count);
    } else if (h->splits) {
        vplStream_Floats(&s, a->direct->pixels + first, place.values);
    }
    if (!s.finite) {
        vplFree(a->context, values);
        return vplFail(a->context, VPL_PARSE_ERROR, "%s: a piece has values that are no numbers", name);
    }
    a->waiting[h->index] = (Waiting){values, h->share};
    if (h->mean) {
        addPasses(a, place.band);
    } else {
        a->next[place.band] = 1;
    }
    a->missing--;
    return VPL_SUCCESS;
}

vplResult vplAssembly_Add(vplAssembly* a, const uint8_t* bytes, size_t size, const char* name,
                          size_t* usedOut)
{
    REQUIRE(CONTEXT_OF(a), a, name, usedOut);
    REQUIRE_ARRAY(CONTEXT_OF(a), bytes, size);
    vplPieceHeader h;
    const bool opens = a->first.grid.count == 0;
    TRY(vplPiece_Read(a->context, bytes, size, name, &h));
    vplResult result = opens ? startPicture(a, &h) : checkSame(a, &h, name);
    if (result == VPL_SUCCESS && !vplAssembly_Has(a, h.index)) {
        result = take(a, &h, bytes, name);
    }
    if (result != VPL_SUCCESS && opens) {
        empty(a);
    }
    TRY(result);
    *usedOut = vplPiece_Size(&h);
    return VPL_SUCCESS;
}

vplPieceGrid vplAssembly_GetGrid(const vplAssembly* a)
{
    if (a == NULL) {
        return (vplPieceGrid){0};
    }
    return a->first.grid;
}

int vplAssembly_CountMissing(const vplAssembly* a)
{
    if (a == NULL) {
        return 0;
    }
    return a->missing;
}

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
