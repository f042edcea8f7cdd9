// SPDX-License-Identifier: MIT
// Based on: Emanuele Franchi and Lorenzo Ferrante, Virtual Point Lights: simulate particles, render the cube
// shadow map of the point light, render the scene lit by it with shadows, then add every virtual light,
// without shadows.
// Departs: placement by the camera's view or by reflective shadow maps, batches and shadows of virtual
// lights, which the document proposes, are options.
#include "render/stage.h"

const vplStageId VPL_INSTANT_RADIOSITY_RECIPE[] = {
    VPL_STAGE_GEOMETRY,     VPL_STAGE_NEAR_DISTANCE, VPL_STAGE_REFLECTIVE_MAPS, VPL_STAGE_PARTICLES,
    VPL_STAGE_EMITTER_MAPS, VPL_STAGE_EMITTER_TREES, VPL_STAGE_AREA_LIGHTS,     VPL_STAGE_VIRTUAL_LIGHTS,
    VPL_STAGE_GBUFFER,      VPL_STAGE_PICTURE,       VPL_STAGE_COUNT,
};
