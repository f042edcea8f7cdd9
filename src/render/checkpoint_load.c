// SPDX-License-Identifier: MIT
// Resumes a saved render. Every size and value of the file is checked.
#include "base/file.h"
#include "reference/path_trace.h"
#include "render/options.h"
#include "render/replay.h"
#include "render/stages/make.h"
#include "render/stages/results.h"
#include "render/state_file.h"

#include <math.h>
#include <string.h>

typedef struct Loading {
    vplRenderer* renderer;
    const char* path;
    vplStream stream;
    size_t size; // of the file
    vplStateHeader header;
} Loading;

// Checks all that can be checked without the renderer.
static vplResult checkFile(Loading* l)
{
    const vplContext* context = l->renderer->runner.run.context;
    const size_t least = VPL_STATE_HEADER_BYTES + VPL_STATE_CHECKSUM_BYTES;
    if (l->size < VPL_STATE_MAGIC_BYTES ||
        memcmp(l->stream.bytes, VPL_STATE_MAGIC, VPL_STATE_MAGIC_BYTES) != 0) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: not the state of a render, which begins with VPLSTATE",
                       l->path);
    }
    if (l->size < least || l->size % 4 != 0) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: has %zu bytes, too few: the file is not complete",
                       l->path, l->size);
    }
    vplState_StreamHeader(&l->stream, &l->header);
    if (l->header.version != VPL_STATE_VERSION) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: is of version %u, must be of version %d", l->path,
                       (unsigned)l->header.version, VPL_STATE_VERSION);
    }
    uint64_t checksum = 0;
    l->stream.at = l->size - VPL_STATE_CHECKSUM_BYTES;
    vplStream_Long(&l->stream, &checksum);
    if (checksum != vplState_Checksum(l->stream.bytes, l->size - VPL_STATE_CHECKSUM_BYTES) ||
        l->header.textBytes > l->size - least || l->header.textBytes % 4 != 0) {
        return vplFail(context, VPL_PARSE_ERROR,
                       "%s: its checksum does not fit: the file is damaged or not complete", l->path);
    }
    return VPL_SUCCESS;
}

// A list of options that is read line by line.
typedef struct Lines {
    const char *at, *end;
} Lines;

// Copies the next line that is not empty, or as much of it as fits. Returns false at the end.
static bool nextLine(Lines* lines, char line[128])
{
    size_t length = 0;
    while (lines->at < lines->end && *lines->at == '\n') {
        lines->at++;
    }
    for (; lines->at < lines->end && *lines->at != '\n'; lines->at++) {
        line[length] = *lines->at;
        length += length < 127;
    }
    line[length] = 0;
    return length > 0;
}

// Compares two lists of options line by line.
static vplResult checkOptions(const Loading* l, Lines was, Lines is)
{
    const vplContext* context = l->renderer->runner.run.context;
    vplRenderOptions scratch = vplDefaultRenderOptions();
    char before[128], now[128];
    while (nextLine(&is, now)) {
        const bool more = nextLine(&was, before);
        const size_t named = strcspn(now, "=") + 1;
        const bool same = more && strcmp(before, now) == 0, alike = more && strncmp(before, now, named) == 0;
        now[named - 1] = 0;
        if (!alike || vplRenderOptions_Set(&scratch, now, before + named) != VPL_SUCCESS) {
            return vplFail(
                context, VPL_PARSE_ERROR,
                "%s: saved with other options than this version of the library has: --%s is not where it "
                "should be",
                l->path, now);
        }
        if (!same && !vplIsStop(vplFindOption(now))) {
            return vplFail(
                context, VPL_INVALID_ARGUMENT,
                "%s: saved with --%s %s, but this render has %s; only passes, spp, budget, max-error and "
                "quality may differ",
                l->path, now, before + named, now + named);
        }
    }
    return VPL_SUCCESS;
}

static vplResult checkScene(const Loading* l)
{
    const vplRenderer* r = l->renderer;
    return l->header.scene == vplRenderer_HashScene(r)
               ? VPL_SUCCESS
               : vplFail(r->runner.run.context, VPL_INVALID_ARGUMENT,
                         "%s: saved with another scene or view, or the scene was changed since", l->path);
}

