// SPDX-License-Identifier: MIT
// Whether virtual lights cast shadows by maps or by rays: what each will cost, from measurements.
#ifndef VPL_RENDER_STAGES_SHADOW_CHOICE_H
#define VPL_RENDER_STAGES_SHADOW_CHOICE_H

#include <vpl/shading.h>

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

// Samples a few pixels and lights. The answer depends on scene and options alone, not on the machine: else
// pictures would.
vplShadowLoad vplMeasureShadowLoad(const vplGeometry* geometry, const vplView* view, double pixels,
                                   const vplShadeLight* lights, int lightCount, int mapSize);

#endif
