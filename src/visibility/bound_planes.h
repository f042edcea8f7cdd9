// SPDX-License-Identifier: MIT
// Choosing the planes that bound an area of a cube map.
#ifndef VPL_VISIBILITY_BOUND_PLANES_H
#define VPL_VISIBILITY_BOUND_PLANES_H

#include "visibility/cube_bounds.h"

#include <math.h>

// Not fmax and fmin, which are calls.
static inline double vplLarger(double a, double b)
{
    return a > b ? a : b;
}

static inline double vplSmaller(double a, double b)
{
    return a < b ? a : b;
}

// Planes that differ by no more are one: rounding.
#define VPL_SAME_PLANE 0x1p-18

// A square of texels: the tangents of its outermost centres, and of the centres of its quarters.
typedef struct vplTexelArea {
    double s[2], u[2], middleS[2], middleU[2];
} vplTexelArea;

vplTexelArea vplFindArea(int size, int column, int row, int step);

// How far `plane` is above `base` at most within an area: the difference is a linear function, so a corner decides.
static inline double vplMostAbove(const vplTexelArea* area, const float plane[3], const float base[3])
{
    const double s = (double)plane[0] - (double)base[0], u = (double)plane[1] - (double)base[1];
    return (double)plane[2] - (double)base[2] + vplLarger(s * area->s[0], s * area->s[1]) +
           vplLarger(u * area->u[0], u * area->u[1]);
}

// Everything lies behind a plane in the light itself.
static inline vplCubeBound vplEmptyBound(void)
{
    return (vplCubeBound){{{0, 0, INFINITY}, {0, 0, INFINITY}}, 0, VPL_BOUND_ONE};
}

// Planes that may bound an area, all different.
typedef struct vplCandidates {
    float planes[VPL_BOUND_CANDIDATES][3];
    int count;
} vplCandidates;

// Adds a plane unless it is there already or there is no room.
void vplAddCandidate(const vplTexelArea* area, const float plane[3], vplCandidates* c);

// Rounded up.
void vplRaisePlane(const float plane[3], double raise, float raisedOut[3]);

// Improves `bound` by the best plane or pair of planes.
void vplChoosePlanes(const vplTexelArea* area, const vplCandidates* c, const vplRaises* raises,
                     vplCubeBound* bound);

#endif
