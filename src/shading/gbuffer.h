// SPDX-License-Identifier: MIT
// Blocks of the G-buffer and what becomes of them, for kernels.
#ifndef VPL_SHADING_GBUFFER_H
#define VPL_SHADING_GBUFFER_H

#include "math/vec.h"
#include "shading/normals.h"
#include "shading/resolve.h"

// A block of the G-buffer.
typedef struct vplBlock {
    _Alignas(64) vplSurface surface, plane; // `plane` only where some object is smooth
    vplPoints points;
    vplReflector reflector; // where all lanes show one triangle
    bool same;
    double sums[3][VPL_LANES];
    int cluster; // whose visibility was asked for last; none: VPL_NO_CLUSTER
    float visible[VPL_LANES];
} vplBlock;

enum { VPL_NO_CLUSTER = -2 };

// Normals of the triangles that a block shows, and which of them are smooth.
static inline void vplReadFacets(const vplShading* s, const int triangles[VPL_LANES], vplSeen* seen,
                                 vplSurface* plane, int32_t smooth[VPL_LANES])
{
    vplVec3 n = {0, 0, 0};
    int32_t isSmooth = 0;
    for (int l = 0, last = -1; l < VPL_LANES; l++) {
        const int triangle = triangles[l];
        if (triangle != last) {
            last = triangle;
            const vplSeenFacet* facet = triangle < 0 ? NULL : vplSee(s, triangle, seen);
            n = facet ? facet->normal : vplVec(0, 0, 0);
            isSmooth = facet && facet->smooth ? -1 : 0;
        }
        plane->nx[l] = n.x;
        plane->ny[l] = n.y;
        plane->nz[l] = n.z;
        smooth[l] = isSmooth;
    }
}

// One coordinate of a block: 0 where nothing is, because nothing was written there.
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

// False where it is empty.
static inline bool vplReadBlock(const vplShading* s, const vplTile* tile, int element, vplSeen* seen,
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
        const vplSeenFacet* facet = vplSee(s, b->points.triangle[0], seen);
        vplSetNormals(facet->normal, flat);
        b->reflector = facet->reflector;
        memset(smooth, facet->smooth ? 0xff : 0, sizeof smooth);
    } else {
        vplReadFacets(s, b->points.triangle, seen, flat, smooth);
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

// Where the points of some blocks lie and where they face.
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
            const float* value = b->surface.px + k * VPL_LANES;
            for (int l = 0; l < VPL_LANES; l++) {
                const float v = value[l];
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

// Begins a block's sums with light that is found once per pixel, whatever becomes of virtual lights.
static inline void vplLightOnce(const vplShading* s, const vplTile* tile, int block, vplBlock* b)
{
    vplTileSums* tileSums = tile->scratch;
    _Alignas(64) float part[3][VPL_LANES] = {{0}};
    if (!s->irradiance) {
        vplDirectIrradiance(s, &b->points, part, &tileSums->shadowRays);
    }
    vplAddNearLightOfBlock(s, &b->points, tile->x + block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE,
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

// Sums become radiance, where that is asked for, and pixels of block `block` of the tile.
static inline void vplWriteLit(const vplShading* s, const vplTile* tile, int block, vplSeen* seen,
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
    if (b->same) {
        vplResolveSame(&b->reflector, b->sums, radiance);
    } else {
        vplResolveMixed(s, b->points.triangle, b->sums, seen, radiance);
    }
    vplWriteBlock(s, tile, block, radiance);
}

#endif
