// SPDX-License-Identifier: MIT
// Interleaved shading: pixel (x, y) belongs to class (y mod K) K + x mod K and is lit by every K^2-th virtual
// light, K^2 times as bright; then a filter takes means over neighbours on about the same surface, with
// weights (K - |x|) (K - |y|). On one surface each class has the same weight, so that each light counts once
// and is interpolated linearly between the pixels that it lit. (A box filter of K x K pixels shows steps: 3.5
// % error instead of 2.1 %, bench/interleaved.)
// Based on: Segovia, Iehl, Mitanchey and Peroche, Non-interleaved Deferred Shading of Interleaved Sample
// Patterns, Graphics Hardware 2006. Departs: a pixel's class is its place in the picture, and classes are
// collected tile by tile, in cache, instead of in sub-pictures of the whole picture.
#include "shading/interleave_filter.h"

// From this many clusters on, each class has lights of one half of them only, and pixels of the two halves
// alternate like the fields of a chessboard: visibility of clusters is looked up half as often, in 3/4 of the
// time at nearly the same error (bench/interleaved).
enum { LEAST_TO_HALVE = 8 };

// ---- classes

// Sorts clusters into two halves with about as many lights each; the last entry is for lights without a
// cluster. False where halves would not pay, or classes have no chessboard.
static bool findHalves(const vplShadeDef* def, int side, int* halves)
{
    int lights[2] = {0, 0}, used = 0;
    memset(halves, 0, ((size_t)def->clusterCount + 1) * sizeof *halves);
    for (int i = 0; i < def->lightCount; i++) {
        const int cluster = def->lightClusters[i];
        halves[cluster < 0 ? def->clusterCount : cluster]++;
    }
    for (int i = 0; i <= def->clusterCount; i++) {
        const int count = halves[i];
        used += count > 0;
        halves[i] = lights[1] < lights[0];
        lights[halves[i]] += count;
    }
    return used >= LEAST_TO_HALVE && side % 2 == 0;
}

// The class of each light. Without `halves` lights are dealt out to all classes in turn.
static void findClasses(const vplShadeDef* def, int side, const int* halves, int* classes)
{
    int turn[2] = {0, 0};
    for (int i = 0; i < def->lightCount; i++) {
        if (halves == NULL) {
            classes[i] = i % (side * side);
            continue;
        }
        const int cluster = def->lightClusters[i], half = halves[cluster < 0 ? def->clusterCount : cluster];
        const int field = 2 * turn[half], y = field / side;
        classes[i] = field + ((y + half) & 1);
        turn[half] = (turn[half] + 1) % (side * side / 2);
    }
}

// Puts lights of a class side by side, in the order of the list, so that clusters stay together.
static vplResult sortLights(vplShading* s, vplInterleave* w)
{
    const vplShadeDef* def = s->def;
    const size_t count = (size_t)def->lightCount;
    const bool clustered = def->lightClusters != NULL, mapped = def->lightShadows != NULL;
    vplShadeLight* lights = vplArena_Alloc(s->arena, count, sizeof *lights);
    vplHemiMap* maps = mapped ? vplArena_Alloc(s->arena, count, sizeof *maps) : NULL;
    int* clusters = clustered ? vplArena_Alloc(s->arena, count, sizeof *clusters) : NULL;
    int* halves = clustered ? vplArena_Alloc(s->arena, (size_t)def->clusterCount + 1, sizeof *halves) : NULL;
    int* classes = vplArena_Alloc(s->arena, count, sizeof *classes);
    TRY(vplArena_Check(s->arena));
    const bool halved = clustered && findHalves(def, w->side, halves);
    findClasses(def, w->side, halved ? halves : NULL, classes);
    int next[VPL_MAX_INTERLEAVE * VPL_MAX_INTERLEAVE + 1] = {0};
    for (int i = 0; i < def->lightCount; i++) {
        next[classes[i] + 1]++;
    }
    for (int i = 0; i < w->side * w->side; i++) {
        next[i + 1] += next[i];
    }
    memcpy(w->classStart, next, sizeof next);
    for (int i = 0; i < def->lightCount; i++) {
        const int at = next[classes[i]]++;
        lights[at] = def->lights[i];
        if (mapped) {
            maps[at] = def->lightShadows[i];
        }
        if (clustered) {
            clusters[at] = def->lightClusters[i];
        }
    }
    s->lights.lights = lights;
    s->lights.maps = maps;
    s->lights.clusters = clusters;
    return VPL_SUCCESS;
}

