// SPDX-License-Identifier: MIT
// Bounces of SSVP after the second, and the lights of all bounces as one list.
// Based on: Vitor Aranha, Marcio Macedo and Antonio Apolinario, Screen-Space Virtual Point Light Propagation
// for Real-Time Global Illumination, section II-B.
// Departs: the document stops after two bounces; its second is repeated here from the clusters of the last.
#include "lights/light_set.h"
#include "render/stages/make.h"
#include "render/stages/ssvp.h"

// ---- bounces

vplBounceParts vplSsvpBounce(const vplRun* run, int k)
{
    const vplFurtherBounces* further = run->results[VPL_STAGE_FURTHER_BOUNCES];
    const vplStageId lights = k == 0 ? VPL_STAGE_FIRST_BOUNCE : VPL_STAGE_SECOND_BOUNCE;
    const vplStageId clusters = k == 0 ? VPL_STAGE_CLUSTERS : VPL_STAGE_SECOND_CLUSTERS;
    const vplStageId maps = k == 0 ? VPL_STAGE_PARABOLOIDS : VPL_STAGE_SECOND_PARABOLOIDS;
    if (k >= 2) {
        return further != NULL && k - 2 < further->count ? further->bounces[k - 2]
                                                         : (vplBounceParts){NULL, NULL, NULL};
    }
    return (vplBounceParts){run->results[lights], run->results[clusters], run->results[maps]};
}

// Clusters of the lights of a bounce, and their maps if lights see by them or the next bounce begins from them.
static vplResult seeByClusters(const vplRun* run, const vplBounceParts* last, bool sampled, vplBounceParts* b)
{
    vplBounceClusters* clusters = NULL;
    vplBounceMaps* maps = NULL;
    if (!sampled && !vplSsvpSees(run->plan)) {
        return VPL_SUCCESS;
    }
    vplResult result = vplClusterBounce(run, b->lights, last->clusters, &clusters);
    b->clusters = clusters;
    result = result == VPL_SUCCESS ? vplMapBounce(run, b, last->maps, sampled, &maps) : result;
    b->maps = maps;
    return result;
}

// Bounces that begin from the clusters of the bounce before: the last needs maps only to see by.
static vplResult repeatSecond(const vplRun* run, const vplFurtherBounces* before, vplFurtherBounces* f)
{
    const int most = run->plan->options.maxBounces - 2;
    vplBounceParts from = vplSsvpBounce(run, 1);
    for (; f->count < most; from = f->bounces[f->count - 1]) {
        const int i = f->count++;
        const vplBounceParts none = {NULL, NULL, NULL};
        vplBounceLights* lights = NULL;
        vplRun_BeginPart(run, i, most);
        const vplResult result = vplMakeNextBounce(run, &from, i + 2, &lights);
        f->bounces[i].lights = lights;
        TRY(result);
        TRY(seeByClusters(run, before != NULL && i < before->count ? &before->bounces[i] : &none,
                          i + 1 < most, &f->bounces[i]));
    }
    return VPL_SUCCESS;
}

// Bounces that need no clusters: their lights are chosen together, and share clusters and maps.
static vplResult goOn(const vplRun* run, const vplFurtherBounces* before, vplFurtherBounces* f)
{
    const vplBounceParts from = vplSsvpBounce(run, 1), none = {NULL, NULL, NULL};
    vplBounceLights* lights = NULL;
    f->count = 1;
    const vplResult result = vplShootFurtherBounces(run, &from, &lights);
    f->bounces[0].lights = lights;
    TRY(result);
    return seeByClusters(run, before != NULL ? &before->bounces[0] : &none, false, &f->bounces[0]);
}

vplResult vplMakeFurtherBounces(const vplRun* run, void** resultOut)
{
    const bool sampled = vplSsvpSamplesMaps(run->plan);
    vplFurtherBounces* f = vplArena_AllocZero(run->arena, 1, sizeof *f);
    vplBounceParts* bounces =
        vplArena_AllocZero(run->arena, sampled ? (size_t)run->plan->options.maxBounces : 1, sizeof *bounces);
    TRY(vplArena_Check(run->arena));
    f->bounces = bounces;
    *resultOut = f;
    return sampled ? repeatSecond(run, run->before, f) : goOn(run, run->before, f);
}

