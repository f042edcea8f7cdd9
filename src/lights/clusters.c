// SPDX-License-Identifier: MIT
// Clusters of lights that share one paraboloid map.
// Based on: Aranha, Macedo and Apolinario, Screen-Space Virtual Point Light Propagation, section II-A,
// equation 2; Dong, Grosch, Ritschel, Kautz and Seidel, Real-time Indirect Illumination with Clustered
// Visibility, VMV 2009.
// Departs: the normal term, which as printed keeps equal normals apart.
#include "lights/clusters.h"

#include "base/arena.h"
#include "math/scalar.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { CLUSTER_COOKIE = 0x56504c90 };

// Largest distance of a flat cluster's lights from its plane, in diagonals of the box around all lights; also
// the largest difference of normals.
static const double FLAT = 1e-4;

vplClusterDef vplDefaultClusterDef(void)
{
    return (vplClusterDef){.count = 8,
                           .metric = VPL_CLUSTER_ONE_MINUS,
                           .w1 = 0.6,
                           .w2 = 0.4,
                           .maxIterations = 32,
                           .cookie = CLUSTER_COOKIE};
}

// ---- checks

static vplResult checkLights(const vplLightSet* set)
{
    for (int i = 0; i < set->lightCount; i++) {
        if (set->lights[i].object < 0) {
            return vplFail(set->context, VPL_INVALID_ARGUMENT,
                           "light %d is an emitter itself, clusters are of lights on surfaces", i);
        }
    }
    return VPL_SUCCESS;
}

static vplResult checkDef(const vplLightSet* set, const vplClusterDef* def)
{
    vplContext* context = set->context;
    if (def->cookie != CLUSTER_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplClusterDef was not made by vplDefaultClusterDef");
    }
    if (def->count < 1 || def->count > VPL_MAX_LIGHTS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplClusterDef.count is %d, must be in [1, %d]",
                       def->count, VPL_MAX_LIGHTS);
    }
    if ((int)def->metric < 0 || def->metric > VPL_CLUSTER_ANGLE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplClusterDef.metric is %d, must be a vplClusterMetric", (int)def->metric);
    }
    if (!(def->w1 >= 0 && def->w2 >= 0 && isfinite(def->w1) && isfinite(def->w2))) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplClusterDef.w1 and w2 are %g and %g, must be finite and at least 0", def->w1,
                       def->w2);
    }
    if (def->maxIterations < 0 || def->maxIterations > 10000) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplClusterDef.maxIterations is %d, must be in [0, 10000]", def->maxIterations);
    }
    for (int j = 0; def->seeds != NULL && j < vplMini(def->count, set->lightCount); j++) {
        if (def->seeds[j] < 0 || def->seeds[j] >= set->lightCount) {
            return vplFail(context, VPL_INVALID_ARGUMENT, "vplClusterDef.seeds[%d] is %d, must be in [0, %d)",
                           j, def->seeds[j], set->lightCount);
        }
    }
    for (int i = 0; def->weights != NULL && i < set->lightCount; i++) {
        if (!(def->weights[i] >= 0 && isfinite(def->weights[i]))) {
            return vplFail(context, VPL_INVALID_ARGUMENT,
                           "vplClusterDef.weights[%d] is %g, must be finite and at least 0", i,
                           (double)def->weights[i]);
        }
    }
    return checkLights(set);
}

// ---- output

static float toFloat(double x)
{
    return x > (double)FLT_MAX ? FLT_MAX : (float)x;
}

static vplVec3 toVec(const double v[3])
{
    return (vplVec3){(float)v[0], (float)v[1], (float)v[2]};
}

// Diagonal of the box around all lights, metres.
static double extentOf(const vplClusterSearch* s)
{
    double square = 0;
    for (int k = 0; k < 3 && s->lightCount > 0; k++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < s->lightCount; i++) {
            low = s->points[i].p[k] < low ? s->points[i].p[k] : low;
            high = s->points[i].p[k] > high ? s->points[i].p[k] : high;
        }
        square += (high - low) * (high - low);
    }
    return sqrt(square);
}

// Four roundings of the largest coordinate, a float, are tolerated, too.
static bool liesFlat(const vplClusterPoint* light, const vplClusterPoint* centre, double extent)
{
    double height = 0, turned = 0, largest = 0;
    for (int k = 0; k < 3; k++) {
        height += (light->p[k] - centre->p[k]) * centre->n[k];
        turned += (light->n[k] - centre->n[k]) * (light->n[k] - centre->n[k]);
        largest = fabs(light->p[k]) > largest ? fabs(light->p[k]) : largest;
    }
    return fabs(height) <= FLAT * extent + 0x1p-22 * largest && turned <= FLAT * FLAT;
}

