// SPDX-License-Identifier: MIT
// Clusters of SSVP and their paraboloid maps.
#include "lights/light_set.h"
#include "render/stages/make.h"
#include "render/stages/ssvp.h"

// True if the frame or pass before had the same samples, so that its result is a start for this one.
static bool follows(const vplRun* run, uint64_t shift, uint64_t lastShift)
{
    return run->plan->options.sequence.coherence == VPL_COHERENCE_ON && shift == lastShift;
}

// ---- clusters

static vplResult splitClusters(const vplRun* run, const vplBounceLights* bounce, vplBounceClusters* c)
{
    const vplPlan* plan = run->plan;
    vplClusterSplitDef def = vplDefaultClusterSplitDef();
    def.maxCount = plan->options.ssvp.maxClusters;
    def.view = vplSsvpView(run);
    def.view.pointCount = 128;
    TRY(vplSplitClusters(run->results[VPL_STAGE_GEOMETRY], bounce->lights, c->whole, &def, &c->clusters,
                         &c->agreement));
    run->stats->rays += c->agreement.rays;
    return VPL_SUCCESS;
}

// Lights are weighted by the share of their light that stays in the scene: 8 clusters of Sponza have a FLIP
// of 0.192 against paths with these weights, and 0.248 without.
vplResult vplClusterBounce(const vplRun* run, const vplBounceLights* bounce, const vplBounceClusters* last,
                           vplBounceClusters** resultOut)
{
    const vplSsvpOptions* o = &run->plan->options.ssvp;
    vplBounceClusters* c = vplArena_Alloc(run->arena, 1, sizeof *c);
    TRY(vplArena_Check(run->arena));
    *c = (vplBounceClusters){.shift = bounce->shift};
    *resultOut = c;
    float* weights = NULL;
    vplClusterDef def = vplDefaultClusterDef();
    def.count = o->clusters;
    def.metric = o->metric;
    def.w1 = o->w1;
    def.w2 = o->w2;
    def.last = last == NULL || !follows(run, c->shift, last->shift) ? NULL
               : last->whole != NULL                                ? last->whole
                                                                    : last->clusters;
    if (o->oversampling > 1) {
        TRY(vplMeasureLightUse(run, bounce->lights, &weights));
    }
    def.weights = weights;
    if (!vplSsvpSplits(run->plan)) {
        return vplFindClusters(bounce->lights, &def, &c->clusters);
    }
    TRY(vplFindClusters(bounce->lights, &def, &c->whole));
    return splitClusters(run, bounce, c);
}

vplResult vplMakeClusters(const vplRun* run, void** resultOut)
{
    return vplClusterBounce(run, run->results[VPL_STAGE_FIRST_BOUNCE], run->before,
                            (vplBounceClusters**)resultOut);
}

vplResult vplMakeSecondClusters(const vplRun* run, void** resultOut)
{
    return vplClusterBounce(run, run->results[VPL_STAGE_SECOND_BOUNCE], run->before,
                            (vplBounceClusters**)resultOut);
}

void vplDestroyClusters(void* result)
{
    vplBounceClusters* c = result;
    vplLightClusters_Destroy(c->clusters);
    vplLightClusters_Destroy(c->whole);
}

// ---- paraboloid maps

// One bounce whose clusters get maps.
typedef struct Viewing {
    const vplRun* run;
    const vplLightSet* lights;
    const vplLightClusters* clusters;
    vplBounceMaps* maps;
    const vplBounceMaps* last; // NULL: no map of a last frame with the same samples
} Viewing;

// Finds the light that a cluster sees from. It stays that of the last frame as long as the cluster has this
// light, so that the view does not jump; else it is the light nearest to the mean. -1: none.
static int findViewpoint(const Viewing* v, int cluster)
{
    if (v->run->plan->options.ssvp.place == VPL_CLUSTER_PLACE_MEAN) {
        return -1;
    }
    const bool known = v->last != NULL && cluster < v->last->count;
    for (int i = 0; known && i < v->clusters->lightCount; i++) {
        if (v->clusters->of[i] == cluster && v->lights->lights[i].particle == v->last->viewpoints[cluster]) {
            return i;
        }
    }
    return v->clusters->clusters[cluster].nearest;
}

// Viewpoints are always lifted as if they were on a surface, also in mid-air: a mean that lies on a wall but
// for rounding would see the wall as half of space.
static vplParaboloidPlace placeOf(const Viewing* v, int i)
{
    const vplPlan* plan = v->run->plan;
    const vplLightCluster* c = &v->clusters->clusters[i];
    const int viewpoint = findViewpoint(v, i);
    const vplVirtualLight* light = viewpoint >= 0 ? &v->lights->lights[viewpoint] : NULL;
    v->maps->viewpoints[i] = light != NULL ? light->particle : -1;
    return (vplParaboloidPlace){.position = light != NULL ? light->position : c->position,
                                .normal = c->normal,
                                .hemispheres =
                                    vplSsvpSees(plan) && !c->flat ? plan->options.ssvp.hemispheres : 1,
                                .onSurface = true};
}

vplResult vplMapBounce(const vplRun* run, const vplBounceParts* bounce, const vplBounceMaps* last,
                       bool triangles, vplBounceMaps** resultOut)
{
    const vplBounceClusters* c = bounce->clusters;
    const int count = c->clusters->count;
    vplBounceMaps* maps = vplArena_Alloc(run->arena, 1, sizeof *maps);
    int* viewpoints = vplArena_Alloc(run->arena, (size_t)count, sizeof *viewpoints);
    vplParaboloidPlace* places = vplArena_Alloc(run->scratch, (size_t)count, sizeof *places);
    TRY(vplArena_Check(run->arena));
    TRY(vplArena_Check(run->scratch));
    *maps = (vplBounceMaps){NULL, viewpoints, count, c->shift};
    *resultOut = maps;
    const Viewing v = {.run = run,
                       .lights = bounce->lights->lights,
                       .clusters = c->clusters,
                       .maps = maps,
                       .last = last != NULL && follows(run, c->shift, last->shift) ? last : NULL};
    for (int i = 0; i < count; i++) {
        places[i] = placeOf(&v, i);
    }
    TRY(vplParaboloidMaps_Create(run->context, run->plan->options.ssvp.paraboloidSize, count, triangles,
                                 &maps->maps));
    return vplParaboloidMaps_Draw(maps->maps, run->results[VPL_STAGE_GEOMETRY], places, count, run->progress,
                                  run->runner);
}

vplResult vplMakeParaboloids(const vplRun* run, void** resultOut)
{
    const vplBounceParts first = vplSsvpBounce(run, 0);
    return vplMapBounce(run, &first, run->before,
                        (vplSsvpHasSecondBounce(run->plan) && vplSsvpSamplesMaps(run->plan)) ||
                            vplSsvpShowsClusters(run->plan),
                        (vplBounceMaps**)resultOut);
}

vplResult vplMakeSecondParaboloids(const vplRun* run, void** resultOut)
{
    const vplBounceParts second = vplSsvpBounce(run, 1);
    return vplMapBounce(run, &second, run->before,
                        vplSsvpHasFurtherBounces(run->plan) && vplSsvpSamplesMaps(run->plan),
                        (vplBounceMaps**)resultOut);
}

void vplDestroyParaboloids(void* result)
{
    vplBounceMaps* maps = result;
    vplParaboloidMaps_Destroy(maps->maps);
}
