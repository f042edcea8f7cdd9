// SPDX-License-Identifier: MIT
// Light at points of surfaces that no camera shows: direct light of radiosity's patches.
#include "math/vec.h"
#include "shading/shading.h"

#include <string.h>

typedef struct PointsTask {
    vplShading shading;
    const vplSurfacePoint* points;
    int count;
    vplRgb* irradiance;
    int64_t rays;
} PointsTask;

enum { TASK_POINTS = 16 * VPL_LANES }; // per task: 64 rays to an area light from each take a millisecond

static void loadBlock(const PointsTask* t, int first, int count, vplSurface* surface, int triangle[VPL_LANES])
{
    memset(surface, 0, sizeof *surface);
    for (int l = 0; l < VPL_LANES; l++) {
        triangle[l] = -1;
    }
    for (int l = 0; l < count; l++) {
        const vplSurfacePoint* p = &t->points[first + l];
        surface->px[l] = p->position.x;
        surface->py[l] = p->position.y;
        surface->pz[l] = p->position.z;
        surface->nx[l] = p->normal.x;
        surface->ny[l] = p->normal.y;
        surface->nz[l] = p->normal.z;
        triangle[l] = p->triangle;
    }
}

// Sums groups in double, as vplTileSums does.
static void addLights(const vplShading* s, const vplPoints* points, double sums[3][VPL_LANES], int64_t* rays)
{
    for (int first = 0; first < s->lights.count; first += VPL_LIGHT_GROUP) {
        const int left = s->lights.count - first;
        float part[3][VPL_LANES] = {{0}};
        vplIndirectIrradiance(s, points, first, left < VPL_LIGHT_GROUP ? left : VPL_LIGHT_GROUP, part, rays);
        for (int c = 0; c < 3; c++) {
            for (int l = 0; l < VPL_LANES; l++) {
                sums[c][l] += (double)part[c][l];
            }
        }
    }
}

static void lightBlock(PointsTask* t, int first, int count, int64_t* rays)
{
    vplSurface surface;
    vplPoints points = {.surface = &surface, .plane = &surface};
    float direct[3][VPL_LANES];
    double sums[3][VPL_LANES];
    loadBlock(t, first, count, &surface, points.triangle);
    vplDirectIrradiance(&t->shading, &t->shading.direct, &points, direct, rays);
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            sums[c][l] = (double)direct[c][l];
        }
    }
    addLights(&t->shading, &points, sums, rays);
    for (int l = 0; l < count; l++) {
        t->irradiance[first + l] = (vplRgb){(float)sums[0][l], (float)sums[1][l], (float)sums[2][l]};
    }
}

static void lightPoints(void* data, int task, int worker)
{
    PointsTask* t = data;
    const int first = task * TASK_POINTS;
    const int end = t->count - first < TASK_POINTS ? t->count : first + TASK_POINTS;
    int64_t rays = 0;
    (void)worker;
    for (int i = first; i < end; i += VPL_LANES) {
        lightBlock(t, i, end - i < VPL_LANES ? end - i : VPL_LANES, &rays);
    }
    __atomic_fetch_add(&t->rays, rays, __ATOMIC_RELAXED);
}

vplResult vplShadePoints(const vplGeometry* geometry, const vplShadeDef* def, const vplSurfacePoint* points,
                         int count, vplRgb* irradianceOut, int64_t* raysOut)
{
    PointsTask task = {.shading = vplShading_Make(geometry, NULL, def),
                       .points = points,
                       .count = count,
                       .irradiance = irradianceOut};
    task.shading.smooth = false; // points have one normal each
    task.shading.arena = vplArena_Create(geometry->context);
    const vplResult result = vplDirectLight_Open(&task.shading.direct, task.shading.arena, def->lighting);
    if (result == VPL_SUCCESS) {
        vplParallelFor(geometry->context, (count + TASK_POINTS - 1) / TASK_POINTS, lightPoints, &task);
        if (raysOut != NULL) {
            *raysOut += task.rays;
        }
    }
    vplArena_Destroy(task.shading.arena);
    return result;
}
