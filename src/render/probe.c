// SPDX-License-Identifier: MIT
#include "render/probe.h"

#include "math/sampling.h"
#include "math/vec.h"

#include <math.h>

enum { COLUMNS = 12, ROWS = 8, POINTS = COLUMNS * ROWS, VERTICES = 256 };

static vplVec3 towards(const vplView* v, int i)
{
    const double x = 2 * (i % COLUMNS + 0.5) / COLUMNS - 1, y = 1 - 2 * (i / COLUMNS + 0.5) / ROWS;
    const float sx = (float)(x / (double)v->scaleX), sy = (float)(y / (double)v->scaleY);
    return vplAdd(v->forward, vplAdd(vplScale(sx, v->right), vplScale(sy, v->up)));
}

// Finds the closest hit. Its normal faces the ray's origin.
static bool hitAt(const vplGeometry* g, vplRay ray, vplHit* hit)
{
    const bool found = vplGeometry_ClosestHit(g, &ray, hit);
    if (found && vplDot(hit->normal, ray.direction) > 0) {
        hit->normal = vplNegate(hit->normal);
    }
    return found;
}

vplProbe vplProbe_Take(const vplGeometry* g, const vplView* view, float nearPlane)
{
    vplHit seen[POINTS], far[POINTS];
    int count = 0, farCount = 0, facing = 0, pairs = 0;
    for (int i = 0; i < POINTS; i++) {
        if (hitAt(
                g,
                (vplRay){vplAdd(view->eye, vplScale(nearPlane, towards(view, i))), towards(view, i), {0, 0}},
                &seen[count])) {
            const vplHit* hit = &seen[count++];
            const float u = ((float)(i % 8) + 0.5f) / 8, v = vplVanDerCorput((uint32_t)i);
            const vplVec3 direction = vplSampleCosineAround(hit->normal, u, v);
            farCount += hitAt(g, vplGeometry_Leave(g, hit, direction), &far[farCount]);
        }
    }
    for (int i = 0; i < count; i++) {
        for (int k = i % 5; k < farCount; k += 5) {
            const vplVec3 way = vplSub(far[k].position, seen[i].position);
            facing += vplDot(way, seen[i].normal) > 0 && vplDot(way, far[k].normal) < 0;
            pairs++;
        }
    }
    return (vplProbe){(double)count / POINTS, count > 0 ? (double)farCount / count : 0,
                      pairs > 0 ? (double)facing / pairs : 0};
}

// Casts a ray from the eye to every n-th vertex, to about VERTICES in all.
double vplProbe_SeenVertices(const vplGeometry* g, const vplView* view)
{
    const int step = g->vertexCount < VERTICES ? 1 : g->vertexCount / VERTICES;
    int seen = 0, asked = 0;
    for (int i = 0; i < g->vertexCount; i += step) {
        const vplVec3 p = g->positions[i];
        float x, y;
        const vplRay ray = {view->eye, vplSub(p, view->eye), {0, 0}};
        seen += vplView_Project(view, p, &x, &y) && x >= 0 && y >= 0 && x < (float)view->width &&
                y < (float)view->height && !vplGeometry_IsOccluded(g, &ray, 1 - 0x1p-10f);
        asked++;
    }
    return asked > 0 ? (double)g->vertexCount * seen / asked : 0;
}
