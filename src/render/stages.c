// SPDX-License-Identifier: MIT
// The table of stages, and when a picture needs each.
#include "base/numbers.h"
#include "reference/light_path.h"
#include "render/options.h"
#include "render/plan.h"
#include "render/show.h"
#include "render/stages/make.h"
#include "render/stages/ssvp.h"

#include <stdarg.h>
#include <stdio.h>

// ---- needs: true or false, and the reason

static const char NOT_DIRECT[] = "the picture shows no direct light";
static const char NOT_VIRTUAL[] = "the picture shows no virtual lights";
static const char NOT_PATCHES[] = "the picture shows no light of patches";
static const char NOT_REFLECTED[] = "the picture shows no reflected light";
static const char NOT_SECOND[] = "there is no second bounce";

__attribute__((format(printf, 3, 4))) static bool because(char* why, bool needed, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vplFormatList(why, VPL_PLAN_TEXT, format, arguments);
    va_end(arguments);
    return needed;
}

static bool choose(char* why, bool needed, const char* reason, const char* otherwise)
{
    return because(why, needed, "%s", needed ? reason : otherwise);
}

static bool needsGeometry(const vplPlan* p, char* why)
{
    return because(why, true, "all stages read it; %s",
                   p->castsRays ? "rays are cast, so it has a ray tree"
                                : "no ray is cast, so it has no ray tree");
}

static bool needsNearDistance(const vplPlan* p, char* why)
{
    return choose(why, p->compensates && p->clampArea > 0,
                  "short rays give back what the clamp takes away, so lights are clamped where surfaces are "
                  "near to each other",
                  p->compensates ? "--min-distance is given" : "no short rays give light back");
}

static bool needsEmitterMaps(const vplPlan* p, char* why)
{
    int casting = 0;
    for (int i = 0; i < p->emitterCount; i++) {
        casting += p->emitters[i].type != VPL_EMITTER_DIRECTIONAL;
    }
    const char* problem = !p->showsDirect && !p->compensates     ? NOT_DIRECT
                          : p->options.method == VPL_METHOD_SSVP ? "reflective maps serve as shadow maps"
                          : casting == 0                         ? "no emitter is a point or a spot"
                                                                 : NULL;
    if (problem == NULL && p->emitterRays) {
        return because(why, false, "rays replace shadow maps, which would take %.0f MiB",
                       vplEmitterMapBytes(p) / 1048576);
    }
    return problem != NULL ? because(why, false, "%s", problem)
                           : because(why, true, "shadows of %d emitter%s with 6 faces of %d^2 texels",
                                     casting, casting > 1 ? "s" : "", p->options.shadow.mapSize);
}

static bool needsEmitterTrees(const vplPlan* p, char* why)
{
    const vplTreesWanted wanted = vplTreesOf(p);
    const bool asks = p->options.method == VPL_METHOD_PATH || p->showsDirect || p->compensates ||
                      p->gathers || p->showsPatches;
    if (!asks) {
        return because(why, false, "%s", NOT_DIRECT);
    }
    const bool emitters = p->emitterCount >= wanted.emitters,
               triangles = p->emittingTriangles >= wanted.triangles;
    if (!emitters && !triangles) {
        return because(why, false, "there are few lights to choose from");
    }
    char lamps[64] = "", surfaces[64] = "";
    if (emitters) {
        snprintf(lamps, sizeof lamps, "%d lights", p->emitterCount);
    }
    if (triangles) {
        snprintf(surfaces, sizeof surfaces, "%s%d triangles that emit", emitters ? " and " : "",
                 p->emittingTriangles);
    }
    return because(why, true, "points choose among %s%s", lamps, surfaces);
}

static bool needsAreaLights(const vplPlan* p, char* why)
{
    const bool documented = p->options.lighting == VPL_LIGHTING_DOCUMENTED;
    const bool patches = p->hasSky && p->showsPatches; // which the environment lights
    const char* problem = !p->showsDirect && !p->compensates && !p->gathers && !patches ? NOT_DIRECT
                          : !p->hasAreaLights && !p->hasSky                             ? "no material emits"
                          : documented ? "documented lighting has no area lights"
                          : vplPixelsChooseTriangles(p) && !p->hasSky ? "points choose among them by a tree"
                          : p->options.method == VPL_METHOD_KELLER
                              ? p->hasSky ? "virtual lights stand for area lights and the environment, too"
                                          : "virtual lights stand for area lights, too"
                              : NULL;
    if (problem != NULL) {
        return because(why, false, "%s", problem);
    }
    return !p->hasSky
               ? because(why, true, "%d points stand for all area lights in direct light",
                         p->options.lights.areaLightSamples)
               : because(why, true, "%d directions stand for the environment in direct light%s",
                         p->options.lights.skySamples,
                         p->hasAreaLights && !vplPixelsChooseTriangles(p) ? ", and points for area lights"
                                                                          : "");
}

