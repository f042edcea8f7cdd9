// SPDX-License-Identifier: MIT
// Reflective shadow maps from the inside.
#ifndef VPL_LIGHTS_RSM_H
#define VPL_LIGHTS_RSM_H

#include <vpl/lights.h>

typedef void vplReflectiveFactorFcn(const vplReflectiveMap* map, const vplSurface* surface,
                                    float factor[restrict VPL_LANES]);

// What is nearer to the emitter than a point and its plane by less than half a texel's side does not shadow it: walls
// that meet in a corner. Pixels dark in the map only + by the ray only, in % of those that face the emitter, for 0, 1/2,
// 1, 3/2, 2 sides (1024 texels): Sponza's sun 0.68 + 0.46, 0.36 + 0.53, 0.32 + 0.59, 0.30 + 0.66, 0.28 + 0.71; Sibenik's
// spot 0.41 + 0.18, 0.24 + 0.19, 0.21 + 0.19, 0.19 + 0.20, 0.17 + 0.28; the room 0.091 + 0.004, 0.007 + 0.004, the same,
// the same, 0.005 + 0.004. Against the plane alone, not the nearer of it and the point, Sponza has 1.43 + 0.38,
// 0.56 + 0.46, 0.44 + 0.53 for 0, 1/2, 1.
#define VPL_REFLECTIVE_TOLERANCE 0.5f

#endif
