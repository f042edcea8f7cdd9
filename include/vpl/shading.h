// SPDX-License-Identifier: MIT
// From geometry, lights and visibility to radiance. All functions sum irradiance E in a fixed order and turn
// it into radiance at the end: emission + rho/pi E.
#ifndef VPL_SHADING_H
#define VPL_SHADING_H

#include <vpl/image.h>
#include <vpl/lights.h>

VPL_HEADER_BEGIN

// Lights are summed in float in groups of this many, groups in double: a plain float sum stops growing at
// 2^24 equal terms.
enum { VPL_LIGHT_GROUP = 64 };

// Largest side of the square of pixels that share the virtual lights of interleaved shading.
enum { VPL_MAX_INTERLEAVE = 16 };

// Most short rays per point of a compensation.
enum { VPL_MAX_NEAR_RAYS = 1 << 20 };

// A camera with the size of its picture.
typedef struct vplView {
    vplVec3 eye, right, up, forward; // right-handed, unit
    double scaleX, scaleY;           // 1 / tangent of the half-angle, across and up
    double offsetX, offsetY;         // position of the sample in the pixel, from its centre; in half pictures
    double nearPlane, farPlane;      // metres
    int width, height;               // pixels
} vplView;

// `camera` must have passed vplScene_AddCamera.
vplView vplView_Create(const vplCameraDef* camera, int width, int height);

// The same view sampled at (x, y) in [0, 1)^2 of each pixel, y down, instead of at (0.5, 0.5).
// Not checked, for speed: pointers must not be NULL.
vplView vplView_At(const vplView* view, double x, double y);

// Pixel coordinates of a point (x right, y down, (0, 0) the upper left corner). False behind the near plane.
// Not checked, for speed: pointers must not be NULL.
bool vplView_Project(const vplView* view, vplVec3 point, float* x, float* y);

// Clip coordinates x, y, z, w of points, with the bits that all draws of the view have. Depth z/w is reversed: 1 at the
// near and 0 at the far plane (vplFramebuffer.reversedDepth).
// Not checked, for speed: pointers must not be NULL.
void vplView_ToClip(const vplView* view, const vplVec3* points, int count, float (*clipOut)[4]);

// Prepares the lights of a set for shading: fills at most out[0 .. set->lightCount) and returns how many.
// Lights of step 0 that are the emitter itself are left out. Keller's lights are physical, also with
// documented attenuation.
int vplPrepareLights(const vplLightSet* set, vplLighting lighting, vplShadeLight* out);

// The content of the picture.
typedef enum vplShadeOutput {
    VPL_OUTPUT_RADIANCE = 0,
    VPL_OUTPUT_DEPTH,   // distance along the view axis, metres; 0 where nothing is
    VPL_OUTPUT_NORMALS, // unit normals as shaded; 0 where nothing is
    VPL_OUTPUT_ALBEDO,  // diffuse reflectance, plus emission if def->emission, at most 1; 0 where nothing is
    VPL_OUTPUT_OBJECT,  // 1 + index of the object; 0 where nothing is
    VPL_OUTPUT_SHADOW_FACTOR, // s of the first emitter, [0, 1]
    // Irradiance of virtual lights only, W/m^2; interleaved: of the lights of the pixel's class, K^2 times as
    // bright.
    VPL_OUTPUT_GATHER,
    VPL_OUTPUT_DENOISED, // the same after the filter of interleaved shading
    // Radiance of the environment, times the share of a pixel's samples that show nothing, W/(m^2 sr).
    VPL_OUTPUT_BACKGROUND
} vplShadeOutput;

// Compensation: brings back the light that the clamp takes, by rays of length minDistance from each point. A
// hit reflects light of emitters, area lights and virtual lights. These may be more than the picture's own,
// so they are listed again.
// Source: Kollig and Keller, Illumination in the Presence of Weak Singularities, MCQMC 2004.
typedef struct vplCompensationDef {
    int rayCount; // per point, [1, VPL_MAX_NEAR_RAYS]; default 2, the fewest of vplRender without interleaving
    // Randomly chosen virtual lights that light a hit, [1, VPL_MAX_LIGHTS]; default 16; 16 to 32 in vplRender. The result is
    // unbiased for any number; noise is low once each light stands for a disc of radius minDistance or less.
    int hitLights;
    uint32_t firstRay; // index of a point's first ray in its sequence, which passes continue; default 0
    uint64_t seed;     // default 0
    const vplEmitterDef* emitters; // as in vplShadeDef; default NULL, without emitters
    const vplShadow* shadows;
    int emitterCount;
    const vplShadeLight* areaLights; // default NULL, without area lights
    int areaLightCount;
    float areaLightMinDistance;
    int trianglesPerPoint;       // of the picture; 16 times fewer light a hit; default 0
    const vplShadeLight* lights; // default NULL, without virtual lights
    int lightCount;
    bool lightRays;   // the virtual lights cast shadows, by rays also where pictures use maps; default false
    float reflection; // factor of reflectances: 1 (default), or 1/pi for lights with documented attenuation
    // The first emitterLightCount lights stand for the emission of surfaces; default 0. Within emitterLightDistance,
    // metres, (0, minDistance], rays find that emission; beyond it these lights compensate for themselves.
    int emitterLightCount;
    float emitterLightDistance; // default 0; must be > 0 where there are such lights
    bool seesEmission;          // they light the picture: the first ray finds emission, too; default true
    bool seesReflection;        // the other lights light the picture; default true
    uint32_t cookie;            // set by vplDefaultCompensationDef
} vplCompensationDef;

