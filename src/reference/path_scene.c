// SPDX-License-Identifier: MIT
#include "reference/path_scene.h"
#include "base/rng.h"
#include "math/scalar.h"
#include "math/vec.h"

vplPathDef vplDefaultPathDef(void)
{
    // rouletteFrom: least variance for the time in rooms (bench/path).
    return (vplPathDef){.lastBounce = 1 << 16,
                        .mostBounces = 1 << 16,
                        .emission = true,
                        .techniques = VPL_PATH_ALL,
                        .lightVertices = 1,
                        .rouletteFrom = 0.25,
                        .emittersOfTree = VPL_PATH_EMITTERS_OF_TREE,
                        .trianglesOfTree = VPL_PATH_TRIANGLES_OF_TREE};
}

void vplPathScene_Free(vplPathScene* s)
{
    vplEmitterTrees_Destroy(s->ownTrees);
    s->ownTrees = NULL;
    s->trees = NULL;
    s->emission = NULL;
}

static vplResult findTrees(vplPathScene* s)
{
    s->trees = s->def.trees;
    if (s->trees == NULL) {
        const vplTreesWanted wanted = {s->def.emittersOfTree, s->def.trianglesOfTree};
        TRY(vplEmitterTrees_Create(s->geometry, s->def.emitters, s->def.emitterCount, wanted, &s->ownTrees));
        s->trees = s->ownTrees;
    }
    s->emission = s->trees->emission;
    return VPL_SUCCESS;
}

vplResult vplPathScene_Init(vplPathScene* s, const vplGeometry* geometry, const vplPathDef* def)
{
    *s = (vplPathScene){.geometry = geometry, .def = *def, .camera = *def->camera, .sobol = vplSobol_Make()};
    const vplCameraDef* camera = &s->camera;
    double sine, cosine;
    vplSinCos(camera->fovY / 2, &sine, &cosine);
    s->forward = vplNormalize(vplSub(camera->target, camera->eye));
    s->right = vplNormalize(vplCross(s->forward, camera->up));
    s->up = vplCross(s->right, s->forward);
    s->scaleY = sine / cosine;
    s->pixelWidth = (float)(2 * s->scaleY / def->height);
    s->scaleX = s->scaleY * def->width / def->height;
    const bool wanted = def->techniques & VPL_PATH_PARTICLES && def->lastBounce > 0;
    s->lightVertices = !wanted                                 ? 0
                       : def->lightVertices < def->mostBounces ? def->lightVertices
                                                               : def->mostBounces;
    TRY(findTrees(s));
    s->def.camera = NULL;
    s->def.emitters = NULL;
    s->power = vplEmission_Power(s->emission);
    if (s->emission->environment >= 0) {
        const double* sums = s->emission->cumulative + s->emission->environment;
        s->skyShare = (sums[1] - sums[0]) / s->power / (VPL_PI * s->emission->radius * s->emission->radius);
    }
    s->trianglePower = s->power - s->emission->cumulative[s->emission->firstTriangle];
    return VPL_SUCCESS;
}

void vplPath_Draw(const vplPathState* path, uint32_t set, float out[4])
{
    const vplPathScene* s = path->scene;
    if (!s->def.random) {
        vplSobol_Sample(&s->sobol, s->def.seed, path->stream, set, path->index, out);
        return;
    }
    const uint32_t counter[4] = {(uint32_t)path->stream, (uint32_t)(path->stream >> 32), set, path->index};
    vplRandom4 r = vplPhilox(counter, (uint32_t)s->def.seed, (uint32_t)(s->def.seed >> 32));
    for (int i = 0; i < 4; i++) {
        out[i] = vplUnitFloat(r.v[i]);
    }
}

vplRay vplPathScene_CameraRay(const vplPathScene* s, int x, int y, const float offset[2])
{
    const vplCameraDef* camera = &s->camera;
    // Pixel centres are moved slightly right and down, so that an edge through a centre belongs to the
    // surface that the rasterizer's top-left rule gives it to. In a symmetric room whole rows of centres lie
    // on edges.
    double px = x + (s->def.pixelCentres ? 0.5 + 0x1p-10 : (double)offset[0]);
    double py = y + (s->def.pixelCentres ? 0.5 + 0x1p-12 : (double)offset[1]);
    double across = s->scaleX * (2 * px / s->def.width - 1);
    double upward = s->scaleY * (1 - 2 * py / s->def.height);
    double d[3] = {s->forward.x + across * s->right.x + upward * s->up.x,
                   s->forward.y + across * s->right.y + upward * s->up.y,
                   s->forward.z + across * s->right.z + upward * s->up.z};
    vplRay ray = {.direction = vplVec((float)d[0], (float)d[1], (float)d[2])};
    ray.origin = vplVec((float)(camera->eye.x + camera->nearPlane * d[0]),
                        (float)(camera->eye.y + camera->nearPlane * d[1]),
                        (float)(camera->eye.z + camera->nearPlane * d[2]));
    return ray;
}

// Not inlined: inside vplPathVertex_Make it costs scenes without textures saved registers.
static __attribute__((noinline)) vplRgb paintAt(const vplGeometry* g, const vplHit* hit, vplVec3 direction,
                                                float width)
{
    const vplFootprint footprint = {vplNormalize(direction), width};
    return vplPaint_Reflectance(g, hit->triangle, hit->position, &footprint);
}

vplPathVertex vplPathVertex_Make(const vplPathScene* s, const vplHit* hit, vplVec3 direction, float width)
{
    const vplGeometry* g = s->geometry;
    vplPathVertex v = {
        .hit = *hit, .normal = hit->normal, .shading = vplGeometry_ShadingNormal(g, hit), .place = -1};
    v.rho = g->paint == NULL ? g->materials[g->triangleMaterials[hit->triangle]].diffuse
                             : paintAt(g, hit, direction, width);
    if (vplDot(direction, hit->normal) > 0) {
        v.normal = vplNegate(v.normal);
        v.shading = vplNegate(v.shading);
    }
    return v;
}

void vplPathVertex_Locate(const vplPathScene* s, vplPathVertex* v, vplVec3 direction)
{
    const vplPathGuide* g = s->def.guide;
    v->place = g->find(g->data, &v->hit, direction);
    v->guided = v->place >= 0 && g->knows(g->data, v->place) ? VPL_GUIDED_SHARE : 0;
}

vplRgb vplPathScene_EmissionAt(const vplPathScene* s, const vplHit* hit, vplVec3 direction)
{
    const vplGeometry* g = s->geometry;
    return vplDot(direction, hit->normal) < 0 ? g->materials[g->triangleMaterials[hit->triangle]].emission
                                              : (vplRgb){0, 0, 0};
}
