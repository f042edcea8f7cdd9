// SPDX-License-Identifier: MIT
// Based on: Dan Hemgren, Radiosity in Realtime Rendering: surfaces are bisected into patches, form factors
// are found between them, what emitters give to each patch is reflected from patch to patch until it changes
// no more, and drawn, smooth from vertex to vertex, over the direct light of every pixel.
// Departs where its discussion asks for more: only sides that light can reach take part, light and form
// factors are means over patches, far patches exchange light in groups, and patches can be small where light
// changes much. Light goes on from frame to frame, as proposed there after Burenius.
#include "render/stage.h"

const vplStageId VPL_RADIOSITY_RECIPE[] = {
    VPL_STAGE_GEOMETRY,     VPL_STAGE_PATCHES,       VPL_STAGE_SIDES,        VPL_STAGE_PATCH_MESH,
    VPL_STAGE_FORM_FACTORS, VPL_STAGE_EMITTER_TREES, VPL_STAGE_AREA_LIGHTS,  VPL_STAGE_PATCH_LIGHT,
    VPL_STAGE_SOLUTION,     VPL_STAGE_VERTEX_LIGHT,  VPL_STAGE_EMITTER_MAPS, VPL_STAGE_PICTURE,
    VPL_STAGE_COUNT,
};
