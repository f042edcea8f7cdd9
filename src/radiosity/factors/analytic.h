// SPDX-License-Identifier: MIT
// Unoccluded form factors of triangles and of points: clipping at a plane, the contour integral, and
// quadrature over areas.
#ifndef VPL_RADIOSITY_ANALYTIC_H
#define VPL_RADIOSITY_ANALYTIC_H

#include "math/double3.h"

#include <vpl/vecmath.h>

#include <stdbool.h>

// out = a - b.
static inline void vplSub3(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = a[k] - b[k];
    }
}

// ---- Gauss-Legendre quadrature (edge_integral.c)

// A rule on [-1, 1] with an even number of nodes, of which these are the positive ones.
typedef struct vplGaussRule {
    int pairs;
    double x[5], w[5];
} vplGaussRule;

extern const vplGaussRule vplGauss4, vplGauss6, vplGauss10;

// ---- the contour integral (edge_integral.c)

// The precision of the outer integral. Its edge is bisected until no singularity of the inner integral is
// nearer to the middle of a part than `apart` half lengths of it, in the complex plane, or until the part's
// half length is at most `least` of the edge.
typedef struct vplEdgeRule {
    const vplGaussRule* gauss;
    double apart, least;
} vplEdgeRule;

typedef struct vplEdge {
    double from[3], along[3]; // along: unit vector
    double length;            // > 0
} vplEdge;

// The double integral of ln r along both edges, times the cosine between them. Coordinates are of the order
// of 1; edges may touch, cross and coincide.
double vplEdgeIntegral(const vplEdge* outer, const vplEdge* inner, const vplEdgeRule* rule);

// ---- polygons (polygon.c)

// A triangle, clipped at one plane at most.
typedef struct vplPolygon {
    double p[4][3];
    int count;
} vplPolygon;

// The points with dot(n, p) > offset. n has any length.
typedef struct vplHalfSpace {
    double n[3], offset;
} vplHalfSpace;

// Twice the vector area of three corners; it points to where they are counter-clockwise.
void vplTwiceArea(const double a[3], const double b[3], const double c[3], double out[3]);

// Clips a triangle at a plane. Corners count as on the plane if dot(n, p) differs from the offset by at most
// `tolerance`. Returns false if nothing is left.
bool vplPolygon_Clip(vplPolygon* triangle, const vplHalfSpace* half, double tolerance);

// The longest edge or diagonal. middle: the mean of the corners.
double vplPolygonExtent(const vplPolygon* polygon, double middle[3]);

// Six by six Gauss points for each triangle of a fan.
enum { VPL_MOST_AREA_POINTS = 2 * 36 };

typedef struct vplAreaPoints {
    double p[VPL_MOST_AREA_POINTS][3], weight[VPL_MOST_AREA_POINTS]; // weights sum to the area
    int count;
} vplAreaPoints;

void vplFindAreaPoints(const vplPolygon* polygon, vplAreaPoints* points);

// ---- two triangles (triangle_factor.c)

// The rule of vplTriangleFormFactor, and a faster one for patches, whose shadow rays err more.
extern const vplEdgeRule vplEdgesExact, vplEdgesQuick;

// A_a F_ab = A_b F_ba, m^2, without occluders.
double vplTriangleExchange(const vplVec3 a[3], const vplVec3 b[3], const vplEdgeRule* rule);

#endif
