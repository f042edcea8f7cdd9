// SPDX-License-Identifier: MIT
// Pixels, passes and the error estimate. Even and odd samples of a pixel come from two independently
// scrambled sequences; the difference of their means estimates the error.
#include "reference/path_trace.h"
#include "base/arena.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { TILE = 16, HALVES = 2 };

struct vplPathTracer {
    vplPathScene scene;
    vplRadiance (*sums)[HALVES]; // of each pixel; without meaning before the first pass, which clears them
    vplRadiance (
        *before)[HALVES]; // the sums before the last pass that could be cancelled; NULL: none was kept
    int64_t* tileRays;
    int64_t raysBefore;   // of all tiles
    int columns, rows;    // of tiles
    int firstRow, endRow; // of the pixels that are traced
    int done, now;        // samples per pixel, before this pass and in it
    vplArena* arena;      // owns the arrays
    vplContext* context;
};

vplResult vplPathTracer_Create(const vplGeometry* geometry, const vplPathDef* def, vplPathTracer** tracerOut)
{
    vplArena* arena = vplArena_Create(geometry->context);
    vplPathTracer* t = vplArena_AllocZero(arena, 1, sizeof *t);
    const int columns = (def->width + TILE - 1) / TILE, rows = (def->height + TILE - 1) / TILE;
    vplRadiance(*sums)[HALVES] =
        vplArena_Alloc(arena, (size_t)def->width * (size_t)def->height, sizeof *sums);
    int64_t* tileRays = vplArena_AllocZero(arena, (size_t)columns * (size_t)rows, sizeof *tileRays);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *t = (vplPathTracer){.sums = sums,
                             .tileRays = tileRays,
                             .columns = columns,
                             .rows = rows,
                             .firstRow = def->endRow > 0 ? def->firstRow : 0,
                             .endRow = def->endRow > 0 ? def->endRow : def->height,
                             .arena = arena,
                             .context = geometry->context};
        result = vplPathScene_Init(&t->scene, geometry, def);
    }
    return vplArena_Deliver(arena, result, t, tracerOut);
}

void vplPathTracer_Destroy(vplPathTracer* tracer)
{
    if (tracer != NULL) {
        vplPathScene_Free(&tracer->scene);
        vplArena_Destroy(tracer->arena);
    }
}

static void tracePixel(vplPathTracer* t, int x, int y, int64_t* rays)
{
    size_t pixel = (size_t)y * (size_t)t->scene.def.width + (size_t)x;
    if (t->done == 0) {
        memset(t->sums[pixel], 0, sizeof t->sums[pixel]);
    }
    for (int i = t->done; i < t->done + t->now; i++) {
        const uint64_t half = i & 1;
        vplPathState path = {
            .scene = &t->scene, .stream = HALVES * (uint64_t)pixel + half, .index = (uint32_t)i / HALVES};
        vplPath_Follow(&path, x, y, &t->sums[pixel][half]);
        *rays += path.rays;
    }
}

static void traceTile(void* data, int tile, int worker)
{
    (void)worker;
    vplPathTracer* t = data;
    int left = tile % t->columns * TILE, top = tile / t->columns * TILE;
    for (int y = top > t->firstRow ? top : t->firstRow; y < top + TILE && y < t->endRow; y++) {
        if (!vplTask_GoesOn(t->context)) {
            return;
        }
        for (int x = left; x < left + TILE && x < t->scene.def.width; x++) {
            tracePixel(t, x, y, &t->tileRays[tile]);
        }
    }
}

// Keeps a copy of the sums, if there are any.
static vplResult keepSums(vplPathTracer* t)
{
    const size_t pixels = (size_t)t->scene.def.width * (size_t)t->scene.def.height;
    t->raysBefore = vplPathTracer_CountRays(t);
    if (t->done == 0) {
        return VPL_SUCCESS;
    }
    if (t->before == NULL) {
        t->before = vplArena_Alloc(t->arena, pixels, sizeof *t->before);
        TRY(vplArena_Check(t->arena));
    }
    enum { PIECE = 1 << 18 }; // pixels; 12 MB
    for (size_t at = 0; at < pixels; at += PIECE) {
        const size_t count = pixels - at < PIECE ? pixels - at : PIECE;
        memcpy(t->before + at, t->sums + at, count * sizeof *t->sums);
        TRY(vplAsk(t->context));
    }
    return VPL_SUCCESS;
}

