// SPDX-License-Identifier: MIT
// The environment as a distribution over directions.
// Based on: Matt Pharr, Wenzel Jakob and Greg Humphreys, Physically Based Rendering, 4th edition 2023, sections 12.5.2 and
// A.5.6 (images of infinite lights, piecewise constant distributions in two dimensions). Departs: within a pixel,
// directions are even in solid angle, so that densities need no sine; surfaces receive the mean of the interpolated
// radiance over a pixel. Where they received the interpolated radiance itself, a sun of one pixel was off by 2 % with 256
// samples.
#include <vpl/scenetools.h>

#include "base/arena.h"
#include "geometry/emission.h"
#include "geometry/object_build.h"
#include "math/scalar.h"
#include "math/vec.h"

#include <string.h>

// ---- radiance

static const float* pixelAt(const vplEnvironment* e, int x, int y)
{
    const int row = y < 0 ? 0 : y < e->height ? y : e->height - 1;
    const int column = x < 0 ? x + e->width : x < e->width ? x : x - e->width;
    return e->pixels + 3 * ((size_t)row * (size_t)e->width + (size_t)column);
}

// The place of a direction in the picture, in pixels from its upper left corner.
static void placeOf(const vplEnvironment* e, vplVec3 direction, double* x, double* y)
{
    const double dx = (double)direction.x, dz = (double)direction.z;
    const double right = e->cosine * dx - e->sine * dz, back = e->sine * dx + e->cosine * dz; // turned back
    const double across = 0.5 + vplAtan2(right, -back) / (2 * VPL_PI);
    const double level = sqrt(dx * dx + dz * dz), down = vplAtan2(level, (double)direction.y) / VPL_PI;
    // A direction of NaN has a place, too: the pixels that are read must exist.
    *x = isfinite(across) ? across * e->width : 0;
    *y = isfinite(down) ? down * e->height : 0;
}

vplRgb vplEnvironment_Radiance(const vplEnvironment* e, vplVec3 direction)
{
    if (e == NULL) {
        return (vplRgb){0, 0, 0};
    }
    double x, y;
    float out[3];
    placeOf(e, direction, &x, &y);
    const double left = floor(x - 0.5), top = floor(y - 0.5), u = x - 0.5 - left, v = y - 0.5 - top;
    const float *a = pixelAt(e, (int)left, (int)top), *b = pixelAt(e, (int)left + 1, (int)top);
    const float *c = pixelAt(e, (int)left, (int)top + 1), *d = pixelAt(e, (int)left + 1, (int)top + 1);
    for (int k = 0; k < 3; k++) {
        const double above = a[k] + u * ((double)b[k] - a[k]), below = c[k] + u * ((double)d[k] - c[k]);
        out[k] = (float)(above + v * (below - above));
    }
    return (vplRgb){out[0], out[1], out[2]};
}

// ---- the distribution

// The mean of the interpolated radiance over a pixel.
static vplRgb meanOverPixel(const vplEnvironment* e, int x, int y)
{
    static const double weights[3] = {0.125, 0.75, 0.125};
    double sum[3] = {0, 0, 0};
    for (int i = 0; i < 9; i++) {
        const float* p = pixelAt(e, x + i % 3 - 1, y + i / 3 - 1);
        for (int k = 0; k < 3; k++) {
            sum[k] += weights[i % 3] * weights[i / 3] * p[k];
        }
    }
    return (vplRgb){(float)sum[0], (float)sum[1], (float)sum[2]};
}

// Sums up the columns of a row into shares; even ones where the row is dark. Adds its light to `irradiance`.
static double sumRow(const vplEnvironment* e, int y, double* shares, double irradiance[3])
{
    const double angle = (e->cosines[y] - e->cosines[y + 1]) * 2 * VPL_PI / e->width; // of a pixel
    shares[0] = 0;
    for (int x = 0; x < e->width; x++) {
        const vplRgb l = meanOverPixel(e, x, y);
        irradiance[0] += angle * l.r;
        irradiance[1] += angle * l.g;
        irradiance[2] += angle * l.b;
        shares[x + 1] = shares[x] + angle * vplRgbMean(l);
    }
    const double sum = shares[e->width];
    for (int x = 0; x <= e->width; x++) {
        shares[x] = sum > 0 ? shares[x] / sum : (double)x / e->width;
    }
    return sum;
}

// The last of `count` intervals whose start is at most `value`, skipping empty ones.
static int findInterval(const double* starts, int count, double value)
{
    int low = 0, high = count - 1;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (value < starts[middle + 1]) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    while (low > 0 && starts[low + 1] == starts[low]) {
        low--;
    }
    return low;
}

// The density of directions in a pixel.
static double densityAt(const vplEnvironment* e, int x, int y)
{
    const double* shares = e->columns + (size_t)y * ((size_t)e->width + 1);
    const double row = (e->rows[y + 1] - e->rows[y]) / e->rows[e->height];
    return row * (shares[x + 1] - shares[x]) * e->width / (2 * VPL_PI * (e->cosines[y] - e->cosines[y + 1]));
}

vplRgb vplEnvironment_Light(const vplEnvironment* e, vplVec3 direction, double* densityOut)
{
    double x, y;
    placeOf(e, direction, &x, &y);
    const int column = vplMini((int)x, e->width - 1), row = vplMini((int)y, e->height - 1);
    *densityOut = densityAt(e, column, row);
    return meanOverPixel(e, column, row);
}