static vplResult checkRender(const Loading* l)
{
    const vplRenderer* r = l->renderer;
    const vplStateHeader* h = &l->header;
    const vplContext* context = r->runner.run.context;
    TRY(checkScene(l));
    vplByteBuffer text = {.context = r->runner.run.context};
    vplReplayList(r->plan, &text);
    const char *was = (const char*)l->stream.bytes + VPL_STATE_HEADER_BYTES, *is = (const char*)text.bytes;
    const vplResult result =
        text.failed ? VPL_OUT_OF_MEMORY
                    : checkOptions(l, (Lines){was, was + h->textBytes}, (Lines){is, is + text.size});
    vplFree(r->runner.run.context, text.bytes);
    TRY(result);
    const uint32_t parts = vplState_PartsOf(r->plan);
    if (!vplRenderer_HasState(r) || (h->parts & ~(uint32_t)VPL_STATE_PLANS) != (h->passes > 0 ? parts : 0)) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "%s: saved by a render of several passes, and this one is drawn at once: say when it ends, by "
            "--passes, --budget or --max-error",
            l->path);
    }
    const vplOutputOptions* size = &r->plan->options.output;
    const bool truth = h->truth <= 1 << 16 && (h->truth == 0 || r->truth == NULL);
    // Coarse pictures have no paths through pixels at edges.
    const bool edges = h->edges[0] == 0 || (h->passes > 0 && h->edges[1] > 0 && size->pixelSize == 1);
    const bool counts =
        truth && h->rays[0] <= INT64_MAX / 4 && h->rays[1] <= INT64_MAX / 4 && h->passes <= VPL_MAX_SAMPLES &&
        h->side <= VPL_MAX_INTERLEAVE && h->tries <= VPL_MAX_SAMPLES && h->edges[0] <= VPL_MAX_EDGE_PIXELS &&
        h->edges[1] <= VPL_MAX_SAMPLES && edges &&
        ((h->parts & VPL_STATE_PATHS) == 0 || (h->samples >= 1 && h->samples <= VPL_MAX_SAMPLES));
    const bool fits = h->width == (uint32_t)vplRenderedWidth(size) &&
                      h->height == (uint32_t)vplRenderedHeight(size) && vplState_Size(h) == l->size;
    return counts && fits
               ? VPL_SUCCESS
               : vplFail(context, VPL_PARSE_ERROR, "%s: its counts contradict each other", l->path);
}

// True for options whose saved values replace those of the caller: what --method auto chooses, and what is changed to fit a plan into the time.
static bool isPlanned(const vplRenderer* r, const char* name)
{
    static const char* const FOR_TIME[] = {"antialias",     "particles",       "compensation",
                                           "light-shadows", "emitter-samples", "pixel-size"};
    const vplOption* option = vplFindOption(name);
    bool planned = false;
    if (r->asked.method == VPL_METHOD_AUTO && option != NULL) {
        planned = strcmp(name, "method") == 0 ||
                  (option->users != VPL_USE_ALL && strcmp(name, "spp") != 0 && !vplIsStop(option));
    }
    for (size_t i = 0; i < sizeof FOR_TIME / sizeof *FOR_TIME; i++) {
        planned = planned || strcmp(name, FOR_TIME[i]) == 0;
    }
    return planned;
}

// Plans as the saved render had planned, where a time or --method auto may have led it to another plan than the first.
static vplResult replan(Loading* l)
{
    vplRenderer* r = l->renderer;
    const bool coarse = (l->header.parts & VPL_STATE_COARSE) != 0;
    const bool follows = r->asked.method == VPL_METHOD_AUTO || (l->header.parts & VPL_STATE_REPLANNED) != 0;
    const char* text = (const char*)l->stream.bytes + VPL_STATE_HEADER_BYTES;
    Lines lines = {text, text + l->header.textBytes};
    vplRenderOptions o = r->asked;
    char line[128];
    if (!follows && !r->coarse) {
        return VPL_SUCCESS;
    }
    while (follows && nextLine(&lines, line)) {
        const size_t named = strcspn(line, "=");
        const bool valued = line[named] == '=';
        line[named] = 0;
        if (valued && isPlanned(r, line)) {
            vplRenderOptions_Set(&o, line, line + named + 1);
        }
    }
    return vplRenderer_Plan(r, &o, coarse);
}

// Makes what the arrays are read into, or draws again what is drawn at once.
static vplResult openState(vplRenderer* r, uint32_t parts)
{
    const vplOutputOptions* o = &r->plan->options.output;
    vplContext* context = r->runner.run.context;
    if ((parts & VPL_STATE_PATHS) != 0) {
        r->runner.run.pass = 0;
        r->runner.run.samples = 0;
        return vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_PATHS);
    }
    if ((parts & VPL_STATE_ONCE) != 0) {
        return vplRenderer_RunPass(r);
    }
    vplImage_Destroy(r->base);
    vplImage_Destroy(r->direct);
    r->base = r->direct = NULL;
    const int width = vplRenderedWidth(o), height = vplRenderedHeight(o);
    TRY(vplImage_Create(context, width, height, &r->base));
    TRY((parts & VPL_STATE_DIRECT) != 0 ? vplImage_Create(context, width, height, &r->direct) : VPL_SUCCESS);
    return vplRenderer_OpenSums(r);
}

