// SPDX-License-Identifier: MIT
// Surfaces that let light through: masks, and panes that stop a share of it. Their triangles are neither in the ray tree
// nor drawn by the rasterizer: a tree of their own is searched for each ray, pixel and shadow, so that scenes without
// them cost nothing, and all methods find the same holes.
#ifndef VPL_GEOMETRY_CUT_OUTS_H
#define VPL_GEOMETRY_CUT_OUTS_H

#include "geometry/bvh.h"

typedef struct vplCutOuts {
    const uint8_t* is;       // per triangle: it is a cut-out
    const uint32_t* indices; // of all triangles, those of cut-outs without area: what the rasterizer draws
    vplBvh* tree;            // of the cut-outs only
    struct vplArena* arena;  // owns the arrays
} vplCutOuts;

// True for a material that lets light through somewhere.
bool vplIsCutOut(const vplMaterialDef* material);

bool vplScene_HasCutOuts(const vplScene* scene);

// True for a triangle of the ray tree.
static inline bool vplIsSolid(const vplGeometry* g, int triangle)
{
    return vplCanBeHit(g, triangle) && (g->cutOuts == NULL || g->cutOuts->is[triangle] == 0);
}

// The share of the light that a triangle stops at a point of it, [0, 1]; 1 for solid ones.
float vplGeometry_Opacity(const vplGeometry* geometry, int triangle, vplVec3 point);

// The mean over a part of a triangle with these corners, by 64 points.
float vplGeometry_MeanOpacity(const vplGeometry* geometry, int triangle, const vplVec3 corners[3]);

// Finds the closest cut-out that stops a ray before tMax; whether one does where its opacity is a share is decided by the
// bits of the point. False if there is none.
bool vplCutOuts_ClosestHit(const vplGeometry* geometry, const vplRay* ray, float tMax, vplHit* hitOut);

// A ray among others through one pixel, of which each object shall stop its share.
typedef struct vplPixelRay {
    vplRay ray;
    uint32_t pixel[2]; // numbers that differ from pixel to pixel and from picture to picture
    float rank;        // of the ray among those of the pixel, [0, 1), evenly spaced
} vplPixelRay;

// The same, decided by pixel, object and rank.
bool vplCutOuts_FindSeen(const vplGeometry* geometry, const vplPixelRay* ray, float tMax, vplHit* hitOut);

// The share of the light along a ray that cut-outs before tMax let through.
float vplCutOuts_Transmittance(const vplGeometry* geometry, const vplRay* ray, float tMax);

// Multiplies amount[i] by the transmittance of ray i.
void vplCutOuts_Veil(const vplGeometry* geometry, const vplRayPacket* rays, float tMax,
                     float amount[VPL_RAY_PACKET]);

// Sets geometry->cutOuts if the scene shows materials with an opacity. The geometry must have its triangles and paint.
// VPL_OUT_OF_MEMORY.
vplResult vplBuildCutOuts(vplGeometry* geometry);

// Makes geometry->cutOuts that of the geometry as it is now, after the given changes of its objects. Stores whether other
// triangles are solid than before. VPL_OUT_OF_MEMORY.
vplResult vplUpdateCutOuts(vplGeometry* geometry, const uint8_t* changes, bool* solidOut);

// NULL is allowed.
void vplCutOuts_Destroy(const vplCutOuts* cutOuts);

#endif
