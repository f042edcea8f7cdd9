// SPDX-License-Identifier: MIT
// The form factor between two triangles: each is clipped at the other's plane, and what is left is integrated
// along the edges of both.
// Based on: Hottel and Sarofim, Radiative Transfer, 1967, chapter 2.
#include "radiosity/factors/analytic.h"

#include <vpl/radiosity.h>

#include <math.h>

// Relative errors of 2e-12 and 4e-4 per part; a part at a singularity errs by least^2 of the edge's integral.
const vplEdgeRule vplEdgesExact = {&vplGauss10, 2, 0x1p-18}, vplEdgesQuick = {&vplGauss4, 1.5, 0x1p-5};

// Triangles are integrated over their areas if they are this many times as far apart as the larger is wide:
// sums along edges cancel there, while six by six points err by 1e-9 (tests/test_form_factors.c).
static const double FAR = 3;

// Planes count as equal if 1 minus the cosine of their angle is below this: an angle of 5e-6. The form factor
// is then below half of this value.
static const double SAME_PLANE = 0x1p-36;

// ---- the pair, moved to its centre and scaled to about 1 against cancellation, overflow and underflow

typedef struct Pair {
    vplPolygon polygon[2];
    vplHalfSpace plane[2]; // the half space in front of each
    double scale;          // metres
    double tolerance;      // scaled: corners this near to a plane are on it
} Pair;

static void loadPair(const vplVec3* const triangle[2], Pair* pair)
{
    double middle[3] = {0}, largest = 0, scale = 0;
    for (int i = 0; i < 6; i++) {
        const vplVec3 v = triangle[i / 3][i % 3];
        const double p[3] = {(double)v.x, (double)v.y, (double)v.z};
        for (int k = 0; k < 3; k++) {
            pair->polygon[i / 3].p[i % 3][k] = p[k];
            middle[k] += p[k] / 6;
            largest = fabs(p[k]) > largest ? fabs(p[k]) : largest;
        }
    }
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < 3; k++) {
            double* p = &pair->polygon[i / 3].p[i % 3][k];
            *p -= middle[k];
            scale = fabs(*p) > scale ? fabs(*p) : scale;
        }
    }
    pair->scale = scale;
    for (int i = 0; i < 6 && scale > 0; i++) {
        for (int k = 0; k < 3; k++) {
            pair->polygon[i / 3].p[i % 3][k] /= scale;
        }
    }
    pair->polygon[0].count = pair->polygon[1].count = 3;
    // Twice the rounding of the largest coordinate, which is a float.
    pair->tolerance = scale > 0 ? largest * 0x1p-23 / scale : 0;
}

// The half space in front of a triangle. False if the triangle has no area.
static bool findPlane(const vplPolygon* t, vplHalfSpace* plane)
{
    double n[3];
    vplTwiceArea(t->p[0], t->p[1], t->p[2], n);
    const double length = sqrt(vplDot3(n, n));
    if (!(length > 0)) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        plane->n[k] = n[k] / length;
    }
    plane->offset = vplDot3(plane->n, t->p[0]);
    return true;
}

// ---- near triangles: along the edges

static int findEdges(const vplPolygon* polygon, vplEdge edges[4])
{
    int count = 0;
    for (int i = 0; i < polygon->count; i++) {
        const double *p = polygon->p[i], *q = polygon->p[i + 1 < polygon->count ? i + 1 : 0];
        double way[3];
        vplSub3(q, p, way);
        const double length = sqrt(vplDot3(way, way));
        if (length > 0) {
            edges[count].length = length;
            for (int k = 0; k < 3; k++) {
                edges[count].from[k] = p[k];
                edges[count].along[k] = way[k] / length;
            }
            count++;
        }
    }
    return count;
}

static double alongEdges(const vplPolygon* small, const vplPolygon* large, const vplEdgeRule* rule)
{
    vplEdge outer[4], inner[4];
    const int outerCount = findEdges(small, outer), innerCount = findEdges(large, inner);
    double sum = 0;
    for (int i = 0; i < outerCount; i++) {
        for (int k = 0; k < innerCount; k++) {
            sum += vplEdgeIntegral(&outer[i], &inner[k], rule);
        }
    }
    return sum / (2 * VPL_PI);
}

// ---- far triangles: over the areas

static double overAreas(const Pair* pair)
{
    vplAreaPoints a, b;
    vplFindAreaPoints(&pair->polygon[0], &a);
    vplFindAreaPoints(&pair->polygon[1], &b);
    double sum = 0;
    for (int i = 0; i < a.count; i++) {
        double part = 0;
        for (int j = 0; j < b.count; j++) {
            double d[3];
            vplSub3(b.p[j], a.p[i], d);
            const double square = vplDot3(d, d), ca = vplDot3(d, pair->plane[0].n),
                         cb = -vplDot3(d, pair->plane[1].n);
            part += ca > 0 && cb > 0 ? b.weight[j] * (ca / square) * (cb / square) : 0;
        }
        sum += a.weight[i] * part;
    }
    return sum / VPL_PI;
}

// ---- either

double vplTriangleExchange(const vplVec3 a[3], const vplVec3 b[3], const vplEdgeRule* rule)
{
    Pair pair;
    loadPair((const vplVec3* const[2]){a, b}, &pair);
    vplPolygon* p = pair.polygon;
    if (!findPlane(&p[0], &pair.plane[0]) || !findPlane(&p[1], &pair.plane[1]) ||
        vplDot3(pair.plane[0].n, pair.plane[1].n) > 1 - SAME_PLANE) {
        return 0;
    }
    if (!vplPolygon_Clip(&p[1], &pair.plane[0], pair.tolerance) ||
        !vplPolygon_Clip(&p[0], &pair.plane[1], pair.tolerance)) {
        return 0;
    }
    double middle[2][3], way[3];
    const double extent[2] = {vplPolygonExtent(&p[0], middle[0]), vplPolygonExtent(&p[1], middle[1])};
    vplSub3(middle[1], middle[0], way);
    const int small = extent[1] < extent[0];
    const bool isFar = sqrt(vplDot3(way, way)) - 2.0 / 3 * (extent[0] + extent[1]) > FAR * extent[1 - small];
    const double exchange = isFar ? overAreas(&pair) : alongEdges(&p[small], &p[1 - small], rule);
    return exchange > 0 ? exchange * pair.scale * pair.scale : 0;
}

double vplTriangleFormFactor(const vplVec3 a[3], const vplVec3 b[3])
{
    if (a == NULL || b == NULL) {
        return 0;
    }
    Pair pair;
    loadPair((const vplVec3* const[2]){a, a}, &pair);
    const double(*p)[3] = pair.polygon[0].p;
    double n[3];
    vplTwiceArea(p[0], p[1], p[2], n);
    const double area = 0.5 * sqrt(vplDot3(n, n)) * pair.scale * pair.scale;
    const double f = area > 0 ? vplTriangleExchange(a, b, &vplEdgesExact) / area : 0;
    return f < 1 ? f : 1;
}
