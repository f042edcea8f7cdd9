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

// The first index of the sets that guided paths draw.
enum { GUIDE_SETS = 1 << 29 };

static void add(vplRadiance* sum, vplRgb throughput, vplRadiance light)
{
    vplRadiance_Add(sum, vplRadiance_Reflect(1, throughput, light));
}

// Russian roulette: false ends the path; surviving paths carry the light of those that end. The throughput of guided paths is small where much
// light comes from, so that it would end them there. Theirs is decided by what surfaces have reflected of it.
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

// Adds the edge between two vertices to the path's. Light paths leave `from` by the cosine of its normal, where paths from the camera leave it by
// that of the shading normal or as the guide says: this changes their densities on all earlier edges. Returns the density of the diffuse
// reflection over that of the path.
static inline __attribute__((always_inline)) double addEdge(vplPathState* path, const vplPathVertex* from,
                                                            vplPathVertex* to, vplVec3 direction, bool guided)
{
    const vplPathScene* s = path->scene;
    const double flat = vplDot(direction, from->normal), cosine = vplDot(direction, from->shading);
    const double reflection = vplDensityOfReflection(cosine, -vplDot(direction, to->normal), to->hit.t);
    const double density = guided ? vplPathVertex_Density(s, from, to->place, reflection) : reflection;
    const double share = !guided ? 1 : density > 0 ? reflection / density : 0;
    const double ratio = cosine > 0 ? vplHeuristic(s, flat / cosine * share) : 0,
                 edge = vplHeuristic(s, 1 / density);
    for (int n = s->lightVertices; n > 0; n--) {
        path->edges[n] = fmin(ratio * path->edges[n - 1] + edge, DBL_MAX);
    }
    to->edges = path->edges[s->lightVertices];
    return share;
}

// Where a path goes from a vertex.
typedef struct Way {
    vplVec3 direction;
    vplGuidePoint to; // `place` is negative where the path is reflected
} Way;

// Chooses where the path goes; false if that is nowhere. u: for a reflection.
static inline __attribute__((always_inline)) bool chooseWay(const vplPathState* path, const vplPathVertex* v,
                                                            int bounce, const float u[2], bool guided,
                                                            Way* way)
{
    way->to.place = -1;
    if (guided && v->guided > 0) {
        const vplPathGuide* guide = path->scene->def.guide;
        float g[4];
        vplPath_Draw(path, (uint32_t)(GUIDE_SETS + bounce), g);
        if ((double)g[0] < v->guided) {
            way->to = guide->choose(guide->data, v->place, g + 1);
            way->direction = vplNormalize(vplSub(way->to.position, v->hit.position));
            return vplDot(way->direction, v->normal) > 0 && vplDot(way->direction, v->shading) > 0;
        }
    }
    way->direction = vplSampleCosineAround(v->shading, u[0], u[1]);
    return vplDot(way->direction, v->normal) > 0;
}

// Returns false where another surface hides the chosen point: the guide's density is that of visible points only.
static bool isReached(const Way* way, const vplPathVertex* v)
{
    return way->to.place < 0 || (v->place == way->to.place && v->hit.triangle == way->to.triangle);
}

// Bounces between two questions whether the task goes on: less than a millisecond.
enum { BOUNCES_PER_QUESTION = 512 };

// Follows the bounces after the camera's first hit. The path is the same for every range of bounces, so that
// pictures of single bounces add up exactly.
static inline __attribute__((always_inline)) void followBounces(vplPathState* path, vplPathVertex vertex,
                                                                const vplLightPath* light, bool guided,
                                                                vplRadiance* sum)
{
    const vplPathScene* s = path->scene;
    vplRgb throughput = {1, 1, 1};
    double share = 1; // of guided paths: what the throughput is multiplied by besides
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
            add(sum, guided ? vplRgbScale((float)share, throughput) : throughput,
                vplSampleDirect(path, &vertex, u + 2, set + 1));
        }
        if (light->count > 0 && !last && bounce + light->count >= s->def.firstBounce) {
            add(sum, guided ? vplRgbScale((float)share, throughput) : throughput,
                vplConnectToLightPath(path, &vertex, light, bounce, throughput));
        }
        if (last && s->trianglePower <= 0 && s->geometry->environment == NULL) {
            return;
        }
        throughput = vplRgbMul(throughput, vertex.rho);
        Way way;
        if (!chooseWay(path, &vertex, bounce, u, guided, &way) || !survives(path, set + 1, &throughput)) {
            return;
        }
        vplRay ray = vplGeometry_Leave(s->geometry, &vertex.hit, way.direction);
        vplHit hit;
        path->rays++;
        if (!vplGeometry_ClosestHit(s->geometry, &ray, &hit)) {
            if (counts && way.to.place < 0) {
                share = guided ? share / (1 - vertex.guided) : share;
                add(sum, guided ? vplRgbScale((float)share, throughput) : throughput,
                    vplMissEmission(s, &vertex, way.direction));
            }
            return;
        }
        const vplPathVertex from = vertex;
        vertex = vplPathVertex_Make(s, &hit, way.direction, VPL_BOUNCE_SPREAD * hit.t);
        if (guided) {
            vplPathVertex_Locate(s, &vertex, way.direction);
        }
        if (guided && !isReached(&way, &vertex)) {
            return;
        }
        share *= addEdge(path, &from, &vertex, way.direction, guided);
        if (counts) {
            add(sum, guided ? vplRgbScale((float)share, throughput) : throughput,
                vplHitEmission(s, &from, &hit, way.direction));
        }
    }
}

// Guided paths are compiled as a function of their own, so that the guide costs other paths no time.
static __attribute__((noinline)) void followGuided(vplPathState* path, vplPathVertex vertex,
                                                   vplVec3 direction, const vplLightPath* light,
                                                   vplRadiance* sum)
{
    vplPathVertex_Locate(path->scene, &vertex, direction);
    followBounces(path, vertex, light, true, sum);
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
    const vplPathVertex vertex = vplPathVertex_Make(s, &hit, ray.direction, width);
    if (s->def.guide != NULL) {
        followGuided(path, vertex, ray.direction, &light, sum);
    } else {
        followBounces(path, vertex, &light, false, sum);
    }
}
