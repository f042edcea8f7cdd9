// SPDX-License-Identifier: MIT
// Samples of area lights.
// Based on: Alexander Keller, Instant Radiosity, SIGGRAPH 1997, section 3: points on the area light, each
// with its share of the flux, are the lights of direct illumination. Departs: their number does not depend on
// particles, they are shared out by power, and each lamp's points are a centred lattice.
#include <vpl/lights.h>

#include "geometry/emission.h"
#include "geometry/triangle.h"
#include "lights/light_set.h"
#include "math/double3.h"
#include "math/vec.h"

#include <math.h>

// Point k of n in the unit square: a lattice by the golden ratio, which is even for every n. The points lie in
// pairs around the middle, so their mean is the middle, and a single one is in it.
// Source: Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, 1992 (Kronecker sequences).
static void latticePoint(int k, int n, double out[2])
{
    const double golden = 0.61803398874989485, y = golden * (k - 0.5 * (n - 1)) + 0.5;
    out[0] = (k + 0.5) / n;
    out[1] = y - floor(y);
}

// Barycentrics of point k of n in a triangle, whose mean is its centre: triples that turn about it, and one or
// two left over on a median.
static void trianglePoint(int k, int n, double w[3])
{
    const int left = n % 3;
    if (k < left) {
        const double along = left == 1 ? 0 : k == 0 ? 0.25 : -0.25;
        w[0] = (1 + 2 * along) / 3;
        w[1] = w[2] = (1 - along) / 3;
        return;
    }
    double at[2];
    latticePoint((k - left) / 3, n / 3, at);
    const double sum = sqrt(at[0]), a = sum * (1 - at[1]), b = sum * at[1]; // in the triangle centre, 0, 1
    const int turn = (k - left) % 3;
    w[turn] = (1 - sum) / 3 + a;
    w[(turn + 1) % 3] = (1 - sum) / 3 + b;
    w[(turn + 2) % 3] = (1 - sum) / 3;
}

// The source's triangles from `first` on that are sampled together: the two of a face, or one.
static int pieceEnd(const vplEmission* e, int first)
{
    const vplGeometry* g = e->geometry;
    const int next = first + 1, triangle = e->sources[first].triangle;
    return next < e->sourceCount && g->owners[e->sources[next].triangle] == g->owners[triangle] &&
                   vplGeometry_FaceOf(g, triangle) != VPL_FACE_NONE &&
                   vplGeometry_FaceOf(g, e->sources[next].triangle) == vplGeometry_FaceOf(g, triangle)
               ? next + 1
               : next;
}

static int lampEnd(const vplEmission* e, int first)
{
    const int* owners = e->geometry->owners;
    const int owner = owners[e->sources[first].triangle];
    int end = first + 1;
    while (end < e->sourceCount && owners[e->sources[end].triangle] == owner) {
        end++;
    }
    return end;
}

// How many of `count` evenly spread ranks of the power between the sources `first` and `end` lie before `at`.
static int ranksBefore(const vplEmission* e, int first, int end, int count, int at)
{
    const double* sums = e->cumulative;
    const double ranks = ceil((sums[at] - sums[first]) / (sums[end] - sums[first]) * count - 0.5);
    return at == end ? count : ranks < count ? (int)ranks : count;
}

// The corner of one of a face's triangles that the other lacks. Both have corner 0.
static int cornerAcross(const vplGeometry* g, int triangle, int other)
{
    const uint32_t *a = g->indices + 3 * (size_t)triangle, *b = g->indices + 3 * (size_t)other;
    return a[1] == b[1] || a[1] == b[2] ? 2 : 1;
}

