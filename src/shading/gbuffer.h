// SPDX-License-Identifier: MIT
// Blocks of the G-buffer, for kernels: reading, bounds, sums of irradiance, writing.
#ifndef VPL_SHADING_GBUFFER_H
#define VPL_SHADING_GBUFFER_H

#include "math/vec.h"
#include "lights/light_set.h"
#include "shading/resolve.h"

#include <math.h>

typedef struct vplBlock {
    union {
        _Alignas(64) vplSurface surface;
        float columns[6][VPL_LANES]; // the same as an array
    };
    vplSurface plane; // set where some object is smooth
    vplPoints points;
    bool same;              // all lanes show one triangle, or nothing
    vplReflector reflector; // of that triangle
    double sums[3][VPL_LANES];
    int cluster; // whose visibility is in `visible`; VPL_NO_CLUSTER: none
    float visible[VPL_LANES];
} vplBlock;

enum { VPL_NO_CLUSTER = -2 };

_Static_assert(sizeof(vplSurface) == 6 * VPL_LANES * sizeof(float), "a surface is six columns");

// Element of the tile's planes that holds pixel (x, y).
static inline int vplElementOf(int x, int y)
{
    const unsigned u = (unsigned)x, v = (unsigned)y; // division is a shift
    const unsigned block = v / VPL_BLOCK_SIDE * VPL_TILE_BLOCKS + u / VPL_BLOCK_SIDE;
    return (int)(block * VPL_LANES + v % VPL_BLOCK_SIDE * VPL_BLOCK_SIDE + u % VPL_BLOCK_SIDE);
}

// ---- normals

static inline void vplSetNormals(vplVec3 n, vplSurface* surface)
{
    for (int l = 0; l < VPL_LANES; l++) {
        surface->nx[l] = n.x;
        surface->ny[l] = n.y;
        surface->nz[l] = n.z;
    }
}

// Turns interpolated normals into unit vectors on their triangle's side. Lanes that are not smooth, or whose
// interpolated normal is 0, get the triangle's.
static inline void vplFinishNormals(const vplSurface* restrict plane,
                                    const int32_t smooth[restrict VPL_LANES], vplSurface* restrict surface)
{
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = surface->nx[l], y = surface->ny[l], z = surface->nz[l];
        const float px = plane->nx[l], py = plane->ny[l], pz = plane->nz[l];
        const float length = sqrtf(x * x + y * y + z * z);
        const bool usable = smooth[l] && length > 0;
        const float scale = (x * px + y * py + z * pz < 0 ? -1.0f : 1.0f) / (usable ? length : 1);
        surface->nx[l] = usable ? scale * x : px;
        surface->ny[l] = usable ? scale * y : py;
        surface->nz[l] = usable ? scale * z : pz;
    }
}

// ---- reading

// Normals of the triangles of a block, and which of them are smooth.
static inline void vplReadFacets(const vplShading* s, const int triangles[VPL_LANES], vplFacetCache* cache,
                                 vplSurface* plane, int32_t smooth[VPL_LANES])
{
    vplVec3 n = {0, 0, 0};
    int32_t isSmooth = 0;
    for (int l = 0, last = -1; l < VPL_LANES; l++) {
        const int triangle = triangles[l];
        if (triangle != last) {
            last = triangle;
            const vplFacet* facet = triangle < 0 ? NULL : vplFacetCache_Get(s, triangle, cache);
            n = facet ? facet->normal : vplVec(0, 0, 0);
            isSmooth = facet && facet->smooth ? -1 : 0;
        }
        plane->nx[l] = n.x;
        plane->ny[l] = n.y;
        plane->nz[l] = n.z;
        smooth[l] = isSmooth;
    }
}

// One coordinate of a block; 0 where nothing is: the plane holds anything there.
static inline void vplReadPlane(const vplTile* tile, int plane, int element, const int triangles[VPL_LANES],
                                float valueOut[VPL_LANES])
{
    float value[VPL_LANES];
    memcpy(value, tile->planes[plane] + element, sizeof value);
    for (int l = 0; l < VPL_LANES; l++) {
        const float there = value[l];
        valueOut[l] = triangles[l] < 0 ? 0 : there;
    }
}

