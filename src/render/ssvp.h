// SPDX-License-Identifier: MIT
// What SSVP makes before it shades, stage by stage.
#ifndef VPL_RENDER_SSVP_H
#define VPL_RENDER_SSVP_H

#include "render/ingredients.h"

// What all of it depends on besides the scene: where two are equal byte for byte, so is the rest.
typedef struct vplSsvpKey {
    int clusters, firstBounce, oversampling, secondBounce, paraboloidSize, rsmSize, maxBounces;
    int hemispheres, clusterMetric, clusterPlace, secondWeight, lightShadows;
    bool shown; // clusters and their maps are looked at, for which these must know surfaces
    double w1, w2;
    uint64_t shift;
} vplSsvpKey;

// One bounce: lights, and the clusters that see for them.
typedef struct vplSsvpBounce {
    vplLightSet* lights;
    vplLightClusters* clusters;
    vplParaboloidMaps* maps; // one per cluster; NULL where nobody looks
    int* lookers; // of each cluster: `particle` of the light that it looks from, -1: of none; NULL as maps
} vplSsvpBounce;

// All lights and what sees for them.
typedef struct vplSsvpLights {
    vplSsvpKey key;
    vplSsvpBounce bounce[2];
    float*
        use; // of each sample of the reflective maps: of what use its light was taken to be; NULL: not asked
    int sampleCount;
    vplLightSet* set; // both bounces, in their order
    int* clusterOf;   // of each light: index in `shadows`
    vplParaboloidMap* shadows;
    int shadowCount; // 0 where lights do not see by clusters
    vplContext* context;
} vplSsvpLights;

typedef struct vplSsvpState {
    vplEmitterDef* emitters; // that the maps were drawn for
    int emitterCount, rsmSize;
    bool drawn;              // the maps, unless nobody looked
    vplReflectiveMap** maps; // one per emitter; NULL where it has no power or nobody looked
    vplSsvpLights* lights;   // NULL before vplSsvp_MakeLights
    vplContext* context;
} vplSsvpState;

// One making of lights.
typedef struct vplSsvpMaking {
    vplJob* job;
    const vplSsvpState* state;
    vplSsvpLights* lights;
    const vplSsvpLights* last; // of the frame before, of the same samples; NULL: there are none
    bool sees;                 // lights see by clusters
    bool twice;                // there is a second bounce
} vplSsvpMaking;

// The stages, of bounce k (0 or 1) where they are of one.
vplResult vplSsvp_SampleFirstBounce(vplSsvpMaking* making);
vplResult vplSsvp_SampleSecondBounce(vplSsvpMaking* making);
vplResult vplSsvp_MeasureUse(vplSsvpMaking* making, const vplLightSet* set, float** useOut); // of each light
vplResult vplSsvp_Cluster(vplSsvpMaking* making, int k);
vplResult vplSsvp_DrawMaps(vplSsvpMaking* making, bool triangles,
                           int k); // triangles where surfaces are asked for

// Reflective maps of all emitters, unless those of the last frame do. Once per job.
vplResult vplSsvp_Begin(vplJob* job, vplSsvpState** stateOut);

// The lights of both bounces and what their clusters see, unless they are there.
vplResult vplSsvp_MakeLights(vplJob* job, vplSsvpState* state);

// The lights alone, for who destroys them.
vplResult vplSsvp_TakeLights(vplJob* job, vplLightSet** setOut);

// NULL is allowed.
void vplSsvpLights_Destroy(vplSsvpLights* lights);

// What lights depend on besides the scene.
vplSsvpKey vplSsvp_FindKey(const vplJob* job);

// NULL is allowed.
void vplSsvp_Destroy(vplSsvpState* state);

// Gives the state to the next frame, or destroys it.
void vplSsvp_End(vplJob* job, vplSsvpState* state);

// The stages for eyes: a map as job->image.
vplResult vplSsvp_ShowMap(vplJob* job, const vplSsvpState* state);

// The same: squares on job->image, red for first-bounce lights, green for clusters, blue for second-bounce lights.
vplResult vplSsvp_ShowLights(vplJob* job, const vplSsvpState* state);

#endif
