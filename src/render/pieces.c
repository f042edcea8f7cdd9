// SPDX-License-Identifier: MIT
// Renders pieces of a picture. A piece is some rows of one pass: its random numbers depend on pixels and on the pass alone,
// so it has the bits that these rows have in the whole pass.
#include "base/hash.h"
#include "reference/path_trace.h"
#include "render/piece_file.h"
#include "render/renderer.h"
#include "render/replay.h"
#include "render/show.h"
#include "render/stages/make.h"

#include <string.h>

enum {
    PATH_TILE = 16,  // rows of a tile of the path tracer
    MOST_ARRAYS = 3, // of a piece
};

// ---- the division

// Why a picture is not made of pieces; NULL: it is.
static const char* findObstacle(const vplRenderer* r)
{
    const vplPlan* p = r->plan;
    const vplRenderOptions* o = &p->options;
    const vplStopOptions* asked = &r->asked.stop; // a coarse first plan has no budget
    return asked->budgetMs > 0 || asked->maxError > 0 || asked->quality != VPL_QUALITY_NONE ||
                   vplPathsAreOpen(p) || (p->progressive && o->stop.passes <= 0)
               ? "a time or an error ends this picture, so its pieces are not known before; a number of them "
                 "has --passes N without --budget, --max-error and --quality, and by --method path --spp N"
           : o->output.pixelSize > 1
               ? "a piece has whole rows of the picture: --pixel-size must be 1 for a picture in pieces"
           : o->path.edgePixels > 0 ? "pixels at edges are chosen from the whole picture: --edge-pixels must "
                                      "be 0 for a picture in pieces"
           : o->sequence.coherence == VPL_COHERENCE_ON && o->sequence.history != NULL
               ? "frames that depend on the one before are not made of pieces: --coherence must be off"
           : p->progressive && VPL_SHOWS[o->output.show].drawOver != NULL
               ? "marks are drawn over the mean of all passes: --show must be another for a picture in pieces"
               : NULL;
}

vplResult vplRenderer_Divide(const vplRenderer* r, int bands, vplPieceGrid* gridOut)
{
    REQUIRE(vplRenderer_ContextOf(r), r, gridOut);
    const vplPlan* p = r->plan;
    const vplOutputOptions* o = &p->options.output;
    const char* obstacle = findObstacle(r);
    if (obstacle != NULL) {
        return vplFail(r->runner.run.context, VPL_INVALID_ARGUMENT, "%s", obstacle);
    }
    if (bands < 1) {
        return vplFail(r->runner.run.context, VPL_INVALID_ARGUMENT,
                       "vplRenderer_Divide: bands is %d, must be at least 1", bands);
    }
    const int tile = p->options.method == VPL_METHOD_PATH ? PATH_TILE : VPL_TILE_SIDE;
    const int tiles = (o->height + tile - 1) / tile, most = bands < tiles ? bands : tiles;
    vplPieceGrid g = {.width = o->width, .height = o->height, .rows = (tiles + most - 1) / most * tile};
    g.bands = (o->height + g.rows - 1) / g.rows;
    g.passes = p->progressive ? p->options.stop.passes : 1;
    g.count = g.passes * g.bands; // at most 2^20 passes in 256 bands
    *gridOut = g;
    return VPL_SUCCESS;
}

// ---- rendering

vplResult vplRenderer_Prepare(vplRenderer* r)
{
    REQUIRE(vplRenderer_ContextOf(r), r);
    const vplPlan* p = r->plan;
    int last = -1;
    for (int i = 0; i < p->stageCount && p->options.method == VPL_METHOD_RADIOSITY; i++) {
        const int id = p->stages[i].id;
        last = id != VPL_STAGE_EMITTER_MAPS && id != VPL_STAGE_PICTURE ? id : last;
    }
    r->runner.stepFrom = r->runner.reported = 0;
    r->runner.stepTo = 1;
    return last >= 0 ? vplRunner_RunPlan(&r->runner, p, (vplStageId)last) : VPL_SUCCESS;
}

static vplResult drawParts(vplRenderer* r, int parts, vplImage** imageOut)
{
    r->runner.run.parts = parts;
    TRY(vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_PICTURE));
    *imageOut = vplRunner_Take(&r->runner, VPL_STAGE_PICTURE);
    return VPL_SUCCESS;
}

// Traces all paths of the piece's rows.
static vplResult tracePiece(vplRenderer* r, vplImage** imageOut)
{
    vplRun* run = &r->runner.run;
    const int all = r->plan->options.path.samples, each = vplPathsOfPass(r->plan);
    for (int done = 0; done < all; run->pass++) {
        run->samples = all - done < each ? all - done : each;
        r->runner.stepFrom = (double)done / all;
        r->runner.stepTo = (double)(done + run->samples) / all;
        TRY(vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_COUNT));
        done += run->samples;
    }
    return vplResolvePaths(run, imageOut);
}