// Two short rays per point. Nothing lights their hits until emitters, areaLights or lights are set.
vplCompensationDef vplDefaultCompensationDef(void);

// The light that a ray of a final gather meets.
typedef struct vplMetLight {
    vplRgb radiosity; // of reflected light, on the side that the ray hit, W/m^2
    // Metres. Hits that are nearer are lit by rays of their own instead; 0: none are.
    float size;
} vplMetLight;

typedef vplMetLight vplMeetFcn(const void* user, const vplHit* hit, vplVec3 direction);

// Final gather: indirect light is found by rays from each pixel. With interleaving, the pixels of a square of
// K x K take different parts of K^2 rayCount directions, and the filter takes the mean of neighbours.
// Source: Reichert, A Two-Pass Radiosity Method Driven by Lights and Viewer Position, Cornell 1992.
typedef struct vplGatherDef {
    int rayCount;      // per pixel, [1, VPL_MAX_NEAR_RAYS]; default 64, as vplRender has for cut-outs
    uint32_t firstRay; // index of a pixel's first ray in its sequence; default 0
    uint64_t seed;     // default 0
    vplMeetFcn* meet;  // called by all workers at the same time; required: the default, NULL, is refused
    const void* user;  // passed to `meet`; default NULL
    const vplEmitterDef* emitters; // they light near hits, with shadow rays; default NULL, without emitters
    int emitterCount;
    const vplShadeLight* areaLights; // as in vplShadeDef; default NULL, without area lights
    int areaLightCount;
    float areaLightMinDistance;
    int trianglesPerPoint; // > 0: one triangle that a tree chooses lights a near hit; default 0
    uint32_t cookie;       // set by vplDefaultGatherDef
} vplGatherDef;

// 64 rays per pixel. The caller must set `meet`, because only the caller knows the light of surfaces.
vplGatherDef vplDefaultGatherDef(void);

// A G-buffer: for each pixel of a view the visible triangle with its position and normal, and the visible triangle of each
// sample. Pictures of one view under different lights can share it.
typedef struct vplGbuffer vplGbuffer;

typedef struct vplShadeDef {
    vplLighting lighting;         // default VPL_LIGHTING_PHYSICAL
    vplAccumulation accumulation; // default VPL_ACCUMULATE_MULTIPASS
    vplShadeOutput output;        // default VPL_OUTPUT_RADIANCE
    int batch;                    // lights per pass, >= 1; batched only; default 64
    int interleave;               // K, [1, VPL_MAX_INTERLEAVE]; interleaved only; 1 is deferred; default 4
    float minDistance; // clamp distance of virtual lights, metres, >= 0; 0 (default): no clamp; physical only

    // Direct light.
    const vplEmitterDef* emitters; // documented: point emitters only; default NULL
    // One per emitter; rays where its map is NULL, and for directional emitters. NULL (default): rays for all.
    const vplShadow* shadows;
    // One per emitter: its shadow is taken from this reflective shadow map. NULL (default), also of an entry: from
    // `shadows`.
    const vplReflectiveMap* const* emitterMaps;
    int emitterCount; // 0 (default): no direct light
    // Points and spots that light a point, with shadow rays, chosen from a tree by how much light they may send there; 0
    // (default), or not fewer than there are: all do. Physical only. The noise depends on a point's position alone.
    // Hits of short rays are lit by a sixteenth of this number, rounded up. If it is 0 and more than 64 emitters have no shadow
    // maps, a tree chooses four of them for each hit, and only four samples of 8 or 16 are lit at rims of shadows.
    int emittersPerPoint;
    // Triangles that emit, and light a point by a point on each, likewise; 0 (default): `areaLights` stand for them.
    int trianglesPerPoint;
    // The trees to choose from, of these emitters and those of `compensation` and `gather`, which are the same; NULL
    // (default): they are made for this call.
    const struct vplEmitterTrees* emitterTrees;
    const vplShadeLight* areaLights; // samples of area lights, with shadow rays; physical only; default NULL
    int areaLightCount;              // default 0
    float areaLightMinDistance;      // their clamp distance, as minDistance; default 0
    int particleCount;               // N, by which documented direct light is divided; default 0, counts as 1

    // Coverage antialiasing: samples per pixel besides its centre, [0, VPL_MAX_SAMPLES_PER_PIXEL], rounded
    // down to an even number; 0 (default): pixels show what is in their centres. Radiance only; multipass and
    // batched ignore it.
    int samples;

    // Virtual lights.
    const vplShadeLight* lights;    // default NULL
    int lightCount;                 // 0 (default): no indirect light
    const vplHemiMap* lightShadows; // one per virtual light; NULL (default): no shadows, or by rays
    bool lightRays;                 // shadows by rays; default false
    // Clusters of lights that share a shadow, instead of lightShadows and lightRays; deferred and interleaved
    // only, without compensation. One per virtual light: index in clusterShadows, -1: no shadow; NULL
    // (default): no clusters. Lights of one cluster should follow each other: the shadow is looked up where
    // the list changes cluster, and once per VPL_LIGHT_GROUP lights. Interleaved: from 8 clusters with lights
    // on, and with an even K, each class has lights of every other cluster.
    const int* lightClusters;
    const vplParaboloidMap* clusterShadows; // default NULL
    int clusterCount;                       // default 0
    float cutError;                         // lightcuts: see vplRenderOptions; (0, 1], default 0.02
    bool emission;                          // the picture shows the emission of surfaces; default false
    const vplCompensationDef* compensation; // physical only; NULL (default): light taken by the clamp is lost
    const vplGatherDef* gather; // deferred and interleaved, physical only; NULL (default): no final gather
    // Only rows in [firstRow, endRow) of the image are written, with the bits that they have in the whole picture. Both are
    // multiples of VPL_TILE_SIDE, or endRow is the height. endRow 0 (default): all.
    int firstRow, endRow;
    // A G-buffer of the same geometry, view and samples, that has these rows. Triangles are then not rasterized again, and the
    // picture has the same bits. Only radiance and background read it; multipass and batched ignore it. NULL (default): triangles
    // are rasterized.
    const vplGbuffer* gbuffer;
    vplProgressFcn* progress; // called while vplShadeView draws; default NULL
    void* progressUser;
    uint32_t cookie; // set by vplDefaultShadeDef
} vplShadeDef;

