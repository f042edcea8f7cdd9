// SPDX-License-Identifier: MIT
// The work of each stage of a plan, counted in the parts that vplSpeeds has times for. Work of another kind is counted as
// so many of the nearest part; these numbers were fitted with vplUsualSpeeds (README.md, Time).
#include "render/options.h"
#include "render/plan.h"
#include "render/stages/make.h"
#include "render/stages/ssvp.h"
#include "render/stages/results.h"
#include "shading/shading.h"
#include "visibility/hemi_map.h"

#include <math.h>

enum { BUILD, TRIANGLE, TEXEL, PIXEL, LIGHT, SHADOW_RAY, PATH_RAY, FORM_FACTOR };

typedef struct Scale {
    const vplPlan* plan;
    const vplGeometry* geometry;
    vplProbe probe;
    bool lamps; // a triangle may emit
    double triangles, area, pixels, lights, sides, emitters, reflectance;
    double depth, pathDepth; // a shadow ray's time and a path's, in units of that in a scene of few triangles
    double overlap;          // a texel's time, likewise
} Scale;

// ---- stages

// Lights that each pixel adds up.
static double lightsPerPixel(const Scale* s)
{
    const vplPipelineOptions* o = &s->plan->options.pipeline;
    const double all = s->plan->showsVirtual ? s->lights : 0;
    switch (o->kind) {
    case VPL_ACCUMULATE_INTERLEAVED:
        return all / o->interleave / o->interleave;
    case VPL_ACCUMULATE_LIGHTCUTS: // room, 2 % error: cuts of some hundred
        return fmin(all, 40 * sqrt(all));
    default:
        return all;
    }
}

double vplChoiceWork(double count)
{
    const double levels = log2(fmax(count, 2));
    return 0.05 * levels * levels;
}

// Light of emitters and area lights in each pixel.
static void addDirect(const Scale* s, double pixels, vplWork* w)
{
    const vplRenderOptions* o = &s->plan->options;
    const bool area = s->lamps && o->method != VPL_METHOD_KELLER;
    const bool sky = s->plan->hasSky && o->method != VPL_METHOD_KELLER;
    const double rays = (s->plan->emitterRays ? s->emitters : 0) +
                        (area ? o->lights.areaLightSamples *
                                    (vplPixelsChooseTriangles(s->plan) ? vplChoiceWork(VPL_MOST_EMITTERS) : 1)
                              : 0);
    if (s->plan->showsDirect) {
        // Emitters are mostly in front of what is seen, also where surfaces do not face each other. Half of the sky is
        // above a surface: of 256 directions 107 to 130 have a ray in grove, garden and attic.
        const double facing = 0.6 * s->probe.facing,
                     cast = rays * fmax(0.24, facing) + (sky ? o->lights.skySamples : 0) * fmax(0.5, facing);
        w->counts[SHADOW_RAY] += pixels * cast * s->depth;
        w->counts[LIGHT] +=
            s->plan->emitterRays ? 0 : pixels * s->emitters * (15 + 1.5 * o->shadow.pcfSamples);
    }
}

// The cost of the emitters' light where a short ray hits a surface, in shadow rays.
static double hitEmitters(const vplPlan* p)
{
    return vplTreesOf(p).emitters <= p->emitterCount ? VPL_CHOSEN_AT_HIT * vplChoiceWork(p->emitterCount)
                                                     : p->emitterCount;
}

// Short rays, a fifth or so of which hit something near.
static double compensationRays(const Scale* s, double lights)
{
    const double distance = fmax((double)s->plan->options.lights.minDistance, 1e-9);
    const double hitLights = vplLightsOfHit(s->area, distance, lights);
    const double rays = vplShortRaysOf(s->plan, lights);
    return s->plan->compensates ? rays * (1 + 0.3 * hitLights + 0.3 * hitEmitters(s->plan)) : 0;
}

// The cost of rasterizing a view, in triangles. With samples at edges it is more than four times as high.
static double viewTriangles(const Scale* s)
{
    return s->triangles * (vplCountPoints(s->plan) > 1 ? 7 : 1.5);
}

