// SPDX-License-Identifier: MIT
// One render of one view: what the accumulation strategies and their kernels share.
#ifndef VPL_SHADING_SHADING_H
#define VPL_SHADING_SHADING_H

#include "base/arena.h"
#include "geometry/emitter_trees.h"
#include "shading/kernels.h"

// ---- light

// A hit of a short ray is lit by all emitters, or, if more than VPL_EMITTERS_OF_HIT would cast shadow rays, by VPL_CHOSEN_AT_HIT that a
// tree chooses.
enum { VPL_EMITTERS_OF_HIT = 64, VPL_CHOSEN_AT_HIT = 4 };

// An emitter as its kernel reads it.
typedef struct vplEmitterRay {
    vplVec3 position;            // metres; point and spot
    vplVec3 direction;           // unit, where light travels; spot and directional
    float cosOuter, inverseRing; // spot: 1 / (cos inner - cos outer)
    bool spot, parallel, falloff;
} vplEmitterRay;

// Emitters and samples of area lights: what lights a surface without a bounce.
typedef struct vplDirectLight {
    const vplEmitterDef* emitters;
    const vplEmitterRay* rays; // one per emitter
    const vplShadow* shadows;  // one per emitter; NULL: rays
    const vplReflectiveMap* const*
        maps; // one per emitter or NULL, entries too: its shadow comes from this map
    int emitterCount;
    float weight;               // factor of all emitters: documented 1/N, else 1
    int perPoint;               // points and spots that light a point, chosen from the tree; 0: all do
    const vplEmitterTree* tree; // of points and spots; NULL: all emitters light a point
    int trianglesPerPoint;      // that emit, likewise
    const vplEmitterTree* triangleTree; // NULL: area lights stand for all of them
    const vplEmitterTrees* trees;       // that hold these trees, and the sources that they choose
    int firstParallel; // directional emitter, which the tree does not hold; emitterCount: there is none
    const vplShadeLight* areaLights;
    int areaLightCount;
    float areaLightInverseClamp;
} vplDirectLight;

// Virtual lights in the order of their accumulation.
typedef struct vplLightList {
    const vplShadeLight* lights;
    int count;
    const vplHemiMap* maps; // shadows, one per light; NULL: none
    const int* clusters;    // index in def->clusterShadows, -1: none, one per light; NULL: no clusters
    bool castsRays;         // their shadows are found by rays
    float inverseClamp;     // 1 / minDistance^2
    float* columns[6];      // px .. nz, for culling; NULL: none is culled
} vplLightList;

struct vplShading;

// Makes the emitter rays in the shading's arena, and where points choose emitters or triangles, finds the trees: those of
// the def, or new ones.
vplResult vplDirectLight_Open(vplDirectLight* direct, const struct vplShading* shading, vplLighting lighting);

// The map that an emitter's shadow is taken from, or NULL.
static inline const vplReflectiveMap* vplDirectLight_Map(const vplDirectLight* direct, int emitter)
{
    return direct->maps != NULL ? direct->maps[emitter] : NULL;
}

// Tests whether an emitter's shadow is found by rays, and so has a hard rim.
static inline bool vplDirectLight_CastsRays(const vplDirectLight* direct, int emitter)
{
    return vplDirectLight_Map(direct, emitter) == NULL &&
           (direct->rays[emitter].parallel || direct->shadows == NULL ||
            direct->shadows[emitter].map == NULL);
}

// 1 / distance^2, infinity for 0: a clamp distance as kernels read it.
float vplInverseSquare(float distance);

// ---- the render

struct vplStrategy;
struct vplCompensator;
struct vplGather;
struct vplObjectUniforms;

typedef struct vplShading {
    const vplGeometry* geometry;
    const vplView* view;
    const vplShadeDef* def;
    vplArena* arena; // owns what is allocated for this render
    vplShadingKernels kernels;
    vplDirectLight direct;
    vplLightList lights;
    bool smooth;                         // some object has shading normals
    bool irradiance;                     // the picture is irradiance of virtual lights, not radiance
    int samples;                         // of coverage, besides centres; even
    bool smoothsRims;                    // tiles keep the irradiance of emitters
    int firstRow, endRow;                // of the picture, that are wanted
    vplImage* image;                     // the picture
    vplMesh* meshes;                     // one per object
    struct vplObjectUniforms* objects;   // one per object
    struct vplCompensator* compensation; // NULL: light taken by the clamp is lost
    struct vplGather* gather;            // NULL: no final gather
    void* state;                         // of the strategy
    vplTileFcn* tileTask;                // of the strategy: reads the G-buffer
    int64_t* shadowRays;                 // counted atomically: sums of integers do not depend on the order
} vplShading;

