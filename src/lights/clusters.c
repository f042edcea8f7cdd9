// SPDX-License-Identifier: MIT
// Groups of lights that will share one view of the scene.
// Based on: Aranha, Macedo and Apolinario, Screen-Space Virtual Point Light Propagation, section II-A, equation 2;
// Dong, Grosch, Ritschel, Kautz and Seidel, Real-time Indirect Illumination with Clustered Visibility, VMV 2009.
// Departs: the normal term, which as printed keeps equal normals apart.
#include "lights/clusters.h"

#include "base/context.h"
#include "math/scalar.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { CLUSTER_COOKIE = 0x56504c90 };

// Of the box around all lights: how far those of a flat cluster may be from its plane. And of a light's normal.
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

// ---- what is handed on

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

// Coordinates are float: 4 roundings of the largest are no step, either.
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

static void gather(vplClusterSearch* s, const vplLightSet* set, vplLightCluster* out)
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
        const double* flux = s->tallies[j].flux; // zeros since the last update
        out[j].flux = (vplRgb){toFloat(flux[0]), toFloat(flux[1]), toFloat(flux[2])};
    }
}

// ---- all of it

static void copyPoints(vplClusterSearch* s, const vplLightSet* set)
{
    for (int i = 0; i < s->lightCount; i++) {
        const vplVec3 p = set->lights[i].position, n = set->lights[i].normal;
        s->points[i] = (vplClusterPoint){{(double)p.x, (double)p.y, (double)p.z},
                                         {(double)n.x, (double)n.y, (double)n.z}};
    }
}

static vplResult reserve(vplClusterSearch* s, vplLightClusters* clusters)
{
    const size_t lights = (size_t)s->lightCount, count = (size_t)s->count;
    s->points = vplAlloc(s->context, lights, sizeof *s->points);
    s->reached = s->points ? vplAlloc(s->context, lights, sizeof *s->reached) : NULL;
    s->centres = s->reached ? vplAlloc(s->context, count, sizeof *s->centres) : NULL;
    s->tallies = s->centres ? vplAlloc(s->context, count, sizeof *s->tallies) : NULL;
    s->moved = s->tallies ? vplAlloc(s->context, count, sizeof *s->moved) : NULL;
    s->movedList = s->moved ? vplAlloc(s->context, count, sizeof *s->movedList) : NULL;
    s->hashes = s->movedList ? vplAlloc(s->context, (size_t)s->maxIterations + 1, sizeof *s->hashes) : NULL;
    s->changed = s->hashes ? vplAlloc(s->context, (size_t)s->taskCount, sizeof *s->changed) : NULL;
    clusters->of = s->of = s->changed ? vplAllocZero(s->context, lights, sizeof *s->of) : NULL;
    clusters->clusters = s->of ? vplAlloc(s->context, count, sizeof *clusters->clusters) : NULL;
    return clusters->clusters ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static void release(vplClusterSearch* s)
{
    vplFree(s->context, s->points);
    vplFree(s->context, s->reached);
    vplFree(s->context, s->centres);
    vplFree(s->context, s->tallies);
    vplFree(s->context, s->moved);
    vplFree(s->context, s->movedList);
    vplFree(s->context, s->hashes);
    vplFree(s->context, s->changed);
}

vplResult vplFindClusters(const vplLightSet* lights, const vplClusterDef* def, vplLightClusters** clustersOut)
{
    vplResult result = checkDef(lights, def);
    vplContext* context = lights->context;
    vplLightClusters* clusters = result == VPL_SUCCESS ? vplAllocZero(context, 1, sizeof *clusters) : NULL;
    if (clusters == NULL) {
        return result == VPL_SUCCESS ? VPL_OUT_OF_MEMORY : result;
    }
    vplClusterSearch s = {.context = context,
                          .distance = {def->metric, def->w1, def->w2},
                          .lightCount = lights->lightCount,
                          .count = vplMini(def->count, lights->lightCount),
                          .maxIterations = def->maxIterations,
                          .weights = def->weights};
    s.taskCount = (s.lightCount + VPL_CLUSTER_TASK - 1) / VPL_CLUSTER_TASK;
    clusters->context = context;
    clusters->lightCount = s.lightCount;
    clusters->count = s.count;
    result = reserve(&s, clusters);
    if (result == VPL_SUCCESS) {
        copyPoints(&s, lights);
        vplClusterSearch_Place(&s, def);
        vplClusterSearch_Run(&s, clusters);
        gather(&s, lights, (vplLightCluster*)clusters->clusters);
        for (int j = 0; j < s.count; j++) {
            clusters->emptyCount += s.tallies[j].lightCount == 0;
        }
    }
    release(&s);
    if (result != VPL_SUCCESS) {
        vplLightClusters_Destroy(clusters);
        return result;
    }
    *clustersOut = clusters;
    return VPL_SUCCESS;
}

void vplLightClusters_Destroy(vplLightClusters* clusters)
{
    if (clusters != NULL) {
        vplFree(clusters->context, (void*)clusters->clusters);
        vplFree(clusters->context, (void*)clusters->of);
        vplFree(clusters->context, clusters);
    }
}