// ---- the strategy

static vplResult openInterleaved(vplShading* shading, vplFramebuffer* framebuffer)
{
    const int width = framebuffer->width, height = framebuffer->height;
    const int workers = shading->geometry->context->workerCount;
    const size_t pixels = (size_t)width * (size_t)height;
    vplInterleave* w = vplArena_AllocZero(shading->arena, 1, sizeof *w);
    TRY(vplArena_Check(shading->arena));
    w->planes = vplArena_Alloc(shading->arena, pixels, VPL_FILTER_PLANES * sizeof *w->planes);
    w->scratch = vplArena_Alloc(shading->arena, (size_t)workers, sizeof *w->scratch);
    TRY(vplArena_Check(shading->arena));
    shading->state = w;
    w->side = shading->def->interleave;
    w->pixelCount = pixels;
    w->tilesX = (width + VPL_FILTER_WIDTH - 1) / VPL_FILTER_WIDTH;
    w->tilesY = (shading->endRow - shading->firstRow + VPL_FILTER_HEIGHT - 1) / VPL_FILTER_HEIGHT;
    w->firstTask = shading->firstRow / VPL_FILTER_HEIGHT * w->tilesX;
    framebuffer->firstRow -= w->side - 1; // the filter reads so far
    framebuffer->endRow += w->side - 1;
    for (int i = 0; i < workers; i++) {
        vplFacetCache_Clear(&w->scratch[i].facets);
    }
    vplOpenGbuffer(shading, framebuffer, shading->kernels.interleaved);
    if (framebuffer->samples > 0) {
        w->rasterTilesX = (width + VPL_TILE_SIDE - 1) / VPL_TILE_SIDE;
        const size_t tiles = (size_t)w->rasterTilesX * (size_t)((height + VPL_TILE_SIDE - 1) / VPL_TILE_SIDE);
        w->centres = vplArena_Alloc(shading->arena, pixels, sizeof *w->centres);
        w->mostEdges = shading->geometry->cutOuts != NULL ? VPL_CUT_OUT_EDGES : VPL_TILE_EDGES;
        w->edges = vplArena_Alloc(shading->arena, tiles, (size_t)w->mostEdges * sizeof *w->edges);
        w->edgeCounts = vplArena_Alloc(shading->arena, tiles, sizeof *w->edgeCounts);
        TRY(vplArena_Check(shading->arena));
    }
    for (int k = 0; k < 3; k++) {
        framebuffer->planes[VPL_PLANE_INDIRECT + k].pixels = vplFilterPlane(w, VPL_FILTER_INDIRECT + k);
    }
    framebuffer->planes[VPL_PLANE_TRIANGLE].pixels = vplFilterPlane(w, VPL_FILTER_TRIANGLE);
    TRY(sortLights(shading, w));
    return vplMakeColumns(shading);
}

// Copies a part of the unfiltered irradiance to the picture.
static void showUnfiltered(void* data, int task, int worker)
{
    (void)worker;
    const vplShading* s = data;
    const vplInterleave* w = s->state;
    task += w->firstTask;
    const int x0 = task % w->tilesX * VPL_FILTER_WIDTH, y0 = task / w->tilesX * VPL_FILTER_HEIGHT;
    for (int y = y0; y < y0 + VPL_FILTER_HEIGHT && y < s->image->height; y++) {
        for (int x = x0; x < x0 + VPL_FILTER_WIDTH && x < s->image->width; x++) {
            const size_t at = (size_t)y * (size_t)s->image->width + (size_t)x;
            for (int c = 0; c < 3; c++) {
                s->image->pixels[3 * at + (size_t)c] = vplFilterPlane(w, VPL_FILTER_INDIRECT + c)[at];
            }
        }
    }
}

static vplResult filterInterleaved(vplShading* shading, vplShadeStats* stats)
{
    (void)stats;
    const vplInterleave* w = shading->state;
    vplTaskFcn* task = shading->def->output == VPL_OUTPUT_GATHER ? showUnfiltered : shading->kernels.filter;
    return vplParallelForProgress(
        shading->geometry->context, w->tilesX * w->tilesY, task, shading,
        (vplProgressRange){shading->def->progress, shading->def->progressUser, 1, 1});
}

const vplStrategy vplInterleavedStrategy = {
    .open = openInterleaved, .record = vplRecordGbuffer, .finish = filterInterleaved};
