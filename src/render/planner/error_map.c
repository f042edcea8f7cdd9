// SPDX-License-Identifier: MIT
// Where the error of a picture lies: one value for each block of 8x8 pixels.
#include "reference/path_trace.h"
#include "render/options.h"
#include "render/planner/contrast.h"
#include "render/planner/edges.h"
#include "render/renderer.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <math.h>

enum { BLOCK = 8 };

typedef struct Map {
    vplRenderer* renderer;
    const vplImage* picture;
    const double* halves; // of path tracing: sums of each pixel's even and odd paths; NULL: passes have sums
    vplImage* image;
} Map;

// The index of the rendered pixel that covers a pixel of the picture.
static size_t renderedPixel(const vplRenderer* r, size_t pixel)
{
    const vplOutputOptions* o = &r->plan->options.output;
    const size_t width = (size_t)o->width, x = pixel % width, y = pixel / width, side = (size_t)o->pixelSize;
    return y / side * (size_t)vplRenderedWidth(o) + x / side;
}

// Squared noise of value c of a pixel.
static double noiseOf(const Map* m, size_t pixel, size_t c)
{
    const vplRenderer* r = m->renderer;
    if (m->halves != NULL) {
        const double half = 0.5 * r->paths, *sums = m->halves + 6 * pixel;
        const double difference = r->paths > 1 ? (sums[c] - sums[3 + c]) / half : 0;
        return 0.25 * difference * difference;
    }
    const double traced = r->edges != NULL ? vplEdges_VarianceAt(r->edges, pixel) : -1;
    if (traced >= 0) {
        return traced;
    }
    if (r->done < 2 || r->sums[0] == NULL) {
        return 0;
    }
    const size_t k = 3 * renderedPixel(r, pixel) + c;
    const double sum = r->sums[0][k], squares = r->sums[1][k];
    return fmax(0, squares - sum * sum / r->weight) / (r->done - 1) / r->weight;
}

// Means over a block: squared noise, and contrast, by which the bias of the whole picture is shared out.
static void measureBlock(const Map* m, int column, int row, float* out)
{
    const vplImage* p = m->picture;
    double noise = 0, contrast = 0;
    int count = 0;
    for (int y = row * BLOCK; y < (row + 1) * BLOCK && y < p->height; y++) {
        for (int x = column * BLOCK; x < (column + 1) * BLOCK && x < p->width; x++) {
            for (size_t c = 0; c < 3; c++, count++) {
                noise += noiseOf(m, (size_t)y * (size_t)p->width + (size_t)x, c);
            }
            contrast += vplContrastOf(p, x, y); // most of the bias is at edges
        }
    }
    out[1] = (float)(noise / count);
    out[2] = (float)(contrast / count);
}

static void fill(const Map* m)
{
    vplRenderStats stats;
    vplImage* map = m->image;
    const size_t blocks = (size_t)map->width * (size_t)map->height;
    double contrast = 0;
    for (int row = 0; row < map->height; row++) {
        for (int column = 0; column < map->width; column++) {
            float* out = map->pixels + 3 * ((size_t)row * (size_t)map->width + (size_t)column);
            measureBlock(m, column, row, out);
            contrast += (double)out[2] / (double)blocks;
        }
    }
    vplRenderer_FinishStats(m->renderer, m->picture, &stats);
    const double scale =
        stats.relativeErrorEstimate > 0 ? stats.errorEstimate / stats.relativeErrorEstimate : 0;
    const double bias = stats.relativeBias > 0 ? stats.relativeBias * scale : 0;
    for (size_t i = 0; i < blocks; i++) {
        float* out = map->pixels + 3 * i;
        const double share = contrast > 0 ? (double)out[2] / contrast : 1;
        const double square = bias * bias * share;
        out[0] = (float)sqrt((double)out[1] + square);
        out[1] = (float)sqrt((double)out[1]);
        out[2] = (float)sqrt(square);
    }
}

vplResult vplRenderer_GetErrorMap(vplRenderer* r, vplImage** mapOut)
{
    REQUIRE(vplRenderer_ContextOf(r), r, mapOut);
    vplContext* context = r->runner.run.context;
    Map m = {.renderer = r};
    vplImage* picture = NULL;
    TRY(vplRenderer_GetImage(r, &picture, NULL));
    m.picture = picture;
    if (r->plan->options.method == VPL_METHOD_PATH && r->paths > 0 && !r->showsKept) {
        m.halves = vplPathTracer_GetSums(vplGetPathTracer(&r->runner.run, false)).values;
    }
    const vplResult result = vplImage_Create(context, (picture->width + BLOCK - 1) / BLOCK,
                                             (picture->height + BLOCK - 1) / BLOCK, &m.image);
    if (result == VPL_SUCCESS) {
        fill(&m);
        *mapOut = m.image;
    }
    vplImage_Destroy(picture);
    return result;
}