static bool needsReflectiveMaps(const vplPlan* p, char* why)
{
    if (p->options.method != VPL_METHOD_SSVP) {
        return choose(why, p->showsVirtual && p->options.particles.placement == VPL_PLACEMENT_RSM,
                      "first hits of particles are its texels", "particles find first hits");
    }
    const bool sampled = p->showsVirtual || p->options.output.show == VPL_SHOW_RSM;
    return choose(why, sampled || !p->emitterRays,
                  sampled ? "first-bounce lights are samples of it" : "shadows of emitters are taken from it",
                  "rays replace shadow maps");
}

static bool needsParticles(const vplPlan* p, char* why)
{
    return choose(why, p->showsVirtual, "virtual lights are where particles land", NOT_VIRTUAL);
}

static bool needsFirstBounce(const vplPlan* p, char* why)
{
    return choose(why, p->showsVirtual, "light that was reflected once",
                  p->options.maxBounces == 0 ? "--max-bounces is 0" : NOT_VIRTUAL);
}

static bool needsClusters(const vplPlan* p, char* why)
{
    const bool second = vplSsvpHasSecondBounce(p) && vplSsvpSamplesMaps(p), sees = vplSsvpSees(p);
    return choose(why, p->showsVirtual && (sees || second || vplSsvpShowsClusters(p)),
                  sees ? "lights of a cluster share what it sees" : "the second bounce begins from clusters",
                  p->showsVirtual ? "lights do not see by clusters, and no bounce begins from them"
                                  : "there are no virtual lights");
}

static bool needsParaboloids(const vplPlan* p, char* why)
{
    return needsClusters(p, why) &&
           because(why, true,
                   vplSsvpSplits(p) ? "what each of %d to %d clusters sees" : "what each of %d clusters sees",
                   p->options.ssvp.clusters, vplSsvpMostClusters(p));
}

static bool needsSecondBounce(const vplPlan* p, char* why)
{
    return choose(why, p->showsVirtual && vplSsvpHasSecondBounce(p), "light that was reflected twice",
                  NOT_SECOND);
}

static bool needsSecondClusters(const vplPlan* p, char* why)
{
    return needsSecondBounce(p, why) &&
           choose(why, vplSsvpSees(p) || (vplSsvpSamplesMaps(p) && vplSsvpHasFurtherBounces(p)),
                  vplSsvpSees(p) ? "second-bounce lights of a cluster share what it sees"
                                 : "the third bounce begins from clusters",
                  "lights do not see by clusters, and no bounce begins from them");
}

static bool needsFurtherBounces(const vplPlan* p, char* why)
{
    const bool needed = p->showsVirtual && vplSsvpHasFurtherBounces(p);
    return needed ? because(why, true, "light that was reflected 3 to %d times", p->options.maxBounces)
                  : because(why, false, "there is no third bounce");
}

static bool needsClusteredLights(const vplPlan* p, char* why)
{
    return needsFirstBounce(p, why) && because(why, true, "the lights of all bounces in one list");
}

static bool needsVirtualLights(const vplPlan* p, char* why)
{
    return choose(why, p->showsVirtual, "the lights that shading adds up", NOT_VIRTUAL);
}

static bool needsPatches(const vplPlan* p, char* why)
{
    return choose(why, p->showsPatches, "surfaces exchange light as patches", NOT_PATCHES);
}

static bool needsSides(const vplPlan* p, char* why)
{
    return choose(why, p->showsPatches, "only sides of patches that light can reach take part", NOT_PATCHES);
}

static bool needsPatchMesh(const vplPlan* p, char* why)
{
    return choose(why, p->showsPatches, "patches are drawn by their vertices", NOT_PATCHES);
}

static bool needsFormFactors(const vplPlan* p, char* why)
{
    return choose(why, VPL_SHOWS[p->options.output.show].patches >= VPL_PATCH_FACTORS,
                  p->linked ? "groups of patches exchange light by links"
                            : "shares of light between all pairs of sides",
                  "the picture shows no exchange of light");
}

