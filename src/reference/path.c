// SPDX-License-Identifier: MIT
// Based on: James T. Kajiya, The Rendering Equation, SIGGRAPH 1986: a path from the eye is reflected by chance and
// gathers light at each vertex. Directions are drawn with the density of the reflected light, so a reflection only
// multiplies by rho. James Arvo and David Kirk, Particle Transport and Image Synthesis, SIGGRAPH 1990: Russian
// roulette. Nothing is clamped: rare bright paths stay, or the mean would be wrong.
#include "reference/path.h"
#include "base/rng.h"
#include "math/sampling.h"
#include "math/vec.h"

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

static vplPathVertex vertexAt(const vplPathScene* s, const vplHit* hit, vplVec3 direction)
{
    const vplGeometry* g = s->geometry;
    vplPathVertex v = {.hit = *hit, .normal = hit->normal, .shading = vplGeometry_ShadingNormal(g, hit)};
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

static void add(double sum[3], vplRgb weight, double r, double g, double b)
{
    sum[0] += weight.r * r;
    sum[1] += weight.g * g;
    sum[2] += weight.b * b;
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

// The bounces after the eye's first hit. Every picture follows the same paths, so that bounces add up exactly.
static void reflectOn(const vplPathScene* s, vplPathVertex vertex, const vplPathNumbers* numbers,
                      double sum[3], int64_t* rays)
{
    vplRgb throughput = {1, 1, 1};
    const bool area = s->trianglePower > 0;
    for (int bounce = 0; bounce <= s->def.lastBounce; bounce++) {
        const bool counts = bounce >= s->def.firstBounce, last = bounce == s->def.lastBounce;
        const uint32_t set =
            (uint32_t)(2 * bounce + 1); // and set + 1, where more than four numbers are needed
        float u[4];
        vplPathNumbers_Get(numbers, set, u);
        if (counts) {
            vplDirectLight d = vplSampleDirect(s, &vertex, u + 2, numbers, set + 1, rays);
            add(sum, throughput, d.r, d.g, d.b);
        }
        if (last && !area) {
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
        vplRgb emission = emissionAt(s, &hit, direction);
        if (counts && emission.r + emission.g + emission.b > 0) {
            double weight = vplWeightOfChance(s, &vertex, &hit, direction);
            add(sum, throughput, weight * emission.r, weight * emission.g, weight * emission.b);
        }
        vertex = vertexAt(s, &hit, direction);
    }
}

void vplFollowPath(const vplPathScene* scene, int x, int y, const vplPathNumbers* numbers, double sum[3],
                   int64_t* rays)
{
    const vplCameraDef* camera = scene->def.camera;
    float u[4];
    vplHit hit;
    vplPathNumbers_Get(numbers, 0, u);
    vplRay ray = cameraRay(scene, x, y, u);
    ++*rays;
    if (!vplGeometry_ClosestHit(scene->geometry, &ray, &hit) || (double)hit.t > camera->far - camera->near) {
        return;
    }
    if (scene->def.emission) {
        vplRgb emission = emissionAt(scene, &hit, ray.direction);
        add(sum, (vplRgb){1, 1, 1}, emission.r, emission.g, emission.b);
    }
    reflectOn(scene, vertexAt(scene, &hit, ray.direction), numbers, sum, rays);
}
