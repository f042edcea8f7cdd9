// SPDX-License-Identifier: MIT
// Based on: James T. Kajiya, The Rendering Equation, SIGGRAPH 1986: a path from the camera is reflected at
// random and gathers light at each vertex. Directions have the density of the reflected light, so a
// reflection only multiplies the throughput by rho. James Arvo and David Kirk, Particle Transport and Image
// Synthesis, SIGGRAPH 1990: Russian roulette. Nothing is clamped: without the rare bright paths the mean
// would be biased.
#include "base/context.h"
#include "math/sampling.h"
#include "math/vec.h"
#include "reference/light_path.h"

#include <float.h>

enum { CAMERA_SET, LIGHT_PATH_SET, FIRST_SET };

static void add(vplRadiance* sum, vplRgb throughput, vplRadiance light)
{
    vplRadiance_Add(sum, vplRadiance_Reflect(1, throughput, light));
}

// Russian roulette: false ends the path; surviving paths carry the light of those that end.
static bool survives(const vplPathState* path, uint32_t set, vplRgb* throughput)
{
    const float chance = vplPathScene_Survival(path->scene, *throughput);
    if (chance >= 1) {
        return true;
    }
    float u[4];
    vplPath_Draw(path, set, u);
    if (u[1] >= chance) {
        return false;
    }
    *throughput = vplRgbScale(1 / chance, *throughput);
    return true;
}

// Makes the next vertex, and adds the edge to it to the path's. Light paths leave `from` by the cosine of its normal, where paths from the
// camera leave it by that of the shading normal: this changes their densities on all earlier edges.
static vplPathVertex arrive(vplPathState* path, const vplPathVertex* from, const vplHit* hit,
                            vplVec3 direction)
{
    const vplPathScene* s = path->scene;
    vplPathVertex v = vplPathVertex_Make(s, hit, direction, VPL_BOUNCE_SPREAD * hit->t);
    const double flat = vplDot(direction, from->normal), cosine = vplDot(direction, from->shading);
    const double density = vplDensityOfReflection(cosine, -vplDot(direction, v.normal), hit->t);
    const double ratio = cosine > 0 ? vplHeuristic(s, flat / cosine) : 0, edge = vplHeuristic(s, 1 / density);
    for (int n = s->lightVertices; n > 0; n--) {
        path->edges[n] = fmin(ratio * path->edges[n - 1] + edge, DBL_MAX);
    }
    v.edges = path->edges[s->lightVertices];
    return v;
}

// Bounces between two questions whether the task goes on: less than a millisecond.
enum { BOUNCES_PER_QUESTION = 512 };

// Follows the bounces after the camera's first hit. The path is the same for every range of bounces, so that
// pictures of single bounces add up exactly.
static void followBounces(vplPathState* path, vplPathVertex vertex, const vplLightPath* light,
                          vplRadiance* sum)
{
    const vplPathScene* s = path->scene;
    vplRgb throughput = {1, 1, 1};
    for (int bounce = 0; bounce <= s->def.lastBounce; bounce++) {
        const uint32_t set = (uint32_t)(2 * bounce + FIRST_SET); // and the next, for more than four numbers
        const bool counts = bounce >= s->def.firstBounce, last = bounce == s->def.lastBounce;
        if (bounce % BOUNCES_PER_QUESTION == BOUNCES_PER_QUESTION - 1 &&
            !vplTask_GoesOn(s->geometry->context)) {
            return;
        }
        float u[4];
        vplPath_Draw(path, set, u);
        if (counts) {
            add(sum, throughput, vplSampleDirect(path, &vertex, u + 2, set + 1));
        }
        if (light->count > 0 && !last && bounce + light->count >= s->def.firstBounce) {
            add(sum, throughput, vplConnectToLightPath(path, &vertex, light, bounce, throughput));
        }
        if (last && s->trianglePower <= 0 && s->geometry->environment == NULL) {
            return;
        }
        throughput = vplRgbMul(throughput, vertex.rho);
        vplVec3 direction = vplSampleCosineAround(vertex.shading, u[0], u[1]);
        if (!(vplDot(direction, vertex.normal) > 0) || !survives(path, set + 1, &throughput)) {
            return;
        }
        vplRay ray = vplGeometry_Leave(s->geometry, &vertex.hit, direction);
        vplHit hit;
        path->rays++;
        if (!vplGeometry_ClosestHit(s->geometry, &ray, &hit)) {
            if (counts) {
                add(sum, throughput, vplMissEmission(s, &vertex, direction));
            }
            return;
        }
        if (counts) {
            add(sum, throughput, vplHitEmission(s, &vertex, &hit, direction));
        }
        vertex = arrive(path, &vertex, &hit, direction);
    }
}

void vplPath_Follow(vplPathState* path, int x, int y, vplRadiance* sum)
{
    const vplPathScene* s = path->scene;
    const vplCameraDef* camera = &s->camera;
    float u[4], start[4];
    vplHit hit;
    vplPath_Draw(path, CAMERA_SET, u);
    vplRay ray = vplPathScene_CameraRay(s, x, y, u);
    path->rays++;
    if (!vplGeometry_ClosestHit(s->geometry, &ray, &hit) ||
        (double)hit.t > camera->farPlane - camera->nearPlane) {
        if (s->def.emission && s->geometry->environment != NULL) {
            const vplVec3 sight = vplNormalize(ray.direction);
            vplRadiance_Add(sum, vplRadiance_Of(vplEnvironment_Radiance(s->geometry->environment, sight)));
        }
        return;
    }
    if (s->def.emission) {
        vplRadiance_Add(sum, vplRadiance_Of(vplPathScene_EmissionAt(s, &hit, ray.direction)));
    }
    vplLightPath light;
    light.count = 0;
    if (s->lightVertices > 0) {
        vplPath_Draw(path, LIGHT_PATH_SET, start);
        vplLightPath_Follow(path, (double)u[2], start, &light);
    }
    // Paths average over the pixel themselves: each looks up half of its width.
    const float width = 0.5f * s->pixelWidth * (hit.t + (float)camera->nearPlane);
    followBounces(path, vplPathVertex_Make(s, &hit, ray.direction, width), &light, sum);
}
