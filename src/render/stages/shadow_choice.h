// SPDX-License-Identifier: MIT
// Estimates what shadows of virtual lights cost by maps and by rays, to choose between them.
#ifndef VPL_RENDER_STAGES_SHADOW_CHOICE_H
#define VPL_RENDER_STAGES_SHADOW_CHOICE_H

#include <vpl/shading.h>

// The numbers that the costs depend on.
typedef struct vplShadowLoad {
    double lights;
    double pixels;         // that ask about each light
    double facing;         // share of pixels and lights that face each other, [0, 1]
    double trianglesAbove; // a light's plane: what its map draws; mean
    double triangles;      // of the scene
    double mapSize;        // texels along a side
} vplShadowLoad;

// Estimates in milliseconds of one core.
typedef struct vplShadowCosts {
    double mapMs, rayMs;
} vplShadowCosts;

// Both costs grow with lights, pixels and facing; that of maps also with trianglesAbove and mapSize, that of
// rays with triangles.
vplShadowCosts vplEstimateShadows(const vplShadowLoad* load);

// Samples a few pixels and lights. The answer depends on scene and options only, not on the machine, since
// pictures must not depend on the machine.
vplShadowLoad vplMeasureShadowLoad(const vplGeometry* geometry, const vplView* view, double pixels,
                                   const vplShadeLight* lights, int lightCount, int mapSize);

#endif
