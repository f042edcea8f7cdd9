// SPDX-License-Identifier: MIT
// The form factor of two triangles: each is cut at the other's plane, the rest is an integral along the edges of both.
// Based on: Hottel and Sarofim, Radiative Transfer, 1967, chapter 2; Sutherland and Hodgman, Reentrant Polygon
// Clipping, CACM 1974.
#include "radiosity/polygon_factor.h"

#include "math/scalar.h"

#include <vpl/radiosity.h>

#include <stdbool.h>
#include <string.h>

// 2e-12 and 4e-4 of a part's integral; the rest of a singular end, least^2 of the edge's.
const vplEdgeRule vplEdgesExact = {&vplGauss10, 2, 0x1p-18}, vplEdgesQuick = {&vplGauss4, 1.5, 0x1p-5};

static const double PI = 3.14159265358979323846;

// Triangles this many times as far from each other as the larger is wide are integrated over their areas: along the
// edges almost all cancels, d/size digits of it, while six by six points leave 1e-9 (tests/test_form_factors.c).
static const double FAR = 3;

// Planes that differ by less than this are one: 1 minus the cosine, at an angle of 5e-6. What would be exchanged is less
// than half of it.
static const double SAME_PLANE = 0x1p-36;

// A triangle that was cut once.
typedef struct Polygon {
    double p[4][3];
    int count;
} Polygon;

typedef struct Plane {
    double n[3], offset;
} Plane;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// ---- moved to the middle of all corners, and scaled to about 1, so that nothing cancels, overflows or underflows

typedef struct Pair {
    Polygon polygon[2];
    Plane plane[2];
    double scale;     // metres
    double tolerance; // scaled: corners this near to a plane are on it
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
    // Coordinates are floats: twice the rounding of the largest.
    pair->tolerance = scale > 0 ? largest * 0x1p-23 / scale : 0;
}

// False where it has no area.
static bool findPlane(const Polygon* t, Plane* plane)
{
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = t->p[1][k] - t->p[0][k];
        v[k] = t->p[2][k] - t->p[0][k];
    }
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double length = sqrt(dot(n, n));
    if (!(length > 0)) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        plane->n[k] = n[k] / length;
    }
    plane->offset = dot(plane->n, t->p[0]);
    return true;
}

// What lies in front of the plane. Returns false where that has no area.
static bool clip(Polygon* polygon, const Plane* plane, double tolerance)
{
    double height[3];
    bool front = false;
    for (int i = 0; i < 3; i++) {
        const double h = dot(plane->n, polygon->p[i]) - plane->offset;
        height[i] = fabs(h) <= tolerance ? 0 : h;
        front = front || height[i] > 0;
    }
    Polygon out = {.count = 0};
    for (int i = 0; i < 3; i++) {
        const int next = i < 2 ? i + 1 : 0;
        if (height[i] >= 0) {
            memcpy(out.p[out.count++], polygon->p[i], sizeof out.p[0]);
        }
        if ((height[i] > 0 && height[next] < 0) || (height[i] < 0 && height[next] > 0)) {
            const double t = height[i] / (height[i] - height[next]);
            for (int k = 0; k < 3; k++) {
                out.p[out.count][k] = polygon->p[i][k] + t * (polygon->p[next][k] - polygon->p[i][k]);
            }
            out.count++;
        }
    }
    *polygon = out;
    return front && out.count >= 3;
}

// ---- near: along the edges

