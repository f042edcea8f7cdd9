// SPDX-License-Identifier: MIT
// Saves a render between two passes and goes on with it. A file has, all words little-endian: the 8 letters
// VPLSTATE, a header, the options as text, the sums that the picture is made from, and a checksum. Before the
// first pass of a plan that replaces another there are no sums. Reading checks every size and value.
#include "base/file.h"
#include "base/hash.h"
#include "reference/path_trace.h"
#include "reference/sparse_paths.h"
#include "render/renderer.h"
#include "render/replay.h"
#include "render/stages/make.h"
#include "render/stages/results.h"
#include "render/state_stream.h"

#include <math.h>
#include <string.h>

enum { VERSION = 3, HEADER_BYTES = 144, CHECKSUM_BYTES = 8 };

// Arrays that a file may have.
enum { PASSES = 1, PATHS = 2, DIRECT = 4 };

// Bytes of a pixel of the truth, and of what was concluded from them (streamTruth).
enum { TRUTH_PIXEL_BYTES = 80, TRUTH_BYTES = 40 };

static const char MAGIC[8] = {'V', 'P', 'L', 'S', 'T', 'A', 'T', 'E'};

typedef struct Header {
    uint32_t version, textBytes; // of the options, a multiple of 4
    uint64_t scene;              // vplRenderer_HashScene
    uint32_t width, height, parts;
    uint32_t passes, samples; // done; samples of path tracing
    uint32_t truth;           // pixels that tell the error; 0: there are none
    uint64_t rays[2];         // of path tracing: of the picture and of its direct light
    double loss[2];           // of virtual lights by the clamp
    uint64_t unreviewed;      // vplRenderer.unreviewed
    double spread;            // spreadBefore of an unreviewed pass; negative: infinite
    double spent;             // rays of the plan under way
    double turn[2];           // rays and pathSquare of vplRenderer.turn
    uint64_t side;            // of vplRenderer.turn
    uint32_t edges[2];        // edgePixels and edgePaths of vplRenderer
    uint64_t tries;           // edgeTries of vplRenderer
} Header;

static void streamHeader(vplStream* s, Header* h)
{
    s->at = sizeof MAGIC;
    vplStream_Word(s, &h->version);
    vplStream_Word(s, &h->textBytes);
    vplStream_Long(s, &h->scene);
    uint32_t* const words[] = {&h->width, &h->height, &h->parts, &h->passes, &h->samples, &h->truth};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        vplStream_Word(s, words[i]);
    }
    vplStream_Long(s, &h->rays[0]);
    vplStream_Long(s, &h->rays[1]);
    vplStream_Doubles(s, h->loss, 2);
    vplStream_Long(s, &h->unreviewed);
    vplStream_Doubles(s, &h->spread, 1);
    vplStream_Doubles(s, &h->spent, 1);
    vplStream_Doubles(s, h->turn, 2);
    vplStream_Long(s, &h->side);
    vplStream_Word(s, &h->edges[0]);
    vplStream_Word(s, &h->edges[1]);
    vplStream_Long(s, &h->tries);
}

// Bytes of the whole file.
static size_t sizeOf(const Header* h)
{
    const size_t values = 3 * (size_t)h->width * (size_t)h->height, direct = (h->parts & DIRECT) != 0;
    size_t size = HEADER_BYTES + h->textBytes + CHECKSUM_BYTES;
    size += (h->parts & PASSES) != 0 ? values * (2 * sizeof(double) + (1 + direct) * sizeof(float)) : 0;
    size += h->truth > 0 ? TRUTH_BYTES + (size_t)h->truth * TRUTH_PIXEL_BYTES : 0;
    size += (h->parts & PATHS) != 0 ? (1 + direct) * 2 * values * sizeof(double) : 0;
    return size;
}

// ---- the state of a renderer

// The arrays of a plan's renderer after its first pass; 0: it has no state between passes.
static uint32_t partsOf(const vplPlan* p)
{
    const bool paths = p->options.method == VPL_METHOD_PATH;
    const bool onSurfaces =
        p->options.method == VPL_METHOD_KELLER && (p->hasAreaLights || p->hasSky); // see addDirect
    const uint32_t parts = paths ? PATHS : p->progressive ? PASSES : 0;
    return parts | (parts != 0 && p->splitsLight && (paths || onSurfaces) ? DIRECT : 0);
}

