// SPDX-License-Identifier: MIT
// Coverage antialiasing: a pixel whose samples show other surfaces than its centre is the mean of all of
// them, by the shares of its samples. The centre's surface is shaded as ever; each other one is shaded once,
// at one of its samples. All other pixels cost a comparison of their samples. The light itself is added by
// kernels.
#ifndef VPL_SHADING_EDGES_H
#define VPL_SHADING_EDGES_H

#include "shading/gbuffer.h"

// The surfaces of a pixel.
typedef struct vplEdgePixel {
    int x, y;     // of the picture
    int triangle; // in the centre; -1: none
    float share;  // of the surface in the centre
    uint32_t own; // the samples that show it, besides the centre
    vplEdgeSurface others[VPL_MAX_SAMPLES_PER_PIXEL];
    int count;
} vplEdgePixel;

// ---- which surfaces

// Direction from the eye through a point of a pixel, of length 1 along the view axis.
static inline vplVec3 vplSightOf(const vplView* v, int x, int y, vplSubPixel at)
{
    const double column = (2 * x + 1 + at.x / 128.0) / v->width - 1 - v->offsetX;
    const double row = 1 - (2 * y + 1 + at.y / 128.0) / v->height - v->offsetY;
    const float right = (float)(column / v->scaleX), up = (float)(row / v->scaleY);
    return vplAdd(v->forward, vplAdd(vplScale(right, v->right), vplScale(up, v->up)));
}

// Distance along the view axis at which a line of sight meets a triangle's plane, clamped to the range of its
// corners.
float vplEdgeDistance(const vplShading* s, int triangle, const vplFacet* facet, vplVec3 sight);

// Tests whether the surface of facet b, seen at a distance along a line of sight, is that of facet a.
bool vplIsOneSurface(const vplShading* s, const vplFacet* a, const vplFacet* b, float distance,
                     vplVec3 sight);

// Sorts the samples of a pixel, whose place and centre `p` holds, by surfaces.
void vplFindEdges(const vplShading* s, const vplTile* tile, int element, vplFacetCache* cache,
                  vplEdgePixel* p);

// ---- their light

static inline float* vplPixelOf(const vplShading* s, int x, int y)
{
    return s->image->pixels + 3 * ((size_t)y * (size_t)s->image->width + (size_t)x);
}

// Adds all virtual lights to the sums of a block.
typedef void vplAddToBlockFcn(const vplShading* s, void* user, vplBlock* b, int64_t* rays);

// Lights surfaces of pixels, sixteen at a time, and adds them to the picture by their shares.
typedef struct vplEdgeQueue {
    const vplShading* shading;
    vplFacetCache* cache;
    vplAddToBlockFcn* addLights;
    void* user;                     // passed to addLights
    int64_t* rays;                  // counter of rays
    bool direct;                    // emission and direct light are added
    bool indirect;                  // compensation and virtual lights are added
    int count;                      // surfaces that wait, in the first lanes
    vplBlock block;                 // their points
    int x[VPL_LANES], y[VPL_LANES]; // their pixels of the picture
    bool glows[VPL_LANES];
    float share[VPL_LANES];
} vplEdgeQueue;

// Lights the surfaces that wait.
void vplEdgeQueue_Flush(vplEdgeQueue* q);

// Puts the point of a triangle that is seen through a point of pixel (x, y) into the next lane.
void vplEdgeQueue_PutSeen(vplEdgeQueue* q, int triangle, int x, int y, vplSubPixel at);

// Adds a surface of pixel (x, y).
void vplEdgeQueue_Push(vplEdgeQueue* q, const vplEdgeSurface* surface, int x, int y);

// ---- tiles

typedef void vplEdgePixelFcn(const vplShading* s, void* user, const vplEdgePixel* pixel);

// Visits the pixels at edges of a tile whose pixels are written, and scales them by the share of the surface
// in their centres. Smooths rims of shadows.
void vplVisitEdges(const vplShading* s, const vplTile* tile, vplFacetCache* cache, vplEdgePixelFcn* visit,
                   void* user);

// Smooths the edges in a tile whose pixels are written, by all light.
void vplSmoothTile(const vplShading* s, const vplTile* tile, vplFacetCache* cache,
                   vplAddToBlockFcn* addLights, void* user);

// Smooths the rims of shadows in a tile whose pixels are written (rims.c). `own` are the samples of each
// element that show the surface in its centre, which shows it, too.
void vplSmoothRims(const vplShading* s, const vplTile* tile, vplFacetCache* cache,
                   const uint16_t own[VPL_TILE_SIDE * VPL_TILE_SIDE]);

#endif
