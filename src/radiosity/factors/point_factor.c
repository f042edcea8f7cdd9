// SPDX-License-Identifier: MIT
// The form factor from a point to a triangle in closed form: the triangle is clipped at the point's plane,
// and the rest is a sum over edges.
// Based on: Lambert, Photometria, 1760; Hottel and Sarofim, Radiative Transfer, 1967, chapter 2; Baum,
// Rushmeier and Winget, Improving Radiosity Solutions through the Use of Analytically Determined
// Form-Factors, SIGGRAPH 1989. Departs: far away, where that sum cancels, the form factor is integrated over
// the area.
#include "radiosity/factors/analytic.h"

#include "math/scalar.h"

#include <vpl/radiosity.h>

#include <string.h>

// Triangles whose middle is this many times as far as they are wide are integrated over their area. At this
// distance both methods err by about 1e-14: cancellation along the edges grows with d / size, the error of
// six by six points falls as (d / size)^-14.
static const double FAR = 5;

// The difference of two points: exact in double, or rounded once.
static void findWay(vplVec3 from, vplVec3 to, double way[3])
{
    way[0] = (double)to.x - (double)from.x;
    way[1] = (double)to.y - (double)from.y;
    way[2] = (double)to.z - (double)from.z;
}

static void loadTriangle(const vplVec3 triangle[3], vplVec3 origin, vplPolygon* polygon)
{
    polygon->count = 3;
    for (int i = 0; i < 3; i++) {
        findWay(origin, triangle[i], polygon->p[i]);
    }
}

// The height of the point above the front of a triangle whose first corner is the origin; 0 if it is behind,
// or if rounding in double could make it seem in front. Source of the bound: Shewchuk, Adaptive Precision
// Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997 (the orientation of four points, in
// eight roundings).
static double heightOver(const vplPolygon* triangle, const double point[3])
{
    const double *u = triangle->p[1], *v = triangle->p[2];
    double volume = 0, bound = 0, square = 0;
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double n = u[i] * v[j] - u[j] * v[i];
        volume += n * point[k];
        bound += (fabs(u[i] * v[j]) + fabs(u[j] * v[i])) * fabs(point[k]);
        square += n * n;
    }
    return volume > 0x1p-50 * bound ? volume / sqrt(square) : 0;
}

static bool isFar(const vplPolygon* polygon, const double point[3])
{
    double middle[3], way[3];
    const double extent = vplPolygonExtent(polygon, middle);
    vplSub3(middle, point, way);
    return vplDot3(way, way) > FAR * FAR * extent * extent;
}

// The irradiance at the origin from a polygon of radiance 1, times the length of the normal.
static double alongEdges(const vplPolygon* polygon, const double normal[3])
{
    double sum = 0;
    for (int i = 0; i < polygon->count; i++) {
        const double *a = polygon->p[i], *b = polygon->p[i + 1 < polygon->count ? i + 1 : 0];
        double edge[3], across[3];
        vplSub3(a, b, edge);
        // b x a, without the cancellation where the corners are near each other or one is near the origin.
        vplCross3(vplDot3(a, a) < vplDot3(b, b) ? a : b, edge, across);
        const double length = sqrt(vplDot3(across, across));
        sum += length > 0 ? vplAtan2(length, vplDot3(a, b)) * (vplDot3(across, normal) / length) : 0;
    }
    return 0.5 * sum;
}

// The same at `point`, by quadrature.
static double overArea(const vplPolygon* polygon, const double point[3], const double normal[3],
                       double height)
{
    vplAreaPoints points;
    vplFindAreaPoints(polygon, &points);
    double sum = 0;
    for (int i = 0; i < points.count; i++) {
        double way[3];
        vplSub3(points.p[i], point, way);
        const double square = vplDot3(way, way);
        sum += points.weight[i] * (vplDot3(way, normal) / square) * (height / square);
    }
    return sum;
}

double vplPointFormFactor(vplVec3 point, vplVec3 normal, const vplVec3 triangle[3])
{
    if (triangle == NULL) {
        return 0;
    }
    // The origin is a corner of a far triangle, whose shape would be lost to rounding otherwise, and the
    // point for a near one.
    vplPolygon polygon;
    double from[3];
    loadTriangle(triangle, triangle[0], &polygon);
    findWay(triangle[0], point, from);
    const double height = heightOver(&polygon, from);
    if (!(height > 0)) {
        return 0;
    }
    bool far = isFar(&polygon, from);
    if (!far) {
        loadTriangle(triangle, point, &polygon);
        memset(from, 0, sizeof from);
    }
    vplHalfSpace ahead = {.n = {(double)normal.x, (double)normal.y, (double)normal.z}};
    ahead.offset = vplDot3(ahead.n, from);
    if (!vplPolygon_Clip(&polygon, &ahead, 0)) {
        return 0;
    }
    far = far || isFar(&polygon, from);
    const double irradiance = far ? overArea(&polygon, from, ahead.n, height) : alongEdges(&polygon, ahead.n);
    // A float normal is unit to 1e-7 only.
    const double f = irradiance / (VPL_PI * sqrt(vplDot3(ahead.n, ahead.n)));
    return f > 0 ? (f < 1 ? f : 1) : 0;
}
