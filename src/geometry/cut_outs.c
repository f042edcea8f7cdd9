// SPDX-License-Identifier: MIT
// Based on: Eric Enderton, Erik Sintorn, Peter Shirley and David Luebke, Stochastic Transparency, I3D 2010 (a surface of
// opacity a stops a ray with probability a); Chris Wyman and Morgan McGuire, Hashed Alpha Testing, I3D 2017 (the random
// number is a hash of the position). Departs: the bits of the position are hashed, because pictures need not be alike
// from frame to frame; shadow rays multiply the shares that are let through, which has no noise.
#include "geometry/cut_outs.h"

#include "base/arena.h"
#include "base/rng.h"
#include "geometry/object_build.h"
#include "geometry/paint_data.h"
#include "geometry/trace.h"
#include "geometry/triangle.h"
#include "scene/texture.h"

#include <string.h>

enum {
    MOST_LAYERS = 1024,       // that a ray goes through; it ends at the last
    HASH_STREAM = 0x616c7068, // of random numbers
    SIDE = 8                  // of a square of points that are averaged
};

// ---- opacity

bool vplIsCutOut(const vplMaterialDef* m)
{
    return m->opacity < 1 || m->alphaTexture >= 0 || m->alphaFromTexture;
}

bool vplScene_HasCutOuts(const vplScene* scene)
{
    bool any = false;
    for (int i = 0; i < vplScene_GetMaterialCount(scene); i++) {
        any = any || vplIsCutOut(vplScene_GetMaterial(scene, i));
    }
    return any;
}

static void lookUp(const vplGeometry* g, int texture, const vplTexturedTriangle* t, const double w[3],
                   float rgbaOut[4])
{
    const vplTextureArea point = {.u = w[0] * t->u[0] + w[1] * t->u[1] + w[2] * t->u[2],
                                  .v = w[0] * t->v[0] + w[1] * t->v[1] + w[2] * t->v[2]};
    vplTexture_Lookup(g->paint->textures[texture], &point, rgbaOut);
}

float vplGeometry_Opacity(const vplGeometry* g, int triangle, vplVec3 point)
{
    const vplMaterialDef* m = &g->materials[g->triangleMaterials[triangle]];
    float opacity = m->opacity;
    if (m->alphaTexture >= 0 || m->alphaFromTexture) {
        const vplTriangleCorners corners = vplGeometry_Corners(g, triangle);
        const vplTexturedTriangle t = vplPaint_Corners(g, triangle);
        double w[3];
        float rgba[4];
        vplTriangle_Barycentrics(corners.corner, point, w);
        if (m->alphaFromTexture) {
            lookUp(g, m->texture, &t, w, rgba);
            opacity *= rgba[3];
        }
        if (m->alphaTexture >= 0) {
            lookUp(g, m->alphaTexture, &t, w, rgba);
            opacity *= (rgba[0] + rgba[1] + rgba[2]) / 3;
        }
    }
    return m->alphaCutoff > 0 ? (opacity >= m->alphaCutoff ? 1.0f : 0.0f) : opacity;
}

float vplGeometry_MeanOpacity(const vplGeometry* g, int triangle, const vplVec3 corners[3])
{
    float sum = 0;
    if (g->cutOuts == NULL || !g->cutOuts->is[triangle]) {
        return 1;
    }
    for (int i = 0; i < SIDE * SIDE; i++) { // a square folded along its diagonal
        float u = ((float)(i % SIDE) + 0.5f) / SIDE, v = ((float)(i / SIDE) + 0.25f) / SIDE;
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        const vplVec3 along = vplScale(u, vplSub(corners[1], corners[0]));
        const vplVec3 across = vplScale(v, vplSub(corners[2], corners[0]));
        sum += vplGeometry_Opacity(g, triangle, vplAdd(corners[0], vplAdd(along, across)));
    }
    return sum / (SIDE * SIDE);
}

