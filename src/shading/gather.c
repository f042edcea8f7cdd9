// SPDX-License-Identifier: MIT
// Final gather: the indirect irradiance of a pixel is the mean of what cosine-distributed rays from its point
// meet. The caller knows the radiosity of surfaces. Where neighbours share their light, pixels of a square of
// K x K share one sequence of directions, and each takes its own part of it.
// Based on: Mark Reichert, A Two-Pass Radiosity Method Driven by Lights and Viewer Position, Cornell 1992.
// Departs: squares of pixels share directions, and the filter of interleaved shading makes them one mean.
#include "shading/gather.h"

#include "geometry/bvh.h"
#include "math/sampling.h"
#include "math/vec.h"

#include <math.h>

// Rays of one point between two questions whether the render goes on.
enum { ASK_RAYS = 16 };

static bool sharesLight(const vplShadeDef* def)
{
    return def->accumulation == VPL_ACCUMULATE_INTERLEAVED && def->interleave > 1;
}

vplResult vplGather_Open(vplShading* shading)
{
    const vplShadeDef* def = shading->def;
    if (def->gather == NULL) {
        return VPL_SUCCESS;
    }
    vplGather* gather = vplArena_Alloc(shading->arena, 1, sizeof *gather);
    TRY(vplArena_Check(shading->arena));
    *gather = (vplGather){def->gather, vplSobol_Make(), sharesLight(def) ? def->interleave : 1};
    shading->gather = gather;
    return VPL_SUCCESS;
}

// A point that gathers, and its part of the directions.
typedef struct Point {
    vplHit hit;
    vplVec3 shading, plane; // normals on the side that is lit
    uint64_t stream;
    uint32_t first, count;
} Point;

static Point pointOf(const vplShading* s, const vplPoints* points, int l, uint32_t pixel)
{
    const vplGather* gather = s->gather;
    const vplSurface *p = points->surface, *plane = points->plane;
    const uint32_t side = (uint32_t)gather->side, classes = side * side;
    const uint32_t x = pixel & 0xffff, y = pixel >> 16, count = (uint32_t)gather->def->rayCount;
    return (Point){.hit = vplHitOfPoint(s->geometry, points->triangle[l], vplVec(p->px[l], p->py[l], p->pz[l])),
                   .shading = vplVec(p->nx[l], p->ny[l], p->nz[l]),
                   .plane = vplVec(plane->nx[l], plane->ny[l], plane->nz[l]),
                   .stream = (uint64_t)(y / side) << 16 | x / side,
                   .first = gather->def->firstRay * classes + (y % side * side + x % side) * count,
                   .count = count};
}

static void gatherPoint(const vplShading* s, const Point* p, double sum[3], int64_t* rays)
{
    const vplGather* gather = s->gather;
    for (uint32_t i = 0; i < p->count; i++) {
        if (i % ASK_RAYS == 0 && !vplTask_GoesOn(s->geometry->context)) {
            return;
        }
        float u[VPL_SOBOL_DIMENSIONS], radiosity[3];
        vplHit met;
        vplSobol_Sample(&gather->sobol, gather->def->seed, p->stream, 0, p->first + i, u);
        const vplVec3 direction = vplSampleCosineAround(p->shading, u[0], u[1]);
        if (!(vplDot(direction, p->plane) > 0)) {
            continue;
        }
        const vplRay ray = vplGeometry_Leave(s->geometry, &p->hit, direction);
        *rays += 1;
        if (vplClosestHit(s->geometry, &ray, INFINITY, NULL, &met)) {
            gather->def->radiosity(gather->def->user, &met, direction, radiosity);
            sum[0] += (double)radiosity[0];
            sum[1] += (double)radiosity[1];
            sum[2] += (double)radiosity[2];
        }
    }
}

void vplAddGathered(const vplShading* shading, const vplPoints* points, const uint32_t pixels[VPL_LANES],
                    float irradiance[3][VPL_LANES], int64_t* rays)
{
    for (int l = 0; l < VPL_LANES; l++) {
        if (points->triangle[l] < 0) {
            continue;
        }
        const Point p = pointOf(shading, points, l, pixels[l]);
        double sum[3] = {0, 0, 0};
        gatherPoint(shading, &p, sum, rays);
        for (int c = 0; c < 3; c++) {
            irradiance[c][l] += (float)(sum[c] / p.count);
        }
    }
}
