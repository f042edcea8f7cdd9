// SPDX-License-Identifier: MIT
#ifndef VPL_LIGHTS_PREPARE_H
#define VPL_LIGHTS_PREPARE_H

#include "math/vec.h"

#include <vpl/lights.h>

// One light of N particles, as vplPrepareLights says.
static inline vplShadeLight vplPrepareLight(const vplVirtualLight* v, int particleCount, vplLighting lighting)
{
    // A virtual light of flux P emits P/pi cos; the 1/pi is taken into the colour once.
    const float scale = lighting == VPL_LIGHTING_PHYSICAL ? (float)(1 / VPL_PI) : 1;
    const vplRgb shown = vplRgbScale(scale * (v->weight / (float)particleCount), v->light);
    return (vplShadeLight){v->position.x, v->position.y, v->position.z, v->normal.x, v->normal.y,
                           v->normal.z,   shown.r,       shown.g,       shown.b};
}

#endif
