// SPDX-License-Identifier: MIT
// A guide knows where the light of a surface comes from. Paths from the camera choose directions by it.
// Based on: Eric P. Lafortune and Yves D. Willems, A 5D Tree to Reduce the Variance of Monte Carlo Ray Tracing, Rendering Techniques 1995:
// directions are chosen by an approximation of the light that arrives, or by the reflection, and weighted by the density of both.
#ifndef VPL_REFERENCE_PATH_GUIDE_H
#define VPL_REFERENCE_PATH_GUIDE_H

#include <vpl/geometry.h>

// A point that sends light.
typedef struct vplGuidePoint {
    int place, triangle;
    vplVec3 position;
} vplGuidePoint;

// Surfaces are divided into places, for example patches, which send light to each other. The mean of paths is the same with any guide; a good one
// reduces their variance. Light that no place sends, as that of the sky, is found by reflections.
typedef struct vplPathGuide {
    // The place of a point that a ray in `direction` has hit; negative: of none.
    int (*find)(const void* data, const vplHit* hit, vplVec3 direction);
    // True if light is known to come to the place from others.
    bool (*knows)(const void* data, int place);
    // Chooses a point that sends light to the place by three random numbers in [0, 1). `knows` must be true for the place.
    vplGuidePoint (*choose)(const void* data, int place, const float u[3]);
    // The density, per square metre, with which it chooses any point of `sender`.
    double (*density)(const void* data, int place, int sender);
    const void* data;
} vplPathGuide;

// The probability with which a path goes where the guide says. With 0.4, 0.6 and 0.8 variance times time is 0.45, 0.44 and 0.48 of that without
// a guide in corridor, 0.67, 0.65 and 3.3 in hall, 0.73, 1.1 and 1.9 in flat, 0.79, 0.75 and 1.1 in shade (bench/guide).
#define VPL_GUIDED_SHARE 0.5

#endif
