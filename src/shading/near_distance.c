// SPDX-License-Identifier: MIT
// How far "near" is in a scene: a distance that surfaces see a given share of their surroundings within.
#include "base/context.h"
#include "math/sampling.h"
#include "math/vec.h"
#include "shading/compensation.h"

// Enough for two digits of the distance.
enum { POINTS = 2048, HALVINGS = 40 };

// What the bound takes away from a surface whose surroundings all shine alike.
static double shareWithin(const double squares[POINTS], int count, double distance)
{
    double sum = 0;
    for (int i = 0; i < count; i++) {
        const double nearer = squares[i] / (distance * distance);
        sum += nearer < 1 ? 1 - nearer : 0;
    }
    return count ? sum / count : 0;
}

vplResult vplFindNearDistance(const vplGeometry* geometry, const vplView* view, double share,
                              float* distanceOut)
{
    double squares[POINTS];
    int count = 0;
    const vplResult result = vplGeometry_PrepareRays(geometry);
    for (uint32_t i = 1; i <= POINTS && result == VPL_SUCCESS; i++) {
        vplLitPoint p;
        vplHit hit;
        if (vplLookAt(geometry, view, (double)vplHalton(i, 0) * view->width,
                      (double)vplHalton(i, 1) * view->height, &p)) {
            const vplVec3 way = vplSampleCosineAround(p.plane, vplHalton(i, 2), vplHalton(i, 3));
            const vplRay ray = vplGeometry_Leave(geometry, &p.hit, way);
            squares[count++] =
                vplGeometry_ClosestHit(geometry, &ray, &hit) ? (double)hit.t * (double)hit.t : INFINITY;
        }
    }
    double low = 0, high = (double)vplGeometry_Diagonal(geometry);
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        if (shareWithin(squares, count, middle) < share) {
            low = middle;
        } else {
            high = middle;
        }
    }
    if (result == VPL_SUCCESS) {
        *distanceOut = (float)high;
    }
    return result;
}