static int findEdges(const Polygon* polygon, vplEdge edges[4])
{
    int count = 0;
    for (int i = 0; i < polygon->count; i++) {
        const double *p = polygon->p[i], *q = polygon->p[i + 1 < polygon->count ? i + 1 : 0];
        double way[3];
        for (int k = 0; k < 3; k++) {
            way[k] = q[k] - p[k];
        }
        const double length = sqrt(dot(way, way));
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

static double alongEdges(const Polygon* small, const Polygon* large, const vplEdgeRule* rule)
{
    vplEdge outer[4], inner[4];
    const int outerCount = findEdges(small, outer), innerCount = findEdges(large, inner);
    double sum = 0;
    for (int i = 0; i < outerCount; i++) {
        for (int k = 0; k < innerCount; k++) {
            sum += vplEdgeIntegral(&outer[i], &inner[k], rule);
        }
    }
    return sum / (2 * PI);
}

// ---- far: over the areas

enum { MOST_POINTS = 2 * 36 };

typedef struct Points {
    double p[MOST_POINTS][3], weight[MOST_POINTS]; // of area
    int count;
} Points;

// Gauss points of a square whose one side is drawn together to a corner.
static void addPoints(const double* a, const double* b, const double* c, Points* points)
{
    const vplGaussRule* g = &vplGauss6;
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - b[k];
    }
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double twice = sqrt(dot(n, n));
    for (int i = 0; i < 4 * g->pairs * g->pairs; i++) {
        const int s = i % (2 * g->pairs), t = i / (2 * g->pairs);
        const double x = 0.5 + (s & 1 ? 0.5 : -0.5) * g->x[s / 2],
                     y = 0.5 + (t & 1 ? 0.5 : -0.5) * g->x[t / 2];
        for (int k = 0; k < 3; k++) {
            points->p[points->count][k] = a[k] + x * (u[k] + y * v[k]);
        }
        points->weight[points->count++] = 0.25 * g->w[s / 2] * g->w[t / 2] * x * twice;
    }
}

static void findPoints(const Polygon* polygon, Points* points)
{
    points->count = 0;
    for (int i = 2; i < polygon->count; i++) {
        addPoints(polygon->p[0], polygon->p[i - 1], polygon->p[i], points);
    }
}

static double overAreas(const Pair* pair)
{
    Points a, b;
    findPoints(&pair->polygon[0], &a);
    findPoints(&pair->polygon[1], &b);
    double sum = 0;
    for (int i = 0; i < a.count; i++) {
        double part = 0;
        for (int j = 0; j < b.count; j++) {
            double d[3];
            for (int k = 0; k < 3; k++) {
                d[k] = b.p[j][k] - a.p[i][k];
            }
            const double square = dot(d, d), ca = dot(d, pair->plane[0].n), cb = -dot(d, pair->plane[1].n);
            part += ca > 0 && cb > 0 ? b.weight[j] * (ca / square) * (cb / square) : 0;
        }
        sum += a.weight[i] * part;
    }
    return sum / PI;
}

// ---- all of it

// The longest edge, and the middle of the corners.
static double extentOf(const Polygon* polygon, double middle[3])
{
    double longest = 0;
    memset(middle, 0, 3 * sizeof *middle);
    for (int i = 0; i < polygon->count; i++) {
        for (int j = 0; j < i; j++) {
            double square = 0;
            for (int k = 0; k < 3; k++) {
                const double d = polygon->p[i][k] - polygon->p[j][k];
                square += d * d;
            }
            longest = square > longest ? square : longest;
        }
        for (int k = 0; k < 3; k++) {
            middle[k] += polygon->p[i][k] / polygon->count;
        }
    }
    return sqrt(longest);
}

double vplTriangleExchange(const vplVec3 a[3], const vplVec3 b[3], const vplEdgeRule* rule)
{
    Pair pair;
    loadPair((const vplVec3* const[2]){a, b}, &pair);
    Polygon* p = pair.polygon;
    if (!findPlane(&p[0], &pair.plane[0]) || !findPlane(&p[1], &pair.plane[1]) ||
        dot(pair.plane[0].n, pair.plane[1].n) > 1 - SAME_PLANE) {
        return 0;
    }
    if (!clip(&p[1], &pair.plane[0], pair.tolerance) || !clip(&p[0], &pair.plane[1], pair.tolerance)) {
        return 0;
    }
    double middle[2][3], way[3];
    const double extent[2] = {extentOf(&p[0], middle[0]), extentOf(&p[1], middle[1])};
    for (int k = 0; k < 3; k++) {
        way[k] = middle[1][k] - middle[0][k];
    }
    const int small = extent[1] < extent[0];
    const bool isFar = sqrt(dot(way, way)) - 2.0 / 3 * (extent[0] + extent[1]) > FAR * extent[1 - small];
    const double exchange = isFar ? overAreas(&pair) : alongEdges(&p[small], &p[1 - small], rule);
    return exchange > 0 ? exchange * pair.scale * pair.scale : 0;
}

double vplTriangleFormFactor(const vplVec3 a[3], const vplVec3 b[3])
{
    Pair pair;
    loadPair((const vplVec3* const[2]){a, a}, &pair);
    const double(*p)[3] = pair.polygon[0].p;
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = p[1][k] - p[0][k];
        v[k] = p[2][k] - p[0][k];
    }
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double area = 0.5 * sqrt(dot(n, n)) * pair.scale * pair.scale;
    const double f = area > 0 ? vplTriangleExchange(a, b, &vplEdgesExact) / area : 0;
    return f < 1 ? f : 1;
}