static vplResult loadState(Loading* l)
{
    vplRenderer* r = l->renderer;
    const vplStateHeader* h = &l->header;
    TRY(h->passes > 0 ? openState(r, h->parts) : VPL_SUCCESS); // else another plan had just begun
    l->stream.at = VPL_STATE_HEADER_BYTES + h->textBytes;
    vplState_StreamSums(&l->stream, r, h->parts);
    if (h->truth > 0) {
        TRY(vplTruth_Open(&r->runner.run, (int)h->truth, &r->truth));
        vplState_StreamTruth(&l->stream, r);
        l->stream.finite = l->stream.finite && vplState_IsTruthValid(r);
    }
    if (!l->stream.finite) {
        return vplFail(r->runner.run.context, VPL_PARSE_ERROR, "%s: has sums that are no numbers", l->path);
    }
    double weight = 0;
    for (int k = 0; k < (int)h->passes && weight < 1e9; k++) {
        weight += vplShareOfPass(r->plan, k);
    }
    if (!vplState_AreSumsValid(r, h->parts, weight)) {
        return vplFail(r->runner.run.context, VPL_PARSE_ERROR, "%s: has sums that no picture has", l->path);
    }
    for (int i = 0; i < vplState_CountTracers(h->parts); i++) {
        vplPathTracer* tracer = vplGetPathTracer(&r->runner.run, i > 0);
        vplPathTracer_SetSamples(tracer, (int)h->samples);
        vplPathTracer_SetRays(tracer, (int64_t)h->rays[i]);
    }
    r->runner.loss = (vplClampLoss){h->loss[0], h->loss[1]};
    r->done = (int)h->passes;
    r->paths = (int)h->samples;
    r->weight = weight;
    r->edgeTries = (int)h->tries;
    r->coarserSquare = h->coarser;
    r->lightRays = h->lights;
    r->stale = true;
    if (h->edges[0] > 0) { // made again, from the same picture
        TRY(vplRenderer_TraceEdges(r, (int)h->edges[0], (int)h->edges[1]));
    }
    r->planRays = (double)r->runner.stats.rays - h->spent;
    r->turn = (vplTurn){h->turn[0], h->turn[1], (int)h->side};
    r->unreviewed = h->unreviewed != 0 && r->done > 0;
    r->spreadBefore = r->unreviewed && h->spread >= 0 ? h->spread : INFINITY;
    return VPL_SUCCESS;
}

// True if the saved picture is coarse, or there is none yet: a render that has a time, or whose caller chose the method, begins anew.
static bool beginsAnew(const Loading* l)
{
    const vplRenderer* r = l->renderer;
    const bool coarse = l->header.passes == 0 || (l->header.parts & VPL_STATE_COARSE) != 0;
    return coarse && (isfinite(r->deadline) || r->asked.method != VPL_METHOD_AUTO);
}

static vplResult load(Loading* l)
{
    vplRenderer* r = l->renderer;
    TRY(checkFile(l));
    if (beginsAnew(l)) {
        return checkScene(l);
    }
    TRY(replan(l));
    TRY(checkRender(l));
    const double deadline = r->deadline;
    r->deadline = INFINITY; // the saved picture is made again whole, even if the time is over before
    const vplResult result = loadState(l);
    r->deadline = deadline;
    return result;
}

// Leaves the renderer before its first step, which would add to what was loaded.
static void takeBack(const Loading* l)
{
    vplRenderer* r = l->renderer;
    const int tracers = r->done > 0 ? vplState_CountTracers(l->header.parts) : 0;
    for (int i = 0; i < tracers; i++) {
        vplPathTracer* tracer = vplGetPathTracer(&r->runner.run, i > 0);
        vplPathTracer_SetSamples(tracer, 0);
        vplPathTracer_SetRays(tracer, 0);
    }
    vplRenderer_ForgetEdges(r);
    vplImage_Destroy(r->direct);
    vplTruth_Destroy(r->truth);
    r->direct = NULL;
    r->truth = NULL;
    r->runner.loss = (vplClampLoss){0, 0};
    r->done = r->paths = r->edgeTries = 0;
    r->weight = r->coarserSquare = r->lightRays = 0;
    r->stale = false;
}

vplResult vplRenderer_Load(vplRenderer* r, const char* path, bool* doneOut)
{
    REQUIRE(vplRenderer_ContextOf(r), r, path, doneOut);
    vplContext* context = r->runner.run.context;
    Loading l = {.renderer = r, .path = path, .stream = {.finite = true}};
    char* bytes;
    if (r->done > 0) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "a renderer can load a state before its first step only");
    }
    const vplWatch outer = vplSetWatch(context, r->runner.progress, r, 0); // a pipe may be silent
    vplResult result = vplReadFile(context, path, &bytes, &l.size);
    context->watch = outer;
    TRY(result);
    l.stream.bytes = (uint8_t*)bytes;
    result = load(&l);
    vplFree(context, bytes);
    if (result != VPL_SUCCESS) {
        takeBack(&l);
        return result;
    }
    if (r->done == 0) { // callers may ask for the picture of what was loaded
        return vplRenderer_Step(r, doneOut);
    }
    const double asked = r->asked.stop.maxError;
    if (asked > 0 && r->plan->options.method == VPL_METHOD_PATH) { // its error is that of its sums
        vplImage* image = NULL;
        result = vplRenderer_Resolve(r, &image);
        vplImage_Destroy(image);
        TRY(result);
    }
    const double bound = r->error.bound;
    *doneOut =
        !r->unreviewed && !r->coarse && (vplIsComplete(r) || (asked > 0 && bound >= 0 && bound <= asked));
    return VPL_SUCCESS;
}