static void addPicture(const Scale* s, vplWork* w)
{
    const vplRenderOptions* o = &s->plan->options;
    const int points = vplCountPoints(s->plan), supersample = o->output.supersample;
    const double lights = lightsPerPixel(s), all = s->pixels * supersample;
    // Of the samples of a pixel only those at edges differ, and edges are as long as the picture is wide.
    const double side = sqrt(fmax(all, 1)), edges = 1 + fmin(4 / side, 0.5) * (points - 1);
    const double pixels = all * s->probe.seen * edges, pairs = pixels * lights;
    const bool filtered = vplPixelsShareLight(s->plan);
    w->counts[PIXEL] += 0.3 * all + 75 * (points - 1) * side + (filtered ? 0.8 * all : 0);
    w->counts[TRIANGLE] += s->plan->keepsGbuffer ? 0 : viewTriangles(s) * supersample;
    addDirect(s, pixels, w);
    switch (o->lights.shadows) {
    case VPL_LIGHT_SHADOWS_RAY:
        w->counts[SHADOW_RAY] += (pairs * s->probe.facing + pixels * compensationRays(s, lights)) * s->depth;
        w->counts[LIGHT] += pairs;
        break;
    case VPL_LIGHT_SHADOWS_MAP: {
        const double texels = (double)vplHemiMap_Texels(o->lights.mapSize);
        w->counts[TRIANGLE] += 0.4 * s->lights * s->triangles;
        w->counts[TEXEL] += 0.5 * s->lights * texels * s->overlap;
        w->counts[SHADOW_RAY] += pixels * compensationRays(s, lights) * s->depth;
        w->counts[LIGHT] += pairs * (6 + 16 * s->probe.facing);
        break;
    }
    case VPL_LIGHT_SHADOWS_CLUSTER:
        w->counts[LIGHT] += pairs * 4;
        break;
    default:
        w->counts[LIGHT] += pairs;
    }
    if (s->plan->gathers) {
        // Near hits cast a quarter more, and take sixteen points together.
        w->counts[PATH_RAY] += 1.4 * pixels * o->radiosity.gather * s->pathDepth;
    } else if (s->plan->showsPatches) {
        w->counts[PIXEL] += 0.15 * all * points;
        w->counts[TRIANGLE] += 2.0 * vplPlan_DrawnPatches(s->plan) * points;
    }
}

// Paths with light paths of up to 16 vertices take so many times as long as with one vertex (1.5 in room, 2.1 in shade).
static const double LONG_LIGHT_PATHS = 1.7;

// Rays of paths: to a surface, to an emitter from there, and on. Paths end where they leave the scene; those that carry
// less than a quarter of their light in all colours end by chance.
static void addPaths(const Scale* s, double paths, vplWork* w)
{
    const double stays = s->probe.enclosed, kept = fmin(sqrt(s->reflectance), 0.98);
    const double whole = kept > 0 ? ceil(log(0.25) / log(fmax(kept, 1e-3))) : 0;
    double vertices = 0, arrive = 1;
    for (int k = 0; k < 64 && k <= s->plan->options.maxBounces + (s->plan->options.maxBounces < 0 ? 65 : 0);
         k++) {
        vertices += arrive;
        arrive *= stays * (k < whole ? 1 : kept);
    }
    const double rays = paths * (1 + s->probe.seen * (2 * vertices - 1));
    w->counts[PATH_RAY] += rays * s->pathDepth * (s->plan->splitsLight ? 1.3 : 1) *
                           (s->plan->options.path.lightVertices > 1 ? LONG_LIGHT_PATHS : 1);
}

static void addMaps(double faces, double size, const Scale* s, vplWork* w)
{
    w->counts[TEXEL] += faces * size * size * s->overlap;
    w->counts[TRIANGLE] += faces * s->triangles;
}

static void addParaboloids(double lights, const Scale* s, vplWork* w)
{
    const vplSsvpOptions* o = &s->plan->options.ssvp;
    const double maps = fmin(lights, vplSsvpMostClusters(s->plan)) * o->hemispheres, size = o->paraboloidSize;
    w->counts[TEXEL] += 8 * maps * size * size;
    w->counts[TRIANGLE] += 0.3 * maps * s->triangles;
}

// Rays of lights to points that the camera sees, by which lights are chosen and clusters are split; three of
// ten pairs face each other.
static void addChoice(double lights, const Scale* s, vplWork* w)
{
    const vplPlan* p = s->plan;
    const double candidates = vplSsvpChooses(p) ? vplSsvpCountCandidates(p, (int)lights) : 0;
    w->counts[SHADOW_RAY] += 0.3 * (256 * candidates + (vplSsvpSplits(p) ? 128 * lights : 0)) * s->depth;
    w->counts[PATH_RAY] += (candidates > 0 ? candidates : lights) * s->pathDepth;
}

// Without maps to sample, all bounces after the second share their clusters.
static void addFurtherBounces(const Scale* s, vplWork* w)
{
    const vplPlan* p = s->plan;
    double all = 0;
    for (int k = 2; k < p->options.maxBounces; k++) {
        const double lights = vplSsvpCountLights(p, k);
        all += lights;
        if (vplSsvpSamplesMaps(p)) {
            addParaboloids(lights, s, w);
        } else {
            addChoice(lights, s, w);
        }
    }
    if (!vplSsvpSamplesMaps(p) && vplSsvpSees(p)) {
        addParaboloids(all, s, w);
    }
}

// Rays from the vertices of groups. The gather takes all corners of a triangle of which the camera sees one: half as many again as it sees.
static double vertexRays(const Scale* s)
{
    const double grouped = s->plan->groupedTriangles / s->triangles;
    return 1.5 * VPL_VERTEX_RAYS * grouped * vplProbe_SeenVertices(s->geometry, &s->plan->view);
}

