// SPDX-License-Identifier: MIT
// Shades patches and adds tiles to the picture.
#include "math/vec.h"
#include "radiosity/radiosity_kernels.h"
#include "radiosity/sides/side.h"

#include <string.h>

// 1 / pi to float.
static const float INVERSE_PI = 0.318309886f;

// The colour of a flat patch, or the factor of interpolated values. An interpolated side that light was not
// found to reach shows the values at its corners, which come from its neighbours: a sliver of floor at the
// foot of a box, which rays missed, is then not drawn black.
static vplRgb factorOf(const vplPatchFace* u, int triangle, int side)
{
    const vplPatchDraw* d = u->draw;
    vplRgb factor = {1, 1, 1};
    if (d->reflect && d->reflectance == NULL) {
        factor = vplRgbScale(INVERSE_PI, vplReflectanceOf(d->mesh->sides, triangle, side));
    }
    if (d->vertexValues != NULL) {
        return factor;
    }
    return side < 0 ? (vplRgb){0, 0, 0} : vplRgbMul(factor, d->values[side]);
}

// Clamps interpolated values to the range of the corners' values: snapping assigns pixels to a triangle whose
// centres are outside of it, and far outside on its plane if it is seen edge-on.
static void interpolate(const vplPatchFace* u, vplFragments* f, vplRgb factor)
{
    const uint32_t* index = u->draw->mesh->indices + 3 * (size_t)f->primitive;
    const vplRgb* values = u->draw->vertexValues;
    const float factors[3] = {factor.r, factor.g, factor.b};
    for (int c = 0; c < 3; c++) {
        float corner[3], value[VPL_LANES];
        for (int k = 0; k < 3; k++) {
            const vplRgb v = values[2 * (size_t)index[k] + (size_t)u->face];
            corner[k] = c == 0 ? v.r : c == 1 ? v.g : v.b;
        }
        const float low01 = corner[0] < corner[1] ? corner[0] : corner[1];
        const float high01 = corner[0] < corner[1] ? corner[1] : corner[0];
        const float low = low01 < corner[2] ? low01 : corner[2];
        const float high = high01 < corner[2] ? corner[2] : high01;
        memcpy(value, f->varying[c], sizeof value);
        for (int l = 0; l < VPL_LANES; l++) {
            const float above = value[l] > low ? value[l] : low;
            value[l] = (above < high ? above : high) * factors[c];
        }
        memcpy(f->plane[c], value, sizeof value);
    }
}

// Multiplies irradiance by the reflectance of each pixel.
static void reflect(const vplPatchFace* u, int triangle, vplFragments* f)
{
    const vplPatchDraw* d = u->draw;
    for (int l = 0; l < VPL_LANES; l++) {
        if (f->covered[l]) {
            const vplRgb rho =
                d->reflectance(d->user, triangle, f->x + l % VPL_BLOCK_SIDE, f->y + l / VPL_BLOCK_SIDE);
            f->plane[0][l] *= INVERSE_PI * rho.r;
            f->plane[1][l] *= INVERSE_PI * rho.g;
            f->plane[2][l] *= INVERSE_PI * rho.b;
        }
    }
}

static void fill(vplFragments* f, vplRgb colour)
{
    const float values[3] = {colour.r, colour.g, colour.b};
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            f->plane[c][l] = values[c];
        }
    }
}

// ---- outlines

// The line through two corners on the screen, a x + b y + c = 0 with a^2 + b^2 = 1. It is the cross product
// of homogeneous points, which needs no division and therefore no clipping. Source: Olano and Greer, Triangle
// Scan Conversion using 2D Homogeneous Coordinates, Graphics Hardware 1997.
static bool lineThrough(const vplPatchFace* u, const float p[4], const float q[4], double line[3])
{
    const double px = 0.5 * ((double)p[0] + p[3]) * u->width, qx = 0.5 * ((double)q[0] + q[3]) * u->width;
    const double py = 0.5 * ((double)p[3] - p[1]) * u->height, qy = 0.5 * ((double)q[3] - q[1]) * u->height;
    line[0] = py * q[3] - p[3] * qy;
    line[1] = p[3] * qx - px * q[3];
    line[2] = px * qy - py * qx;
    const double length = sqrt(line[0] * line[0] + line[1] * line[1]);
    for (int k = 0; k < 3; k++) {
        line[k] = length > 0 ? line[k] / length : 0;
    }
    return length > 0;
}