static bool needsPatchLight(const vplPlan* p, char* why)
{
    return choose(why, VPL_SHOWS[p->options.output.show].patches == VPL_PATCH_LIGHT,
                  "what emitters send to each side", NOT_PATCHES);
}

static bool needsSolution(const vplPlan* p, char* why)
{
    return needsPatchLight(p, why) && because(why, true, "sides exchange light until it changes no more");
}

static bool needsVertexLight(const vplPlan* p, char* why)
{
    const vplShow show = p->options.output.show;
    const bool lit = show == VPL_SHOW_PICTURE || show == VPL_SHOW_INDIRECT;
    return choose(why, lit && p->options.radiosity.interpolation == VPL_INTERPOLATION_GOURAUD,
                  p->gathers
                      ? "rays of pixels meet light that is interpolated between the vertices of patches"
                      : "light is interpolated between the vertices of patches",
                  "light of patches is shown as it is");
}

static bool needsGbuffer(const vplPlan* p, char* why)
{
    return choose(why, p->keepsGbuffer, "passes light the same surfaces, whose triangles are drawn once",
                  !p->progressive                     ? "the picture is drawn once"
                  : p->options.output.supersample > 1 ? "each sample of a pixel is another view"
                  : p->options.pipeline.kind < VPL_ACCUMULATE_DEFERRED
                      ? "triangles are drawn for each light"
                      : "each pass draws the triangles, which takes little");
}

static bool needsPicture(const vplPlan* p, char* why)
{
    const vplOutputOptions* o = &p->options.output;
    const int width = vplRenderedWidth(o), height = vplRenderedHeight(o);
    char rays[32] = "";
    if (p->gathers) {
        snprintf(rays, sizeof rays, ", %d rays from each", p->options.radiosity.gather);
    }
    if (o->antialias > 1) {
        return because(why, true, "%dx%d pixels%s; at edges the mean of %d samples", width, height, rays,
                       o->antialias);
    }
    return because(why, true, "%dx%d pixels, %d sample%s each%s", width, height, o->supersample,
                   o->supersample > 1 ? "s" : "", rays);
}

// A picture of few paths takes hardly longer than those that measure.
enum { WORTH_PILOTS = 64 };

static bool needsLightPaths(const vplPlan* p, char* why)
{
    const vplRenderOptions* o = &p->options;
    const double paths = vplCountPixels(&o->output) * o->path.samples;
    const char* problem = o->path.lightVertices >= 0               ? "--light-vertices is given"
                          : o->maxBounces == 0                     ? NOT_REFLECTED
                          : o->output.show == VPL_SHOW_DIRECT      ? NOT_REFLECTED
                          : paths < WORTH_PILOTS * VPL_PILOT_PATHS ? "there are few paths"
                                                                   : NULL;
    return choose(why, problem == NULL, "paths tell how often light is reflected before it is seen", problem);
}

static bool needsPaths(const vplPlan* p, char* why)
{
    const int width = vplRenderedWidth(&p->options.output), height = vplRenderedHeight(&p->options.output);
    return vplPathsAreOpen(p)
               ? because(why, true, "as many paths as asked for, for each of %dx%d pixels", width, height)
               : because(why, true, "%d paths for each of %dx%d pixels", p->options.path.samples, width,
                         height);
}

// ---- the table

#define IN(stage) (1u << VPL_STAGE_##stage)
#define CHOICE_KEY                                                                                           \
    "next-bounce size pixel-size VIEW seed PASS min-distance max-bounces" // lights are chosen for what is seen
#define SSVP_KEY                                                                                             \
    "clusters max-clusters size pixel-size VIEW oversampling cluster-metric w1 w2 coherence SHIFT"
#define MAP_KEY                                                                                              \
    "paraboloid hemispheres cluster-place light-shadows show max-bounces second-bounce coherence SHIFT"
#define FACTOR_KEY "form-factors form-samples row-sums hierarchy link-error seed"

