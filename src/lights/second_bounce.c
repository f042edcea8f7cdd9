// SPDX-License-Identifier: MIT
// Second-bounce lights of SSVP, and those of further bounces: samples of the clusters' paraboloid maps.
// Based on: Vitor Aranha, Marcio Macedo and Antonio Apolinario, Screen-Space Virtual Point Light Propagation
// for Real-Time Global Illumination, section II-B: evenly spread points of a cluster's paraboloid map.
// Departs: points of equal density on the disk do not share a diffuse light's flux equally, so each has the
// weight 4 (1 - p^2) / (1 + p^2)^3, whose mean over the disk is 1.
#include "base/arena.h"
#include "base/rng.h"
#include "geometry/paint.h"
#include "lights/light_set.h"
#include "math/sampling.h"
#include "math/vec.h"

enum { SECOND_BOUNCE_COOKIE = 0x56504c67, SHIFT_STREAM = 0x53424e01, MAX_STEPS = 64 };

vplSecondBounceDef vplDefaultSecondBounceDef(void)
{
    return (vplSecondBounceDef){256, VPL_SECOND_WEIGHT_COSINE, 0, 1, SECOND_BOUNCE_COOKIE};
}

typedef struct Sampling {
    const vplGeometry* geometry;
    const vplLightClusters* clusters;
    const vplParaboloidMaps* maps;
    const vplSecondBounceDef* def;
    vplLightSet* set;
    vplLightArrays arrays;
} Sampling;

static bool shines(const vplLightCluster* c)
{
    return c->lightCount > 0 && (c->flux.r > 0 || c->flux.g > 0 || c->flux.b > 0);
}

static float wrap(float x)
{
    return x < 1 ? x : x - 1;
}

// Point k of m on the disk. Each cluster shifts the points on the square, so that clusters do not have the
// same pattern; the first cluster's are as published unless the def shifts all.
static void pointOf(uint64_t shift, int cluster, int k, int m, float* x, float* y)
{
    float u = (float)((double)k / m), v = vplVanDerCorput((uint32_t)k);
    if (shift != 0 || cluster != 0) {
        const vplRandom4 r = vplRandomAt(shift, SHIFT_STREAM, (uint64_t)cluster);
        u = wrap(u + vplUnitFloat(r.v[0]));
        v = wrap(v + vplUnitFloat(r.v[1]));
    }
    vplSampleConcentricDisc(u, v, x, y);
}

// The column or row of a coordinate.
static int cellOf(float x, int size)
{
    const int at = (int)((x + 1) * 0.5f * (float)size);
    return at < size ? at : size - 1;
}

// The texel of a point. Next to the rim, where its own texel may have its centre outside the disk, one
// further in by up to half a diagonal.
static void texelOf(float x, float y, int size, int* column, int* row)
{
    const float r = sqrtf(x * x + y * y), most = fmaxf(1 - 1.4143f / (float)size, 0);
    const float scale = r > most ? most / r : 1;
    *column = cellOf(scale * x, size);
    *row = cellOf(scale * y, size);
}

// Takes one of the m samples of a cluster: it carries the cluster's whole flux times its weight; N / m
// accounts for the samples of other clusters.
static void takeSample(Sampling* s, int cluster, int k, int m, int particle)
{
    const vplParaboloidMap* map = &s->maps->maps[cluster];
    const vplRgb flux = s->clusters->clusters[cluster].flux;
    int column, row;
    float x, y;
    vplHit hit;
    vplVec3 direction;
    pointOf(s->def->shift, cluster, k, m, &x, &y);
    texelOf(x, y, map->size, &column, &row);
    if (!vplParaboloidMap_GetHit(map, s->geometry, (vplParaboloidTexel){0, column, row}, &hit, &direction)) {
        s->set->escaped++;
        return;
    }
    const double weight =
        s->def->weight == VPL_SECOND_WEIGHT_PRINTED ? 1 : vplParaboloid_Weight((double)x, (double)y);
    const vplFootprint footprint =
        vplUpright(s->geometry, hit.triangle, vplShareOfArea(s->geometry, s->def->count));
    const vplRgb albedo = vplGeometry_Reflectance(s->geometry, hit.triangle, hit.position, &footprint);
    const vplRgb light = vplRgbScale((float)weight, vplRgbMul(flux, albedo));
    if (light.r > 0 || light.g > 0 || light.b > 0) {
        s->arrays.lights[s->set->lightCount++] = (vplVirtualLight){
            .position = hit.position,
            .normal = vplDot(direction, hit.normal) > 0 ? vplNegate(hit.normal) : hit.normal,
            .light = light,
            .weight = (float)((double)s->set->particleCount / m),
            .step = s->def->step,
            .particle = particle,
            .object = hit.object};
    }
}

// Clusters that shine have equally many samples; the first ones have one more.
static void takeSamples(Sampling* s)
{
    int shining = 0, rank = 0, particle = 0;
    for (int i = 0; i < s->clusters->count; i++) {
        shining += shines(&s->clusters->clusters[i]);
    }
    for (int i = 0; i < s->clusters->count; i++) {
        if (shines(&s->clusters->clusters[i])) {
            const int m = s->def->count / shining + (rank++ < s->def->count % shining);
            for (int k = 0; k < m; k++) {
                takeSample(s, i, k, m, particle++);
            }
        }
    }
}

static vplResult check(const vplLightClusters* clusters, const vplParaboloidMaps* maps,
                       const vplSecondBounceDef* def)
{
    vplContext* context = maps->context;
    if (def->cookie != SECOND_BOUNCE_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplSecondBounceDef was not made by vplDefaultSecondBounceDef");
    }
    if (def->count < 0 || def->count > VPL_MAX_LIGHTS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplSecondBounceDef.count is %d, must be in [0, %d]",
                       def->count, VPL_MAX_LIGHTS);
    }
    if (def->step < 1 || def->step >= MAX_STEPS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplSecondBounceDef.step is %d, must be in [1, %d]",
                       def->step, MAX_STEPS - 1);
    }
    if (maps->count != clusters->count || maps->triangles == NULL) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "second-bounce lights of %d clusters need as many paraboloid maps, with triangles, not %d",
            clusters->count, maps->count);
    }
    return VPL_SUCCESS;
}

vplResult vplSampleParaboloidMaps(const vplGeometry* geometry, const vplLightClusters* clusters,
                                  const vplParaboloidMaps* maps, const vplSecondBounceDef* def,
                                  vplLightSet** setOut)
{
    REQUIRE(CONTEXT_OF(geometry) ?: CONTEXT_OF(clusters) ?: CONTEXT_OF(maps), geometry, clusters, maps, def,
            setOut);
    Sampling s = {.geometry = geometry, .clusters = clusters, .maps = maps, .def = def};
    TRY(check(clusters, maps, def));
    TRY(vplLightSet_Make(maps->context, def->count, def->step + 1, &s.arrays, &s.set));
    s.set->particleCount = def->count;
    takeSamples(&s);
    s.arrays.stepCounts[def->step] = def->count;
    s.arrays.lightsInStep[def->step] = s.set->lightCount;
    *setOut = s.set;
    return VPL_SUCCESS;
}
