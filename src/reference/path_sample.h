// SPDX-License-Identifier: MIT
#ifndef VPL_REFERENCE_PATH_SAMPLE_H
#define VPL_REFERENCE_PATH_SAMPLE_H

#include "reference/path_scene.h"

// Follows a path through pixel (x, y) and adds its radiance to *sum.
void vplPath_Follow(vplPathState* path, int x, int y, vplRadiance* sum);

#endif