// A number in [0, 1) by the bits of the hit's position.
static float chanceAt(const vplHit* hit)
{
    uint32_t counter[4] = {0, 0, 0, (uint32_t)hit->triangle};
    memcpy(counter, &hit->position, sizeof hit->position);
    return vplUnitFloat(vplPhilox(counter, HASH_STREAM, 0).v[0]);
}

// A number in [0, 1); those of the rays of a pixel are evenly spaced.
static float chanceOf(const vplPixelRay* ray, const vplHit* hit)
{
    const uint32_t counter[4] = {ray->pixel[0], ray->pixel[1], (uint32_t)hit->object, HASH_STREAM};
    const float u = vplUnitFloat(vplPhilox(counter, HASH_STREAM, 1).v[0]) + ray->rank;
    return u < 1 ? u : u - 1;
}

// ---- rays

// The next cut-out along a ray. On success *at becomes its distance from where the ray first started, and *ray goes on
// behind it.
static bool nextLayer(const vplGeometry* g, vplRay* ray, float tMax, float* at, vplHit* hit)
{
    vplRawHit raw;
    vplTraceOneTree(g->cutOuts->tree, g->context->isa, ray, tMax - *at, &raw);
    if (raw.triangle < 0) {
        return false;
    }
    *hit = vplFinishHit(g, ray, &raw);
    *at += hit->t;
    *ray = vplGeometry_Leave(g, hit, ray->direction);
    hit->t = *at;
    return *at < tMax;
}

// The first layer that stops the ray; `seen` is NULL or the ray as one of a pixel.
static bool findStop(const vplGeometry* g, const vplRay* ray, const vplPixelRay* seen, float tMax,
                     vplHit* hitOut)
{
    vplRay rest = *ray;
    vplHit hit;
    float at = 0;
    for (int i = 0; i < MOST_LAYERS && nextLayer(g, &rest, tMax, &at, &hit); i++) {
        const float opacity = vplGeometry_Opacity(g, hit.triangle, hit.position);
        if (opacity >= 1 ||
            (opacity > 0 && (seen != NULL ? chanceOf(seen, &hit) : chanceAt(&hit)) < opacity)) {
            *hitOut = hit;
            return true;
        }
    }
    return false;
}

bool vplCutOuts_ClosestHit(const vplGeometry* g, const vplRay* ray, float tMax, vplHit* hitOut)
{
    return findStop(g, ray, NULL, tMax, hitOut);
}

bool vplCutOuts_FindSeen(const vplGeometry* g, const vplPixelRay* ray, float tMax, vplHit* hitOut)
{
    return findStop(g, &ray->ray, ray, tMax, hitOut);
}

float vplCutOuts_Transmittance(const vplGeometry* g, const vplRay* ray, float tMax)
{
    vplRay rest = *ray;
    vplHit hit;
    float at = 0, share = 1;
    for (int i = 0; i < MOST_LAYERS && share > 0 && nextLayer(g, &rest, tMax, &at, &hit); i++) {
        share *= 1 - vplGeometry_Opacity(g, hit.triangle, hit.position);
    }
    return share;
}

void vplCutOuts_Veil(const vplGeometry* g, const vplRayPacket* rays, float tMax, float amount[VPL_RAY_PACKET])
{
    for (uint32_t active = rays->active; active != 0; active &= active - 1) {
        const int lane = __builtin_ctz(active);
        if (amount[lane] > 0) {
            const vplRay ray = vplRayPacket_Get(rays, lane);
            amount[lane] *= vplCutOuts_Transmittance(g, &ray, tMax);
        }
    }
}

// ---- building

// The geometry of cut-outs alone: `solid`, the inverse of the mask, leaves the others out.
typedef struct Inverse {
    vplGeometry geometry;
    vplCutOuts others;
    uint8_t* solid;
} Inverse;

