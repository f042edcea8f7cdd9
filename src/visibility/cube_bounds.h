// SPDX-License-Identifier: MIT
// Bounds of what square regions of a cube map show, so that one test often replaces all samples of 16 points.
// Based on: the depth pyramid of Ned Greene, Michael Kass and Gavin Miller, Hierarchical Z-Buffer Visibility,
// SIGGRAPH 1993. Departs: a region has the bounding box of its surface points besides its nearest and
// farthest distance. A floor seen at a slant spans more distance within a region than any bias, but its box
// is as flat as the floor, so that the test against the receiver's plane finds that the floor does not shadow
// itself.
#ifndef VPL_VISIBILITY_CUBE_BOUNDS_H
#define VPL_VISIBILITY_CUBE_BOUNDS_H

#include <vpl/visibility.h>

#include "math/scalar.h"

// A texel shows the surface point D d: D is its stored distance times far, d the unit direction of its
// centre, and the axes are the face's right, up and forward.
enum {
    VPL_LEAST_POINT,                            // smallest x, y, z of the region's points, rounded down
    VPL_LEAST_NEGATED = VPL_LEAST_POINT + 3,    // smallest -x, -y, -z, rounded down
    VPL_LEAST_DISTANCE = VPL_LEAST_NEGATED + 3, // smallest stored distance
    VPL_LEAST_NEGATED_DISTANCE,                 // smallest negated stored distance
    VPL_REGION_VALUES
};

// Only minima, so that eight of them are merged by one vector operation. Texels that show nothing have no
// point.
typedef struct vplCubeRegion {
    float least[VPL_REGION_VALUES];
} vplCubeRegion;

// Texels along the side of a region of level 0, one vector, and its binary logarithm.
enum { VPL_REGION_SHIFT = 4, VPL_REGION_SIDE = 1 << VPL_REGION_SHIFT, VPL_REGION_LEVELS = 10 };

// A region of level k is 2^k regions of level 0 wide. Region (i, j) of a face lies at
// first[k] + (face * side[k] + j) * side[k] + i.
typedef struct vplCubeBounds {
    int levelCount;
    int side[VPL_REGION_LEVELS]; // regions along a face
    int first[VPL_REGION_LEVELS];
    vplCubeRegion regions[];
} vplCubeBounds;

// The least of 16, by halves: a chain would wait for each step.
static inline float vplLeastLane(const float* restrict values)
{
    float a[8], b[4];
    for (int l = 0; l < 8; l++) {
        a[l] = vplMinf(values[l], values[l + 8]);
    }
    for (int l = 0; l < 4; l++) {
        b[l] = vplMinf(a[l], a[l + 4]);
    }
    return vplMinf(vplMinf(b[0], b[2]), vplMinf(b[1], b[3]));
}

#endif
