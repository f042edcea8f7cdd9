// SPDX-License-Identifier: MIT
// Based on: Sutherland and Hodgman, Reentrant Polygon Clipping, CACM 1974. Departs: only triangles are
// clipped, at one plane, and corners that are nearly on it count as on it.
#include "radiosity/factors/analytic.h"

#include <math.h>
#include <string.h>

void vplTwiceArea(const double a[3], const double b[3], const double c[3], double out[3])
{
    double u[3], v[3];
    vplSub3(b, a, u);
    vplSub3(c, a, v);
    vplCross3(u, v, out);
}

bool vplPolygon_Clip(vplPolygon* triangle, const vplHalfSpace* half, double tolerance)
{
    double height[3];
    bool front = false;
    for (int i = 0; i < 3; i++) {
        const double h = vplDot3(half->n, triangle->p[i]) - half->offset;
        height[i] = fabs(h) <= tolerance ? 0 : h;
        front = front || height[i] > 0;
    }
    vplPolygon out = {.count = 0};
    for (int i = 0; i < 3; i++) {
        const int next = i < 2 ? i + 1 : 0;
        if (height[i] >= 0) {
            memcpy(out.p[out.count++], triangle->p[i], sizeof out.p[0]);
        }
        if ((height[i] > 0 && height[next] < 0) || (height[i] < 0 && height[next] > 0)) {
            const double t = height[i] / (height[i] - height[next]);
            for (int k = 0; k < 3; k++) {
                out.p[out.count][k] = triangle->p[i][k] + t * (triangle->p[next][k] - triangle->p[i][k]);
            }
            out.count++;
        }
    }
    *triangle = out;
    return front && out.count >= 3;
}

double vplPolygonExtent(const vplPolygon* polygon, double middle[3])
{
    double longest = 0;
    memset(middle, 0, 3 * sizeof *middle);
    for (int i = 0; i < polygon->count; i++) {
        for (int j = 0; j < i; j++) {
            double d[3];
            vplSub3(polygon->p[i], polygon->p[j], d);
            const double square = vplDot3(d, d);
            longest = square > longest ? square : longest;
        }
        for (int k = 0; k < 3; k++) {
            middle[k] += polygon->p[i][k] / polygon->count;
        }
    }
    return sqrt(longest);
}

// Adds the Gauss points of a square, mapped to the triangle by collapsing one of its sides.
static void addPoints(const double* a, const double* b, const double* c, vplAreaPoints* points)
{
    const vplGaussRule* g = &vplGauss6;
    double u[3], v[3], n[3];
    vplSub3(b, a, u);
    vplSub3(c, b, v);
    vplCross3(u, v, n);
    const double twice = sqrt(vplDot3(n, n));
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

void vplFindAreaPoints(const vplPolygon* polygon, vplAreaPoints* points)
{
    points->count = 0;
    for (int i = 2; i < polygon->count; i++) {
        addPoints(polygon->p[0], polygon->p[i - 1], polygon->p[i], points);
    }
}
