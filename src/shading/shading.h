// SPDX-License-Identifier: MIT
// What the ways of accumulating light share.
#ifndef VPL_SHADING_SHADING_H
#define VPL_SHADING_SHADING_H

#include <vpl/shading.h>

#include "base/context.h"
#include "lights/light_tree.h"

// Adds lights to irradiance, one after another. inverseBound is 1 / minDistance^2, infinity for no bound.
typedef void vplLightKernelFcn(const vplSurface* restrict surface, const vplShadeLight* restrict lights,
                               int count, float inverseBound, float irradiance[restrict 3][VPL_LANES]);

// Smallest and largest px, py, pz, nx, ny, nz of some points.
typedef struct vplBounds {
    float low[6], high[6];
} vplBounds;

// keep[i] = 0 where light first + i gives exactly nothing to any point within the bounds, else 1. `columns` are
// the lights' px, py, pz, nx, ny, nz. count is in [1, VPL_LIGHT_GROUP].
typedef void vplCullFcn(const vplBounds* bounds, float* const columns[6], int first, int count,
                        int32_t keep[VPL_LIGHT_GROUP]);

// An emitter as its kernel wants it.
typedef struct vplEmitterRay {
    vplVec3 position;            // metres; point and spot
    vplVec3 direction;           // unit, where light travels; spot and directional
    float cosOuter, inverseRing; // spot: 1 / (cos inner - cos outer)
    bool spot, parallel, falloff;
} vplEmitterRay;

// Irradiance per unit of intensity, without shadows; false where it lights no lane.
typedef bool vplEmitterKernelFcn(const vplSurface* restrict surface, const vplEmitterRay* emitter,
                                 float cosine[restrict VPL_LANES]);

// Not less than what a light of the node, of intensity 1, gives to each point; 0 where all give nothing.
typedef void vplClusterBoundFcn(const vplSurface* restrict surface, const vplLightNode* restrict node,
                                float inverseBound, float bound[restrict VPL_LANES]);

vplLightKernelFcn* vplGetLightKernel(vplIsa isa, vplLighting lighting);
vplClusterBoundFcn* vplGetClusterBound(vplIsa isa, vplLighting lighting);
vplCullFcn* vplGetCull(vplIsa isa, vplLighting lighting);

struct vplShading;
struct vplPoints;

// Adds the irradiance of all emitters, with shadows. Counts the rays it cast.
typedef void vplAddEmittersFcn(const struct vplShading* shading, const struct vplPoints* points,
                               float irradiance[restrict 3][VPL_LANES], int64_t* rays);

vplAddEmittersFcn* vplGetAddEmitters(vplIsa isa);

// The map of what an emitter lights first, from which its shadow is taken; NULL: none.
static inline const vplReflectiveMap* vplEmitterMapOf(const vplShadeDef* def, int emitter)
{
    return def->emitterMaps != NULL ? def->emitterMaps[emitter] : NULL;
}

// One render of one view.
typedef struct vplShading {
    const vplGeometry* geometry;
    const vplView* view;
    const vplShadeDef* def;
    vplImage* image;
    vplLightKernelFcn* lightKernel;
    vplAddEmittersFcn* addEmitters;
    vplCullFcn* cull;
    vplClusterBoundFcn* clusterBound;
    float* columns[6]; // of the virtual lights, for `cull`; NULL where no light is left out
    float inverseBound, areaLightInverseBound;
    bool smooth;                       // some object has shading normals
    bool irradiance;                   // of virtual lights only is shown, as it arrives
    vplMesh* meshes;                   // one per object
    struct vplObjectUniforms* objects; // one per object
    vplEmitterRay* emitters;           // one per emitter
    int64_t* shadowRays;               // counted atomically: sums of integers do not depend on the order
    struct vplInterleave* interleave;  // NULL: every pixel meets every light
    struct vplLightcuts* lightcuts;    // NULL: every pixel meets every light
    struct vplNearLight* nearLight;    // NULL: what the bound takes away is lost
} vplShading;

