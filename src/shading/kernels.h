// SPDX-License-Identifier: MIT
// All kernels of shading: one list, from which prototypes, table and getter are made.
#ifndef VPL_SHADING_KERNELS_H
#define VPL_SHADING_KERNELS_H

#include <vpl/shading.h>

#include "base/isa.h"
#include "geometry/emitter_tree.h"
#include "lights/light_tree.h"
#include "visibility/blocks.h"

struct vplShading;
struct vplDirectLight;
struct vplPoints;

// Adds lights to irradiance, one after another. inverseClamp is 1 / minDistance^2, infinity for no clamp.
typedef void vplLightKernelFcn(const vplSurface* restrict surface, const vplShadeLight* restrict lights,
                               int count, float inverseClamp, float irradiance[restrict 3][VPL_LANES]);

// Smallest and largest px, py, pz, nx, ny, nz of some points.
typedef struct vplBounds {
    float low[6], high[6];
} vplBounds;

// facing[i] = 0 where light first + i contributes exactly nothing to any point within the bounds, else 1.
// `columns` are the lights' px, py, pz, nx, ny, nz. count is in [1, VPL_LIGHT_GROUP].
typedef void vplCullFcn(const vplBounds* bounds, float* const columns[6], int first, int count,
                        int32_t facing[VPL_LIGHT_GROUP]);

// Upper bound of the contribution of a light of the node, of intensity 1, to each point; 0 where all
// contribute 0.
typedef void vplClusterBoundFcn(const vplSurface* restrict surface, const vplLightNode* restrict node,
                                float inverseClamp, float bound[restrict VPL_LANES]);

// Sixteen virtual lights side by side: px, py, pz, nx, ny, nz.
typedef struct vplLightLanes {
    _Alignas(64) float at[6][VPL_LANES];
} vplLightLanes;

// Irradiance of one point (px, py, pz, nx, ny, nz) by each light, per unit of intensity: the arithmetic of
// vplAddLightsPhysical, with a clamp per light. `subtracted` is taken off the clamped 1/d^2.
typedef void vplPointKernelFcn(const vplLightLanes* restrict lights, const float point[restrict 6],
                               const float inverseClamp[restrict VPL_LANES], float subtracted,
                               float geometry[restrict VPL_LANES]);

// Adds the irradiance of all emitters, with shadows, and counts the rays it casts.
typedef void vplAddEmittersFcn(const struct vplShading* shading, const struct vplDirectLight* direct,
                               const struct vplPoints* points, float irradiance[restrict 3][VPL_LANES],
                               int64_t* rays);

// vplEmitterTree_Choose for each point on a triangle, by its number in [0, 1); the source is -1 for the others.
typedef void vplChooseSourcesFcn(const vplEmitterTree* tree, const struct vplPoints* points,
                                 const double choice[VPL_LANES], vplChosenSource out[VPL_LANES]);

// The kernels of one vplLighting: X(type, field, function). Tile and task kernels get the vplShading as data.
#define VPL_SHADING_KERNELS(X, Lighting)                                                                     \
    X(vplLightKernelFcn, addLights, vplAddLights##Lighting)                                                  \
    X(vplCullFcn, cull, vplCull##Lighting)                                                                   \
    X(vplClusterBoundFcn, clusterBound, vplClusterBound##Lighting)                                           \
    X(vplPointKernelFcn, lightPoint, vplLightsOfPoint)                                                       \
    X(vplAddEmittersFcn, addEmitters, vplAddEmitters)                                                        \
    X(vplChooseSourcesFcn, chooseSources, vplChooseSources)                                                  \
    X(vplFragmentFcn, surface, vplShadeSurface)   /* surface shader of the passes */                         \
    X(vplFragmentFcn, direct, vplShadeDirect)     /* fragment shader: direct light */                        \
    X(vplPassesFcn, lights, vplShadeLights)       /* fragment shader: passes of virtual lights */            \
    X(vplTileFcn, flush, vplFlushTile)            /* ends a group: moves the planes to the sums */           \
    X(vplTileFcn, resolve, vplResolveTile)        /* turns sums into radiance, writes the picture */         \
    X(vplFragmentFcn, gbuffer, vplWriteGbuffer)   /* fragment shader: writes the G-buffer */                 \
    X(vplTileFcn, show, vplShowTile)              /* writes depth, normals or shadow factor */               \
    X(vplTileFcn, deferred, vplLightTile)         /* every light for every pixel */                          \
    X(vplTileFcn, lightcuts, vplCutTile)          /* clusters of lights for blocks of pixels */              \
    X(vplTileFcn, interleaved, vplInterleaveTile) /* the lights of a pixel's class */                        \
    X(vplTaskFcn, filter, vplFilterTask)          /* means over the classes of neighbours */

#define VPL_DOCUMENTED_KERNELS(X) VPL_SHADING_KERNELS(X, Documented)
#define VPL_PHYSICAL_KERNELS(X)   VPL_SHADING_KERNELS(X, Physical)

typedef struct vplShadingKernels {
    VPL_DOCUMENTED_KERNELS(VPL_KERNEL_FIELD)
} vplShadingKernels;

const vplShadingKernels* vplGetShadingKernels(vplIsa isa, vplLighting lighting);

#ifdef VPL_KERNEL_ISA
VPL_DOCUMENTED_KERNELS(VPL_KERNEL_PROTOTYPE)
VPL_PHYSICAL_KERNELS(VPL_KERNEL_PROTOTYPE)
#endif

#endif