static void streamState(vplStream* s, vplRenderer* r, uint32_t parts)
{
    for (int i = 0; i < 1 + ((parts & DIRECT) != 0) && (parts & PATHS) != 0; i++) {
        const vplPathSums sums = vplPathTracer_GetSums(vplGetPathTracer(&r->runner.run, i > 0));
        vplStream_Doubles(s, sums.values, sums.count);
    }
    if ((parts & PASSES) != 0) {
        const size_t values = vplValueCount(r->base);
        vplStream_Floats(s, r->base->pixels, values);
        vplStream_Doubles(s, r->sums[0], values);
        vplStream_Doubles(s, r->sums[1], values);
        if ((parts & DIRECT) != 0) {
            vplStream_Floats(s, r->direct->pixels, values);
        }
    }
}

// What was found of the error so far, on which it depends when the render ends.
static void streamTruth(vplStream* s, vplRenderer* r)
{
    const vplTruthState t = vplTruth_GetState(r->truth);
    uint32_t each = (uint32_t)t.each, reserved = 0;
    vplStream_Word(s, &each);
    vplStream_Word(s, &reserved);
    vplStream_Doubles(s, &r->judgedNoise, 1);
    vplStream_Doubles(s, &r->error.noise, 1);
    vplStream_Doubles(s, &r->error.total, 1);
    vplStream_Doubles(s, &r->error.bound, 1);
    for (int i = 0; i < t.count; i++) {
        vplSparsePixel* p = &t.pixels[i];
        uint32_t x = (uint32_t)p->x, y = (uint32_t)p->y;
        uint64_t rays = (uint64_t)p->rays;
        vplStream_Word(s, &x);
        vplStream_Word(s, &y);
        vplStream_Doubles(s, &p->sums[0].r, 3);
        vplStream_Doubles(s, &p->sums[1].r, 3);
        vplStream_Long(s, &rays);
        vplStream_Doubles(s, &t.weights[i], 1);
        p->x = (int)x;
        p->y = (int)y;
        p->rays = (int64_t)rays;
    }
    for (int i = 0; i < t.count; i++) {
        vplStream_Doubles(s, &t.pixels[i].squares, 1);
    }
    vplTruth_SetPaths(r->truth, (int)each);
}

// True if what was read of the truth lies in the picture and has plausible counts.
static bool isTruthValid(const vplRenderer* r)
{
    const vplTruthState t = vplTruth_GetState(r->truth);
    const vplOutputOptions* o = &r->plan->options.output;
    bool valid = t.each >= 1 && t.each <= VPL_MAX_SAMPLES / 2;
    for (int i = 0; i < t.count && valid; i++) {
        const vplSparsePixel* p = &t.pixels[i];
        valid = p->x >= 0 && p->x < o->width && p->y >= 0 && p->y < o->height && p->rays >= 0 &&
                p->rays < INT64_MAX / 4096;
    }
    return valid;
}

// ---- saving

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

static Header describe(const vplRenderer* r, const vplByteBuffer* text)
{
    const vplOutputOptions* o = &r->plan->options.output;
    const uint32_t parts = r->done > 0 ? partsOf(r->plan) : 0;
    Header h = {.version = VERSION,
                .textBytes = (uint32_t)text->size,
                .scene = vplRenderer_HashScene(r),
                .width = (uint32_t)o->width,
                .height = (uint32_t)o->height,
                .parts = parts,
                .passes = (uint32_t)r->done,
                .truth = r->truth != NULL && r->asked.stop.maxError > 0
                             ? (uint32_t)vplTruth_GetState(r->truth).count
                             : 0,
                .loss = {r->runner.loss.lost, r->runner.loss.all},
                .unreviewed = r->unreviewed,
                .spread = r->unreviewed && isfinite(r->spreadBefore) ? r->spreadBefore : -1,
                .spent = (double)r->runner.stats.rays - r->planRays,
                .turn = {r->turn.rays, r->turn.pathSquare},
                .side = (uint64_t)r->turn.side,
                .edges = {(uint32_t)r->edgePixels, (uint32_t)r->edgePaths},
                .tries = (uint64_t)r->edgeTries};
    for (int i = 0; i < 1 + ((parts & DIRECT) != 0) && (parts & PATHS) != 0; i++) {
        vplPathTracer* tracer = vplGetPathTracer(&r->runner.run, i > 0);
        h.samples = (uint32_t)vplPathTracer_GetSums(tracer).samples;
        h.rays[i] = (uint64_t)vplPathTracer_CountRays(tracer);
    }
    return h;
}