// Whether a picture shows light, not a stage on the way to it.
static inline bool vplShowsLight(vplShadeOutput output)
{
    return output == VPL_OUTPUT_RADIANCE || output == VPL_OUTPUT_GATHER || output == VPL_OUTPUT_DENOISED;
}

// What a block of pixels shows.
typedef struct vplPoints {
    const vplSurface* surface; // positions, and the normals that light is received with
    const vplSurface*
        plane; // the same with the triangles' own normals; equals `surface` where none is smooth
    int triangle[VPL_LANES]; // index in geometry->normals, -1 where nothing is
} vplPoints;

// Planes of the framebuffer.
enum {
    VPL_PLANE_IRRADIANCE = 0, // 3 planes: the light group being summed; not in deferred shading, where
    VPL_PLANE_NORMAL = 0,     // 3 planes: interpolated normals, of smooth geometry
    VPL_PLANE_TRIANGLE = 3,   // bits of an int: 1 + index in geometry->normals, 0 where nothing is
    VPL_PLANE_POSITION = 4,   // 3 planes, deferred only
    VPL_PLANE_INDIRECT = 4    // 3 planes, interleaved only: irradiance, once positions have done their work
};

// Scratch of a tile. Deferred shading needs the first number only.
typedef struct vplTileSums {
    int64_t shadowRays;
    _Alignas(64) double irradiance[3][VPL_TILE_SIDE * VPL_TILE_SIDE]; // sums of whole groups
} vplTileSums;

// Vertex shader of all camera passes, and its uniforms.
typedef struct vplObjectUniforms {
    const vplShading* shading;
    const vplVec3* positions;
    const vplVec3* normals; // NULL: flat
    int object;
} vplObjectUniforms;

void vplCameraVertices(const void* uniforms, int first, int count, const vplVertices* out);
// World position; three more for the normal of smooth objects. After the surface shader: a vplSurface, and where
// some object is smooth another one for vplPoints.plane.
enum { VPL_CAMERA_VARYINGS = 3, VPL_SURFACE_VARYINGS = 6 };

// What the shading of a triangle needs besides positions.
typedef struct vplFacet {
    vplVec3 normal; // as shaded: towards the eye for physical lighting, as declared for documented
    float offset;   // of its plane from the eye: normal . (point - eye), metres
    vplRgb rho, emission;
} vplFacet;

// `triangle` is an index in geometry->normals.
vplFacet vplGetFacet(const vplShading* shading, int triangle);

// Where rays leave a block, the same for all its lights.
typedef struct vplRayStarts {
    vplHit hit[VPL_LANES]; // of lanes that show a triangle
} vplRayStarts;

void vplFindRayStarts(const vplShading* shading, const vplPoints* points, vplRayStarts* starts);

// What one virtual light or lamp gives to the lanes, and which of it arrives, [0, 1]: by rays where there are starts,
// else by the map, else all of it. False where no lane is lit; then neither is complete.
bool vplLightVisibly(const vplShading* shading, const vplPoints* points, const vplRayStarts* starts,
                     const vplHemiMap* map, const vplShadeLight* light, float inverseBound,
                     float part[3][VPL_LANES], float visible[VPL_LANES], int64_t* rays);

// Sets amount to 0 where something is between a point and an emitter. Lanes of amount 0 cast no ray.
void vplCastEmitterRays(const vplShading* shading, const vplPoints* points, const vplEmitterRay* emitter,
                        float amount[VPL_LANES], int64_t* rays);

// A place that pixels show, as rays leave it.
vplHit vplStartOf(const vplGeometry* g, int triangle, vplVec3 seen);

// A virtual light lies on a surface that must not shadow it: rays aim a little above.
vplVec3 vplAimAt(const vplShadeLight* light);

// Direct irradiance of all emitters and lamps, with shadows. Counts the rays it cast.
void vplDirectIrradiance(const vplShading* shading, const vplPoints* points, float irradiance[3][VPL_LANES],
                         int64_t* rays);

