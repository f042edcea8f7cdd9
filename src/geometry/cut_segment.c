// SPDX-License-Identifier: MIT
// The segments in which a convex polygon meets a triangle.
// Based on: Tomas Moeller, A Fast Triangle-Triangle Intersection Test, 1997 (distances to the other's plane). Departs:
// distances within a tolerance are 0, so that what stands on a surface meets it in spite of rounding.
#include "geometry/patch_cuts.h"
#include "math/double3.h"

#include <math.h>

// ---- the plane of the triangle

typedef struct Plane {
    double origin[3], normal[3]; // unit
} Plane;

static bool planeOf(const vplTriangleCorners* triangle, Plane* plane)
{
    vplToDouble3(triangle->corner[0], plane->origin);
    vplTriangle_Cross(triangle, plane->normal);
    const double length = sqrt(vplDot3(plane->normal, plane->normal));
    for (int k = 0; k < 3; k++) {
        plane->normal[k] /= length;
    }
    return length > 0;
}

static double distanceTo(const Plane* plane, const double point[3])
{
    double d = 0;
    for (int k = 0; k < 3; k++) {
        d += plane->normal[k] * (point[k] - plane->origin[k]);
    }
    return d;
}

// ---- segments

typedef struct Segment {
    double end[2][3];
} Segment;

static double squareBetween(const double a[3], const double b[3])
{
    const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    return vplDot3(d, d);
}

static void moveEnd(double from[3], const double to[3], double share)
{
    for (int k = 0; k < 3; k++) {
        from[k] += share * (to[k] - from[k]);
    }
}

// Clips a segment to the triangle, enlarged by the tolerance. False if no more than a point is left.
static bool clip(const vplTriangleCorners* triangle, const Plane* plane, double tolerance, Segment* s)
{
    for (int k = 0; k < 3; k++) {
        double a[3], b[3], edge[3], inward[3], d[2] = {tolerance, tolerance};
        vplToDouble3(triangle->corner[k], a);
        vplToDouble3(triangle->corner[(k + 1) % 3], b);
        const double length = sqrt(squareBetween(a, b));
        for (int i = 0; i < 3; i++) {
            edge[i] = (b[i] - a[i]) / length;
        }
        vplCross3(plane->normal, edge, inward);
        for (int i = 0; i < 3; i++) {
            d[0] += inward[i] * (s->end[0][i] - a[i]);
            d[1] += inward[i] * (s->end[1][i] - a[i]);
        }
        if (d[0] <= 0 && d[1] <= 0) {
            return false;
        }
        if (d[0] < 0) {
            moveEnd(s->end[0], s->end[1], d[0] / (d[0] - d[1]));
        } else if (d[1] < 0) {
            moveEnd(s->end[1], s->end[0], d[1] / (d[1] - d[0]));
        }
    }
    return squareBetween(s->end[0], s->end[1]) > 16 * tolerance * tolerance;
}

static int add(const Segment* s, int faces, vplPatchCut* out)
{
    *out = (vplPatchCut){.ends = {vplRound3(s->end[0]), vplRound3(s->end[1])}, .faces = (uint8_t)faces};
    return 1;
}

// The outline of a polygon in the triangle's own plane.
static int addOutline(const vplTriangleCorners* triangle, const vplCutPolygon* polygon, const Plane* plane,
                      double tolerance, vplPatchCut out[4])
{
    int count = 0;
    for (int i = 0; i < polygon->count; i++) {
        Segment s;
        for (int k = 0; k < 3; k++) {
            s.end[0][k] = polygon->corners[i][k];
            s.end[1][k] = polygon->corners[(i + 1) % polygon->count][k];
        }
        if (clip(triangle, plane, tolerance, &s)) {
            count += add(&s, 0, &out[count]);
        }
    }
    return count;
}

// Moves one end of a segment to `point` if that makes it longer.
static void extend(Segment* s, int* count, const double point[3])
{
    const double now = squareBetween(s->end[0], s->end[1]);
    const int end = *count < 2                              ? *count
                    : squareBetween(s->end[0], point) > now ? 1
                    : squareBetween(s->end[1], point) > now ? 0
                                                            : -1;
    for (int k = 0; k < 3 && end >= 0; k++) {
        s->end[end][k] = point[k];
    }
    *count += *count < 2;
}

// The part of a polygon that lies in the triangle's plane, by distances d of its corners. False if there is no
// segment.
static bool crossPlane(const vplCutPolygon* polygon, const double d[4], Segment* s)
{
    int count = 0;
    for (int i = 0; i < polygon->count; i++) {
        const int j = (i + 1) % polygon->count;
        if (d[i] == 0) {
            extend(s, &count, polygon->corners[i]);
        }
        if (d[i] * d[j] < 0) {
            double at[3] = {polygon->corners[i][0], polygon->corners[i][1], polygon->corners[i][2]};
            moveEnd(at, polygon->corners[j], d[i] / (d[i] - d[j]));
            extend(s, &count, at);
        }
    }
    return count == 2;
}

int vplCutSegment_Between(const vplTriangleCorners* triangle, const vplCutPolygon* polygon, double tolerance,
                          vplPatchCut out[4])
{
    Plane plane;
    double d[4], low = 0, high = 0;
    if (!planeOf(triangle, &plane)) {
        return 0;
    }
    for (int i = 0; i < polygon->count; i++) {
        d[i] = distanceTo(&plane, polygon->corners[i]);
        d[i] = fabs(d[i]) <= tolerance ? 0 : d[i];
        low = i == 0 ? d[i] : fmin(low, d[i]);
        high = i == 0 ? d[i] : fmax(high, d[i]);
    }
    if (low == 0 && high == 0) {
        return addOutline(triangle, polygon, &plane, tolerance, out);
    }
    Segment s = {{{0, 0, 0}, {0, 0, 0}}};
    if (low > 0 || high < 0 || !crossPlane(polygon, d, &s) || !clip(triangle, &plane, tolerance, &s)) {
        return 0;
    }
    return add(&s, (high > 0) | (low < 0) << 1, out);
}
