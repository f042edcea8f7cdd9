// SPDX-License-Identifier: MIT
// Lines of cuts in the plane of a triangle.
#include "geometry/patch_cuts.h"
#include "math/double3.h"

#include <math.h>

bool vplCutLine_Make(const vplPatchCut* segment, vplVec3 normal, vplCutLine* line)
{
    double end[3], n[3];
    vplToDouble3(segment->ends[0], line->start);
    vplToDouble3(segment->ends[1], end);
    vplToDouble3(normal, n);
    for (int k = 0; k < 3; k++) {
        line->along[k] = end[k] - line->start[k];
    }
    line->length = sqrt(vplDot3(line->along, line->along));
    for (int k = 0; k < 3; k++) {
        line->along[k] /= line->length;
    }
    vplCross3(n, line->along, line->across);
    return line->length > 0;
}

void vplCutLine_Locate(const vplCutLine* line, vplVec3 point, double* along, double* across)
{
    double p[3];
    vplToDouble3(point, p);
    for (int k = 0; k < 3; k++) {
        p[k] -= line->start[k];
    }
    *along = vplDot3(p, line->along);
    *across = vplDot3(p, line->across);
}

bool vplCutLine_PassThrough(const vplCutLine* line, const vplTriangleCorners* at, double tolerance,
                            double way[2])
{
    double x[3], y[3];
    for (int k = 0; k < 3; k++) {
        vplCutLine_Locate(line, at->corner[k], &x[k], &y[k]);
    }
    way[0] = -INFINITY;
    way[1] = INFINITY;
    for (int k = 0; k < 3; k++) {
        const int next = (k + 1) % 3;
        const double dx = x[next] - x[k], dy = y[next] - y[k], length = sqrt(dx * dx + dy * dy);
        // The inside is where dx (0 - y) - dy (s - x) >= tolerance * length.
        const double rest = dx * y[k] - dy * x[k] + tolerance * length;
        if (dy > 0) {
            way[1] = fmin(way[1], -rest / dy);
        } else if (dy < 0) {
            way[0] = fmax(way[0], -rest / dy);
        } else if (rest > 0) {
            return false;
        }
    }
    return way[1] - way[0] > tolerance;
}
