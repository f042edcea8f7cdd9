// SPDX-License-Identifier: MIT
// From geometry, lights and visibility to radiance. Everything here sums irradiance E in a fixed order and
// turns it into radiance at the end: emission + rho/pi E.
#ifndef VPL_SHADING_H
#define VPL_SHADING_H

#include <vpl/image.h>
#include <vpl/lights.h>

#ifdef __cplusplus
extern "C" {
#endif

// Lights are summed in float in groups of this many, the groups in double, so that a million equal terms still
// add up (a plain float sum stops growing at 2^24 of them).
enum { VPL_LIGHT_GROUP = 64 };

// Largest side of the square of pixels that share the virtual lights of interleaved shading.
enum { VPL_MAX_INTERLEAVE = 16 };

// Most short rays per point of a compensation.
enum { VPL_MAX_NEAR_RAYS = 1 << 20 };

// A camera at work.
typedef struct vplView {
    vplVec3 eye, right, up, forward; // right-handed, unit
    double scaleX, scaleY;           // 1 / tangent of the half-angle, across and up
    double offsetX, offsetY; // where in the pixel it is sampled, from the centre; units of half pictures
    double near, far;        // metres
    int width, height;       // pixels
} vplView;

// `camera` must have passed vplScene_AddCamera.
vplView vplView_Create(const vplCameraDef* camera, int width, int height);

// The same view sampled at (x, y) in [0, 1)^2 of each pixel, y down, instead of at (0.5, 0.5).
vplView vplView_At(const vplView* view, double x, double y);

// Pixel coordinates of a point (x right, y down, (0, 0) the upper left corner). False behind the near plane.
bool vplView_Project(const vplView* view, vplVec3 point, float* x, float* y);

// Clip coordinates x, y, z, w of points, those that all draws of the view have.
void vplView_ToClip(const vplView* view, const vplVec3* points, int count, float (*clipOut)[4]);

// Fills at most out[0 .. set->lightCount) and returns how many: lights of step 0 that are the emitter itself are
// left out. Keller's are physical, also with documented attenuation.
int vplPrepareLights(const vplLightSet* set, vplLighting lighting, vplShadeLight* out);

// Adds lights[0 .. count) to the irradiance of 16 points, one after another.
//   documented: E += L (n.l)+                       (Franchi and Ferrante, no distance, isotropic)
//   physical:   E += I (n.l)+ (m.-l)+ / max(d^2, minDistance^2)   (Keller 1997, bounded)
// l is the unit vector to the light, m the light's normal. What coincides with a light receives nothing from
// it. Distances up to 1e18 m; below 1e-19 m the square underflows and the result is between 0 and the bound.
void vplAccumulateLights(const vplContext* context, vplLighting lighting, float minDistance,
                         const vplSurface* surface, const vplShadeLight* lights, int count,
                         float irradiance[3][VPL_LANES]);

// How virtual lights reach the pixels. The first three give the same bits.
typedef enum vplAccumulation {
    VPL_ACCUMULATE_MULTIPASS = 0, // one pass over the scene per light, depth EQUAL, additive
    VPL_ACCUMULATE_BATCHED,       // one pass per `batch` lights
    VPL_ACCUMULATE_DEFERRED,      // one pass for a G-buffer, then all lights per tile
    VPL_ACCUMULATE_INTERLEAVED,   // every K^2-th light per pixel, then means of neighbours on one surface
    VPL_ACCUMULATE_LIGHTCUTS,     // clusters of a light tree, as fine as an error bound asks for
    VPL_ACCUMULATE_USUAL          // vplRender chooses by the method
} vplAccumulation;

// What the picture shows.
typedef enum vplShadeOutput {
    VPL_OUTPUT_RADIANCE = 0,
    VPL_OUTPUT_DEPTH,         // distance along the view axis, metres; 0 where nothing is
    VPL_OUTPUT_NORMALS,       // unit normals as shaded; 0 where nothing is
    VPL_OUTPUT_SHADOW_FACTOR, // s of the first emitter, [0, 1]
    VPL_OUTPUT_GATHER,  // irradiance of virtual lights only, W/m^2; interleaved: of the pixel's own class of
                        // lights, K^2 times as bright
    VPL_OUTPUT_DENOISED // the same after neighbours have shared
} vplShadeOutput;

// The light that minDistance takes away, found again by rays of that length from each point. Where a ray meets a
// surface, light is reflected that the surface has from emitters, lamps and virtual lights; that may be more than
// what the picture shows, so all are named here once more.
// Source: Kollig and Keller, Illumination in the Presence of Weak Singularities, MCQMC 2004.
typedef struct vplCompensationDef {
    int rayCount;  // per point, [1, VPL_MAX_NEAR_RAYS]
    int hitLights; // virtual lights that light a hit, chosen by chance, [1, VPL_MAX_LIGHTS]: enough that
                   // each stands for a disc of radius minDistance, or less; fewer are as right and noisier
    uint32_t firstRay; // index of a point's first ray in its sequence: renders in several passes go on
    uint64_t seed;
    const vplEmitterDef* emitters; // as in vplShadeDef
    const vplShadow* shadows;
    int emitterCount;
    const vplShadeLight* areaLights;
    int areaLightCount;
    float areaLightMinDistance;
    const vplShadeLight* lights;
    int lightCount;
    bool lightRays;   // they cast shadows: by rays, also where the picture's come from maps
    float reflection; // multiplies reflectances: 1; for lights that lost light as documented 1/pi
    // The first lights of the list lie on surfaces that emit and stand for their emission. Within emitterLightDistance,
    // metres, (0, minDistance], rays find that emission; beyond it these lights themselves do.
    int emitterLightCount;
    float emitterLightDistance;
    bool seesEmission;   // also by the first ray: the picture shows these lights
    bool seesReflection; // the picture shows lights of reflected light
} vplCompensationDef;

typedef struct vplShadeDef {
    vplLighting lighting;
    vplAccumulation accumulation;
    vplShadeOutput output;
    int batch;                     // lights per pass, >= 1; batched only
    int interleave;                // K, [1, VPL_MAX_INTERLEAVE]; interleaved only; 1 is deferred
    float minDistance;             // metres, >= 0; 0 is unbounded; physical only
    const vplEmitterDef* emitters; // emitters that light directly; documented: point emitters only
    const vplShadow* shadows;   // one per emitter; where its map is NULL, and for directional emitters, rays
    int emitterCount;           // 0: no direct light
    const vplShadeLight* areaLights; // direct light of area emitters, always with shadow rays; physical only
    int areaLightCount;
    float areaLightMinDistance;          // as minDistance
    int particleCount;              // N, by which documented direct light is divided (0 counts as 1)
    const vplShadeLight* lights;    // virtual lights
    int lightCount;                 // 0: no indirect light
    const vplHemiMap* lightShadows; // one per virtual light; NULL: they cast none, or by rays
    bool lightRays;                 // virtual lights cast shadows by rays
    // Instead of these: lights that share what their clusters see. Lights of one cluster are summed and then
    // multiplied by its visibility, which is looked up where they give anything: in groups of VPL_LIGHT_GROUP lights,
    // and wherever the list changes cluster, so lights of one cluster should follow each other. Interleaved: with 8
    // clusters that have lights, and more, and an even K, each class has lights of every other cluster. Deferred and
    // interleaved only, without compensation.
    // One per virtual light: index in clusterShadows, -1: it casts none; NULL (default): no clusters.
    const int* lightClusters;
    const vplParaboloidMap* clusterShadows;
    int clusterCount;
    // One per emitter: its shadow is taken from what it lights first; NULL, also of an entry: as above.
    const vplReflectiveMap* const* emitterMaps;
    float cutError;                         // lightcuts: see vplRenderOptions
    bool emission;                          // surfaces that emit are seen to
    const vplCompensationDef* compensation; // physical only; NULL: what minDistance takes away is lost
} vplShadeDef;

typedef struct vplShadeStats {
    vplRasterStats raster;
    int64_t shadowRays;
    int64_t lightEvaluations; // lightcuts: pairs of a pixel and a virtual light that were evaluated
    int64_t cutPixels;        // lightcuts: pixels that show something
    int largestCut;           // lightcuts: most virtual lights evaluated for one pixel
} vplShadeStats;

// Draws the geometry into `image`, which has the view's size.
vplResult vplShadeView(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                       vplProgressFcn* progress, void* user, vplImage* image, vplShadeStats* statsOut);

// Points on the geometry, each with the side that it is lit from.
typedef struct vplSurfacePoint {
    vplVec3 position; // metres; on the triangle
    vplVec3 normal;   // unit, of the side that receives
    int triangle;     // index in the geometry
} vplSurfacePoint;

// What arrives at points from the def's emitters, lamps and virtual lights, W/m^2, with the shadows that it asks for,
// one way for all points; of pipelines, outputs, clusters and compensation nothing is used. Rays are added to *raysOut, which may be NULL.
vplResult vplShadePoints(const vplGeometry* geometry, const vplShadeDef* def, const vplSurfacePoint* points,
                         int count, vplRgb* irradianceOut, int64_t* raysOut);

// The distance D, metres, for which the mean of max(0, 1 - d^2 / D^2) over what surfaces in view see at distances d
// (2048 cosine-distributed rays) is `share`, (0, 1): the bound D then takes about that share of the light of virtual
// lights. The geometry's diagonal where there is no such D.
vplResult vplFindNearDistance(const vplGeometry* geometry, const vplView* view, double share,
                              float* distanceOut);

// What the bound takes away, and all light of virtual lights with it: sums over some points that the view shows, so
// that their ratio is the share that is lost.
typedef struct vplClampLoss {
    double lost,
        all; // mean over the channels of the light reflected to the eye, in units that the number of points
             // and their choice decide
} vplClampLoss;

// Estimates the loss from `pointCount` pixels, evenly spread. def->compensation says how rays are cast, whether the
// picture was compensated or not.
vplResult vplEstimateClampLoss(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                               int pointCount, vplClampLoss* lossOut);

#ifdef __cplusplus
}
#endif

#endif
