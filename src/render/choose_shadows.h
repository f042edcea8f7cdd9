// SPDX-License-Identifier: MIT
// Whether virtual lights cast shadows by maps or by rays: what each will cost, from measurements.
#ifndef VPL_RENDER_CHOOSE_SHADOWS_H
#define VPL_RENDER_CHOOSE_SHADOWS_H

#include "render/ingredients.h"

// What the costs depend on.
typedef struct vplShadowLoad {
    double lights;
    double pixels;         // that ask about each light
    double facing;         // share of pixels and lights that face each other, [0, 1]
    double trianglesAbove; // a light's plane: what its map draws; mean
    double triangles;      // of the scene
    double mapSize;        // texels along a side
} vplShadowLoad;

// Milliseconds of one core, about.
typedef struct vplShadowCosts {
    double mapMs, rayMs;
} vplShadowCosts;

// Grows with lights, pixels and facing; maps also with trianglesAbove and mapSize, rays with triangles.
vplShadowCosts vplEstimateShadows(const vplShadowLoad* load);

// Looks at a few pixels and lights. The answer depends on scene and options alone, not on the machine: else pictures
// would.
vplShadowLoad vplMeasureShadowLoad(const vplGeometry* geometry, const vplView* view, double pixels,
                                   const vplShadeLight* lights, int lightCount, int mapSize);

// VPL_LIGHT_SHADOWS_MAP or RAY, whichever is cheaper, for the lights of `in`; says so in the log.
vplLightShadows vplChooseLightShadows(vplJob* job, const vplIngredients* in);

#endif
