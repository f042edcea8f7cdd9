// SPDX-License-Identifier: MIT
// Pixels, passes and the error. Even and odd samples of a pixel come from two sequences that are scrambled by
// themselves: how far their means lie apart tells how far the picture may be from the truth.
#include "reference/path_trace.h"
#include "base/context.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "reference/path.h"

#include <float.h>

enum { TILE = 16, HALVES = 2 };

typedef struct PixelSum {
    double half[HALVES][3]; // sums of radiance
} PixelSum;

struct vplPathTracer {
    vplPathScene scene;
    PixelSum* sums;
    int64_t* raysOf; // per tile
    int columns, rows;
    int done, now; // samples per pixel, before this pass and in it
    vplContext* context;
};

vplPathDef vplDefaultPathDef(void)
{
    // rouletteFrom: least variance for the time on rooms, see tests/bench/path.c.
    return (vplPathDef){.lastBounce = 1 << 16, .emission = true, .ways = VPL_PATH_ALL, .rouletteFrom = 0.25};
}

// The same frame as the rasterizer's view has.
static void aimCamera(vplPathScene* s)
{
    const vplCameraDef* camera = s->def.camera;
    double sine, cosine;
    vplSinCos(camera->fovY / 2, &sine, &cosine);
    s->forward = vplNormalize(vplSub(camera->target, camera->eye));
    s->right = vplNormalize(vplCross(s->forward, camera->up));
    s->up = vplCross(s->right, s->forward);
    s->scaleY = sine / cosine;
    s->scaleX = s->scaleY * s->def.width / s->def.height;
}

vplResult vplPathTracer_Create(const vplGeometry* geometry, const vplPathDef* def, vplPathTracer** tracerOut)
{
    vplContext* context = geometry->context;
    vplPathTracer* t = vplAllocZero(context, 1, sizeof *t);
    if (t == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    t->context = context;
    t->columns = (def->width + TILE - 1) / TILE;
    t->rows = (def->height + TILE - 1) / TILE;
    t->scene = (vplPathScene){.geometry = geometry, .def = *def, .sobol = vplSobol_Make()};
    aimCamera(&t->scene);
    vplResult result = vplEmission_Create(geometry, def->emitters, def->emitterCount, &t->scene.emission);
    if (result == VPL_SUCCESS) {
        result = vplGeometry_PrepareRays(geometry);
    }
    if (result == VPL_SUCCESS) {
        t->sums = vplAllocZero(context, (size_t)def->width * (size_t)def->height, sizeof *t->sums);
        t->raysOf = t->sums ? vplAllocZero(context, (size_t)(t->columns * t->rows), sizeof *t->raysOf) : NULL;
        result = t->raysOf ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    }
    if (result != VPL_SUCCESS) {
        vplPathTracer_Destroy(t);
        return result;
    }
    const vplEmission* e = t->scene.emission;
    t->scene.power = vplEmission_Power(e);
    t->scene.trianglePower = t->scene.power - e->cumulative[e->firstTriangle];
    *tracerOut = t;
    return VPL_SUCCESS;
}

void vplPathTracer_Destroy(vplPathTracer* tracer)
{
    if (tracer != NULL) {
        vplEmission_Destroy(tracer->scene.emission);
        vplFree(tracer->context, tracer->sums);
        vplFree(tracer->context, tracer->raysOf);
        vplFree(tracer->context, tracer);
    }
}

static void tracePixel(vplPathTracer* t, int x, int y, int64_t* rays)
{
    size_t pixel = (size_t)y * (size_t)t->scene.def.width + (size_t)x;
    for (int i = t->done; i < t->done + t->now; i++) {
        uint64_t half = i & 1;
        vplPathNumbers numbers = {&t->scene, HALVES * (uint64_t)pixel + half, (uint32_t)i / HALVES};
        vplFollowPath(&t->scene, x, y, &numbers, t->sums[pixel].half[half], rays);
    }
}

static void traceTile(void* data, int tile, int worker)
{
    (void)worker;
    vplPathTracer* t = data;
    int left = tile % t->columns * TILE, top = tile / t->columns * TILE;
    for (int y = top; y < top + TILE && y < t->scene.def.height; y++) {
        for (int x = left; x < left + TILE && x < t->scene.def.width; x++) {
            tracePixel(t, x, y, &t->raysOf[tile]);
        }
    }
}

vplResult vplPathTracer_Pass(vplPathTracer* tracer, int samples, vplProgressFcn* progress, void* user,
                             double from, double to)
{
    tracer->now = samples;
    vplResult result = vplParallelForProgress(tracer->context, tracer->columns * tracer->rows, traceTile,
                                              tracer, progress, user, from, to);
    tracer->done += samples;
    return result;
}

// ---- the picture

static float toFloat(double value)
{
    return value < (double)FLT_MAX ? (float)value : FLT_MAX;
}

// If each half's mean of n_h samples has variance v/n_h, the picture's is (A - B)^2 n_A n_B / n^2.
static void estimate(const vplPathTracer* t, double squares, double total, vplPathStats* stats)
{
    double values = 3.0 * t->scene.def.width * t->scene.def.height;
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
    size_t pixels = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < pixels; i++) {
        const PixelSum* sum = &tracer->sums[i];
        for (int c = 0; c < 3; c++) {
            double mean = (sum->half[0][c] + sum->half[1][c]) / tracer->done;
            double apart = count[1] > 0 ? sum->half[0][c] / count[0] - sum->half[1][c] / count[1] : 0;
            image->pixels[3 * i + (size_t)c] = toFloat(mean);
            squares += apart * apart;
            total += mean;
        }
    }
    estimate(tracer, squares, total, statsOut);
    statsOut->rays = 0;
    for (int i = 0; i < tracer->columns * tracer->rows; i++) {
        statsOut->rays += tracer->raysOf[i];
    }
}
