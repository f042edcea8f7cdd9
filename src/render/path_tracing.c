// SPDX-License-Identifier: MIT
// The truth that the other methods are judged against: paths from the camera, without bias.
#include "render/stage.h"

const vplStageId VPL_PATH_RECIPE[] = {VPL_STAGE_GEOMETRY, VPL_STAGE_EMITTER_TREES, VPL_STAGE_PATHS,
                                      VPL_STAGE_COUNT};