// A black picture: neither emitters nor lights, and surfaces do not show what they emit.
vplShadeDef vplDefaultShadeDef(void);

typedef struct vplShadeStats {
    vplRasterStats raster;
    int64_t shadowRays;
    int64_t lightEvaluations; // lightcuts: pairs of a pixel and a virtual light that were evaluated
    int64_t cutPixels;        // lightcuts: pixels that show something
    int largestCut;           // lightcuts: most virtual lights evaluated for one pixel
} vplShadeStats;

// Draws the geometry into `image`, which has the view's size. statsOut may be NULL. VPL_INVALID_ARGUMENT for an image of
// another size, and for a def, compensation or gather that its default function did not make or with values out of range.
vplResult vplShadeView(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                       vplImage* image, vplShadeStats* statsOut);

// Rasterizes a view into a new G-buffer. The function reads samples, firstRow, endRow and progress of the def, and ignores the
// rest. The geometry must outlive the G-buffer and must not change. Memory: 16 KiB per plane for each tile of 64 x 64 pixels; the
// planes are 4 for triangle and position, 3 for normals if some object is smooth, and 1 per sample. statsOut may be NULL.
// VPL_INVALID_ARGUMENT for a def that vplDefaultShadeDef did not make, and for samples or rows out of range.
vplResult vplGbuffer_Create(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                            vplGbuffer** gbufferOut, vplRasterStats* statsOut);

// NULL is allowed.
void vplGbuffer_Destroy(vplGbuffer* gbuffer);

// Points on the geometry, each with the side that it is lit from.
typedef struct vplSurfacePoint {
    vplVec3 position; // metres; on the triangle
    vplVec3 normal;   // unit, of the side that receives
    int triangle;     // index in the geometry
} vplSurfacePoint;

// Irradiance of points by the def's emitters, area lights and virtual lights, W/m^2, with its shadows.
// Accumulation, output, clusters, compensation and gather are ignored. Rays are added to *raysOut, which may be NULL.
// VPL_INVALID_ARGUMENT for a def that vplDefaultShadeDef did not make.
vplResult vplShadePoints(const vplGeometry* geometry, const vplShadeDef* def, const vplSurfacePoint* points,
                         int count, vplRgb* irradianceOut, int64_t* raysOut);

// The clamp distance D, metres, that takes about `share`, (0, 1), of the light of virtual lights: the mean of
// max(0, 1 - d^2 / D^2) over the distances d of 2048 cosine-distributed rays from visible points is `share`.
// The geometry's diagonal where there is no such D.
vplResult vplFindNearDistance(const vplGeometry* geometry, const vplView* view, double share,
                              float* distanceOut);

// Light that the clamp takes from virtual lights, and their light without a clamp: sums over visible points,
// of which only the ratio has a meaning.
typedef struct vplClampLoss {
    double lost, all; // reflected to the eye, sum of the channels
} vplClampLoss;

// Estimates the loss from `pointCount` evenly spread pixels. def->compensation says how rays are cast,
// whether or not the picture is compensated; both numbers are 0 without it. VPL_INVALID_ARGUMENT for a def or a
// compensation that its default function did not make, or with ray counts out of range.
vplResult vplEstimateClampLoss(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                               int pointCount, vplClampLoss* lossOut);

VPL_HEADER_END

#endif