// Returns false for an empty block.
static inline bool vplReadBlock(const vplShading* s, const vplTile* tile, int element, vplFacetCache* cache,
                                vplBlock* b)
{
    if (!vplReadTriangles(tile, element, b->points.triangle)) {
        b->same = true;
        return false;
    }
    b->cluster = VPL_NO_CLUSTER;
    vplReadPlane(tile, VPL_PLANE_POSITION, element, b->points.triangle, b->surface.px);
    vplReadPlane(tile, VPL_PLANE_POSITION + 1, element, b->points.triangle, b->surface.py);
    vplReadPlane(tile, VPL_PLANE_POSITION + 2, element, b->points.triangle, b->surface.pz);
    b->points.surface = b->points.plane = &b->surface;
    b->same = vplSameTriangle(b->points.triangle);
    int32_t smooth[VPL_LANES];
    vplSurface* flat = s->smooth ? &b->plane : &b->surface;
    if (b->same) {
        const vplFacet* facet = vplFacetCache_Get(s, b->points.triangle[0], cache);
        vplSetNormals(facet->normal, flat);
        b->reflector = facet->reflector;
        memset(smooth, facet->smooth ? 0xff : 0, sizeof smooth);
    } else {
        vplReadFacets(s, b->points.triangle, cache, flat, smooth);
    }
    if (!s->smooth) {
        return true;
    }
    b->points.plane = &b->plane;
    memcpy(&b->plane, &b->surface, 3 * sizeof b->surface.px);
    vplReadPlane(tile, VPL_PLANE_NORMAL, element, b->points.triangle, b->surface.nx);
    vplReadPlane(tile, VPL_PLANE_NORMAL + 1, element, b->points.triangle, b->surface.ny);
    vplReadPlane(tile, VPL_PLANE_NORMAL + 2, element, b->points.triangle, b->surface.nz);
    vplFinishNormals(&b->plane, smooth, &b->surface);
    return true;
}

// Bounds of positions and normals of the blocks lit[0 .. count).
static inline vplBounds vplFindBounds(const vplBlock* blocks, const int* lit, int count)
{
    float low[6][VPL_LANES], high[6][VPL_LANES];
    for (int k = 0; k < 6; k++) {
        for (int l = 0; l < VPL_LANES; l++) {
            low[k][l] = INFINITY;
            high[k][l] = -INFINITY;
        }
    }
    for (int i = 0; i < count; i++) {
        const vplBlock* b = &blocks[lit[i]];
        for (int k = 0; k < 6; k++) {
            for (int l = 0; l < VPL_LANES; l++) {
                const float v = b->columns[k][l];
                const float least = v < low[k][l] ? v : low[k][l], most = v > high[k][l] ? v : high[k][l];
                low[k][l] = b->points.triangle[l] < 0 ? low[k][l] : least;
                high[k][l] = b->points.triangle[l] < 0 ? high[k][l] : most;
            }
        }
    }
    vplBounds bounds;
    for (int k = 0; k < 6; k++) {
        bounds.low[k] = low[k][0];
        bounds.high[k] = high[k][0];
        for (int l = 1; l < VPL_LANES; l++) {
            bounds.low[k] = low[k][l] < bounds.low[k] ? low[k][l] : bounds.low[k];
            bounds.high[k] = high[k][l] > bounds.high[k] ? high[k][l] : bounds.high[k];
        }
    }
    return bounds;
}

static inline void vplStartSums(vplBlock* b, float part[3][VPL_LANES])
{
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            b->sums[c][l] = (double)part[c][l];
        }
    }
}

// ---- sums

// Finds the direct light of a block. The tile keeps what comes from emitters, where rims of shadows are
// smooth.
static inline void vplStartDirect(const vplShading* s, const vplTile* tile, int element,
                                  const vplPoints* points, float part[3][VPL_LANES])
{
    vplTileSums* sums = tile->scratch;
    s->kernels.addEmitters(s, &s->direct, points, part, &sums->shadowRays);
    for (int c = 0; c < 3 && s->smoothsRims; c++) {
        memcpy(sums->emitted[c] + element, part[c], sizeof part[c]);
    }
    vplAddAreaLights(s, &s->direct, points, part, &sums->shadowRays);
}

// Starts a block's sums with direct light and the light of its own rays, which are found once per pixel.
static inline void vplStartLight(const vplShading* s, const vplTile* tile, int block, vplBlock* b)
{
    vplTileSums* tileSums = tile->scratch;
    _Alignas(64) float part[3][VPL_LANES] = {{0}};
    if (!s->irradiance) {
        vplStartDirect(s, tile, block * VPL_LANES, &b->points, part);
    }
    vplAddLightOfRaysOfBlock(s, &b->points, tile->x + block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE,
                             tile->y + block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE, part, &tileSums->shadowRays);
    vplStartSums(b, part);
}

static inline void vplWriteSums(const vplShading* s, const vplTile* tile, int block,
                                double sums[3][VPL_LANES])
{
    float values[3][VPL_LANES];
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            values[c][l] = (float)sums[c][l];
        }
    }
    vplWriteBlock(s, tile, block, values);
}

// Writes block `block` of the tile: radiance, or irradiance if the picture is that.
static inline void vplWriteLit(const vplShading* s, const vplTile* tile, int block, vplFacetCache* cache,
                               vplBlock* b)
{
    float radiance[3][VPL_LANES] = {{0}};
    if (b->same && b->points.triangle[0] < 0) {
        vplWriteBlock(s, tile, block, radiance);
        return;
    }
    if (s->irradiance) {
        vplWriteSums(s, tile, block, b->sums);
        return;
    }
    if (s->geometry->paint != NULL) {
        vplResolvePainted(s, tile->x + block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE,
                          tile->y + block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE, b->points.triangle, b->sums,
                          cache, radiance);
    } else if (b->same) {
        vplResolveSame(&b->reflector, b->sums, radiance);
    } else {
        vplResolveMixed(s, b->points.triangle, b->sums, cache, radiance);
    }
    vplWriteBlock(s, tile, block, radiance);
}

#endif