// Draws a pass of a mean, and before the first one direct light; or all light at once. The images have the whole picture's size.
static vplResult drawLight(vplRenderer* r, vplImage** images)
{
    const vplPlan* p = r->plan;
    if (p->progressive) {
        const bool first = r->runner.run.pass == 0;
        TRY(first ? drawParts(r, VPL_PART_DIRECT, &images[0]) : VPL_SUCCESS);
        return drawParts(r, VPL_PART_INDIRECT, &images[first]);
    }
    TRY(drawParts(r, VPL_PART_DIRECT | VPL_PART_INDIRECT, &images[0]));
    const vplShowRow* show = &VPL_SHOWS[p->options.output.show];
    return show->drawOver != NULL ? show->drawOver(&r->runner.run, images[0]) : VPL_SUCCESS;
}

// Draws the arrays of a piece.
static vplResult drawPiece(vplRenderer* r, const vplPieceHeader* h, vplImage* images[MOST_ARRAYS])
{
    const bool traces = r->plan->options.method == VPL_METHOD_PATH;
    vplImage** direct = &images[vplPiece_CountArrays(h) - 1];
    TRY(traces ? tracePiece(r, &images[0]) : drawLight(r, images));
    return !h->splits ? VPL_SUCCESS
           : traces   ? vplResolveDirectPaths(&r->runner.run, direct)
                      : vplRenderer_DrawDirect(r, direct);
}

vplResult vplRenderer_HashOptions(const vplRenderer* r, uint64_t* hashOut)
{
    vplByteBuffer text = {.context = r->runner.run.context};
    vplReplayList(r->plan, &text);
    *hashOut = text.failed ? 0 : vplState_Checksum(text.bytes, text.size);
    vplFree(text.context, text.bytes);
    return text.failed ? VPL_OUT_OF_MEMORY : VPL_SUCCESS;
}

// Writes the rows of the images as a piece.
static vplResult writePiece(vplContext* context, vplPieceHeader* h, vplImage** images, uint8_t** bytesOut)
{
    const vplPiecePlace place = vplPieceGrid_Place(&h->grid, h->index);
    vplStream s = {.bytes = vplAlloc(context, vplPiece_Size(h), 1), .writes = true};
    if (s.bytes == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplPiece_StreamHeader(&s, h);
    for (int i = 0; i < vplPiece_CountArrays(h); i++) {
        vplStream_Floats(&s, images[i]->pixels + 3 * (size_t)place.firstRow * (size_t)h->grid.width,
                         place.values);
    }
    uint64_t checksum = vplState_Checksum(s.bytes, s.at);
    vplStream_Long(&s, &checksum);
    *bytesOut = s.bytes;
    return VPL_SUCCESS;
}

vplResult vplRenderer_MakePiece(vplRenderer* r, const vplPieceGrid* grid, int index, uint8_t** bytesOut,
                                size_t* sizeOut)
{
    REQUIRE(vplRenderer_ContextOf(r), r, grid, bytesOut, sizeOut);
    vplRun* run = &r->runner.run;
    vplImage* images[MOST_ARRAYS] = {NULL};
    vplPieceGrid own;
    TRY(vplRenderer_Divide(r, grid->bands, &own));
    if (memcmp(&own, grid, sizeof own) != 0 || index < 0 || index >= own.count) {
        return vplFail(run->context, VPL_INVALID_ARGUMENT,
                       "vplRenderer_MakePiece: piece %d of another division, must be in [0, %d)", index,
                       own.count);
    }
    const vplPiecePlace place = vplPieceGrid_Place(grid, index);
    vplPieceHeader h = {.scene = vplRenderer_HashScene(r),
                        .grid = own,
                        .index = index,
                        .mean = r->plan->progressive,
                        .splits = vplPassesSplitLight(r->plan),
                        .share = r->plan->progressive ? vplShareOfPass(r->plan, place.pass) : 1};
    TRY(vplRenderer_HashOptions(r, &h.options));
    run->pass = place.pass;
    run->firstRow = place.firstRow;
    run->endRow = place.endRow;
    r->runner.stepFrom = r->runner.reported = 0;
    r->runner.stepTo = 1;
    vplResult result = drawPiece(r, &h, images);
    run->firstRow = run->endRow = 0;
    result = result == VPL_SUCCESS ? writePiece(run->context, &h, images, bytesOut) : result;
    for (int i = 0; i < MOST_ARRAYS; i++) {
        vplImage_Destroy(images[i]);
    }
    *sizeOut = result == VPL_SUCCESS ? vplPiece_Size(&h) : *sizeOut;
    return result;
}