void vplDestroyFurtherBounces(void* result)
{
    vplFurtherBounces* f = result;
    for (int i = 0; i < f->count; i++) {
        const vplBounceParts* b = &f->bounces[i];
        vplLightSet_Destroy(b->lights != NULL ? b->lights->lights : NULL);
        vplLightSet_Destroy(b->lights != NULL ? b->lights->all : NULL);
        vplLightClusters_Destroy(b->clusters != NULL ? b->clusters->clusters : NULL);
        vplLightClusters_Destroy(b->clusters != NULL ? b->clusters->whole : NULL);
        vplParaboloidMaps_Destroy(b->maps != NULL ? b->maps->maps : NULL);
    }
}

// ---- all bounces as one list

static vplResult listShadows(const vplRun* run, vplClusteredLights* l)
{
    int shadows = 0, at = 0;
    for (int k = 0; vplSsvpBounce(run, k).maps != NULL; k++) {
        shadows += vplSsvpBounce(run, k).maps->count;
    }
    l->clusterOf = vplArena_Alloc(run->arena, (size_t)l->set->lightCount, sizeof *l->clusterOf);
    l->shadows = vplArena_Alloc(run->arena, (size_t)shadows, sizeof *l->shadows);
    TRY(vplArena_Check(run->arena));
    for (int k = 0; vplSsvpBounce(run, k).maps != NULL; k++) {
        const vplBounceParts b = vplSsvpBounce(run, k);
        const int first = l->shadowCount;
        for (int i = 0; i < b.clusters->clusters->lightCount; i++) {
            l->clusterOf[at++] = first + b.clusters->clusters->of[i];
        }
        for (int i = 0; i < b.maps->count; i++) {
            l->shadows[l->shadowCount++] = b.maps->maps->maps[i];
        }
    }
    return VPL_SUCCESS;
}

// The share of the light that is wrong, over all bounces; negative if no rays tested it.
static double disagreementOf(const vplRun* run)
{
    double light = 0, wrong = 0;
    for (int k = 0; vplSsvpBounce(run, k).clusters != NULL; k++) {
        light += vplSsvpBounce(run, k).clusters->agreement.light;
        wrong += vplSsvpBounce(run, k).clusters->agreement.wrong;
    }
    return light > 0 ? wrong / light : -1;
}

// Share of wrong light from which SSVP is the wrong method.
static const double MOST_WRONG = 0.15;

static void warnOfDisagreement(const vplRun* run)
{
    const double wrong = disagreementOf(run);
    if (wrong > MOST_WRONG && vplSsvpSees(run->plan)) {
        vplLog(run->context, VPL_LOG_WARNING,
               "--method ssvp: %.0f %% of the light at points that the camera sees is tested wrong, because "
               "lights of "
               "one cluster see different parts of the scene; use --method keller, or more than %d "
               "--max-clusters",
               100 * wrong, run->plan->options.ssvp.maxClusters);
    }
}

vplResult vplMakeClusteredLights(const vplRun* run, void** resultOut)
{
    const vplLightSet none = {.context = run->context, .particleCount = 1};
    vplClusteredLights* l = vplArena_AllocZero(run->arena, 1, sizeof *l);
    TRY(vplArena_Check(run->arena));
    *resultOut = l;
    TRY(vplLightSet_Join(vplSsvpBounce(run, 0).lights->lights, &none, &l->set));
    for (int k = 1; vplSsvpBounce(run, k).lights != NULL; k++) {
        vplLightSet* joined;
        TRY(vplLightSet_Join(l->set, vplSsvpBounce(run, k).lights->lights, &joined));
        vplLightSet_Destroy(l->set);
        l->set = joined;
    }
    warnOfDisagreement(run);
    return vplSsvpSees(run->plan) ? listShadows(run, l) : VPL_SUCCESS;
}

void vplDestroyClusteredLights(void* result)
{
    vplClusteredLights* l = result;
    vplLightSet_Destroy(l->set);
}

void vplReportClusteredLights(const vplRun* run)
{
    const vplClusteredLights* l = run->results[VPL_STAGE_CLUSTERED_LIGHTS];
    const vplBounceClusters* first = run->results[VPL_STAGE_CLUSTERS];
    vplReportLights(l->set, run->stats);
    if (first != NULL) {
        run->stats->clusters = first->clusters->count;
        run->stats->clusterIterations = first->clusters->iterations;
        run->stats->allClusters = 0; // those of the last pass
        for (int k = 0; vplSsvpBounce(run, k).clusters != NULL; k++) {
            run->stats->allClusters += vplSsvpBounce(run, k).clusters->clusters->count;
        }
    }
    run->stats->clusterDisagreement = disagreementOf(run);
}
