// SPDX-License-Identifier: MIT
// Results of stages whose types are not public.
#ifndef VPL_RENDER_STAGES_RESULTS_H
#define VPL_RENDER_STAGES_RESULTS_H

#include <vpl/radiosity.h>

#include "render/stage.h"

// VPL_STAGE_NEAR_DISTANCE has a float: the metres within which surfaces see a fifth of what they see.
// VPL_STAGE_LIGHT_PATHS has a double: the share of reflected light that vplMeasureFurther measures.
// VPL_STAGE_VERTEX_LIGHT has an array of vplRgb: the irradiance of reflected light, for a final gather of all
// light but that of emitters, at the vertices of the patch mesh, [vertex][front, back].
enum { VPL_VERTEX_RAYS = 64 }; // of the gather, from each of these vertices

// VPL_STAGE_EMITTER_MAPS: one entry per emitter.
typedef struct vplEmitterMaps {
    vplCubeMap** maps;  // NULL: the emitter's shadows come by rays
    vplShadow* shadows; // of the maps
    int count;
} vplEmitterMaps;

// VPL_STAGE_AREA_LIGHTS: points that stand for all area lights in direct light, then for the environment.
typedef struct vplAreaLights {
    vplShadeLight* lights;
    int count;
    int skyCount;      // the last of them
    float minDistance; // metres
} vplAreaLights;

// The samples that light hits of rays: all of the stage's, or only those of the environment if a tree chooses triangles for hits.
static inline vplAreaLights vplAreaLightsOfHits(const vplRun* run)
{
    const vplAreaLights* area = run->results[VPL_STAGE_AREA_LIGHTS];
    if (area == NULL) {
        return (vplAreaLights){.count = 0};
    }
    const int left = run->plan->trianglesPerPoint > 0 ? area->count - area->skyCount : 0;
    vplShadeLight* first = left > 0 ? area->lights + left : area->lights; // NULL where there are none
    return (vplAreaLights){first, area->count - left, area->skyCount, area->minDistance};
}

// VPL_STAGE_REFLECTIVE_MAPS: one per emitter.
typedef struct vplReflectiveMaps {
    vplReflectiveMap** maps; // NULL where the emitter has no power
    int count;
} vplReflectiveMaps;

// VPL_STAGE_VIRTUAL_LIGHTS: the lights that the picture adds up.
typedef struct vplVirtualLights {
    const vplLightSet* set; // that they were made from
    vplShadeLight* lights;
    int* clusters; // of each light, in the order of clusters; NULL: lights do not see by clusters
    int count;
    int first;             // lights before this one only light the hits of compensation's rays
    int emitterLightCount; // the first lights, if they lie on area lights
    float minDistance;     // clamp, metres
} vplVirtualLights;

// VPL_STAGE_FIRST_BOUNCE and VPL_STAGE_SECOND_BOUNCE.
typedef struct vplBounceLights {
    vplLightSet* lights;
    vplLightSet* all; // that they were chosen from; NULL: no choice
    uint64_t shift;   // of the sample pattern
    float* use; // of each sample of the reflective maps: the share of its light that stays; NULL: not asked
    int sampleCount; // of them
} vplBounceLights;

// VPL_STAGE_CLUSTERS and VPL_STAGE_SECOND_CLUSTERS.
typedef struct vplBounceClusters {
    vplLightClusters* clusters;
    vplLightClusters* whole; // before splitting, from which the next frame starts; NULL: none was to be split
    vplClusterAgreement agreement;
    uint64_t shift; // of the sample pattern
} vplBounceClusters;

// VPL_STAGE_PARABOLOIDS and VPL_STAGE_SECOND_PARABOLOIDS.
typedef struct vplBounceMaps {
    vplParaboloidMaps* maps; // one per cluster
    int* viewpoints;         // of each cluster: `particle` of the light that it sees from; -1: of none
    int count;
    uint64_t shift;
} vplBounceMaps;

// One bounce: the results of its stages.
typedef struct vplBounceParts {
    const vplBounceLights* lights;
    const vplBounceClusters* clusters; // NULL: not needed
    const vplBounceMaps* maps;         // NULL: not needed
} vplBounceParts;