static vplResult save(vplRenderer* r, const vplByteBuffer* text, const char* path)
{
    vplContext* context = r->runner.run.context;
    Header h = describe(r, text);
    const size_t size = sizeOf(&h);
    vplStream s = {.bytes = vplAllocZero(context, size, 1), .writes = true};
    if (s.bytes == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    memcpy(s.bytes, MAGIC, sizeof MAGIC);
    streamHeader(&s, &h);
    memcpy(s.bytes + s.at, text->bytes, text->size);
    s.at += text->size;
    streamState(&s, r, h.parts);
    if (h.truth > 0) {
        streamTruth(&s, r);
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
    if (partsOf(r->plan) == 0) {
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

// ---- loading

typedef struct Loading {
    vplRenderer* renderer;
    const char* path;
    vplStream stream;
    size_t size; // of the file
    Header header;
} Loading;

// Checks all that can be checked without the renderer.
static vplResult checkFile(Loading* l)
{
    const vplContext* context = l->renderer->runner.run.context;
    const size_t least = HEADER_BYTES + CHECKSUM_BYTES;
    if (l->size < sizeof MAGIC || memcmp(l->stream.bytes, MAGIC, sizeof MAGIC) != 0) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: not the state of a render, which begins with VPLSTATE",
                       l->path);
    }
    if (l->size < least || l->size % 4 != 0) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: has %zu bytes, too few: the file is not complete",
                       l->path, l->size);
    }
    streamHeader(&l->stream, &l->header);
    if (l->header.version != VERSION) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: is of version %u, must be of version %d", l->path,
                       (unsigned)l->header.version, VERSION);
    }
    uint64_t checksum = 0;
    l->stream.at = l->size - CHECKSUM_BYTES;
    vplStream_Long(&l->stream, &checksum);
    if (checksum != vplState_Checksum(l->stream.bytes, l->size - CHECKSUM_BYTES) ||
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

static vplResult checkRender(const Loading* l)
{
    const vplRenderer* r = l->renderer;
    const Header* h = &l->header;
    const vplContext* context = r->runner.run.context;
    if (h->scene != vplRenderer_HashScene(r)) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "%s: saved with another scene or view, or the scene was changed since", l->path);
    }
    vplByteBuffer text = {.context = r->runner.run.context};
    vplReplayList(r->plan, &text);
    const char *was = (const char*)l->stream.bytes + HEADER_BYTES, *is = (const char*)text.bytes;
    const vplResult result =
        text.failed ? VPL_OUT_OF_MEMORY
                    : checkOptions(l, (Lines){was, was + h->textBytes}, (Lines){is, is + text.size});
    vplFree(r->runner.run.context, text.bytes);
    TRY(result);
    const uint32_t parts = partsOf(r->plan);
    if (parts == 0 || h->parts != (h->passes > 0 ? parts : 0)) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "%s: saved by a render of several passes, and this one is drawn at once: say when it ends, by "
            "--passes, --budget or --max-error",
            l->path);
    }
    const bool truth = h->truth <= 1 << 16 && (h->truth == 0 || r->truth == NULL);
    const bool counts =
        truth && h->rays[0] <= INT64_MAX / 4 && h->rays[1] <= INT64_MAX / 4 && h->passes <= VPL_MAX_SAMPLES &&
        h->side <= VPL_MAX_INTERLEAVE && h->tries <= VPL_MAX_SAMPLES && h->edges[0] <= VPL_MAX_EDGE_PIXELS &&
        h->edges[1] <= VPL_MAX_SAMPLES && (h->edges[0] == 0 || (h->passes > 0 && h->edges[1] > 0)) &&
        ((h->parts & PATHS) == 0 || (h->samples >= 1 && h->samples <= VPL_MAX_SAMPLES));
    const bool fits = h->width == (uint32_t)r->plan->options.output.width &&
                      h->height == (uint32_t)r->plan->options.output.height && sizeOf(h) == l->size;
    return counts && fits
               ? VPL_SUCCESS
               : vplFail(context, VPL_PARSE_ERROR, "%s: its counts contradict each other", l->path);
}