// Adds virtual lights first .. first + count - 1, with the shadows that were asked for.
void vplIndirectIrradiance(const vplShading* shading, const vplPoints* points, int first, int count,
                           float irradiance[3][VPL_LANES], int64_t* rays);

// Adds what the bound takes from virtual lights, by the short rays of def->compensation. `pixels` are different
// numbers for different pixels.
void vplAddNearLight(const vplShading* shading, const vplPoints* points, const uint32_t pixels[VPL_LANES],
                     float irradiance[3][VPL_LANES], int64_t* rays);

// The same for the block of 4 x 4 pixels from (x, y) on, where there is anything to add.
static inline void vplAddNearLightOfBlock(const vplShading* s, const vplPoints* points, int x, int y,
                                          float irradiance[3][VPL_LANES], int64_t* rays)
{
    uint32_t pixels[VPL_LANES];
    if (s->nearLight != NULL) {
        for (int l = 0; l < VPL_LANES; l++) {
            pixels[l] = (uint32_t)(y + l / VPL_BLOCK_SIDE) << 16 | (uint32_t)(x + l % VPL_BLOCK_SIDE);
        }
        vplAddNearLight(s, points, pixels, irradiance, rays);
    }
}

// Makes and frees shading->nearLight, as def->compensation says.
vplResult vplOpenNearLight(vplShading* shading);
void vplCloseNearLight(vplShading* shading);

// Of a distance, as kernels want bounds: infinity for 0.
float vplInverseSquare(float distance);

// What all stages of a render share; images, objects and emitters are not there yet.
vplShading vplShading_Make(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def);

// The emitters of shading->def for their kernel.
vplResult vplMakeEmitterRays(vplShading* shading);

// What runs per block or per tile, compiled for an instruction set.
typedef struct vplShadingKernels {
    vplFragmentFcn* surface; // surface shader of all camera passes
    vplFragmentFcn* gbuffer; // fragment shaders: the deferred pass,
    vplFragmentFcn* direct;  // emitters,
    vplPassesFcn* lights;    // passes of virtual lights
    vplTileFcn* light; // tile tasks, data is the vplShading: lights the G-buffer and writes the picture,
    vplTileFcn* interleaved; // lights each pixel by the lights of its class,
    vplTileFcn* cut;         // lights each block by clusters of lights,
    vplTaskFcn* gather;      // tasks, data is the vplShading: mixes the classes,
    vplTileFcn* show;        // shows depth, normals or shadow factor instead,
    vplTileFcn* fold;        // moves a finished group of lights from the planes to the sums,
    vplTileFcn* resolve;     // turns sums into radiance and writes the picture
} vplShadingKernels;

vplShadingKernels vplGetShadingKernels(vplIsa isa);

// Uniforms of the fragment shaders in passes.
typedef struct vplPassUniforms {
    const vplShading* shading;
    int object;
    int first, count; // virtual lights of this pass
} vplPassUniforms;

// The pipelines: record all draws and tile tasks.
vplResult vplRecordPasses(const vplShading* shading, vplRaster* raster, void** uniformsOut);
vplResult vplRecordDeferred(const vplShading* shading, vplRaster* raster);

// Interleaved shading: sorts the lights and makes planes for the framebuffer; replaces shading->def. Then, after
// the tiles, the second step.
vplResult vplOpenInterleave(vplShading* shading, vplFramebuffer* framebuffer);
vplResult vplGatherInterleaved(const vplShading* shading, vplProgressFcn* progress, void* user);
void vplCloseInterleave(vplShading* shading);

// Lightcuts: makes the tree and what each worker needs. Then, after the tiles, what it took.
vplResult vplOpenLightcuts(vplShading* shading, vplProgressFcn* progress, void* user);
void vplCountLightcuts(const vplShading* shading, vplShadeStats* stats);
void vplCloseLightcuts(vplShading* shading);

// A pipeline set up for the camera; the fragment shader is the caller's.
vplPipeline vplCameraPipeline(const vplShading* shading, int object);

#endif
