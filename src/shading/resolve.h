// SPDX-License-Identifier: MIT
// The end of every strategy, for kernels: sums of irradiance become radiance and pixels.
#ifndef VPL_SHADING_RESOLVE_H
#define VPL_SHADING_RESOLVE_H

#include "shading/pixel_paint.h"

// Stores one triangle in all lanes, as vplReadTriangles reads it.
static inline void vplStoreTriangle(int triangle, vplFragments* f)
{
    int32_t id[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        id[l] = triangle + 1;
    }
    memcpy(f->plane[VPL_PLANE_TRIANGLE], id, sizeof id);
}

// Index in geometry->normals of each lane of a block, -1 where nothing is. Returns whether any lane has one.
static inline bool vplReadTriangles(const vplTile* tile, int element, int triangles[VPL_LANES])
{
    // Copied as bits: small integers read as floats are denormal.
    memcpy(triangles, tile->planes[VPL_PLANE_TRIANGLE] + element, VPL_LANES * sizeof(int));
    int any = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        any |= triangles[l];
        triangles[l]--;
    }
    return any != 0;
}

static inline bool vplSameTriangle(const int triangles[VPL_LANES])
{
    int different = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        different |= triangles[l] ^ triangles[0];
    }
    return different == 0;
}

// Writes three values per pixel of a block to the picture.
static inline void vplWriteBlock(const vplShading* shading, const vplTile* tile, int block,
                                 float values[3][VPL_LANES])
{
    vplImage* image = shading->image;
    const int x = block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE, y = block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE;
    // Rows are aligned to vectors, so that each load is forwarded from one store.
    _Alignas(64) float rows[VPL_BLOCK_SIDE][VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        float* pixel = &rows[l / VPL_BLOCK_SIDE][3 * (l % VPL_BLOCK_SIDE)];
        pixel[0] = values[0][l];
        pixel[1] = values[1][l];
        pixel[2] = values[2][l];
    }
    const size_t pitch = 3 * (size_t)image->width;
    float* to = image->pixels + (size_t)(tile->y + y) * pitch + 3 * (size_t)(tile->x + x);
    const int width = tile->width - x < VPL_BLOCK_SIDE ? tile->width - x : VPL_BLOCK_SIDE;
    for (int row = 0; row < VPL_BLOCK_SIDE && y + row < tile->height && width > 0; row++, to += pitch) {
        if (width == VPL_BLOCK_SIDE) { // a constant size: no call
            memcpy(to, rows[row], 3 * VPL_BLOCK_SIDE * sizeof(float));
        } else {
            memcpy(to, rows[row], 3 * (size_t)width * sizeof(float));
        }
    }
}

// All lanes show one triangle.
static inline void vplResolveSame(const vplReflector* r, double sums[3][VPL_LANES],
                                  float radiance[3][VPL_LANES])
{
    for (int c = 0; c < 3; c++) {
        const double factor = r->factor[c];
        const float emission = r->emission[c];
        for (int l = 0; l < VPL_LANES; l++) {
            radiance[c][l] = (float)(emission + factor * sums[c][l]);
        }
    }
}

static inline void vplResolveMixed(const vplShading* s, const int triangles[VPL_LANES],
                                   double sums[3][VPL_LANES], vplFacetCache* cache,
                                   float radiance[3][VPL_LANES])
{
    vplReflector r = {{0}, {0}, -1};
    for (int l = 0, last = -1; l < VPL_LANES; l++) {
        if (triangles[l] != last) {
            last = triangles[l];
            r = last < 0 ? (vplReflector){{0}, {0}, -1} : vplFacetCache_Get(s, last, cache)->reflector;
        }
        for (int c = 0; c < 3; c++) {
            radiance[c][l] = (float)(r.emission[c] + r.factor[c] * sums[c][l]);
        }
    }
}

// The same where triangles may have textures or colours of vertices. The block's first pixel is (x, y).
static inline void vplResolvePainted(const vplShading* s, int x, int y, const int triangles[VPL_LANES],
                                     double sums[3][VPL_LANES], vplFacetCache* cache,
                                     float radiance[3][VPL_LANES])
{
    for (int l = 0; l < VPL_LANES; l++) {
        if (triangles[l] < 0) {
            continue;
        }
        const vplReflector* r = &vplFacetCache_Get(s, triangles[l], cache)->reflector;
        double factor[3];
        vplFactorInPixel(s, r, triangles[l], x + l % VPL_BLOCK_SIDE, y + l / VPL_BLOCK_SIDE, factor);
        for (int c = 0; c < 3; c++) {
            radiance[c][l] = (float)(r->emission[c] + factor[c] * sums[c][l]);
        }
    }
}

#endif
