// SPDX-License-Identifier: MIT
#include "render/planner/edges.h"

#include "render/planner/contrast.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <math.h>
#include <string.h>

static const uint64_t SEED = 0x6564676573; // differs from that of pictures and of the truth

struct vplEdges {
    vplSparsePaths paths;
    vplSparsePixel* pixels;
    int32_t* places; // of each pixel of the picture: its index in `pixels`, or -1
    vplArena* arena; // owns all
};

// ---- which pixels

int vplContrastBin(const vplImage* image, int x, int y)
{
    const float contrast = (float)vplContrastOfPixel(image, x, y);
    uint32_t bits;
    memcpy(&bits, &contrast, sizeof bits);
    return (int)(bits >> 19);
}

// The lowest bin that is taken, and the count of pixels from there on. Pixels without contrast are no edges.
static int chooseBin(const vplImage* picture, int most, int* countOut)
{
    int counts[VPL_CONTRAST_BINS] = {0}, bin = VPL_CONTRAST_BINS;
    for (int y = 0; y < picture->height; y++) {
        for (int x = 0; x < picture->width; x++) {
            counts[vplContrastBin(picture, x, y)]++;
        }
    }
    *countOut = 0;
    while (bin > 1 && counts[bin - 1] <= most - *countOut) {
        *countOut += counts[--bin];
    }
    return bin;
}

static void choosePixels(vplEdges* e, const vplImage* picture, int bin)
{
    int count = 0;
    for (int y = 0; y < picture->height; y++) {
        for (int x = 0; x < picture->width; x++) {
            const bool chosen = vplContrastBin(picture, x, y) >= bin;
            e->places[(size_t)y * (size_t)picture->width + (size_t)x] = chosen ? count : -1;
            if (chosen) {
                e->pixels[count++] = (vplSparsePixel){.x = x, .y = y};
            }
        }
    }
}

// ---- their paths

static vplResult openEdges(const vplRun* run, const vplImage* picture, int most, vplEdges* e)
{
    int count;
    const int bin = chooseBin(picture, most, &count);
    e->pixels = vplArena_AllocZero(e->arena, (size_t)count, sizeof *e->pixels);
    e->places = vplArena_Alloc(e->arena, (size_t)picture->width * (size_t)picture->height, sizeof *e->places);
    TRY(vplArena_Check(e->arena));
    choosePixels(e, picture, bin);
    TRY(vplFindLightVertices(run));
    vplPathDef def = vplDescribePaths(run, VPL_SHOW_PICTURE);
    def.seed ^= SEED;
    return vplSparsePaths_Init(&e->paths, run->results[VPL_STAGE_GEOMETRY], &def, e->pixels, count);
}

vplResult vplEdges_Create(const vplRun* run, const vplImage* picture, int most, int paths,
                          vplEdges** edgesOut)
{
    vplArena* arena = vplArena_Create(run->context);
    vplEdges* e = vplArena_AllocZero(arena, 1, sizeof *e);
    vplResult result = vplArena_Check(arena);
    if (result != VPL_SUCCESS) {
        vplArena_Destroy(arena);
        return result;
    }
    e->arena = arena;
    result = openEdges(run, picture, most, e);
    result = result == VPL_SUCCESS ? vplEdges_Refine(run, e, paths) : result;
    if (result != VPL_SUCCESS) {
        vplEdges_Destroy(e);
        return result;
    }
    *edgesOut = e;
    return VPL_SUCCESS;
}

vplResult vplEdges_Refine(const vplRun* run, vplEdges* e, int paths)
{
    return vplTraceGuided(run, &e->paths, (paths + 1) / 2 - e->paths.done,
                          (vplProgressRange){run->progress, run->runner, 0, 1});
}

void vplEdges_Destroy(vplEdges* e)
{
    if (e != NULL) {
        vplSparsePaths_Free(&e->paths);
        vplArena_Destroy(e->arena);
    }
}

int64_t vplEdges_Rays(const vplEdges* edges)
{
    return edges->paths.cast;
}

// ---- the picture

void vplEdges_Draw(const vplEdges* e, vplImage* picture)
{
    const double paths = 2.0 * e->paths.done;
    for (int i = 0; i < e->paths.count; i++) {
        const vplSparsePixel* p = &e->pixels[i];
        float* values = picture->pixels + 3 * ((size_t)p->y * (size_t)picture->width + (size_t)p->x);
        values[0] = (float)((p->sums[0].r + p->sums[1].r) / paths);
        values[1] = (float)((p->sums[0].g + p->sums[1].g) / paths);
        values[2] = (float)((p->sums[0].b + p->sums[1].b) / paths);
    }
}

double vplEdges_VarianceAt(const vplEdges* e, size_t pixel)
{
    const int32_t place = e->places[pixel];
    return place < 0 ? -1 : vplSparsePixel_Variance(&e->pixels[place], e->paths.done);
}

// A variance v that is estimated from two halves has a standard error of sqrt(2) v.
vplEdgeNoise vplEdges_Noise(const vplEdges* e, int pixels)
{
    double sum = 0, squares = 0;
    for (int i = 0; e != NULL && i < e->paths.count; i++) {
        const double v = vplSparsePixel_Variance(&e->pixels[i], e->paths.done) / pixels;
        sum += v;
        squares += 2 * v * v;
    }
    return (vplEdgeNoise){sum, sqrt(squares)};
}
