// SPDX-License-Identifier: MIT
// Puts pieces together. Passes are added in their order, as vplRenderer_Step adds them, so a pass that comes before its
// turn waits.
#include "render/assembly.h"

#include "image/image_file.h"
#include "render/renderer.h"
#include "render/stages/results.h"

#include <float.h>
#include <math.h>
#include <string.h>

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
    for (size_t i = 0; i < a->waitingCount; i++) {
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
    a->missing = g->count;
    const bool whole = (a->sums != NULL || !h->mean) && a->weights != NULL && a->next != NULL;
    return whole ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static vplResult checkHashes(const vplAssembly* a, const vplPieceHeader* h, const char* name)
{
    const vplPieceHeader* f = &a->first;
    return h->scene == f->scene && h->options == f->options
               ? VPL_SUCCESS
               : vplFail(a->context, VPL_INVALID_ARGUMENT,
                         "%s: a part of another picture than the first: %s differ", name,
                         h->scene != f->scene ? "scene or camera" : "options");
}

static vplResult checkGrid(const vplAssembly* a, const vplPieceHeader* h, const char* name)
{
    const vplPieceHeader* f = &a->first;
    const bool same =
        memcmp(&h->grid, &f->grid, sizeof h->grid) == 0 && h->mean == f->mean && h->splits == f->splits;
    return same ? VPL_SUCCESS
                : vplFail(
                      a->context, VPL_INVALID_ARGUMENT,
                      "%s: divided in %d bands of %d rows and %d passes, must be in %d of %d and %d as the "
                      "first part",
                      name, h->grid.bands, h->grid.rows, h->grid.passes, f->grid.bands, f->grid.rows,
                      f->grid.passes);
}

static vplResult checkSame(const vplAssembly* a, const vplPieceHeader* h, const char* name)
{
    TRY(checkHashes(a, h, name));
    return checkGrid(a, h, name);
}

vplResult vplAssembly_CheckRenderer(const vplAssembly* assembly, const vplRenderer* renderer)
{
    REQUIRE(vplRenderer_ContextOf(renderer) ?: CONTEXT_OF(assembly), assembly, renderer);
    vplPieceHeader own = assembly->first;
    if (assembly->first.grid.count == 0) {
        return VPL_SUCCESS;
    }
    own.scene = vplRenderer_HashScene(renderer);
    own.mean = renderer->plan->progressive;
    own.splits = vplPassesSplitLight(renderer->plan);
    TRY(vplRenderer_HashOptions(renderer, &own.options));
    TRY(checkHashes(assembly, &own, "this render"));
    // Hashes alone do not make a header right: whoever writes a file can copy them.
    TRY(vplRenderer_Divide(renderer, own.grid.bands, &own.grid));
    return checkGrid(assembly, &own, "this render");
}

// The place of a piece among those that wait, or where it belongs.
static size_t findWaiting(const vplAssembly* a, int index)
{
    size_t first = 0, end = a->waitingCount;
    while (first < end) {
        const size_t middle = first + (end - first) / 2;
        if (a->waiting[middle].index < index) {
            first = middle + 1;
        } else {
            end = middle;
        }
    }
    return first;
}

static bool waits(const vplAssembly* a, size_t at, int index)
{
    return at < a->waitingCount && a->waiting[at].index == index;
}

// Adds a pass whose turn it is, and frees its values.
static void addPass(vplAssembly* a, const vplWaiting* w)
{
    const vplPiecePlace place = vplPieceGrid_Place(&a->first.grid, w->index);
    const size_t first = 3 * (size_t)place.firstRow * (size_t)a->first.grid.width;
    for (size_t k = 0; k < place.values; k++) {
        a->sums[first + k] += w->share * (double)w->values[k];
    }
    for (size_t k = 0; k < place.values && a->direct != NULL; k++) {
        a->direct->pixels[first + k] += (float)w->share * w->values[place.values + k];
    }
    a->weights[place.band] += w->share;
    a->next[place.band]++;
    vplFree(a->context, w->values);
}

// Adds a pass whose turn it is, and those of its band that waited for it. Any other pass waits; the list has room for one more.
static void addOrWait(vplAssembly* a, const vplWaiting* w)
{
    const vplPiecePlace place = vplPieceGrid_Place(&a->first.grid, w->index);
    const size_t at = findWaiting(a, w->index), behind = a->waitingCount - at;
    if (place.pass > a->next[place.band]) {
        memmove(&a->waiting[at + 1], &a->waiting[at], behind * sizeof *w);
        a->waiting[at] = *w;
        a->waitingCount++;
        return;
    }
    size_t added = 0;
    addPass(a, w);
    while (waits(a, at + added,
                 w->index + 1 + (int)added)) { // never of another band, whose pass 0 does not wait
        addPass(a, &a->waiting[at + added]);
        added++;
    }
    memmove(&a->waiting[at], &a->waiting[at + added], (behind - added) * sizeof *w);
    a->waitingCount -= added;
}

bool vplAssembly_Has(const vplAssembly* a, int index)
{
    if (a == NULL) {
        return false;
    }
    const vplPieceGrid* g = &a->first.grid;
    return index >= 0 && index < g->count &&
           (index % g->passes < a->next[index / g->passes] || waits(a, findWaiting(a, index), index));
}

// Takes the floats of a piece over.
static vplResult take(vplAssembly* a, const vplPieceHeader* h, const uint8_t* bytes, const char* name)
{
    const vplPiecePlace place = vplPieceGrid_Place(&h->grid, h->index);
    vplStream s = {.bytes = (uint8_t*)bytes, .at = VPL_PIECE_HEADER_BYTES, .finite = true};
    const size_t first = 3 * (size_t)place.firstRow * (size_t)h->grid.width;
    const size_t count = place.values * (1 + (size_t)h->splits);
    float* values = NULL;
    if (h->mean) {
        TRY(vplReserve(a->context, &a->waiting, &a->waitingRoom, a->waitingCount + 1, sizeof *a->waiting));
        values = vplAlloc(a->context, count, sizeof *values);
        if (values == NULL) {
            return VPL_OUT_OF_MEMORY;
        }
    }
    if (!h->mean || place.pass == 0) {
        vplStream_Floats(&s, a->base->pixels + first, place.values);
    }
    if (h->mean) {
        vplStream_Floats(&s, values, count);
    } else if (h->splits) {
        vplStream_Floats(&s, a->direct->pixels + first, place.values);
    }
    // The sum of two such values is a float, also where rounding has added to them.
    const double most = (double)FLT_MAX / 4;
    const bool small = !h->mean || (vplStream_AreSmall(a->base->pixels + first, place.values, most) &&
                                    vplStream_AreSmall(values, count, most));
    if (!s.finite || !small) {
        vplFree(a->context, values);
        return vplFail(a->context, VPL_PARSE_ERROR, "%s: a piece has values that are no numbers%s", name,
                       s.finite ? " or too large" : "");
    }
    if (h->mean) {
        addOrWait(a, &(vplWaiting){h->index, values, h->share});
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
