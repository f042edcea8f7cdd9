// SPDX-License-Identifier: MIT
// Light that comes straight from emitters and area lights.
#include "render/stage.h"

const vplStageId VPL_DIRECT_RECIPE[] = {VPL_STAGE_GEOMETRY,      VPL_STAGE_EMITTER_MAPS,
                                        VPL_STAGE_EMITTER_TREES, VPL_STAGE_AREA_LIGHTS,
                                        VPL_STAGE_PICTURE,       VPL_STAGE_COUNT};
