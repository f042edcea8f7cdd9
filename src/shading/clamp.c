// SPDX-License-Identifier: MIT
// Measures how much light the clamp takes: the distance at which it takes a given share, and the share of a
// given picture.
#include "math/sampling.h"
#include "math/vec.h"
#include "shading/compensation.h"

#include <string.h>

bool vplFindVisiblePoint(const vplGeometry* g, const vplView* view, double x, double y, vplLitPoint* p)
{
    const double across = (2 * x / view->width - 1) / view->scaleX;
    const double upward = (1 - 2 * y / view->height) / view->scaleY;
    const vplVec3 d = vplAdd(view->forward,
                             vplAdd(vplScale((float)across, view->right), vplScale((float)upward, view->up)));
    const vplRay ray = {vplAdd(view->eye, vplScale((float)view->nearPlane, d)), d, {0, 0}};
    if (!vplGeometry_ClosestHit(g, &ray, &p->hit) || (double)p->hit.t > view->farPlane - view->nearPlane) {
        return false;
    }
    vplLitPoint_Face(p, g, d);
    return true;
}

// ---- distance of a share

enum {
    POINTS = 2048, // enough for two digits of the distance
    POINTS_PER_TASK = 128,
    HALVINGS = 40,
    MANY_TRIANGLES = 50000 // for fewer, workers take longer to wake than the rays
};

// Rays from visible points to their surroundings.
typedef struct NearRays {
    const vplGeometry* geometry;
    const vplView* view;
    double squares[POINTS]; // of their lengths; below 0: there is no visible point
} NearRays;

static double squareOfRay(const NearRays* rays, uint32_t i)
{
    const vplGeometry* g = rays->geometry;
    vplLitPoint p;
    vplHit hit;
    if (!vplFindVisiblePoint(g, rays->view, (double)vplHalton(i, 0) * rays->view->width,
                             (double)vplHalton(i, 1) * rays->view->height, &p)) {
        return -1;
    }
    const vplVec3 way = vplSampleCosineAround(p.plane, vplHalton(i, 2), vplHalton(i, 3));
    const vplRay ray = vplGeometry_Leave(g, &p.hit, way);
    return vplGeometry_ClosestHit(g, &ray, &hit) ? (double)hit.t * (double)hit.t : INFINITY;
}

static void castNearRays(void* data, int task, int worker)
{
    (void)worker;
    NearRays* rays = data;
    for (int i = task * POINTS_PER_TASK; i < (task + 1) * POINTS_PER_TASK; i++) {
        rays->squares[i] = squareOfRay(rays, (uint32_t)i + 1);
    }
}

// Moves the squares of the rays that were cast to the front and returns their number.
static int listSquares(double squares[POINTS])
{
    int count = 0;
    for (int i = 0; i < POINTS; i++) {
        squares[count] = squares[i];
        count += squares[i] >= 0;
    }
    return count;
}

// The share that the clamp takes from a surface whose surroundings, at these squared distances, are all
// equally bright.
static double shareTaken(const double squares[POINTS], int count, double distance)
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
    REQUIRE(CONTEXT_OF(geometry), geometry, view, distanceOut);
    NearRays rays = {geometry, view, {0}};
    const int tasks = POINTS / POINTS_PER_TASK;
    if (geometry->triangleCount > MANY_TRIANGLES) {
        vplParallelFor(geometry->context, tasks, castNearRays, &rays);
    } else {
        for (int i = 0; i < tasks; i++) {
            castNearRays(&rays, i, 0);
        }
    }
    const int count = listSquares(rays.squares);
    double low = 0, high = (double)vplGeometry_Diagonal(geometry);
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        if (shareTaken(rays.squares, count, middle) < share) {
            low = middle;
        } else {
            high = middle;
        }
    }
    *distanceOut = (float)high;
    return VPL_SUCCESS;
}

// ---- share of a picture

enum { DRAWN_LIGHTS = 64 }; // per point

// Adds points first .. first + 15.
static void addBlock(const vplShading* s, int first, int count, vplClampLoss* sum)
{
    const vplGeometry* g = s->geometry;
    const vplCompensationDef* def = s->compensation->def;
    const int hidden = def->seesEmission ? 0 : def->emitterLightCount; // these light only hits of short rays
    const vplLightDraw all = {def->lights + hidden, def->lightCount - hidden, DRAWN_LIGHTS, 0, 0};
    vplLitPoint at[VPL_LANES];
    vplSurface surface, plane;
    vplPoints points = {.surface = &surface, .plane = &plane};
    uint32_t pixels[VPL_LANES];
    float lost[3][VPL_LANES] = {{0}};
    int64_t rays = 0;
    memset(&surface, 0, sizeof surface);
    memset(&plane, 0, sizeof plane);
    for (int l = 0; l < VPL_LANES; l++) {
        const uint64_t i = (uint64_t)(first + l) + def->firstRay;
        points.triangle[l] = -1;
        pixels[l] = (uint32_t)i;
        at[l] = (vplLitPoint){.pixel = pixels[l]};
        if (l < count && vplFindVisiblePoint(g, s->view, (double)vplHalton(i + 1, 0) * s->view->width,
                                             (double)vplHalton(i + 1, 1) * s->view->height, &at[l])) {
            points.triangle[l] = at[l].hit.triangle;
            vplSurface_Put(&surface, l, at[l].hit.position, at[l].shading);
            vplSurface_Put(&plane, l, at[l].hit.position, at[l].plane);
        }
    }
    vplAddCompensation(s, &points, pixels, lost, &rays);
    for (int l = 0; l < count; l++) {
        if (points.triangle[l] < 0) {
            continue;
        }
        const vplRgb rho = vplLitPoint_Reflectance(&at[l], g);
        float left[3];
        vplReceiveDrawnLights(s, &all, &at[l], left, &rays);
        const float taken = rho.r * lost[0][l] + rho.g * lost[1][l] + rho.b * lost[2][l];
        sum->lost += (double)taken;
        sum->all += (double)(taken + rho.r * left[0] + rho.g * left[1] + rho.b * left[2]);
    }
}

vplResult vplEstimateClampLoss(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                               int pointCount, vplClampLoss* lossOut)
{
    REQUIRE(CONTEXT_OF(geometry), geometry, view, def, lossOut);
    TRY(vplShadeDef_CheckCookie(geometry->context, def));
    TRY(vplShadeDef_CheckCompensation(geometry->context, def));
    vplShading shading = vplShading_Make(geometry, view, def);
    vplClampLoss sum = {0, 0};
    shading.arena = vplArena_Create(geometry->context);
    const vplResult result = vplCompensator_Open(&shading);
    if (result == VPL_SUCCESS && shading.compensation != NULL) {
        for (int i = 0; i < pointCount; i += VPL_LANES) {
            addBlock(&shading, i, pointCount - i < VPL_LANES ? pointCount - i : VPL_LANES, &sum);
        }
    }
    vplArena_Destroy(shading.arena);
    if (result == VPL_SUCCESS) {
        *lossOut = sum;
    }
    return result;
}
