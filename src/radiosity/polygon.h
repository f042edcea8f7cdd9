// SPDX-License-Identifier: MIT
// A triangle cut at a plane, and points to integrate over it: what form factors of triangles and of points share.
#ifndef VPL_RADIOSITY_POLYGON_H
#define VPL_RADIOSITY_POLYGON_H

#include "math/double3.h"

#include <stdbool.h>

// A triangle that was cut once at most.
typedef struct vplPolygon {
    double p[4][3];
    int count;
} vplPolygon;

// What lies in front of a plane: dot(n, p) > offset. n of any length.
typedef struct vplHalfSpace {
    double n[3], offset;
} vplHalfSpace;

// Twice the vector area of three corners: it points to where they are counter-clockwise.
void vplTwiceArea(const double a[3], const double b[3], const double c[3], double out[3]);

// Leaves of three corners what lies in front of the plane. Corners `tolerance` (in the plane's dot(n, p)) and less from
// it are on it. Returns false where what is left has no area.
bool vplCutTriangle(vplPolygon* triangle, const vplHalfSpace* half, double tolerance);

// The longest edge or diagonal, and the middle of the corners.
double vplPolygonExtent(const vplPolygon* polygon, double middle[3]);

enum { VPL_MOST_AREA_POINTS = 2 * 36 };

// Six by six Gauss points for each triangle of a fan.
typedef struct vplAreaPoints {
    double p[VPL_MOST_AREA_POINTS][3], weight[VPL_MOST_AREA_POINTS]; // of area
    int count;
} vplAreaPoints;

void vplFindAreaPoints(const vplPolygon* polygon, vplAreaPoints* points);

#endif
