// SPDX-License-Identifier: MIT
// The share of virtual light that the bound takes away, from a few pixels: at each, some short rays and some of the
// virtual lights.
#include "math/sampling.h"
#include "math/vec.h"
#include "shading/compensation.h"

#include <string.h>

enum { CHOSEN_LIGHTS = 64 };

bool vplLookAt(const vplGeometry* g, const vplView* view, double x, double y, vplLitPoint* p)
{
    const double across = (2 * x / view->width - 1) / view->scaleX;
    const double upward = (1 - 2 * y / view->height) / view->scaleY;
    const vplVec3 d = vplAdd(view->forward,
                             vplAdd(vplScale((float)across, view->right), vplScale((float)upward, view->up)));
    const vplRay ray = {vplAdd(view->eye, vplScale((float)view->near, d)), d, {0, 0}};
    if (!vplGeometry_ClosestHit(g, &ray, &p->hit) || (double)p->hit.t > view->far - view->near) {
        return false;
    }
    const bool behind = vplDot(d, p->hit.normal) > 0;
    const vplVec3 shading = vplGeometry_ShadingNormal(g, &p->hit);
    p->plane = behind ? vplNegate(p->hit.normal) : p->hit.normal;
    p->shading = behind ? vplNegate(shading) : shading;
    return true;
}

static void setLane(const vplLitPoint* p, int l, vplSurface* surface, vplSurface* plane)
{
    const vplVec3 at = p->hit.position;
    surface->px[l] = plane->px[l] = at.x;
    surface->py[l] = plane->py[l] = at.y;
    surface->pz[l] = plane->pz[l] = at.z;
    surface->nx[l] = p->shading.x;
    surface->ny[l] = p->shading.y;
    surface->nz[l] = p->shading.z;
    plane->nx[l] = p->plane.x;
    plane->ny[l] = p->plane.y;
    plane->nz[l] = p->plane.z;
}

// Points first .. first + 15.
static void addBlock(const vplShading* s, int first, int count, vplClampLoss* sum)
{
    const vplGeometry* g = s->geometry;
    const vplCompensationDef* def = s->nearLight->def;
    const int hidden = def->seesEmission ? 0 : def->emitterLightCount; // that light only what rays meet
    const vplLightChoice all = {def->lights + hidden, def->lightCount - hidden, CHOSEN_LIGHTS, 0, 0};
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
        if (l < count && vplLookAt(g, s->view, (double)vplHalton(i + 1, 0) * s->view->width,
                                   (double)vplHalton(i + 1, 1) * s->view->height, &at[l])) {
            points.triangle[l] = at[l].hit.triangle;
            setLane(&at[l], l, &surface, &plane);
        }
    }
    vplAddNearLight(s, &points, pixels, lost, &rays);
    for (int l = 0; l < count; l++) {
        if (points.triangle[l] < 0) {
            continue;
        }
        const vplRgb rho = g->materials[g->triangleMaterials[points.triangle[l]]].diffuse;
        float left[3];
        vplLightPoint(s, s->nearLight, &all, &at[l], left, &rays);
        const float taken = rho.r * lost[0][l] + rho.g * lost[1][l] + rho.b * lost[2][l];
        sum->lost += (double)taken;
        sum->all += (double)(taken + rho.r * left[0] + rho.g * left[1] + rho.b * left[2]);
    }
}

vplResult vplEstimateClampLoss(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                               int pointCount, vplClampLoss* lossOut)
{
    vplShading shading = vplShading_Make(geometry, view, def);
    vplClampLoss sum = {0, 0};
    vplResult result = vplGeometry_PrepareRays(geometry);
    if (result == VPL_SUCCESS) {
        result = vplOpenNearLight(&shading);
    }
    for (int i = 0; i < pointCount && result == VPL_SUCCESS && shading.nearLight != NULL; i += VPL_LANES) {
        addBlock(&shading, i, pointCount - i < VPL_LANES ? pointCount - i : VPL_LANES, &sum);
    }
    vplCloseNearLight(&shading);
    if (result == VPL_SUCCESS) {
        *lossOut = sum;
    }
    return result;
}