// VPL_STAGE_FURTHER_BOUNCES: the third bounce, and those after it.
typedef struct vplFurtherBounces {
    vplBounceParts* bounces;
    int count;
} vplFurtherBounces;

// VPL_STAGE_CLUSTERED_LIGHTS: the lights of all bounces as one list.
typedef struct vplClusteredLights {
    vplLightSet* set;
    int* clusterOf;            // of each light: index in `shadows`
    vplParaboloidMap* shadows; // maps of all bounces
    int shadowCount;           // 0 where lights do not see by clusters
} vplClusteredLights;

// VPL_STAGE_FORM_FACTORS: of all pairs, or links.
typedef struct vplExchangeFactors {
    vplFormFactors* factors;
    vplLinks* links;
} vplExchangeFactors;

// VPL_STAGE_PATCH_LIGHT: light of emitters, one entry per side.
typedef struct vplPatchLight {
    vplRgb* direct; // irradiance, W/m^2
    float* spread;  // its standard deviation over the side
    vplRgb* source; // radiosity: emission and reflected direct light, W/m^2
    vplRgb*
        cells; // irradiance of the VPL_PATCH_CELLS cells of each side, W/m^2; NULL: no rays will meet them
} vplPatchLight;

// VPL_STAGE_SOLUTION: one entry per side, W/m^2.
typedef struct vplSolution {
    vplRgb* radiosity;  // all light
    vplRgb* irradiance; // of light that was reflected at least once
    vplSolveStats stats;
    uint32_t factorBuild; // identifies the form factors that it was solved with
} vplSolution;

// ---- what stages share

// The number of floats in a picture.
static inline size_t vplValueCount(const vplImage* image)
{
    return 3 * (size_t)image->width * (size_t)image->height;
}

static inline vplTransport vplTransportOf(const vplRun* run)
{
    const vplExchangeFactors* f = run->results[VPL_STAGE_FORM_FACTORS];
    return (vplTransport){run->results[VPL_STAGE_SIDES], f->factors, f->links};
}

// The clamp distance of a pass with so many lights, metres.
float vplClampDistance(const vplRun* run, double lights);

// Describes the short rays that find the light that the clamp takes away. `shadows` are those of the
// emitters.
vplCompensationDef vplMakeCompensation(const vplRun* run, const vplVirtualLights* lights,
                                       const vplShadow* shadows);

// Measures the light that the clamp takes away in this pass, and adds it to the statistics.
vplResult vplEstimateLoss(const vplRun* run, const vplVirtualLights* lights, const vplShadeDef* shown,
                          vplCompensationDef compensation);

// Returns VPL_LIGHT_SHADOWS_MAP or RAY, whichever is cheaper; writes the costs into the plan and the reason
// into `why`.
vplLightShadows vplChooseLightShadows(const vplRun* run, const vplVirtualLights* lights, vplPlan* plan,
                                      char* why);

// Describes the rays of the final gather, whose light the solution knows.
vplResult vplDescribeGather(const vplRun* run, vplGatherDef* defOut);

// Draws patches over a picture, as smooth indirect light or as the values that --show asks for.
vplResult vplDrawPatchView(const vplRun* run, const vplView* view, vplImage* image);

// Finds the reflected part of the radiosity of sides: all but their emission.
void vplFindReflected(const vplPatchSides* sides, const vplRgb* radiosity, vplRgb* reflectedOut);

// Gathers the irradiance of reflected light at those vertices of groups that the picture needs: [vertex][front, back].
vplResult vplGatherAtGroups(const vplRun* run, const vplPatchMesh* mesh, vplRgb* corners);

// Finds the irradiance of sides by the light that sides send and by emitters.
vplResult vplReceive(const vplRun* run, const vplRgb* sent, vplRgb* irradianceOut);

// The number of virtual lights that are evaluated where a short ray hits a surface. `area` is that of all surfaces in square metres,
// `distance` the clamp distance in metres, `pixelLights` the number of lights that a pixel evaluates. (compensation_rays.c)
double vplLightsOfHit(double area, double distance, double pixelLights);

// The number of short rays of a pixel that evaluates so many virtual lights.
int vplShortRaysOf(const vplPlan* plan, double lights);

#endif
