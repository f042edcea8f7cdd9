// SPDX-License-Identifier: MIT
// What a picture with virtual lights is made of. Everything is made only where the options ask for it.
#ifndef VPL_RENDER_INGREDIENTS_H
#define VPL_RENDER_INGREDIENTS_H

#include "render/render.h"

// Shadow maps from some points.
typedef struct vplMaps {
    vplCubeMap** maps; // NULL where a point needs none
    vplShadow* shadows;
    int count;
} vplMaps;

typedef struct vplIngredients {
    const vplEmitterDef* emitters;
    int emitterCount;
    vplMaps emitterMaps;
    vplShadeLight* areaLights;
    int areaLightCount;
    float areaLightMinDistance;
    // of one pass
    vplLightSet* set;
    vplShadeLight* lights;
    int lightCount;
    int emitterLightCount; // the first lights, if they lie on lamps
    int firstShown; // Keller's --show indirect: lights before this one light only what compensation meets
    float minDistance;
    vplLightShadows lightShadows;        // none, map or ray
    vplHemiMaps* lightMaps;              // NULL where there are none; room for a batch of the lights
    struct vplSsvpState* ssvp;           // NULL but for SSVP; then it owns `set`
    struct vplRadiosityState* radiosity; // NULL but for radiosity
    int* lightClusters; // of each of `lights`, which are in the order of clusters; NULL: without clusters
} vplIngredients;

// Shadow maps of emitters and lights that stand for lamps: what direct light needs.
vplResult vplMakeDirectLight(vplJob* job, vplIngredients* in);

// Virtual lights of pass job->stepsDone, without their shadows. Those of the last pass are gone.
vplResult vplMakeVirtualLights(vplJob* job, vplIngredients* in);

// How many of the virtual lights have maps at the same time: all, if there is room. At least 1.
int vplLightBatch(const vplJob* job, const vplIngredients* in);

// Maps of virtual lights first .. first + count - 1, at most a batch.
vplResult vplMakeLightShadows(vplJob* job, vplIngredients* in, int first, int count);

// Lights of step 0 that lie on surfaces: Keller's, which stand for their emission.
int vplCountEmitterLights(const vplLightSet* set);

// Whether light that the bound takes away is found by rays.
bool vplCompensates(const vplJob* job);

// Finds job->nearDistance, once, where the automatic bound of compensated lights wants it.
vplResult vplJob_FindNear(vplJob* job);

// How, for lights and shadows that are there.
vplCompensationDef vplMakeCompensation(const vplJob* job, const vplIngredients* in);

// Adds a pass to the loss by the bound that statistics tell.
vplResult vplEstimateLoss(vplJob* job, const vplIngredients* in, const vplShadeDef* shown);

void vplFreeVirtualLights(vplJob* job, vplIngredients* in);
void vplFreeIngredients(vplJob* job, vplIngredients* in);

#endif
