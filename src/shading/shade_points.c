// SPDX-License-Identifier: MIT
// Light at points of surfaces that no camera shows: direct light of radiosity's patches.
#include "lights/light_set.h"
#include "shading/accumulate.h"

typedef struct PointsTask {
    vplShading shading;
    const vplSurfacePoint* points;
    int count;
    vplRgb* irradiance;
    int64_t rays;
} PointsTask;

enum { TASK_POINTS = 16 * VPL_LANES }; // per task: 64 rays to an area light from each take a millisecond

static void lightBlock(PointsTask* t, int first, int count, int64_t* rays)
{
    static const int lit = 0;
    vplBlock b;
    const vplLitBlocks to = {.blocks = &b, .lit = &lit, .count = 1};
    float direct[3][VPL_LANES];
    memset(&b.surface, 0, sizeof b.surface);
    b.points.surface = b.points.plane = &b.surface;
    for (int l = 0; l < VPL_LANES; l++) {
        b.points.triangle[l] = l < count ? t->points[first + l].triangle : -1;
    }
    for (int l = 0; l < count; l++) {
        vplSurface_Put(&b.surface, l, t->points[first + l].position, t->points[first + l].normal);
    }
    vplDirectIrradiance(&t->shading, &t->shading.direct, &b.points, direct, rays);
    vplStartSums(&b, direct);
    vplAddLights(&t->shading, &to, 0, t->shading.lights.count, rays);
    for (int l = 0; l < count; l++) {
        t->irradiance[first + l] = (vplRgb){(float)b.sums[0][l], (float)b.sums[1][l], (float)b.sums[2][l]};
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
    REQUIRE(CONTEXT_OF(geometry), geometry, def);
    REQUIRE_ARRAY(CONTEXT_OF(geometry), points, count);
    REQUIRE_ARRAY(CONTEXT_OF(geometry), irradianceOut, count);
    TRY(vplShadeDef_CheckCookie(geometry->context, def));
    PointsTask task = {.shading = vplShading_Make(geometry, NULL, def),
                       .points = points,
                       .count = count,
                       .irradiance = irradianceOut};
    task.shading.smooth = false; // points have one normal each
    task.shading.arena = vplArena_Create(geometry->context);
    vplResult result = vplDirectLight_Open(&task.shading.direct, &task.shading, def->lighting);
    if (result == VPL_SUCCESS) {
        result = vplParallelForAsking(geometry->context, (count + TASK_POINTS - 1) / TASK_POINTS, lightPoints,
                                      &task);
        if (raysOut != NULL) {
            *raysOut += task.rays;
        }
    }
    vplArena_Destroy(task.shading.arena);
    return result;
}
