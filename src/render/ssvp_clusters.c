// SPDX-License-Identifier: MIT
// SSVP's clusters and what they see.
#include "render/ssvp.h"

// Clusters are for lights whose light stays in the scene: of Sponza's eight, one had all of the courtyard's floor and the
// others the roof. FLIP of 4, 8, 16, 32 clusters against path tracing, mean of three seeds: 0.254, 0.248, 0.204, 0.185
// where all lights count alike; by their use 0.245, 0.192, 0.154, 0.175, by its square 0.278, 0.203, 0.176, 0.179. In
// closed rooms all are of the same use.
vplResult vplSsvp_Cluster(vplSsvpMaking* m, int k)
{
    const vplRenderOptions* o = &m->job->options;
    vplSsvpBounce* bounce = &m->lights->bounce[k];
    if (bounce->lights == NULL) {
        return VPL_SUCCESS;
    }
    vplClusterDef def = vplDefaultClusterDef();
    def.count = o->ssvp.clusters;
    def.metric = o->ssvp.metric;
    def.w1 = o->ssvp.w1;
    def.w2 = o->ssvp.w2;
    def.last = m->last != NULL ? m->last->bounce[k].clusters : NULL;
    float* weights = NULL;
    vplResult result = o->ssvp.oversampling > 1 ? vplSsvp_MeasureUse(m, bounce->lights, &weights) : VPL_SUCCESS;
    if (result == VPL_SUCCESS) {
        def.weights = weights;
        result = vplFindClusters(bounce->lights, &def, &bounce->clusters);
    }
    vplFree(m->job->context, weights);
    return result;
}

// The light that a cluster looks from: that of the last frame as long as it is one of its lights, so that what is seen
// does not jump; else the nearest to the mean. -1: none.
static int findLooker(const vplSsvpMaking* m, int k, int cluster)
{
    const vplSsvpBounce* bounce = &m->lights->bounce[k];
    const vplSsvpBounce* last = m->last != NULL ? &m->last->bounce[k] : NULL;
    const vplLightClusters* clusters = bounce->clusters;
    if (m->job->options.ssvp.place == VPL_CLUSTER_PLACE_MEAN) {
        return -1;
    }
    for (int i = 0;
         last != NULL && last->lookers != NULL && cluster < last->clusters->count && i < clusters->lightCount;
         i++) {
        if (clusters->of[i] == cluster && bounce->lights->lights[i].particle == last->lookers[cluster]) {
            return i;
        }
    }
    return clusters->clusters[cluster].nearest;
}

// Always lifted, also from mid-air: a mean that lies on a wall but for rounding would see the wall as half of space.
static vplParaboloidPlace placeOf(const vplSsvpMaking* m, int k, int i)
{
    vplSsvpBounce* bounce = &m->lights->bounce[k];
    const vplLightCluster* c = &bounce->clusters->clusters[i];
    const int looker = findLooker(m, k, i);
    const vplVirtualLight* light = looker >= 0 ? &bounce->lights->lights[looker] : NULL;
    bounce->lookers[i] = light != NULL ? light->particle : -1;
    return (vplParaboloidPlace){.position = light != NULL ? light->position : c->position,
                                .normal = c->normal,
                                .hemispheres = m->sees && !c->flat ? m->job->options.ssvp.hemispheres : 1,
                                .onSurface = true};
}

// With triangles where surfaces are asked for, not only distances.
vplResult vplSsvp_DrawMaps(vplSsvpMaking* m, bool triangles, int k)
{
    vplJob* job = m->job;
    vplSsvpBounce* bounce = &m->lights->bounce[k];
    const int count = bounce->clusters->count;
    vplParaboloidPlace* places = vplAlloc(job->context, (size_t)count, sizeof *places);
    bounce->lookers = vplAlloc(job->context, (size_t)count, sizeof *bounce->lookers);
    vplResult result = places && bounce->lookers ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
        places[i] = placeOf(m, k, i);
    }
    if (result == VPL_SUCCESS) {
        result = vplParaboloidMaps_Create(job->context, job->options.ssvp.paraboloidSize, count, triangles,
                                          &bounce->maps);
    }
    if (result == VPL_SUCCESS) {
        result =
            vplParaboloidMaps_Draw(bounce->maps, job->geometry, places, count, vplJob_GetProgress(job), job);
    }
    vplFree(job->context, places);
    return result;
}