vplEnvironmentSample vplEnvironment_Sample(const vplEnvironment* e, double u, double v)
{
    const double down = u * e->rows[e->height];
    const int y = findInterval(e->rows, e->height, down);
    const double* shares = e->columns + (size_t)y * ((size_t)e->width + 1);
    const int x = findInterval(shares, e->width, v);
    const double inRow = (down - e->rows[y]) / (e->rows[y + 1] - e->rows[y]);
    const double inColumn = (v - shares[x]) / (shares[x + 1] - shares[x]);
    const double up = e->cosines[y] + inRow * (e->cosines[y + 1] - e->cosines[y]), flat2 = 1 - up * up;
    const double level = sqrt(flat2 > 0 ? flat2 : 0);
    double across, ahead;
    vplSinCosQuarters(4 * ((x + inColumn) / e->width - 0.5), &across, &ahead);
    const double right = level * across, back = -level * ahead;
    return (vplEnvironmentSample){
        {(float)(e->cosine * right + e->sine * back), (float)up, (float)(e->cosine * back - e->sine * right)},
        meanOverPixel(e, x, y),
        densityAt(e, x, y)};
}

// ---- making it

// A picture of 16384 x 8192 pixels takes seconds. Rows are asked after about 2^18 pixels, a few milliseconds.
static vplResult askAfterRow(vplContext* context, int y, int width)
{
    const int rows = width < 1 << 18 ? (1 << 18) / width : 1;
    return y % rows == rows - 1 ? vplAsk(context) : VPL_SUCCESS;
}

// A row of the picture of the directions, with all its factors: one pixel where radiance is the same everywhere.
static void copyRow(const vplEnvironmentDef* def, int y, int count, float* pixels)
{
    const size_t start = 3 * (size_t)y * (size_t)count;
    const float one[3] = {def->radiance.r, def->radiance.g, def->radiance.b};
    const float* from = def->type == VPL_ENVIRONMENT_CONSTANT ? one : def->pixels + start;
    pixels += start;
    for (int i = 0; i < count; i++) {
        const vplRgb l = vplScaleRadiometric(
            def->scale, (vplRgb){from[3 * (size_t)i], from[3 * (size_t)i + 1], from[3 * (size_t)i + 2]});
        pixels[3 * (size_t)i] = vplMinf(l.r, VPL_MAX_MAGNITUDE);
        pixels[3 * (size_t)i + 1] = vplMinf(l.g, VPL_MAX_MAGNITUDE);
        pixels[3 * (size_t)i + 2] = vplMinf(l.b, VPL_MAX_MAGNITUDE);
    }
}

static vplResult fill(vplContext* context, vplEnvironment* e, const vplEnvironmentDef* def)
{
    const size_t pixels = (size_t)e->width * (size_t)e->height, rows = (size_t)e->height + 1;
    float* copy = vplArena_Alloc(e->arena, pixels, 3 * sizeof *copy);
    double* sums = vplArena_Alloc(e->arena, rows, sizeof *sums);
    double* cosines = vplArena_Alloc(e->arena, rows, sizeof *cosines);
    double* columns = vplArena_Alloc(e->arena, pixels + (size_t)e->height, sizeof *columns);
    double sine, irradiance[3] = {0, 0, 0};
    TRY(vplArena_Check(e->arena));
    for (int y = 0; y < e->height; y++) {
        copyRow(def, y, e->width, copy);
        TRY(askAfterRow(context, y, e->width));
    }
    e->pixels = copy;
    e->rows = sums;
    e->columns = columns;
    e->cosines = cosines;
    vplSinCos(def->rotate, &e->sine, &e->cosine);
    for (int y = 0; y <= e->height; y++) {
        vplSinCosQuarters(2.0 * y / e->height, &sine, &cosines[y]);
    }
    sums[0] = 0;
    for (int y = 0; y < e->height; y++) {
        sums[y + 1] = sums[y] + sumRow(e, y, columns + (size_t)y * ((size_t)e->width + 1), irradiance);
        TRY(askAfterRow(context, y, e->width));
    }
    e->irradiance =
        vplScaleRadiometric(1, (vplRgb){(float)irradiance[0], (float)irradiance[1], (float)irradiance[2]});
    return VPL_SUCCESS;
}

// An environment with what identifies the def that it was made of.
typedef struct Stamped {
    vplEnvironment environment;
    uint64_t stamp; // vplScene.environmentStamp
} Stamped;

bool vplEnvironment_IsOf(const vplEnvironment* e, const vplScene* scene)
{
    return e != NULL ? ((const Stamped*)e)->stamp == scene->environmentStamp
                     : scene->environment.type == VPL_ENVIRONMENT_NONE;
}

vplResult vplEnvironment_Create(const vplScene* scene, vplEnvironment** environmentOut)
{
    REQUIRE(vplScene_GetContext(scene), scene, environmentOut);
    const vplEnvironmentDef* def = vplScene_GetEnvironment(scene);
    *environmentOut = NULL;
    if (def->type == VPL_ENVIRONMENT_NONE) {
        return VPL_SUCCESS;
    }
    vplArena* arena = vplArena_Create(vplScene_GetContext(scene));
    Stamped* stamped = vplArena_AllocZero(arena, 1, sizeof *stamped);
    vplEnvironment* e = (vplEnvironment*)stamped; // its first member, and NULL where nothing was allocated
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        stamped->stamp = scene->environmentStamp;
        const bool constant = def->type == VPL_ENVIRONMENT_CONSTANT;
        e->arena = arena;
        e->width = constant ? 1 : def->width;
        e->height = constant ? 1 : def->height;
        result = fill(vplScene_GetContext(scene), e, def);
    }
    if (result == VPL_SUCCESS && !(e->rows[e->height] > 0)) {
        vplArena_Destroy(arena);
        return VPL_SUCCESS;
    }
    return vplArena_Deliver(arena, result, e, environmentOut);
}

void vplEnvironment_Destroy(vplEnvironment* environment)
{
    vplArena_Destroy(environment != NULL ? environment->arena : NULL);
}
