// SPDX-License-Identifier: MIT
#include "reference/sparse_paths.h"

#include "base/arena.h"

#include <string.h>

enum { CHUNK = 8 }; // pixels per task

double vplSparsePixel_Variance(const vplSparsePixel* p, double each)
{
    const double r = p->sums[0].r - p->sums[1].r, g = p->sums[0].g - p->sums[1].g,
                 b = p->sums[0].b - p->sums[1].b;
    const double paths = 2 * each;
    return (r * r + g * g + b * b) / 3 / (paths * paths);
}

vplResult vplSparsePaths_Init(vplSparsePaths* paths, const vplGeometry* geometry, const vplPathDef* def,
                              vplSparsePixel* pixels, int count)
{
    *paths = (vplSparsePaths){.pixels = pixels, .count = count};
    return vplPathScene_Init(&paths->scene, geometry, def);
}

void vplSparsePaths_Free(vplSparsePaths* paths)
{
    vplPathScene_Free(&paths->scene);
}

// The same paths as those of a path-traced picture.
static void tracePixel(const vplSparsePaths* s, vplSparsePixel* p)
{
    const uint64_t pixel = (uint64_t)p->y * (uint64_t)s->scene.def.width + (uint64_t)p->x;
    for (int i = 2 * s->done; i < 2 * (s->done + s->now); i++) {
        const uint64_t half = i & 1;
        vplPathState path = {.scene = &s->scene, .stream = 2 * pixel + half, .index = (uint32_t)i / 2};
        vplRadiance light = {0, 0, 0};
        vplPath_Follow(&path, p->x, p->y, &light);
        vplRadiance_Add(&p->sums[half], light);
        p->squares += (light.r * light.r + light.g * light.g + light.b * light.b) / 3;
        p->rays += path.rays;
    }
}

static void traceChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const vplSparsePaths* s = data;
    for (int i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < s->count; i++) {
        tracePixel(s, &s->pixels[i]);
    }
}

vplResult vplSparsePaths_Trace(vplSparsePaths* paths, int each, vplProgressRange progress)
{
    vplContext* context = paths->scene.geometry->context;
    const size_t size = sizeof *paths->pixels;
    vplSparsePixel* before = vplAlloc(context, (size_t)paths->count, size);
    if (before == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    memcpy(before, paths->pixels, (size_t)paths->count * size);
    paths->now = each;
    const vplResult result =
        vplParallelForProgress(context, (paths->count + CHUNK - 1) / CHUNK, traceChunk, paths, progress);
    if (result == VPL_SUCCESS) {
        paths->done += each;
        for (int i = 0; i < paths->count; i++) {
            paths->cast += paths->pixels[i].rays - before[i].rays;
        }
    } else {
        memcpy(paths->pixels, before, (size_t)paths->count * size);
    }
    vplFree(context, before);
    return result;
}