// clang-format off
const vplStage VPL_STAGES[VPL_STAGE_COUNT] = {
    [VPL_STAGE_GEOMETRY] = {
        "geometry", 0.02, 0, "SCENE",
        needsGeometry, vplMakeGeometry, vplDestroyGeometry, .report = vplReportGeometry, .updates = true},
    [VPL_STAGE_NEAR_DISTANCE] = {
        "clamp distance", 0.03, IN(GEOMETRY), "VIEW",
        needsNearDistance, vplMakeNearDistance, NULL, .report = NULL},
    [VPL_STAGE_EMITTER_MAPS] = {
        "shadow map", 0.15, IN(GEOMETRY), "EMITTERS method lighting shadow-map bias bias-slope pcf pcf-offset size pixel-size supersample",
        needsEmitterMaps, vplMakeEmitterMaps, vplDestroyEmitterMaps, .report = NULL},
    [VPL_STAGE_EMITTER_TREES] = {
        "emitter tree", 0.15, IN(GEOMETRY), "EMITTERS emitter-samples method lighting area-light-samples",
        needsEmitterTrees, vplMakeEmitterTrees, vplDestroyEmitterTrees, .report = NULL},
    [VPL_STAGE_AREA_LIGHTS] = {
        "area lights", 0.15, IN(GEOMETRY), "area-light-samples sky-samples",
        needsAreaLights, vplMakeAreaLights, NULL, .report = NULL},
    [VPL_STAGE_REFLECTIVE_MAPS] = {
        "reflective map", 0.05, IN(GEOMETRY), "EMITTERS rsm-size",
        needsReflectiveMaps, vplMakeReflectiveMaps, vplDestroyReflectiveMaps, .report = NULL},
    [VPL_STAGE_PARTICLES] = {
        "particles", 0.1, IN(GEOMETRY) | IN(REFLECTIVE_MAPS) | IN(NEAR_DISTANCE),
        "method lighting particles grow-from reflectivity sampler bounce particle-geometry seed EMITTERS PASS PLACEMENT",
        needsParticles, vplMakeParticles, vplDestroyLightSet, .report = vplReportParticles},
    [VPL_STAGE_FIRST_BOUNCE] = {
        "first bounce", 0.06, IN(GEOMETRY) | IN(REFLECTIVE_MAPS), "first-bounce oversampling coherence EMITTERS SHIFT " CHOICE_KEY,
        needsFirstBounce, vplMakeFirstBounce, vplDestroyBounce, .continues = true},
    [VPL_STAGE_CLUSTERS] = {
        "clusters", 0.07, IN(GEOMETRY) | IN(FIRST_BOUNCE), SSVP_KEY,
        needsClusters, vplMakeClusters, vplDestroyClusters, .continues = true},
    [VPL_STAGE_PARABOLOIDS] = {
        "paraboloid", 0.12, IN(GEOMETRY) | IN(FIRST_BOUNCE) | IN(CLUSTERS), MAP_KEY,
        needsParaboloids, vplMakeParaboloids, vplDestroyParaboloids, .continues = true},
    [VPL_STAGE_SECOND_BOUNCE] = {
        "second bounce", 0.13, IN(GEOMETRY) | IN(FIRST_BOUNCE) | IN(CLUSTERS) | IN(PARABOLOIDS),
        "second-bounce second-weight oversampling SHIFT " CHOICE_KEY,
        needsSecondBounce, vplMakeSecondBounce, vplDestroyBounce, .continues = true},
    [VPL_STAGE_SECOND_CLUSTERS] = {
        "second clusters", 0.14, IN(GEOMETRY) | IN(SECOND_BOUNCE), SSVP_KEY,
        needsSecondClusters, vplMakeSecondClusters, vplDestroyClusters, .continues = true},
    [VPL_STAGE_SECOND_PARABOLOIDS] = {
        "second paraboloid", 0.19, IN(GEOMETRY) | IN(SECOND_BOUNCE) | IN(SECOND_CLUSTERS), MAP_KEY,
        needsSecondClusters, vplMakeSecondParaboloids, vplDestroyParaboloids, .continues = true},
    [VPL_STAGE_FURTHER_BOUNCES] = {
        "further bounces", 0.2, IN(GEOMETRY) | IN(SECOND_BOUNCE) | IN(SECOND_CLUSTERS) | IN(SECOND_PARABOLOIDS),
        SSVP_KEY " " MAP_KEY " second-weight " CHOICE_KEY,
        needsFurtherBounces, vplMakeFurtherBounces, vplDestroyFurtherBounces, .continues = true},
    [VPL_STAGE_CLUSTERED_LIGHTS] = {
        "list", 0.2, IN(FIRST_BOUNCE) | IN(CLUSTERS) | IN(PARABOLOIDS) | IN(SECOND_BOUNCE) | IN(SECOND_CLUSTERS) |
            IN(SECOND_PARABOLOIDS) | IN(FURTHER_BOUNCES), "light-shadows",
        needsClusteredLights, vplMakeClusteredLights, vplDestroyClusteredLights, .report = vplReportClusteredLights},
    [VPL_STAGE_VIRTUAL_LIGHTS] = {
        "virtual lights", 0.2, IN(GEOMETRY) | IN(NEAR_DISTANCE) | IN(PARTICLES) | IN(CLUSTERED_LIGHTS),
        "method lighting show show-index compensation min-distance particles grow-from PASS",
        needsVirtualLights, vplMakeVirtualLights, NULL, .report = vplReportVirtualLights},
    [VPL_STAGE_PATCHES] = {
        "patches", 0.05, IN(GEOMETRY),
        "patch-size patches subdivisions patch-placement patch-cuts patch-groups faint-sides form-factors camera seed ADAPTIVE",
        needsPatches, vplMakePatches, vplDestroyPatches, .report = vplReportPatches},
    [VPL_STAGE_SIDES] = {
        "reachable sides", 0.1, IN(GEOMETRY) | IN(PATCHES), "form-factors faint-sides camera seed",
        needsSides, vplMakeSides, vplDestroySides, .report = vplReportSides},
    [VPL_STAGE_PATCH_MESH] = {
        "patch mesh", 0.11, IN(GEOMETRY) | IN(PATCHES) | IN(SIDES), "",
        needsPatchMesh, vplMakePatchMesh, vplDestroyPatchMesh, .report = NULL},
    [VPL_STAGE_FORM_FACTORS] = {
        "form factors", 0.6, IN(GEOMETRY) | IN(PATCHES) | IN(SIDES), FACTOR_KEY,
        needsFormFactors, vplMakeFormFactors, vplDestroyFormFactors, .report = vplReportFormFactors},
    [VPL_STAGE_PATCH_LIGHT] = {
        "patch light", 0.65, IN(GEOMETRY) | IN(EMITTER_TREES) | IN(AREA_LIGHTS) | IN(PATCHES) | IN(SIDES), "patch-light seed gather EMITTERS",
        needsPatchLight, vplMakePatchLight, NULL, .report = NULL},
    [VPL_STAGE_SOLUTION] = { // sweeps of the next frame go on from it, also where no light moved
        "solve", 0.7, IN(SIDES) | IN(FORM_FACTORS) | IN(PATCH_LIGHT), "solver iterations residual CONTINUES",
        needsSolution, vplMakeSolution, NULL, .report = vplReportSolution, .continues = true},
    [VPL_STAGE_VERTEX_LIGHT] = {
        "corners", 0.71, IN(PATCH_MESH) | IN(SOLUTION), "vertex-weight sharpen gather GROUPS",
        needsVertexLight, vplMakeVertexLight, NULL, .report = NULL},
    [VPL_STAGE_GBUFFER] = {
        "visible surfaces", 0.2, IN(GEOMETRY), "size pixel-size VIEW antialias ROWS",
        needsGbuffer, vplMakeGbuffer, vplDestroyGbuffer, .report = NULL},
    [VPL_STAGE_PICTURE] = { // its result is taken away each time
        "shading", 1, IN(GEOMETRY) | IN(EMITTER_MAPS) | IN(EMITTER_TREES) | IN(AREA_LIGHTS) | IN(REFLECTIVE_MAPS) | IN(CLUSTERED_LIGHTS) |
            IN(VIRTUAL_LIGHTS) | IN(SIDES) | IN(PATCH_MESH) | IN(PATCH_LIGHT) | IN(SOLUTION) |
            IN(VERTEX_LIGHT) | IN(GBUFFER), "ALWAYS",
        needsPicture, vplMakePicture, vplDestroyImage, .report = NULL},
    [VPL_STAGE_LIGHT_PATHS] = {
        "light paths", 0.15, IN(GEOMETRY), "EMITTERS VIEW size pixel max-bounces",
        needsLightPaths, vplMakeLightPaths, NULL, .report = NULL},
    [VPL_STAGE_PATHS] = {
        "paths", 1, IN(GEOMETRY) | IN(EMITTER_TREES), "ALWAYS",
        needsPaths, vplMakePaths, vplDestroyPaths, .continues = true, .undoes = true},
};
// clang-format on