// A render without picture, objects, emitter rays and arena.
vplShading vplShading_Make(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def);

// Refuses a def that vplDefaultShadeDef did not make.
vplResult vplShadeDef_CheckCookie(const vplContext* context, const vplShadeDef* def);

// Refuses a compensation that vplDefaultCompensationDef did not make, and numbers of rays and lights out of range. A def
// without compensation passes.
vplResult vplShadeDef_CheckCompensation(const vplContext* context, const vplShadeDef* def);

// The rows of the picture that are wanted: [first, end).
static inline int vplShadeDef_FirstRow(const vplShadeDef* def)
{
    return def->endRow > 0 ? def->firstRow : 0;
}

static inline int vplShadeDef_EndRow(const vplShadeDef* def, const vplView* view)
{
    return def->endRow > 0 ? def->endRow : view->height;
}

// Refuses a def that vplGbuffer_Create cannot use, with a message.
vplResult vplShadeDef_CheckGbuffer(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def);

// Refuses what vplShadeView cannot draw, with a message.
vplResult vplShadeDef_Check(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                            const vplImage* image);

// The ways in which virtual lights reach the pixels.
typedef struct vplStrategy {
    vplResult (*open)(vplShading* shading, vplFramebuffer* framebuffer); // makes shading->state and planes
    vplResult (*record)(vplShading* shading, vplRaster* raster);         // records all draws and tile tasks
    vplResult (*finish)(vplShading* shading, vplShadeStats* stats);      // after all tiles; may be NULL
} vplStrategy;

// multipass and batched; deferred, also for pictures without virtual lights; stages of the G-buffer; what is behind all
// surfaces
extern const vplStrategy vplPassesStrategy, vplDeferredStrategy, vplShowStrategy, vplBackgroundStrategy;
extern const vplStrategy vplInterleavedStrategy, vplLightcutsStrategy;

// Returns true for pictures that show light, false for stages on the way to it.
static inline bool vplIsLight(vplShadeOutput output)
{
    return output == VPL_OUTPUT_RADIANCE || output == VPL_OUTPUT_GATHER || output == VPL_OUTPUT_DENOISED;
}

// The contents of the tiles of a view, or of some of its rows, after all triangles were rasterized.
struct vplGbuffer {
    vplContext* context;
    const vplGeometry* geometry;
    vplView view;
    int samples;
    int firstRow, endRow;       // pictures of these rows can use it
    int firstTile, tilesX;      // number of the first tile that is kept; tiles in a row of the whole view
    int firstPlane, planeCount; // planes of a tile that are kept
    float* tiles;               // for each tile its planes, then its samples
};

extern const vplStrategy vplKeepStrategy; // fills the vplGbuffer that is its state

// Tests whether an output uses coverage samples. Only such outputs read a vplGbuffer.
static inline bool vplShowsSamples(vplShadeOutput output)
{
    return output == VPL_OUTPUT_RADIANCE || output == VPL_OUTPUT_BACKGROUND;
}

// Adds the planes of a G-buffer and the scratch memory of its tiles. `tileTask` will read them.
void vplOpenGbuffer(vplShading* shading, vplFramebuffer* framebuffer, vplTileFcn* tileTask);

// Records the draws that fill the G-buffer or, if the def has a vplGbuffer, a task that copies its tiles; then shading->tileTask,
// which reads each finished tile.
vplResult vplRecordGbuffer(vplShading* shading, vplRaster* raster);

// A task of tiles: puts the cut-outs that are seen into the G-buffer and its samples.
vplTileFcn vplShowCutOuts;

// Makes the columns of the lights, which culling reads, unless each light has a shadow of its own.
vplResult vplMakeColumns(vplShading* shading);

// ---- the view

