// SPDX-License-Identifier: MIT
// Saves the state of a render between two passes.
#include "base/file.h"
#include "base/hash.h"
#include "reference/path_trace.h"
#include "render/options.h"
#include "render/replay.h"
#include "render/stages/make.h"
#include "render/stages/results.h"
#include "render/state_file.h"

#include <math.h>
#include <string.h>

// Hashes a view word by word, the low half of a double first, so that files go from one machine to any other.
static uint64_t hashView(uint64_t state, const vplView* view)
{
    const size_t first = offsetof(vplView, scaleX) / sizeof(uint32_t);
    const double numbers[] = {view->scaleX,  view->scaleY,    view->offsetX,
                              view->offsetY, view->nearPlane, view->farPlane};
    uint32_t words[sizeof *view / sizeof(uint32_t)];
    memcpy(words, view, sizeof words);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        uint64_t bits;
        memcpy(&bits, &numbers[i], sizeof bits);
        words[first + 2 * i] = (uint32_t)bits;
        words[first + 2 * i + 1] = (uint32_t)(bits >> 32);
    }
    return vplHashWords(state, words, sizeof words / sizeof *words);
}

uint64_t vplRenderer_HashScene(const vplRenderer* r)
{
    const uint64_t scene = vplScene_GetHash(r->runner.run.scene);
    return r->asked.view != NULL ? hashView(scene, &r->plan->view) : scene;
}

static vplStateHeader describe(const vplRenderer* r, const vplByteBuffer* text)
{
    const vplOutputOptions* o = &r->plan->options.output;
    const uint32_t parts = r->done > 0 ? vplState_PartsOf(r->plan) : 0;
    const bool coarse = r->coarse || o->pixelSize > r->asked.output.pixelSize;
    const uint32_t plan = (r->replanned ? VPL_STATE_REPLANNED : 0) | (coarse ? VPL_STATE_COARSE : 0);
    vplStateHeader h = {.version = VPL_STATE_VERSION,
                        .textBytes = (uint32_t)text->size,
                        .scene = vplRenderer_HashScene(r),
                        .width = (uint32_t)vplRenderedWidth(o),
                        .height = (uint32_t)vplRenderedHeight(o),
                        .parts = parts | plan,
                        .passes = (uint32_t)r->done,
                        .truth = r->truth != NULL && r->asked.stop.maxError > 0
                                     ? (uint32_t)vplTruth_GetState(r->truth).count
                                     : 0,
                        .loss = {r->runner.loss.lost, r->runner.loss.all},
                        .unreviewed = r->unreviewed,
                        .spread = r->unreviewed && isfinite(r->spreadBefore) ? r->spreadBefore : -1,
                        .spent = vplRaysOfPlan(r),
                        .turn = {r->turn.rays, r->turn.pathSquare},
                        .side = (uint64_t)r->turn.side,
                        .edges = {(uint32_t)r->edgePixels, (uint32_t)r->edgePaths},
                        .tries = (uint64_t)r->edgeTries,
                        .coarser = r->coarserSquare,
                        .lights = r->lightRays};
    for (int i = 0; i < vplState_CountTracers(parts); i++) {
        vplPathTracer* tracer = vplGetPathTracer(&r->runner.run, i > 0);
        h.samples = (uint32_t)vplPathTracer_GetSums(tracer).samples;
        h.rays[i] = (uint64_t)vplPathTracer_CountRays(tracer);
    }
    return h;
}

static vplResult save(vplRenderer* r, const vplByteBuffer* text, const char* path)
{
    vplContext* context = r->runner.run.context;
    vplStateHeader h = describe(r, text);
    const size_t size = vplState_Size(&h);
    vplStream s = {.bytes = vplAllocZero(context, size, 1), .writes = true};
    if (s.bytes == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    memcpy(s.bytes, VPL_STATE_MAGIC, VPL_STATE_MAGIC_BYTES);
    vplState_StreamHeader(&s, &h);
    memcpy(s.bytes + s.at, text->bytes, text->size);
    s.at += text->size;
    vplState_StreamSums(&s, r, h.parts);
    if (h.truth > 0) {
        vplState_StreamTruth(&s, r);
    }
    uint64_t checksum = vplState_Checksum(s.bytes, s.at);
    vplStream_Long(&s, &checksum);
    const vplResult result = vplWriteFile(context, path, s.bytes, size);
    vplFree(context, s.bytes);
    return result;
}

vplResult vplRenderer_Save(vplRenderer* r, const char* path)
{
    REQUIRE(vplRenderer_ContextOf(r), r, path);
    vplContext* context = r->runner.run.context;
    if (!vplRenderer_HasState(r)) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "a render that is drawn at once has no state to save; renders of several passes have "
                       "one (--passes, --budget, --max-error), and path tracing");
    }
    if (!vplRenderer_HasPicture(r)) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "a renderer has no state to save before its first step");
    }
    vplByteBuffer text = {.context = context};
    vplReplayList(r->plan, &text);
    const vplResult result = text.failed ? VPL_OUT_OF_MEMORY : save(r, &text, path);
    vplFree(context, text.bytes);
    return result;
}
