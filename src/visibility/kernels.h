// SPDX-License-Identifier: MIT
// All kernels of visibility: one list, from which prototypes and a table for each instruction set are made.
#ifndef VPL_VISIBILITY_KERNELS_H
#define VPL_VISIBILITY_KERNELS_H

#include "base/isa.h"
#include "visibility/blocks.h"

struct vplBvh;
struct vplCubeBounds;

// ---- cube maps

// 16 points as the light sees them.
typedef struct vplShadowPoints {
    float x[VPL_LANES], y[VPL_LANES], z[VPL_LANES]; // from the light
    float inverse[VPL_LANES];                       // 1 / distance
    float radius[VPL_LANES];                        // of the disc of samples, metres
    float limit[VPL_LANES];                         // distance less bias: a sample nearer than this shadows
    int32_t face[VPL_LANES];                        // all samples fall on it; negative where they may differ
} vplShadowPoints;

typedef void vplShadowBiasFcn(const vplShadow* shadow, const float* restrict distance,
                              const float* restrict cosine, float* restrict bias);

// Returns how many points needed no samples.
typedef int vplShadowFactorFcn(const vplShadow* shadow, const vplSurface* surface, float* restrict factor);

// Sets the points' faces, known where the map's bounds decide all samples, and shadowed to how many lie in
// shadow there. Returns how many points are known.
typedef int vplTestBoundsFcn(const vplShadow* shadow, const vplSurface* surface,
                             vplShadowPoints* restrict points, int32_t known[restrict VPL_LANES],
                             float shadowed[restrict VPL_LANES]);

// Bounds one row of regions of level 0 in all faces.
typedef void vplBoundRegionsFcn(const vplCubeMap* map, int row, struct vplCubeBounds* restrict bounds);

// ---- small maps

// Draws all triangles of a tree into a map of zeros.
typedef void vplDrawHemiMapFcn(const struct vplBvh* bvh, const vplHemiMap* map, float* texels);

typedef void vplHemiMapFactorFcn(const vplHemiMap* map, const vplSurface* surface,
                                 float factor[restrict VPL_LANES]);

// Texels of a hemisphere; `triangles` may be NULL.
typedef struct vplParaboloidTexels {
    float* texels;
    int32_t* triangles;
} vplParaboloidTexels;

// Draws a hemisphere of a map, with a back or without; `scratch` has room for the blocks.
typedef void vplDrawParaboloidFcn(const struct vplBvh* bvh, const vplParaboloidMap* map, int hemisphere,
                                  vplParaboloidTexels scratch, vplParaboloidTexels out);

typedef void vplParaboloidFactorFcn(const vplParaboloidMap* map, const vplSurface* surface,
                                    float factor[restrict VPL_LANES]);

// ---- the list: X(type, field, function)

#define VPL_VISIBILITY_KERNELS(X)                                                                            \
    X(vplShadowBiasFcn, shadowBias, vplShadowBias)                                                           \
    X(vplShadowFactorFcn, shadowFactor, vplShadowFactor)                                                     \
    X(vplTestBoundsFcn, testBounds, vplTestBounds)                                                           \
    X(vplBoundRegionsFcn, boundRegions, vplBoundRegions)                                                     \
    X(vplDrawHemiMapFcn, drawHemiMap, vplDrawHemiMap)                                                        \
    X(vplHemiMapFactorFcn, hemiMapFactor, vplHemiMapFactor)                                                  \
    X(vplDrawParaboloidFcn, drawParaboloid, vplDrawParaboloid)                                               \
    X(vplParaboloidFactorFcn, paraboloidFactor, vplParaboloidFactor)

typedef struct vplVisibilityKernels {
    VPL_VISIBILITY_KERNELS(VPL_KERNEL_FIELD)
} vplVisibilityKernels;

const vplVisibilityKernels* vplVisibilityKernels_Get(vplIsa isa);

#ifdef VPL_KERNEL_ISA
VPL_VISIBILITY_KERNELS(VPL_KERNEL_PROTOTYPE)
#endif

#endif