// Fills n points of a face or triangle, each of the flux of source `first` times `share`.
static void samplePiece(const vplEmission* e, int first, int end, int n, double share, vplShadeLight* out)
{
    const vplGeometry* g = e->geometry;
    const int triangle = e->sources[first].triangle;
    const vplTriangleCorners t = vplGeometry_Corners(g, triangle);
    double corner[3][3];
    for (int k = 0; k < 3; k++) {
        vplToDouble3(t.corner[k], corner[k]);
    }
    const int across = end - first == 2 ? cornerAcross(g, triangle, e->sources[first + 1].triangle) : 0;
    const vplVec3 normal = g->normals[triangle];
    const vplRgb i = vplScaleRadiometric(share / VPL_PI, e->sources[first].power);
    for (int k = 0; k < n; k++) {
        double w[3], p[3];
        if (across !=
            0) { // a parallelogram: along two sides, from corner 0 over that one to the opposite one
            latticePoint(k, n, w);
            w[3 - across] = w[1];
            w[across] = w[0] - w[1];
            w[0] = 1 - w[0];
        } else {
            trianglePoint(k, n, w);
        }
        for (int axis = 0; axis < 3; axis++) {
            p[axis] = w[0] * corner[0][axis] + w[1] * corner[1][axis] + w[2] * corner[2][axis];
        }
        out[k] = (vplShadeLight){(float)p[0], (float)p[1], (float)p[2], normal.x, normal.y,
                                 normal.z,    i.r,         i.g,         i.b};
    }
}

// True if each piece has at least one of n points that lie on the sources first .. end - 1.
static bool everyPieceHasAPoint(const vplEmission* e, int first, int end, int n)
{
    for (int at = first, done = 0; at < end;) {
        const int next = pieceEnd(e, at), upTo = ranksBefore(e, first, end, n, next);
        if (upTo == done) {
            return false;
        }
        at = next;
        done = upTo;
    }
    return true;
}

// Fills n points of the sources first .. end - 1, whose power is `flux`. Where each piece has a point, its points share its own
// power: of 16 points on a box, two faces have two and four have three, and opposite faces were 1.5 times as bright.
static void sampleLamp(const vplEmission* e, int first, int end, int n, double flux, vplShadeLight* out)
{
    const double* sums = e->cumulative;
    const bool own = everyPieceHasAPoint(e, first, end, n);
    for (int at = first, done = 0; at < end;) {
        const int next = pieceEnd(e, at), upTo = ranksBefore(e, first, end, n, next), count = upTo - done;
        const double power = sums[at + 1] - sums[at],
                     share = (sums[next] - sums[at]) / (sums[end] - sums[first]),
                     each = own ? flux * share / count : flux / n;
        samplePiece(e, at, next, count, each / power, out + done);
        at = next;
        done = upTo;
    }
}

int vplSampleAreaLights(const vplEmission* e, int count, vplShadeLight* out)
{
    if (e == NULL || out == NULL) {
        return 0;
    }
    const int first = e->firstTriangle, end = e->sourceCount;
    if (first >= end) {
        return 0;
    }
    const double* sums = e->cumulative;
    bool everyLamp = true; // has a point, so that its points can share its own power
    for (int pass = 0; pass < 2; pass++) {
        for (int at = first, done = 0; at < end;) {
            const int next = lampEnd(e, at), upTo = ranksBefore(e, first, end, count, next), n = upTo - done;
            everyLamp = everyLamp && n > 0;
            if (pass == 1 && n > 0) {
                const double flux = everyLamp ? sums[next] - sums[at] : (sums[end] - sums[first]) / count * n;
                sampleLamp(e, at, next, n, flux, out + done);
            }
            at = next;
            done = upTo;
        }
    }
    return count;
}

int vplCountEmittingFaces(const vplEmission* e)
{
    int count = 0;
    for (int at = e->firstTriangle; at < e->sourceCount; at = pieceEnd(e, at)) {
        count++;
    }
    return count;
}

int vplSampleEmittingFaces(const vplEmission* e, int count, vplShadeLight* out)
{
    const double *sums = e->cumulative, all = sums[e->sourceCount] - sums[e->firstTriangle];
    int done = 0;
    for (int at = e->firstTriangle, next; at < e->sourceCount; at = next) {
        next = pieceEnd(e, at);
        const double power = sums[next] - sums[at], share = power / all * count;
        const int n = share < 1 ? 1 : (int)share;
        samplePiece(e, at, next, n, power / (sums[at + 1] - sums[at]) / n, out + done);
        done += n;
    }
    return done;
}