// Planes of the framebuffer.
enum {
    VPL_PLANE_IRRADIANCE = 0, // 3 planes, passes: the light group being summed
    VPL_PLANE_NORMAL = 0,     // 3 planes, G-buffer: interpolated normals of smooth geometry
    VPL_PLANE_TRIANGLE = 3,   // bits of an int: 1 + index in geometry->normals, 0 where nothing is
    VPL_PLANE_POSITION = 4,   // 3 planes, G-buffer
    VPL_PLANE_INDIRECT = 4 // 3 planes, interleaved: irradiance replaces positions that are no longer needed
};

// Scratch of a tile. A G-buffer needs the first number only, unless rims of shadows are smooth.
typedef struct vplTileSums {
    int64_t shadowRays;
    union {
        _Alignas(64) double irradiance[3][VPL_TILE_SIDE * VPL_TILE_SIDE]; // passes: sums of whole groups
        _Alignas(64) float emitted[3][VPL_TILE_SIDE * VPL_TILE_SIDE];     // irradiance of emitters
    };
} vplTileSums;

// Uniforms of the vertex shader of all camera passes.
typedef struct vplObjectUniforms {
    const vplShading* shading;
    const vplVec3* positions;
    const vplVec3* normals; // NULL: flat
    int object;
} vplObjectUniforms;

// A surface that samples of a pixel show.
typedef struct vplEdgeSurface {
    int triangle;
    int16_t sample; // one that shows it, near the middle of those that do
    bool glows;     // its emission counts
    float share;
} vplEdgeSurface;

// Varyings of a camera pass: world position, and the normal of smooth objects. The surface shader leaves a
// vplSurface, and where some object is smooth another one for vplPoints.plane.
enum { VPL_CAMERA_VARYINGS = 3, VPL_SURFACE_VARYINGS = 6 };

void vplCameraVertices(const void* uniforms, int first, int count, const vplVertices* out);

// Sets the vertex and surface shader of a pipeline, with their uniforms and varyings, for one object.
void vplSetCamera(const vplShading* shading, int object, vplPipeline* pipeline);

// Uniforms of the fragment shaders in passes.
typedef struct vplPassUniforms {
    const vplShading* shading;
    int object;
    int first, count; // virtual lights of this pass
} vplPassUniforms;

// A triangle reflects irradiance E: radiance = emission + factor E.
typedef struct vplReflector {
    double factor[3]; // rho / pi, of the material alone
    float emission[3];
    int texture; // -1: none
} vplReflector;

// A triangle as it is shaded, besides positions.
typedef struct vplFacet {
    vplVec3 normal; // as shaded: towards the eye for physical lighting, as declared for documented
    float offset;   // of its plane from the eye: normal . (point - eye), metres
    vplReflector reflector;
    bool smooth; // its object has shading normals
} vplFacet;

// `triangle` is an index in geometry->normals.
vplFacet vplGetFacet(const vplShading* shading, int triangle);

// ---- irradiance

// Points shown by a block of pixels.
typedef struct vplPoints {
    const vplSurface* surface; // positions, and the normals that light is received with
    // The same with the triangles' own normals; equals `surface` where none is smooth.
    const vplSurface* plane;
    int triangle[VPL_LANES]; // index in geometry->normals, -1 where nothing is
} vplPoints;

// Rays to all lights leave the points of a block from these places.
typedef struct vplRayStarts {
    vplHit hit[VPL_LANES]; // of lanes that show a triangle
} vplRayStarts;

void vplFindRayStarts(const vplShading* shading, const vplPoints* points, vplRayStarts* starts);

// A point of a triangle as a ray leaves it.
vplHit vplHitOfPoint(const vplGeometry* g, int triangle, vplVec3 position);

// Points that receive light.
typedef struct vplReceiver {
    const vplShading* shading;
    const vplPoints* points;
    const vplRayStarts* starts; // NULL: shadows are not found by rays
    int64_t* rays;              // counter of rays
} vplReceiver;

// A light's contribution if nothing is between, and the share of it that arrives, [0, 1].
typedef struct vplReceived {
    float open[3][VPL_LANES], visible[VPL_LANES];
} vplReceived;

// Visibility by rays where the receiver has starts, else by `map`, else 1. False where no lane is lit; `out`
// is not complete then.
bool vplReceiveLight(const vplReceiver* receiver, const vplShadeLight* light, const vplHemiMap* map,
                     float inverseClamp, vplReceived* out);