void vplPathTracer_Undo(vplPathTracer* t)
{
    vplRadiance(*sums)[HALVES] = t->sums;
    t->done -= t->now;
    if (t->done > 0) {
        t->sums = t->before;
        t->before = sums;
    }
    vplPathTracer_SetRays(t, t->raysBefore);
}

vplResult vplPathTracer_Pass(vplPathTracer* tracer, int samples, vplProgressFcn* progress, void* user,
                             double from, double to)
{
    TRY(progress != NULL ? keepSums(tracer) : VPL_SUCCESS);
    tracer->now = samples;
    const vplResult result =
        vplParallelForProgress(tracer->context, tracer->columns * tracer->rows, traceTile, tracer,
                               (vplProgressRange){progress, user, from, to});
    tracer->done += samples;
    if (result != VPL_SUCCESS) {
        vplPathTracer_Undo(tracer);
    }
    return result;
}

// ---- the state

vplPathSums vplPathTracer_GetSums(vplPathTracer* t)
{
    const size_t pixels = (size_t)t->scene.def.width * (size_t)t->scene.def.height;
    return (vplPathSums){&t->sums[0][0].r, 3 * HALVES * pixels, t->done};
}

void vplPathTracer_SetSamples(vplPathTracer* t, int samples)
{
    t->done = samples;
}

int64_t vplPathTracer_CountRays(const vplPathTracer* t)
{
    int64_t rays = 0;
    for (int i = 0; i < t->columns * t->rows; i++) {
        rays += t->tileRays[i];
    }
    return rays;
}

void vplPathTracer_SetRays(vplPathTracer* t, int64_t rays)
{
    memset(t->tileRays, 0, (size_t)(t->columns * t->rows) * sizeof *t->tileRays);
    t->tileRays[0] = rays;
}

// ---- the picture

static float toFloat(double value)
{
    return value < (double)FLT_MAX ? (float)value : FLT_MAX;
}

// If each half's mean of n_h samples has variance v/n_h, the picture's is (A - B)^2 n_A n_B / n^2.
static void estimate(const vplPathTracer* t, double squares, double total, vplPathStats* stats)
{
    double values = 3.0 * t->scene.def.width * (t->endRow - t->firstRow);
    double a = (t->done + 1) / HALVES, b = t->done / HALVES;
    stats->errorEstimate = stats->relativeErrorEstimate = -1;
    if (t->done > 1) {
        stats->errorEstimate = sqrt(squares / values * a * b) / t->done;
        stats->relativeErrorEstimate = total > 0 ? stats->errorEstimate * values / total : 0;
    }
}

void vplPathTracer_Resolve(const vplPathTracer* tracer, vplImage* image, vplPathStats* statsOut)
{
    double count[HALVES] = {(tracer->done + 1) / HALVES, tracer->done / HALVES}, squares = 0, total = 0;
    const size_t width = (size_t)image->width;
    for (size_t i = (size_t)tracer->firstRow * width; i < (size_t)tracer->endRow * width; i++) {
        const vplRadiance *a = &tracer->sums[i][0], *b = &tracer->sums[i][1];
        const double channels[3][HALVES] = {{a->r, b->r}, {a->g, b->g}, {a->b, b->b}};
        for (int c = 0; c < 3; c++) {
            const double* half = channels[c];
            double mean = (half[0] + half[1]) / tracer->done;
            double difference = count[1] > 0 ? half[0] / count[0] - half[1] / count[1] : 0;
            image->pixels[3 * i + (size_t)c] = toFloat(mean);
            squares += difference * difference;
            total += mean;
        }
    }
    estimate(tracer, squares, total, statsOut);
    statsOut->rays = vplPathTracer_CountRays(tracer);
}
