// SPDX-License-Identifier: MIT
// The filter of interleaved shading: every pixel takes the mean indirect irradiance of the pixels less than K
// away that lie on about the same surface, and reflects it. Rows are summed first, then columns. Where a run
// of 16 pixels and all their windows show one triangle, no surface is tested; the bits are those of tests
// that all pass.
#include "base/isa.h"
#include "math/scalar.h"
#include "shading/interleave_filter_edges.h"

// Rows are short and a picture's width apart, which hardware does not prefetch: they are fetched this many
// rows early.
enum { AHEAD = 8, LINE = 64 / sizeof(float) };

static void prefetch(const float* from, int count)
{
    for (int i = 0; i < count; i += LINE) {
        __builtin_prefetch(from + i);
    }
}

// Copies a plane's rows; 0 outside the picture. `to` has VPL_FILTER_COLUMNS values per row.
static void loadPlane(const vplImage* image, const float* plane, const Part* part, int reach, float* to)
{
    int first = reach - part->x, end = image->width - part->x + reach; // columns of the picture
    first = first > 0 ? first : 0;
    end = end < part->columns ? end : part->columns;
    for (int row = 0; row < part->rows; row++, to += VPL_FILTER_COLUMNS) {
        const int y = part->y - reach + row;
        if (y < 0 || y >= image->height) {
            memset(to, 0, VPL_FILTER_COLUMNS * sizeof *to);
            continue;
        }
        const float* from = plane + (size_t)y * (size_t)image->width + (part->x - reach + first);
        if (y + AHEAD < image->height) {
            prefetch(from + (size_t)AHEAD * (size_t)image->width, end - first);
        }
        memset(to, 0, (size_t)first * sizeof *to);
        memcpy(to + first, from, (size_t)(end - first) * sizeof *to);
        memset(to + end, 0, (size_t)(VPL_FILTER_COLUMNS - end) * sizeof *to);
    }
}

// Finds the runs whose windows show one triangle.
static void findUniform(int side, vplFilterScratch* scratch, Part* part)
{
    part->mixed = part->any = false;
    for (int row = 0; row < part->rows; row++) {
        for (int run = 0; run < VPL_FILTER_RUNS; run++) {
            const int32_t* at = scratch->triangle[row] + run * VPL_LANES;
            int32_t different = 0, any = 0;
            for (int i = 0; i < VPL_LANES + tapsOf(side) - 1; i++) {
                different |= at[i] ^ at[0];
                any |= at[i];
            }
            scratch->uniform[row][run] = different ? 0 : at[0];
            part->mixed |= different != 0;
            part->any |= any != 0;
        }
    }
    for (int row = 1; row < part->rows; row++) {
        for (int run = 0; run < VPL_FILTER_RUNS; run++) {
            part->mixed |= scratch->uniform[row][run] != scratch->uniform[row - 1][run];
        }
    }
}

// Sums the weighted values of 16 windows side by side, whose pixels are `stride` values apart.
static inline __attribute__((always_inline)) void sumTaps(const float* from, int stride, int side,
                                                          float out[VPL_LANES])
{
    float sum[VPL_LANES] = {0};
    for (int k = 0; k < tapsOf(side); k++, from += stride) {
        const float weight = weightOf(side, k);
        for (int l = 0; l < VPL_LANES; l++) {
            sum[l] += weight * from[l];
        }
    }
    memcpy(out, sum, sizeof sum);
}

// Row sums of 16 windows that show one triangle.
static void sumRow(int side, vplFilterScratch* scratch, int row, int x)
{
    for (int c = 0; c < 3; c++) {
        sumTaps(scratch->indirect[c][row] + x, 1, side, scratch->rowSums[c][row] + x);
    }
    for (int l = 0; l < VPL_LANES; l++) {
        scratch->rowCounts[row][x + l] = (float)(side * side);
    }
}

static bool isEmpty(const int32_t triangles[VPL_LANES])
{
    int32_t any = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        any |= triangles[l];
    }
    return any == 0;
}

static void sumRows(const vplShading* s, int side, vplFilterScratch* scratch, const Part* part)
{
    for (int i = 0; i < part->rows * VPL_FILTER_RUNS; i++) {
        const int row = i / VPL_FILTER_RUNS, x = i % VPL_FILTER_RUNS * VPL_LANES;
        if (scratch->uniform[row][i % VPL_FILTER_RUNS] != 0) {
            sumRow(side, scratch, row, x);
        } else {
            sumMixedRow(s->view, scratch, side, row, x);
        }
    }
}

// Means of 16 windows that show one triangle.
static void meanOfUniform(const vplFilterScratch* scratch, int side, int row, int x, float mean[3][VPL_LANES])
{
    const float inverse = 1 / (float)(side * side * side * side);
    for (int c = 0; c < 3; c++) {
        float sum[VPL_LANES];
        sumTaps(scratch->rowSums[c][row] + x, VPL_FILTER_WIDTH, side, sum);
        for (int l = 0; l < VPL_LANES; l++) {
            mean[c][l] = sum[l] * inverse;
        }
    }
}