static vplWork workOf(const Scale* s, vplStageId id)
{
    const vplPlan* p = s->plan;
    const vplRenderOptions* o = &p->options;
    const double pairs = s->sides * s->sides;
    vplWork w = {{0}};
    switch (id) {
    case VPL_STAGE_GEOMETRY:
        w.counts[BUILD] = s->triangles * (p->castsRays ? 1 : 0.15);
        break;
    case VPL_STAGE_EMITTER_MAPS:
        addMaps(vplEmitterMapFaces(p), o->shadow.mapSize, s, &w);
        break;
    case VPL_STAGE_REFLECTIVE_MAPS:
        addMaps(vplReflectiveMapFaces(p), o->shadow.rsmSize, s, &w);
        break;
    case VPL_STAGE_PARTICLES:
        w.counts[PATH_RAY] = s->lights * s->pathDepth;
        break;
    case VPL_STAGE_FIRST_BOUNCE: // rays test which light leaves the scene, or what the camera sees
        addChoice(o->ssvp.firstBounce, s, &w);
        w.counts[PATH_RAY] += (double)o->ssvp.firstBounce * o->ssvp.oversampling * s->pathDepth;
        break;
    case VPL_STAGE_SECOND_BOUNCE:
        addChoice(vplSsvpSamplesMaps(p) ? 0 : o->ssvp.secondBounce, s, &w);
        break;
    case VPL_STAGE_FURTHER_BOUNCES:
        addFurtherBounces(s, &w);
        break;
    case VPL_STAGE_PARABOLOIDS:
        addParaboloids(o->ssvp.firstBounce, s, &w);
        break;
    case VPL_STAGE_SECOND_PARABOLOIDS:
        addParaboloids(o->ssvp.secondBounce, s, &w);
        break;
    case VPL_STAGE_PATCHES: // the pieces in the dark are sought before patches are made
        w.counts[PATH_RAY] = 90.0 * (p->patchGroups > 0 ? 0 : p->patches - p->litPatches) * s->pathDepth;
        break;
    case VPL_STAGE_SIDES:
        w.counts[PATH_RAY] = (p->patchGroups > 0 ? 250.0 : 90.0) * p->patches * s->pathDepth;
        break;
    case VPL_STAGE_FORM_FACTORS: // groups have more samples, and no shaft finds what may be in the way
        w.counts[FORM_FACTOR] = p->linked
                                    ? (p->patchGroups > 0 ? 30000 : 20000) * s->sides
                                    : 1100 * s->sides + pairs * (0.24 + 0.14 * o->radiosity.formSamples) *
                                                            s->depth * (p->patchGroups > 0 ? 3 : 1);
        break;
    case VPL_STAGE_PATCH_LIGHT:
        w.counts[SHADOW_RAY] = vplPlan_PointSets(p) * s->sides * o->radiosity.lightSamples *
                               (fmax(s->emitters, s->lamps) + (p->hasSky ? 0.5 * o->lights.skySamples : 0)) *
                               s->depth;
        break;
    case VPL_STAGE_SOLUTION: // about 20 sweeps
        w.counts[FORM_FACTOR] = p->linked ? 2000 * s->sides : 0.55 * pairs;
        break;
    case VPL_STAGE_VERTEX_LIGHT:
        w.counts[PATH_RAY] = vertexRays(s) * s->pathDepth;
        break;
    case VPL_STAGE_GBUFFER:
        w.counts[TRIANGLE] = viewTriangles(s);
        break;
    case VPL_STAGE_PICTURE:
        addPicture(s, &w);
        break;
    case VPL_STAGE_PATHS:
        addPaths(s, s->pixels * (vplPathsAreOpen(p) ? 32 : o->path.samples), &w);
        break;
    default: // little
        break;
    }
    return w;
}

// Keller's lights of step 0 lie on area lights; elsewhere they are the emitters themselves, which cast shadows by maps.
static double drawnLights(const vplPlan* p)
{
    const bool asEmitters = p->options.method == VPL_METHOD_KELLER && !p->hasAreaLights && !p->hasSky;
    return (double)p->virtualLights - (asEmitters ? p->particlesPerStep[0] : 0);
}

void vplCountWork(vplRunner* r, const vplPlan* p, vplWork works[VPL_MAX_PLAN_STAGES])
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    Scale s = {.plan = p,
               .geometry = g,
               .probe = {1, 0.8, 0.4},
               .triangles = g->triangleCount,
               .pixels = vplCountPixels(&p->options.output),
               .lights = drawnLights(p),
               .lamps = g->emits,
               .area = vplGeometry_Area(g),
               .sides = p->patchSides,
               .emitters = p->emittersPerPoint > 0 ? vplChoiceWork(p->emitterCount) * p->emittersPerPoint
                                                   : p->emitterCount,
               .reflectance = vplGeometry_MeanReflectance(g)};
    const double doublings = log2(fmax(s.triangles, 2) / 32);
    s.depth = 1 + 0.1 * fmax(doublings, 0);
    s.pathDepth = 1 + 0.06 * fmax(doublings, 0);
    s.overlap = 1 + 0.1 * fmax(doublings, 0);
    if (p->castsRays || g->triangleCount < 1000) {
        if (!r->probed) {
            r->probe = vplProbe_Take(g, &p->view, (float)p->camera.nearPlane);
            r->probed = true;
        }
        s.probe = r->probe;
    }
    for (int i = 0; i < p->stageCount; i++) {
        works[i] = workOf(&s, (vplStageId)p->stages[i].id);
    }
}
