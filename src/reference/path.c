// SPDX-License-Identifier: MIT
// Based on: James T. Kajiya, The Rendering Equation, SIGGRAPH 1986: a path from the eye is reflected by chance and
// gathers light at each vertex. Directions are drawn with the density of the reflected light, so a reflection only
// multiplies by rho. James Arvo and David Kirk, Particle Transport and Image Synthesis, SIGGRAPH 1990: Russian
// roulette. Nothing is clamped: rare bright paths stay, or the mean would be wrong.
#include "reference/path.h"
#include "base/rng.h"
#include "math/sampling.h"
#include "math/vec.h"

enum { CAMERA_SET, PARTICLE_SET, FIRST_SET };

void vplPathNumbers_Get(const vplPathNumbers* numbers, uint32_t set, float out[4])
{
    const vplPathScene* s = numbers->scene;
    if (!s->def.random) {
        vplSobol_Sample(&s->sobol, s->def.seed, numbers->stream, set, numbers->index, out);
        return;
    }
    const uint32_t counter[4] = {(uint32_t)numbers->stream, (uint32_t)(numbers->stream >> 32), set,
                                 numbers->index};
    vplRandom4 r = vplPhilox(counter, (uint32_t)s->def.seed, (uint32_t)(s->def.seed >> 32));
    for (int i = 0; i < 4; i++) {
        out[i] = vplUnitFloat(r.v[i]);
    }
}

// From the near plane; t counts the depth beyond it, so that t < far - near is what the camera sees.
static vplRay cameraRay(const vplPathScene* s, int x, int y, const float offset[2])
{
    const vplCameraDef* camera = s->def.camera;
    // A hair right of and below the centre: an edge through it belongs to the surface that the rasterizer's
    // top-left rule gives it to. In a symmetric room whole rows of centres lie on edges.
    double px = x + (s->def.pixelCentres ? 0.5 + 0x1p-10 : (double)offset[0]);
    double py = y + (s->def.pixelCentres ? 0.5 + 0x1p-12 : (double)offset[1]);
    double across = s->scaleX * (2 * px / s->def.width - 1);
    double upward = s->scaleY * (1 - 2 * py / s->def.height);
    double d[3] = {s->forward.x + across * s->right.x + upward * s->up.x,
                   s->forward.y + across * s->right.y + upward * s->up.y,
                   s->forward.z + across * s->right.z + upward * s->up.z};
    vplRay ray = {.direction = vplVec((float)d[0], (float)d[1], (float)d[2])};
    ray.origin =
        vplVec((float)(camera->eye.x + camera->near * d[0]), (float)(camera->eye.y + camera->near * d[1]),
               (float)(camera->eye.z + camera->near * d[2]));
    return ray;
}

vplPathVertex vplPathVertex_Make(const vplPathScene* s, const vplHit* hit, vplVec3 direction)
{
    const vplGeometry* g = s->geometry;
    vplPathVertex v = {.hit = *hit,
                       .normal = hit->normal,
                       .shading = vplGeometry_ShadingNormal(g, hit),
                       .density = INFINITY};
    v.rho = g->materials[g->triangleMaterials[hit->triangle]].diffuse;
    if (vplDot(direction, hit->normal) > 0) {
        v.normal = vplNegate(v.normal);
        v.shading = vplNegate(v.shading);
    }
    return v;
}

static vplRgb emissionAt(const vplPathScene* s, const vplHit* hit, vplVec3 direction)
{
    const vplGeometry* g = s->geometry;
    return vplDot(direction, hit->normal) < 0 ? g->materials[g->triangleMaterials[hit->triangle]].emission
                                              : (vplRgb){0, 0, 0};
}

static void add(double sum[3], vplRgb weight, vplLight3 light)
{
    sum[0] += weight.r * light.r;
    sum[1] += weight.g * light.g;
    sum[2] += weight.b * light.b;
}

// Whether a path goes on; those that do carry the light of those that do not.
static bool survives(const vplPathScene* s, const vplPathNumbers* numbers, uint32_t set, vplRgb* throughput)
{
    float most = fmaxf(throughput->r, fmaxf(throughput->g, throughput->b));
    float chance = most / (float)s->def.rouletteFrom;
    if (chance >= 1) {
        return true;
    }
    float u[4];
    vplPathNumbers_Get(numbers, set, u);
    if (u[1] >= chance) {
        return false;
    }
    *throughput = vplRgbScale(1 / chance, *throughput);
    return true;
}