// Darkens pixels that are less than a pixel from a patch's edge.
static void outline(const vplPatchFace* u, vplFragments* f)
{
    const vplPatchMesh* mesh = u->draw->mesh;
    const uint32_t* index = mesh->indices + 3 * (size_t)f->primitive;
    for (int k = 0; k < 3; k++) {
        double line[3];
        if ((mesh->edges[f->primitive] >> k & 1) == 0 ||
            !lineThrough(u, u->clip[index[k]], u->clip[index[(k + 1) % 3]], line)) {
            continue;
        }
        for (int l = 0; l < VPL_LANES; l++) {
            const double x = f->x + l % VPL_BLOCK_SIDE + 0.5, y = f->y + l / VPL_BLOCK_SIDE + 0.5;
            const double distance = fabs(line[0] * x + line[1] * y + line[2]);
            const float shade = distance < 1 ? (float)distance : 1;
            for (int c = 0; c < 3; c++) {
                f->plane[c][l] *= shade;
            }
        }
    }
}

// ---- blocks and tiles

void VPL_KERNEL(vplShadePatch)(const void* uniforms, vplFragments* f)
{
    const vplPatchFace* u = uniforms;
    const vplPatchMesh* mesh = u->draw->mesh;
    const int patch = mesh->patchOf[f->primitive];
    const int side = vplSideOf(mesh->sides, patch, u->face);
    const vplRgb factor = factorOf(u, mesh->triangleOf[f->primitive], side);
    if (u->draw->vertexValues != NULL) {
        interpolate(u, f, factor);
    } else {
        fill(f, factor);
    }
    if (u->draw->reflect && u->draw->reflectance != NULL) {
        reflect(u, mesh->triangleOf[f->primitive], f);
    }
    if (u->draw->outlines) {
        outline(u, f);
    }
}

// Adds four pixels of a row, or fewer at the picture's right edge.
static inline void addPixels(const vplTile* tile, int element, int count, float* to)
{
    float sum[3 * VPL_BLOCK_SIDE];
    for (int i = 0; i < VPL_BLOCK_SIDE; i++) {
        sum[3 * i] = tile->planes[0][element + i];
        sum[3 * i + 1] = tile->planes[1][element + i];
        sum[3 * i + 2] = tile->planes[2][element + i];
    }
    if (count == VPL_BLOCK_SIDE) {
        for (int k = 0; k < 3 * VPL_BLOCK_SIDE; k++) {
            to[k] += sum[k];
        }
        return;
    }
    for (int k = 0; k < 3 * count; k++) {
        to[k] += sum[k];
    }
}

// Adds the tile's planes to the picture.
void VPL_KERNEL(vplAddPatchTile)(void* data, vplTile* tile, int worker)
{
    (void)worker;
    vplImage* image = data;
    for (int y = 0; y < tile->height; y++) {
        float* to = image->pixels + 3 * ((size_t)(tile->y + y) * (size_t)image->width + (size_t)tile->x);
        const int row =
            y / VPL_BLOCK_SIDE * VPL_TILE_BLOCKS * VPL_LANES + y % VPL_BLOCK_SIDE * VPL_BLOCK_SIDE;
        for (int x = 0; x < tile->width; x += VPL_BLOCK_SIDE, to += 3 * VPL_BLOCK_SIDE) {
            const int left = tile->width - x;
            addPixels(tile, row + x / VPL_BLOCK_SIDE * VPL_LANES,
                      left < VPL_BLOCK_SIDE ? left : VPL_BLOCK_SIDE, to);
        }
    }
}
