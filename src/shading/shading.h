// SPDX-License-Identifier: MIT
// What the ways of accumulating light share.
#ifndef VPL_SHADING_SHADING_H
#define VPL_SHADING_SHADING_H

#include <vpl/shading.h>

#include "base/context.h"

// Adds lights to irradiance, one after another. inverseBound is 1 / minDistance^2, infinity for no bound.
typedef void vplLightKernelFcn(const vplSurface* restrict surface, const vplShadeLight* restrict lights,
                               int count, float inverseBound, float irradiance[restrict 3][VPL_LANES]);

// Irradiance of one point emitter of `colour`, times visibility; false (and untouched) where it lights no lane.
typedef bool vplEmitterKernelFcn(const vplSurface* restrict surface, vplVec3 position, bool falloff,
                                 float cosine[restrict VPL_LANES]);

vplLightKernelFcn* vplGetLightKernel(vplIsa isa, vplLighting lighting);
vplEmitterKernelFcn* vplGetEmitterKernel(vplIsa isa);

// One render of one view.
typedef struct vplShading {
    const vplGeometry* geometry;
    const vplView* view;
    const vplShadeDef* def;
    vplImage* image;
    vplLightKernelFcn* lightKernel;
    vplEmitterKernelFcn* emitterKernel;
    float inverseBound;
    vplMesh* meshes;                   // one per object
    struct vplObjectUniforms* objects; // one per object
} vplShading;

// Planes of the framebuffer.
enum {
    VPL_PLANE_IRRADIANCE = 0, // 3 planes: the light group being summed
    VPL_PLANE_TRIANGLE = 3,   // bits of an int: 1 + index in geometry->normals, 0 where nothing is
    VPL_PLANE_POSITION = 4    // 3 planes, deferred only
};

// Scratch of a tile: sums of whole groups.
typedef struct vplTileSums {
    double irradiance[3][VPL_TILE_SIDE * VPL_TILE_SIDE];
} vplTileSums;

// Vertex shader of all camera passes, and its uniforms.
typedef struct vplObjectUniforms {
    const vplShading* shading;
    const vplVec3* positions;
    int object;
} vplObjectUniforms;

void vplCameraVertices(const void* uniforms, int first, int count, const vplVertices* out);
enum { VPL_CAMERA_VARYINGS = 3 }; // world position

// What the shading of a triangle needs besides positions.
typedef struct vplFacet {
    vplVec3 normal; // as shaded: towards the eye for physical lighting, as declared for documented
    vplRgb rho, emission;
} vplFacet;

// `triangle` is an index in geometry->normals.
vplFacet vplGetFacet(const vplShading* shading, int triangle);

// The surface of a block of fragments.
void vplSurface_FromFragments(const vplShading* shading, int object, const vplFragments* fragments,
                              vplSurface* surfaceOut);

// Direct irradiance of all emitters, with shadows.
void vplDirectIrradiance(const vplShading* shading, const vplSurface* surface,
                         float irradiance[3][VPL_LANES]);

// Moves a finished group from the planes to the sums; tile task, data is unused.
void vplFoldTile(void* data, vplTile* tile, int worker);

// Turns sums into radiance and writes the picture; tile task, data is the vplShading.
void vplResolveTile(void* data, vplTile* tile, int worker);

// Writes three values per pixel of a block to the picture.
void vplWriteBlock(const vplShading* shading, const vplTile* tile, int block, float values[3][VPL_LANES]);

// Index in geometry->normals of each lane of a block, -1 where nothing is. Returns whether any lane has one.
bool vplReadTriangles(const vplTile* tile, int element, int triangles[VPL_LANES]);

// The pipelines: record all draws and tile tasks.
vplResult vplRecordPasses(const vplShading* shading, vplRaster* raster, void** uniformsOut);
vplResult vplRecordDeferred(const vplShading* shading, vplRaster* raster);

// A pipeline set up for the camera; the fragment shader is the caller's.
vplPipeline vplCameraPipeline(const vplShading* shading, int object);

#endif