// Emission that the path has met by itself after leaving `from`.
static vplLight3 meetEmission(const vplPathScene* s, const vplPathVertex* from, const vplHit* hit,
                              vplVec3 direction)
{
    vplRgb emission = emissionAt(s, hit, direction);
    if (emission.r + emission.g + emission.b <= 0) {
        return (vplLight3){0, 0, 0};
    }
    vplLightPoint light = {-1, hit->triangle, hit->position, hit->normal};
    vplLightWay way = vplFindWay(s, from, &light);
    double weight = vplWeightOfChance(s, &way);
    return (vplLight3){weight * emission.r, weight * emission.g, weight * emission.b};
}

// The next vertex, with the density that the reflection had of leading there.
static vplPathVertex arrive(const vplPathScene* s, const vplPathVertex* from, const vplHit* hit,
                            vplVec3 direction)
{
    vplPathVertex v = vplPathVertex_Make(s, hit, direction);
    double cosines = (double)vplDot(direction, from->shading) * -(double)vplDot(direction, v.normal);
    v.density = cosines / (VPL_PI * hit->t * hit->t);
    return v;
}

// The bounces after the eye's first hit. Every picture follows the same paths, so that bounces add up exactly.
static void reflectOn(const vplPathScene* s, vplPathVertex vertex, const vplLanding* landing,
                      const vplPathNumbers* numbers, double sum[3], int64_t* rays)
{
    vplRgb throughput = {1, 1, 1};
    for (int bounce = 0; bounce <= s->def.lastBounce; bounce++) {
        const uint32_t set =
            (uint32_t)(2 * bounce + FIRST_SET); // and the next, where four numbers are not enough
        const bool counts = bounce >= s->def.firstBounce, last = bounce == s->def.lastBounce;
        float u[4];
        vplPathNumbers_Get(numbers, set, u);
        if (counts) {
            add(sum, throughput, vplSampleDirect(s, &vertex, u + 2, numbers, set + 1, rays));
        }
        if (landing->landed && !last && bounce + 1 >= s->def.firstBounce) {
            add(sum, throughput, vplConnect(s, &vertex, landing, rays));
        }
        if (last && s->trianglePower <= 0) {
            return;
        }
        throughput = vplRgbMul(throughput, vertex.rho);
        vplVec3 direction = vplSampleCosineAround(vertex.shading, u[0], u[1]);
        if (!(vplDot(direction, vertex.normal) > 0) || !survives(s, numbers, set + 1, &throughput)) {
            return;
        }
        vplRay ray = vplGeometry_Leave(s->geometry, &vertex.hit, direction);
        vplHit hit;
        ++*rays;
        if (!vplGeometry_ClosestHit(s->geometry, &ray, &hit)) {
            return;
        }
        if (counts) {
            add(sum, throughput, meetEmission(s, &vertex, &hit, direction));
        }
        vertex = arrive(s, &vertex, &hit, direction);
    }
}

void vplFollowPath(const vplPathScene* scene, int x, int y, const vplPathNumbers* numbers, double sum[3],
                   int64_t* rays)
{
    const vplCameraDef* camera = scene->def.camera;
    float u[4], start[4];
    vplHit hit;
    vplPathNumbers_Get(numbers, CAMERA_SET, u);
    vplRay ray = cameraRay(scene, x, y, u);
    ++*rays;
    if (!vplGeometry_ClosestHit(scene->geometry, &ray, &hit) || (double)hit.t > camera->far - camera->near) {
        return;
    }
    if (scene->def.emission) {
        vplRgb emission = emissionAt(scene, &hit, ray.direction);
        add(sum, (vplRgb){1, 1, 1}, (vplLight3){emission.r, emission.g, emission.b});
    }
    vplLanding landing = {.landed = false};
    if (scene->def.ways & VPL_PATH_PARTICLES && scene->def.lastBounce > 0) {
        vplPathNumbers_Get(numbers, PARTICLE_SET, start);
        landing = vplShootParticle(scene, (double)u[2], start, rays);
    }
    reflectOn(scene, vplPathVertex_Make(scene, &hit, ray.direction), &landing, numbers, sum, rays);
}