// Turns irradiance into radiance.
static void reflect(const vplShading* s, const int32_t triangles[VPL_LANES], vplFacetCache* cache,
                    float mean[3][VPL_LANES])
{
    float factor[3][VPL_LANES];
    for (int l = 0; l < VPL_LANES;) {
        const int32_t triangle = triangles[l];
        const vplFacet* facet = triangle == 0 ? NULL : vplFacetCache_Get(s, triangle - 1, cache);
        const float r = facet ? (float)facet->reflector.factor[0] : 0,
                    g = facet ? (float)facet->reflector.factor[1] : 0,
                    b = facet ? (float)facet->reflector.factor[2] : 0;
        for (; l < VPL_LANES && triangles[l] == triangle; l++) {
            factor[0][l] = r;
            factor[1][l] = g;
            factor[2][l] = b;
        }
    }
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            mean[c][l] *= factor[c][l];
        }
    }
}

// The same where triangles may have textures or colours of vertices, for pixels from (x, y) on.
static void reflectPainted(const vplShading* s, const int32_t triangles[VPL_LANES], int x, int y,
                           float mean[3][VPL_LANES])
{
    for (int l = 0; l < VPL_LANES; l++) {
        const vplRgb rho = vplReflectanceInPixel(s->geometry, s->view, triangles[l] - 1, x + l, y);
        double factor[3];
        vplFactorOf(rho, factor);
        for (int c = 0; c < 3; c++) {
            mean[c][l] *= (float)factor[c];
        }
    }
}

static void addToPixels(float values[3][VPL_LANES], float* pixels, int count)
{
    _Alignas(64) float row[3 * VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        row[3 * l] = values[0][l];
        row[3 * l + 1] = values[1][l];
        row[3 * l + 2] = values[2][l];
    }
    if (count >= VPL_LANES) {
        for (int i = 0; i < 3 * VPL_LANES; i++) {
            pixels[i] += row[i];
        }
        return;
    }
    for (int i = 0; i < 3 * count; i++) {
        pixels[i] += row[i];
    }
}

static bool isUniform(const vplFilterScratch* scratch, int side, int row, int x)
{
    bool uniform = scratch->uniform[row][x / VPL_LANES] != 0;
    for (int i = 1; i < tapsOf(side); i++) {
        uniform &= scratch->uniform[row + i][x / VPL_LANES] == scratch->uniform[row][x / VPL_LANES];
    }
    return uniform;
}

// Filters pixels x .. x + 15 of one row of the part.
static void filterRun(const vplShading* s, vplFilterScratch* scratch, const Part* part, int row, int x)
{
    const vplInterleave* w = s->state;
    const int side = w->side;
    const int32_t* triangles = scratch->triangle[row + side - 1] + x + side - 1;
    float mean[3][VPL_LANES];
    if (isUniform(scratch, side, row, x)) {
        meanOfUniform(scratch, side, row, x, mean);
    } else if (isEmpty(triangles)) {
        return;
    } else {
        meanOfMixed(s->view, scratch, side, row, x, mean);
    }
    if (!s->irradiance && s->geometry->paint != NULL) {
        reflectPainted(s, triangles, part->x + x, part->y + row, mean);
    } else if (!s->irradiance) {
        reflect(s, triangles, &scratch->facets, mean);
    }
    const size_t pixel = (size_t)(part->y + row) * (size_t)s->image->width + (size_t)(part->x + x);
    for (int l = 0; w->centres != NULL && l < vplMini(part->width - x, VPL_LANES); l++) {
        for (int c = 0; c < 3; c++) {
            mean[c][l] *= w->centres[pixel + (size_t)l];
        }
    }
    addToPixels(mean, s->image->pixels + 3 * pixel, part->width - x);
}

void VPL_KERNEL(vplFilterTask)(void* data, int task, int worker)
{
    const vplShading* s = data;
    const vplInterleave* w = s->state;
    const vplImage* image = s->image;
    vplFilterScratch* scratch = &w->scratch[worker];
    const int side = w->side, reach = side - 1;
    task += w->firstTask;
    Part part = {.x = task % w->tilesX * VPL_FILTER_WIDTH, .y = task / w->tilesX * VPL_FILTER_HEIGHT};
    part.width = image->width - part.x < VPL_FILTER_WIDTH ? image->width - part.x : VPL_FILTER_WIDTH;
    part.height = image->height - part.y < VPL_FILTER_HEIGHT ? image->height - part.y : VPL_FILTER_HEIGHT;
    part.columns = VPL_FILTER_WIDTH + tapsOf(side) - 1;
    part.rows = part.height + tapsOf(side) - 1;
    loadPlane(image, vplFilterPlane(w, VPL_FILTER_TRIANGLE), &part, reach, (float*)scratch->triangle[0]);
    findUniform(side, scratch, &part);
    const KeptEdges kept = edgesOf(w, &part);
    if (!part.any && kept.count == 0) {
        return;
    }
    part.mixed |= kept.count > 0;
    for (int c = 0; c < 3; c++) {
        loadPlane(image, vplFilterPlane(w, VPL_FILTER_INDIRECT + c), &part, reach, scratch->indirect[c][0]);
    }
    if (part.mixed) {
        findLinesOfSight(s->view, &part, reach, scratch);
        for (int row = 0; row < part.rows; row++) {
            findPlanes(s, row, part.columns, scratch);
        }
    }
    sumRows(s, side, scratch, &part);
    for (int row = 0; row < part.height; row++) {
        if (row + AHEAD < part.height) {
            const size_t ahead = (size_t)(part.y + row + AHEAD) * (size_t)image->width + (size_t)part.x;
            prefetch(image->pixels + 3 * ahead, 3 * part.width);
        }
        for (int x = 0; x < part.width; x += VPL_LANES) {
            filterRun(s, scratch, &part, row, x);
        }
    }
    if (kept.count > 0) {
        filterEdges(s, scratch, &part, kept);
    }
}