static void summarize(vplClusterSearch* s, const vplLightSet* set, vplLightCluster* out)
{
    const double extent = extentOf(s);
    for (int j = 0; j < s->count; j++) {
        out[j] = (vplLightCluster){.position = toVec(s->centres[j].p),
                                   .normal = toVec(s->centres[j].n),
                                   .lightCount = s->tallies[j].lightCount,
                                   .nearest = -1,
                                   .flat = true};
        s->tallies[j].nearest = INFINITY;
    }
    for (int i = 0; i < s->lightCount; i++) {
        const vplVirtualLight* v = &set->lights[i];
        const double share = (double)v->weight / set->particleCount;
        const vplClusterPoint* centre = &s->centres[s->of[i]];
        vplClusterTally* tally = &s->tallies[s->of[i]];
        vplLightCluster* cluster = &out[s->of[i]];
        tally->flux[0] += share * (double)v->light.r;
        tally->flux[1] += share * (double)v->light.g;
        tally->flux[2] += share * (double)v->light.b;
        const double d = vplClusterDistance_Below(&s->distance, &s->points[i], centre, tally->nearest);
        if (d < tally->nearest || cluster->nearest < 0) {
            tally->nearest = d;
            cluster->nearest = i;
        }
        cluster->flat = cluster->flat && liesFlat(&s->points[i], centre, extent);
    }
    for (int j = 0; j < s->count; j++) {
        const double* flux = s->tallies[j].flux; // the last update set them to 0
        out[j].flux = (vplRgb){toFloat(flux[0]), toFloat(flux[1]), toFloat(flux[2])};
    }
}

// ---- the clusters

// Scratch memory of the search; `of` belongs to the clusters.
static vplResult prepare(vplClusterSearch* s, vplArena* scratch)
{
    const size_t lights = (size_t)s->lightCount, count = (size_t)s->count;
    s->points = vplArena_Alloc(scratch, lights, sizeof *s->points);
    s->distances = vplArena_Alloc(scratch, lights, sizeof *s->distances);
    s->centres = vplArena_Alloc(scratch, count, sizeof *s->centres);
    s->tallies = vplArena_Alloc(scratch, count, sizeof *s->tallies);
    s->moved = vplArena_Alloc(scratch, count, sizeof *s->moved);
    s->movedList = vplArena_Alloc(scratch, count, sizeof *s->movedList);
    s->hashes = vplArena_Alloc(scratch, (size_t)s->maxIterations + 1, sizeof *s->hashes);
    s->changed = vplArena_Alloc(scratch, (size_t)s->taskCount, sizeof *s->changed);
    return vplArena_Check(scratch);
}

static vplResult search(vplClusterSearch* s, const vplLightSet* lights, const vplClusterDef* def,
                        vplLightClusters* clusters, vplLightCluster* summaries)
{
    for (int i = 0; i < s->lightCount; i++) {
        s->points[i] = vplClusterPoint_Make(lights->lights[i].position, lights->lights[i].normal);
    }
    TRY(vplClusterSearch_Place(s, def));
    TRY(vplClusterSearch_Run(s, clusters));
    summarize(s, lights, summaries);
    for (int j = 0; j < s->count; j++) {
        clusters->emptyCount += s->tallies[j].lightCount == 0;
    }
    return VPL_SUCCESS;
}

static vplResult find(const vplLightSet* lights, const vplClusterDef* def, vplArena* scratch,
                      vplLightClusters** clustersOut)
{
    vplContext* context = lights->context;
    vplClusterSearch s = {.context = context,
                          .distance = {def->metric, def->w1, def->w2},
                          .lightCount = lights->lightCount,
                          .count = vplMini(def->count, lights->lightCount),
                          .maxIterations = def->maxIterations,
                          .weights = def->weights,
                          .taskCount = (lights->lightCount + VPL_CLUSTER_TASK - 1) / VPL_CLUSTER_TASK};
    TRY(prepare(&s, scratch));
    vplArena* arena = vplArena_Create(context);
    vplLightClusters* clusters = vplArena_AllocZero(arena, 1, sizeof *clusters);
    vplLightCluster* summaries = vplArena_Alloc(arena, (size_t)s.count, sizeof *summaries);
    s.of = vplArena_AllocZero(arena, (size_t)s.lightCount, sizeof *s.of);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *clusters = (vplLightClusters){.clusters = summaries,
                                       .count = s.count,
                                       .of = s.of,
                                       .lightCount = s.lightCount,
                                       .context = context,
                                       .arena = arena};
        result = search(&s, lights, def, clusters, summaries);
    }
    return vplArena_Deliver(arena, result, clusters, clustersOut);
}

vplResult vplFindClusters(const vplLightSet* lights, const vplClusterDef* def, vplLightClusters** clustersOut)
{
    REQUIRE(CONTEXT_OF(lights), lights, def, clustersOut);
    TRY(checkDef(lights, def));
    vplArena* scratch = vplArena_Create(lights->context);
    const vplResult result = find(lights, def, scratch, clustersOut);
    vplArena_Destroy(scratch);
    return result;
}

void vplLightClusters_Destroy(vplLightClusters* clusters)
{
    vplArena_Destroy(clusters != NULL ? clusters->arena : NULL);
}
