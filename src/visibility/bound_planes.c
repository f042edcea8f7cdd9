// SPDX-License-Identifier: MIT
#include "visibility/bound_planes.h"

#include <math.h>
#include <string.h>

vplTexelArea vplFindArea(int size, int column, int row, int step)
{
    const int right = column + step < size ? column + step : size,
              last = row + step < size ? row + step : size;
    vplTexelArea a = {{(2 * column + 1.0) / size - 1, (2 * right - 1.0) / size - 1},
                      {1 - (2 * row + 1.0) / size, 1 - (2 * last - 1.0) / size},
                      {0, 0},
                      {0, 0}};
    for (int i = 0; i < 2; i++) {
        a.middleS[i] = (a.s[i] * 3 + a.s[1 - i]) / 4;
        a.middleU[i] = (a.u[i] * 3 + a.u[1 - i]) / 4;
    }
    return a;
}

void vplAddCandidate(const vplTexelArea* area, const float plane[3], vplCandidates* c)
{
    const double same =
        VPL_SAME_PLANE * (fabs((double)plane[0]) + fabs((double)plane[1]) + fabs((double)plane[2]));
    for (int i = 0; i < c->count; i++) {
        if (vplMostAbove(area, plane, c->planes[i]) <= same &&
            vplMostAbove(area, c->planes[i], plane) <= same) {
            return;
        }
    }
    if (c->count < VPL_BOUND_CANDIDATES && isfinite(plane[2])) {
        memcpy(c->planes[c->count++], plane, sizeof c->planes[0]);
    }
}

// The sum of a bound's values in the quarters of an area: less is better.
static double score(const vplTexelArea* area, const vplCubeBound* b)
{
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        double value[2];
        for (int k = 0; k < 2; k++) {
            value[k] = (double)b->planes[k][0] * area->middleS[i & 1] +
                       (double)b->planes[k][1] * area->middleU[i >> 1] + (double)b->planes[k][2];
        }
        sum += b->kind == VPL_BOUND_BOTH ? vplLarger(value[0], value[1]) : vplSmaller(value[0], value[1]);
    }
    return sum;
}

void vplRaisePlane(const float plane[3], double raise, float raisedOut[3])
{
    const double ahead = (double)plane[2] + raise;
    memcpy(raisedOut, plane, sizeof(float[3]));
    raisedOut[2] = raise > 0 ? (float)(ahead + fabs(ahead) * 0x1p-23) : plane[2];
}

static void keepBetter(const vplTexelArea* area, const vplCandidates* c, int i, int k, vplBoundKind kind,
                       double raiseI, double raiseK, double* best, vplCubeBound* bound)
{
    vplCubeBound b = {.farthest = bound->farthest, .kind = kind};
    vplRaisePlane(c->planes[i], raiseI, b.planes[0]);
    vplRaisePlane(c->planes[k], raiseK, b.planes[1]);
    const double value = score(area, &b);
    if (value < *best) {
        *best = value;
        *bound = b;
    }
}

void vplChoosePlanes(const vplTexelArea* area, const vplCandidates* c, const vplRaises* raises,
                     vplCubeBound* bound)
{
    double best = score(area, bound);
    best = best < INFINITY ? best : INFINITY; // a number
    for (int i = 0; i < c->count; i++) {
        keepBetter(area, c, i, i, VPL_BOUND_ONE, raises->one[i], raises->one[i], &best, bound);
        for (int k = i + 1; k < c->count; k++) {
            keepBetter(area, c, i, k, VPL_BOUND_EITHER, raises->one[i], raises->one[k], &best, bound);
            keepBetter(area, c, i, k, VPL_BOUND_BOTH, raises->two[i][k], raises->two[i][k], &best, bound);
        }
    }
}