static vplResult invert(const vplGeometry* g, const uint8_t* is, Inverse* inverseOut)
{
    uint8_t* solid = vplAlloc(g->context, (size_t)g->triangleCount, 1);
    if (solid == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < g->triangleCount; i++) {
        solid[i] = !is[i];
    }
    *inverseOut = (Inverse){.geometry = *g, .others = {.is = solid}, .solid = solid};
    inverseOut->geometry.cutOuts = &inverseOut->others;
    return VPL_SUCCESS;
}

static vplResult buildTree(const vplGeometry* g, const uint8_t* is, vplBvh** treeOut)
{
    Inverse inverse;
    TRY(invert(g, is, &inverse));
    const vplResult result = vplBvh_Create(&inverse.geometry, VPL_BRUTE_BLOCKS, false, treeOut);
    vplFree(g->context, inverse.solid);
    return result;
}

// Those of all triangles, where cut-outs have no area.
static void fillIndices(const vplGeometry* g, const uint8_t* is, uint32_t* indices)
{
    memcpy(indices, g->indices, 3 * (size_t)g->triangleCount * sizeof *indices);
    for (size_t i = 0; i < (size_t)g->triangleCount; i++) {
        if (is[i]) {
            indices[3 * i + 1] = indices[3 * i + 2] = indices[3 * i];
        }
    }
}

vplResult vplBuildCutOuts(vplGeometry* g)
{
    bool any = false;
    for (int i = 0; i < g->triangleCount && !any; i++) {
        any = vplIsCutOut(&g->materials[g->triangleMaterials[i]]);
    }
    if (!any) {
        return VPL_SUCCESS;
    }
    const size_t count = (size_t)g->triangleCount;
    vplArena* arena = vplArena_Create(g->context);
    vplCutOuts* c = vplArena_AllocZero(arena, 1, sizeof *c);
    uint8_t* is = vplArena_Alloc(arena, count, 1);
    uint32_t* indices = vplArena_Alloc(arena, 3 * count, sizeof *indices);
    vplBvh* tree = NULL;
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        for (size_t i = 0; i < count; i++) {
            is[i] = vplIsCutOut(&g->materials[g->triangleMaterials[i]]);
        }
        fillIndices(g, is, indices);
        result = buildTree(g, is, &tree);
        *c = (vplCutOuts){is, indices, tree, arena};
    }
    return vplArena_Deliver(arena, result, c, &g->cutOuts);
}

void vplCutOuts_Destroy(const vplCutOuts* cutOuts)
{
    if (cutOuts != NULL) {
        vplBvh_Destroy(cutOuts->tree);
        vplArena_Destroy(cutOuts->arena);
    }
}

// ---- updates

static vplResult refit(const vplGeometry* g, const uint8_t* changes, bool* goodOut)
{
    Inverse inverse;
    TRY(invert(g, g->cutOuts->is, &inverse));
    *goodOut = vplBvh_Refit(g->cutOuts->tree, &inverse.geometry, changes);
    vplFree(g->context, inverse.solid);
    return VPL_SUCCESS;
}

vplResult vplUpdateCutOuts(vplGeometry* g, const uint8_t* changes, bool* solidOut)
{
    const vplCutOuts* c = g->cutOuts;
    bool same = true, moved = false;
    for (int i = 0; i < g->triangleCount; i++) {
        const bool is = vplIsCutOut(&g->materials[g->triangleMaterials[i]]);
        same = same && is == (c != NULL && c->is[i]);
        moved = moved || (is && (changes[g->owners[i]] & VPL_OBJECT_MOVED) != 0);
    }
    *solidOut = !same;
    if (same && c != NULL) {
        fillIndices(g, c->is, (uint32_t*)c->indices);
        if (moved) {
            TRY(refit(g, changes, &same));
        }
    }
    if (same) {
        return VPL_SUCCESS;
    }
    vplCutOuts_Destroy(c);
    g->cutOuts = NULL;
    return vplBuildCutOuts(g);
}
