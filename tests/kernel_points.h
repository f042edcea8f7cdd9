// SPDX-License-Identifier: MIT
// The light kernel at single points.
#ifndef VPL_TESTS_KERNEL_POINTS_H
#define VPL_TESTS_KERNEL_POINTS_H

#include "test.h"

#include "shading/light_block.h"

vplShadeLight lightAt(vplVec3 position, vplVec3 normal, float colour);

// Returns the red irradiance of lights[0 .. count) at one point, which all lanes must have.
double irradianceAt(const vplContext* context, vplLightFormula formula, vplVec3 position, vplVec3 normal,
                    const vplShadeLight* lights, int count);

#endif
