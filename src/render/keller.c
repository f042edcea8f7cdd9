// SPDX-License-Identifier: MIT
// Based on: Alexander Keller, Instant Radiosity, SIGGRAPH 1997: particles begin as virtual lights on the area
// lights, bounce diffusely and leave a light at each landing; the scene is drawn once per light, with
// shadows, and summed.
// Departs: lights are clamped where they are near, and short rays give back what the clamp takes away (Kollig
// and Keller, Illumination in the Presence of Weak Singularities, MCQMC 2004).
#include "render/stage.h"

const vplStageId VPL_KELLER_RECIPE[] = {
    VPL_STAGE_GEOMETRY,     VPL_STAGE_NEAR_DISTANCE, VPL_STAGE_REFLECTIVE_MAPS, VPL_STAGE_PARTICLES,
    VPL_STAGE_EMITTER_MAPS, VPL_STAGE_EMITTER_TREES, VPL_STAGE_AREA_LIGHTS,     VPL_STAGE_VIRTUAL_LIGHTS,
    VPL_STAGE_GBUFFER,      VPL_STAGE_PICTURE,       VPL_STAGE_COUNT,
};