// Plans as the saved render had planned, where a goal or --method auto may have led it to another plan than the first.
static vplResult replan(Loading* l)
{
    vplRenderer* r = l->renderer;
    const char* text = (const char*)l->stream.bytes + HEADER_BYTES;
    Lines lines = {text, text + l->header.textBytes};
    vplRenderOptions o = r->asked;
    char line[128];
    if (r->asked.method != VPL_METHOD_AUTO && !r->coarse) {
        return VPL_SUCCESS;
    }
    while (r->asked.method == VPL_METHOD_AUTO && nextLine(&lines, line)) {
        const size_t named = strcspn(line, "=");
        const bool valued = line[named] == '=';
        line[named] = 0;
        const vplOption* option = vplFindOption(line);
        const bool planned =
            option != NULL && option->users != VPL_USE_ALL && strcmp(line, "spp") != 0 && !vplIsStop(option);
        if (valued && (planned || strcmp(line, "method") == 0)) {
            vplRenderOptions_Set(&o, line, line + named + 1);
        }
    }
    return vplRenderer_Plan(r, &o, false);
}

// Makes what the arrays are read into.
static vplResult openState(vplRenderer* r, uint32_t parts)
{
    const vplOutputOptions* o = &r->plan->options.output;
    vplContext* context = r->runner.run.context;
    if ((parts & PATHS) != 0) {
        r->runner.run.pass = 0;
        r->runner.run.samples = 0;
        return vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_PATHS);
    }
    vplImage_Destroy(r->base);
    vplImage_Destroy(r->direct);
    r->base = r->direct = NULL;
    TRY(vplImage_Create(context, o->width, o->height, &r->base));
    TRY((parts & DIRECT) != 0 ? vplImage_Create(context, o->width, o->height, &r->direct) : VPL_SUCCESS);
    return vplRenderer_OpenSums(r);
}

static vplResult loadState(Loading* l)
{
    vplRenderer* r = l->renderer;
    const Header* h = &l->header;
    TRY(h->passes > 0 ? openState(r, h->parts) : VPL_SUCCESS); // else another plan had just begun
    l->stream.at = HEADER_BYTES + h->textBytes;
    streamState(&l->stream, r, h->parts);
    if (h->truth > 0) {
        TRY(vplTruth_Open(&r->runner.run, (int)h->truth, &r->truth));
        streamTruth(&l->stream, r);
        l->stream.finite = l->stream.finite && isTruthValid(r);
    }
    if (!l->stream.finite) {
        return vplFail(r->runner.run.context, VPL_PARSE_ERROR, "%s: has sums that are no numbers", l->path);
    }
    for (int i = 0; i < 1 + ((h->parts & DIRECT) != 0) && (h->parts & PATHS) != 0; i++) {
        vplPathTracer* tracer = vplGetPathTracer(&r->runner.run, i > 0);
        vplPathTracer_SetSamples(tracer, (int)h->samples);
        vplPathTracer_SetRays(tracer, (int64_t)h->rays[i]);
    }
    r->runner.loss = (vplClampLoss){h->loss[0], h->loss[1]};
    r->done = (int)h->passes;
    r->paths = (int)h->samples;
    for (int k = 0; k < r->done && r->weight < 1e9; k++) {
        r->weight += vplShareOfPass(r->plan, k);
    }
    r->edgeTries = (int)h->tries;
    if (h->edges[0] > 0) { // made again, from the same picture
        TRY(vplRenderer_TraceEdges(r, (int)h->edges[0], (int)h->edges[1]));
    }
    r->stale = true;
    r->planRays = (double)r->runner.stats.rays - h->spent;
    r->turn = (vplTurn){h->turn[0], h->turn[1], (int)h->side};
    r->unreviewed = h->unreviewed != 0 && r->done > 0;
    r->spreadBefore = r->unreviewed && h->spread >= 0 ? h->spread : INFINITY;
    return VPL_SUCCESS;
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
    result = checkFile(&l);
    result = result == VPL_SUCCESS ? replan(&l) : result;
    result = result == VPL_SUCCESS ? checkRender(&l) : result;
    result = result == VPL_SUCCESS ? loadState(&l) : result;
    vplFree(context, bytes);
    if (result != VPL_SUCCESS) { // the first pass would add to it; it makes all else anew
        vplImage_Destroy(r->direct);
        r->direct = NULL;
        vplTruth_Destroy(r->truth);
        r->truth = NULL;
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
    *doneOut = !r->unreviewed && (vplIsComplete(r) || (asked > 0 && bound >= 0 && bound <= asked));
    return VPL_SUCCESS;
}