// Sets amount to 0 where something is on the way from the point, of length 1 (parallel: any length), and
// where the way leads behind the triangle. Lanes of amount 0 cast no ray. The receiver must have starts.
void vplCastShadowRays(const vplReceiver* receiver, const vplVec3 way[VPL_LANES], bool parallel,
                       float amount[VPL_LANES]);

// Adds the irradiance of points and spots, or of triangles that emit, that a tree chooses, with shadows, and counts the
// rays it casts.
void vplAddChosenEmitters(const vplShading* shading, const vplDirectLight* direct, const vplPoints* points,
                          float irradiance[3][VPL_LANES], int64_t* rays);
void vplAddChosenTriangles(const vplShading* shading, const vplDirectLight* direct, const vplPoints* points,
                           float irradiance[3][VPL_LANES], int64_t* rays);

// Sets amount to 0 where something is between a point and an emitter. Lanes of amount 0 cast no ray. The receiver must
// have starts.
void vplCastEmitterRays(const vplReceiver* receiver, const vplEmitterRay* emitter, float amount[VPL_LANES]);

// Irradiance of all emitters and area lights, with shadows. Adds to `rays`.
void vplDirectIrradiance(const vplShading* shading, const vplDirectLight* direct, const vplPoints* points,
                         float irradiance[3][VPL_LANES], int64_t* rays);

// Adds the irradiance of area lights, and of triangles that emit and that a tree chooses, with shadows.
void vplAddAreaLights(const vplShading* shading, const vplDirectLight* direct, const vplPoints* points,
                      float irradiance[3][VPL_LANES], int64_t* rays);

// Adds virtual lights first .. first + count - 1, each with its own shadow if it has one.
void vplIndirectIrradiance(const vplShading* shading, const vplPoints* points, int first, int count,
                           float irradiance[3][VPL_LANES], int64_t* rays);

// Multiply amount by the share of light that cut-outs let through on its way from a place or an emitter to the points.
void vplVeilFromPoint(const vplGeometry* g, const vplPoints* points, vplVec3 from, float amount[VPL_LANES]);
void vplVeilFromEmitter(const vplGeometry* g, const vplPoints* points, const vplEmitterRay* emitter,
                        float amount[VPL_LANES]);

// ---- compensation

// Makes shading->compensation in the arena, if the def asks for it.
vplResult vplCompensator_Open(vplShading* shading);

// Adds the light that the clamp takes from virtual lights. `pixels` differ from pixel to pixel.
void vplAddCompensation(const vplShading* shading, const vplPoints* points, const uint32_t pixels[VPL_LANES],
                        float irradiance[3][VPL_LANES], int64_t* rays);

// ---- final gather

// Makes shading->gather in the arena, if the def asks for it.
vplResult vplGather_Open(vplShading* shading);

// Adds the light that rays from the points meet. `pixels` are y << 16 | x.
void vplAddGathered(const vplShading* shading, const vplPoints* points, const uint32_t pixels[VPL_LANES],
                    float irradiance[3][VPL_LANES], int64_t* rays);

// ---- indirect light that each point finds by its own rays: compensation and final gather

static inline bool vplFindsLightByRays(const vplShading* s)
{
    return s->compensation != NULL || s->gather != NULL;
}

static inline void vplAddLightOfRays(const vplShading* s, const vplPoints* points,
                                     const uint32_t pixels[VPL_LANES], float irradiance[3][VPL_LANES],
                                     int64_t* rays)
{
    if (s->compensation != NULL) {
        vplAddCompensation(s, points, pixels, irradiance, rays);
    }
    if (s->gather != NULL) {
        vplAddGathered(s, points, pixels, irradiance, rays);
    }
}

// The same for the block of 4 x 4 pixels from (x, y) on, if the render casts such rays.
static inline void vplAddLightOfRaysOfBlock(const vplShading* s, const vplPoints* points, int x, int y,
                                            float irradiance[3][VPL_LANES], int64_t* rays)
{
    uint32_t pixels[VPL_LANES];
    if (vplFindsLightByRays(s)) {
        for (int l = 0; l < VPL_LANES; l++) {
            pixels[l] = (uint32_t)(y + l / VPL_BLOCK_SIDE) << 16 | (uint32_t)(x + l % VPL_BLOCK_SIDE);
        }
        vplAddLightOfRays(s, points, pixels, irradiance, rays);
    }
}

#endif
