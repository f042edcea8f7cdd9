// SPDX-License-Identifier: MIT
// Counts and bytes of a plan. A stage that ran while decisions were made is known exactly; for the others
// sizes follow from what they allocate. tests/test_plan.c compares the sum with what rendering holds.
#include "radiosity/links/links.h"
#include "render/plan.h"
#include "render/stages/make.h"
#include "render/stages/ssvp.h"
#include "visibility/hemi_map.h"
#include "scene/scene.h"
#include "visibility/paraboloid_map.h"

#include <math.h>

typedef struct Bytes {
    double held, scratch;
} Bytes;

typedef struct Scale {
    const vplPlan* plan;
    double workers, triangles, objects, pixels, lights, drawn, sides; // drawn: lights that shading adds up
    bool smooth;                                                      // some object has shading normals
    Bytes links;                                                      // 0 where they are not known
    vplSharedBytes factors;                                           // of all pairs
} Scale;

// Bytes of one plane of a tile: a float or an int per pixel.
static const double TILE_PLANE = 4.0 * VPL_TILE_SIDE * VPL_TILE_SIDE;

// Bytes per triangle that the rasterizer holds while it draws a view, and the six faces of a cube map.
static const double RASTER_VIEW = 34, RASTER_CUBE = 150;

int vplEmitterMapFaces(const vplPlan* p)
{
    int faces = 0;
    for (int i = 0; i < p->emitterCount; i++) {
        faces += p->emitters[i].type != VPL_EMITTER_DIRECTIONAL ? 6 : 0;
    }
    return faces;
}

double vplEmitterMapBytes(const vplPlan* p)
{
    const double texels = (double)p->options.shadow.mapSize * p->options.shadow.mapSize;
    return vplEmitterMapFaces(p) * texels * sizeof(float);
}

double vplReflectiveMapFaces(const vplPlan* p)
{
    double faces = 0;
    for (int i = 0; i < p->mapEmitterCount; i++) {
        faces += p->mapEmitters[i].type == VPL_EMITTER_POINT ? 6 : 1;
    }
    return faces;
}

// ---- stages

// Maps of both hemispheres, whether they are used or not, for the clusters of at most so many lights.
static Bytes paraboloids(const Scale* s, double lights, double values)
{
    const int size = s->plan->options.ssvp.paraboloidSize;
    const double texels = 2 * (double)vplParaboloidMap_Texels(size), drawn = (double)vplHemiMap_Texels(size);
    const double most = vplSsvpMostClusters(s->plan), count = lights < most ? lights : most;
    return (Bytes){4 * values * (count * texels + s->workers * drawn), 0};
}

// Lights of a bounce that are kept, and those that they are chosen from: so many.
static Bytes chosen(double lights, double all)
{
    return (Bytes){(lights + all) * sizeof(vplVirtualLight), 60 * all};
}

// Where there are no more candidates than lights, all are kept.
static Bytes bounce(const Scale* s, double lights)
{
    const double all = vplSsvpCountCandidates(s->plan, (int)lights);
    return chosen(lights, all > lights ? all : 0);
}

// K-means, and where clusters are split, what each light sees.
static Bytes clusters(const Scale* s, double lights)
{
    return vplSsvpSplits(s->plan) ? (Bytes){7 * lights + 56.0 * vplSsvpMostClusters(s->plan), 45 * lights}
                                  : (Bytes){3 * lights, 45 * lights};
}

// All bounces after the second: each has clusters and maps where it is sampled from maps; else they share one
// set of them.
static Bytes furtherBounces(const Scale* s)
{
    const vplPlan* p = s->plan;
    const bool sampled = vplSsvpSamplesMaps(p);
    double lights = 0, all = 0, held = 0, scratch = 0;
    for (int k = 2; k < p->options.maxBounces; k++) {
        const double mine = vplSsvpCountLights(p, k);
        lights += mine;
        all += vplSsvpChooses(p) ? vplSsvpCountCandidates(p, (int)mine) : 0;
        held += sampled ? paraboloids(s, mine, k + 1 < p->options.maxBounces ? 2 : 1).held : 0;
    }
    const Bytes made = chosen(lights, all), grouped = clusters(s, lights);
    held += sampled || !vplSsvpSees(p) ? 0 : paraboloids(s, lights, 1).held;
    scratch = made.scratch > grouped.scratch ? made.scratch : grouped.scratch;
    return (Bytes){held + made.held + grouped.held, scratch};
}

vplSharedBytes vplEstimateFactors(const vplRunner* r, const vplPlan* p)
{
    const double sides = p->patchSides;
    const vplTeam* team = &r->run.context->team;
    return team->count > 1 ? vplSharedRows_Estimate(r->run.results[VPL_STAGE_SIDES], sides, team->count,
                                                    p->options.radiosity.formSamples)
                           : (vplSharedBytes){4 * sides * sides, 515 * sides};
}

static Bytes formFactors(const Scale* s, double sides)
{
    const double part = s->sides > 0 ? sides / s->sides : 0; // drafts of adaptive patches have fewer
    return !s->plan->linked    ? (Bytes){part * part * s->factors.held, part * s->factors.scratch}
           : s->links.held > 0 ? s->links
                               : (Bytes){800 * sides, 700 * sides};
}

static Bytes patchLight(const Scale* s, double sides)
{
    const double chunk = sides < 4096 ? sides : 4096;
    const double cells = s->plan->gathers ? 12.0 * VPL_PATCH_CELLS : 0;
    return (Bytes){(28 + cells) * sides, 8 * vplPlan_PointSets(s->plan) * sides +
                                             40 * chunk * s->plan->options.radiosity.lightSamples};
}

// The last draft of adaptive patches has two thirds of the final sides.
static Bytes adaptivePatches(const Scale* s)
{
    const double sides = s->sides / 1.5;
    const Bytes factors = formFactors(s, sides), light = patchLight(s, sides);
    const bool cut =
        s->plan->options.radiosity.cuts == VPL_PATCH_CUTS_ON; // nodes and positions of hidden parts
    return (Bytes){(cut ? 150.0 : 70.0) * s->plan->patches,
                   factors.held + light.held + light.scratch + 24 * sides + 300 * sides};
}

static double pipelineScratch(const Scale* s)
{
    const vplRenderOptions* o = &s->plan->options;
    const bool lit = s->plan->showsVirtual || s->plan->gathers;
    switch (o->pipeline.kind) {
    case VPL_ACCUMULATE_MULTIPASS:
    case VPL_ACCUMULATE_BATCHED:
        return 2.82e6 * s->workers;
    case VPL_ACCUMULATE_INTERLEAVED:
        return lit ? 16 * s->pixels + 4.6e5 * s->workers : 1.4e5 * s->workers;
    case VPL_ACCUMULATE_LIGHTCUTS:
        return lit ? 3.6e6 * s->workers + 104 * s->lights : 1.4e5 * s->workers;
    default:
        return 1.4e5 * s->workers;
    }
}

static double countTiles(const vplRenderOptions* o)
{
    return ceil(o->output.width / (double)VPL_TILE_SIDE) * ceil(o->output.height / (double)VPL_TILE_SIDE);
}

// Memory of smooth edges: each worker holds the samples of a tile; interleaved shading a share per pixel and
// the edges of every tile; radiosity one more picture.
static double sampleScratch(const Scale* s)
{
    const vplRenderOptions* o = &s->plan->options;
    const bool filtered = vplPixelsShareLight(s->plan);
    const double tile = (o->output.antialias + 1) * TILE_PLANE + 1024;
    const double tiles = countTiles(o), edges = s->plan->hasCutOuts ? 131072 : 32768;
    return o->output.antialias > 1 ? tile * s->workers + (filtered ? 4 * s->pixels + edges * tiles : 0) +
                                         (s->plan->showsPatches && !s->plan->gathers ? 12 * s->pixels : 0)
                                   : 0;
}

// True if the picture stage draws direct light a second time, for layers.
static bool drawsDirect(const vplPlan* p)
{
    const bool keller = p->options.method == VPL_METHOD_KELLER;
    return p->splitsLight && p->options.method != VPL_METHOD_PATH &&
           (!p->progressive || (keller && (p->hasAreaLights || p->hasSky)));
}

// Bytes that shading holds for each light: its copy and class where lights are interleaved, and what lights
// are culled by.
static double bytesPerLight(const vplRenderOptions* o)
{
    const vplLightShadows shadows = o->lights.shadows;
    const bool maps = shadows == VPL_LIGHT_SHADOWS_MAP, culled = !maps && shadows != VPL_LIGHT_SHADOWS_RAY;
    const size_t columns = culled ? 6 * sizeof(float) : 0,
                 copy = sizeof(vplShadeLight) + sizeof(int) + (maps ? sizeof(vplHemiMap) : 0) +
                        (shadows == VPL_LIGHT_SHADOWS_CLUSTER ? sizeof(int) : 0);
    return (double)(o->pipeline.kind == VPL_ACCUMULATE_INTERLEAVED ? copy + columns
                    : o->pipeline.kind == VPL_ACCUMULATE_DEFERRED  ? columns
                                                                   : 0);
}

// Lights and their maps; where the maps do not fit into their memory, of one batch, and the sum of batches.
static double lightScratch(const Scale* s)
{
    const vplRenderOptions* o = &s->plan->options;
    const double map = (double)(vplHemiMaps_BytesPerMap(o->lights.mapSize) + sizeof(vplHemiMapPlace));
    const double room = floor(o->lights.mapMemory * 1048576.0 / map);
    if (o->lights.shadows != VPL_LIGHT_SHADOWS_MAP) {
        return s->drawn * bytesPerLight(o);
    }
    return (s->drawn < room ? s->drawn : room) * (bytesPerLight(o) + map) +
           (s->drawn > room ? 12 * s->pixels : 0);
}

// Triangles and positions, normals where some object is smooth, and samples. Each worker holds a tile while it is drawn.
static Bytes gbuffer(const Scale* s)
{
    const vplRenderOptions* o = &s->plan->options;
    const double samples = o->output.antialias & ~1, kept = (s->smooth ? 7 : 4) + samples;
    return (Bytes){countTiles(o) * kept * TILE_PLANE,
                   (9 + samples) * TILE_PLANE * s->workers + RASTER_VIEW * s->triangles};
}

static Bytes picture(const Scale* s)
{
    const vplRenderOptions* o = &s->plan->options;
    double scratch = pipelineScratch(s) + sampleScratch(s);
    scratch += s->plan->keepsGbuffer ? 0 : RASTER_VIEW * s->triangles;
    scratch += drawsDirect(s->plan) ? 12 * s->pixels : 0;
    scratch += o->output.supersample > 1 ? 24 * s->pixels : 0;
    // What is behind all surfaces is a picture of its own, when the memory of interleaved shading is free again.
    scratch += s->plan->hasSky && s->plan->showsDirect && !vplPixelsShareLight(s->plan) ? 12 * s->pixels : 0;
    scratch += s->plan->showsVirtual ? lightScratch(s) : 0;
    scratch += 48.0 * s->plan->emitterCount * (s->plan->compensates ? 2 : 1); // emitters as kernels read them
    scratch += s->plan->gathers ? 12 * s->sides + 4.0 * s->plan->patches : 0; // what rays meet
    return (Bytes){(s->plan->progressive ? 72 : 12) * s->pixels, scratch};
}

// True if the path tracer keeps a copy of its sums, because a later pass may be cancelled.
static bool isUndone(const vplPlan* p)
{
    return p->options.progress != NULL && vplCountPathPasses(p) > 1;
}

// Sources, and the trees of those that are many (emitter_tree.h).
static Bytes emitterTrees(const vplPlan* p)
{
    const vplTreesWanted wanted = vplTreesOf(p);
    const double emitters = p->emitterCount, triangles = p->emittingTriangles;
    const double chosen =
        (emitters >= wanted.emitters ? emitters : 0) + (triangles >= wanted.triangles ? triangles : 0);
    return (Bytes){sizeof(vplEmitterDef) * emitters + 32 * (emitters + triangles) + 120 * chosen,
                   120 * chosen};
}

static Bytes estimate(const Scale* s, vplStageId id)
{
    const vplPlan* p = s->plan;
    const vplRenderOptions* o = &p->options;
    const double rsmTexels = (double)o->shadow.rsmSize * o->shadow.rsmSize;
    const bool sampled = vplSsvpSamplesMaps(p),
               surfaces = (vplSsvpHasSecondBounce(p) && sampled) || vplSsvpShowsClusters(p);
    switch (id) {
    case VPL_STAGE_EMITTER_MAPS:
        return (Bytes){vplEmitterMapBytes(p) + p->emitterCount * (double)sizeof(vplShadow),
                       2e5 + RASTER_CUBE * s->triangles};
    case VPL_STAGE_EMITTER_TREES:
        return emitterTrees(p);
    case VPL_STAGE_AREA_LIGHTS:
        return (Bytes){(2.0 * o->lights.areaLightSamples + (p->hasSky ? o->lights.skySamples : 0)) *
                           (double)sizeof(vplShadeLight),
                       0};
    case VPL_STAGE_REFLECTIVE_MAPS: // a distance and a triangle per texel
        return (Bytes){vplReflectiveMapFaces(p) * rsmTexels * 8, 1.5e5 + RASTER_VIEW * s->triangles};
    case VPL_STAGE_PARTICLES: // two counts and a flag per particle
        return (Bytes){s->lights * sizeof(vplVirtualLight), 3e4 + 9.0 * o->particles.count};
    case VPL_STAGE_FIRST_BOUNCE: // and the samples of the map
        return vplSsvpChooses(p) ? bounce(s, o->ssvp.firstBounce)
                                 : (Bytes){o->ssvp.firstBounce * (double)sizeof(vplVirtualLight),
                                           56.0 * o->ssvp.firstBounce};
    case VPL_STAGE_CLUSTERS:
        return clusters(s, o->ssvp.firstBounce);
    case VPL_STAGE_SECOND_BOUNCE:
        return bounce(s, o->ssvp.secondBounce);
    case VPL_STAGE_SECOND_CLUSTERS:
        return clusters(s, o->ssvp.secondBounce);
    case VPL_STAGE_FURTHER_BOUNCES:
        return furtherBounces(s);
    case VPL_STAGE_CLUSTERED_LIGHTS: // bounces are joined one after the other
        return (Bytes){s->lights * sizeof(vplVirtualLight), 2 * s->lights * sizeof(vplVirtualLight)};
    case VPL_STAGE_PARABOLOIDS: // distances, and triangles where surfaces are asked for
        return paraboloids(s, o->ssvp.firstBounce, surfaces ? 2 : 1);
    case VPL_STAGE_SECOND_PARABOLOIDS:
        return paraboloids(s, o->ssvp.secondBounce, vplSsvpHasFurtherBounces(p) && sampled ? 2 : 1);
    case VPL_STAGE_VIRTUAL_LIGHTS: // twice where they are sorted by cluster
        return (Bytes){s->lights * (double)(o->lights.shadows == VPL_LIGHT_SHADOWS_CLUSTER
                                                ? 2 * sizeof(vplShadeLight) + sizeof(int)
                                                : sizeof(vplShadeLight)),
                       0};
    case VPL_STAGE_PATCHES:
        return adaptivePatches(s);
    case VPL_STAGE_PATCH_MESH: // faces of cut patches have vertices of their own
        return o->radiosity.cuts == VPL_PATCH_CUTS_ON
                   ? (Bytes){320 * vplPlan_DrawnPatches(p), 300 * vplPlan_DrawnPatches(p)}
                   : (Bytes){98 * vplPlan_DrawnPatches(p), 98 * vplPlan_DrawnPatches(p)};
    case VPL_STAGE_FORM_FACTORS:
        return formFactors(s, s->sides);
    case VPL_STAGE_PATCH_LIGHT:
        return patchLight(s, s->sides);
    case VPL_STAGE_SOLUTION:
        return (Bytes){24 * s->sides, (p->linked ? 152 : 72) * s->sides};
    case VPL_STAGE_VERTEX_LIGHT:
        return (Bytes){14 * vplPlan_DrawnPatches(p),
                       57.0 * p->patches + 16.0 * p->groupedTriangles + (p->gathers ? 12 * s->sides : 0)};
    case VPL_STAGE_GBUFFER:
        return gbuffer(s);
    case VPL_STAGE_PICTURE:
        return picture(s);
    case VPL_STAGE_PATHS: // sums of two halves, and the picture that they resolve to
        return (Bytes){((p->splitsLight ? 2 : 1) * (isUndone(p) ? 96 : 48) + 12) * s->pixels, 0};
    default: // little
        return (Bytes){0, 0};
    }
}

// Layers when the last of them is drawn, besides what the render holds: pictures, and their scratch memory.
static Bytes layers(const Scale* s)
{
    const vplPlan* p = s->plan;
    const int aovs = p->options.output.aovs, light = aovs & (VPL_AOV_DIRECT | VPL_AOV_INDIRECT);
    const bool path = p->options.method == VPL_METHOD_PATH;
    if (aovs == 0) {
        return (Bytes){0, 0};
    }
    const int pictures = !path && !p->progressive, direct = drawsDirect(p) + (light == VPL_AOV_INDIRECT);
    const double scratch = RASTER_VIEW * s->triangles + 1.4e5 * s->workers;
    return (Bytes){12 * s->pixels * (__builtin_popcount((unsigned)aovs) + pictures + direct),
                   light == aovs ? 0 : scratch + (vplCountLayerSamples(p) > 1 ? 12 * s->pixels : 0)};
}

// ---- the plan

// Keller's lights of step 0 are drawn where they lie on area lights; elsewhere they are the emitter itself.
static int64_t drawnLights(const vplRunner* r, const vplPlan* p)
{
    const bool asEmitters = p->options.method == VPL_METHOD_KELLER && !p->hasAreaLights && !p->hasSky;
    const vplVirtualLights* known = r->history->slots[VPL_STAGE_VIRTUAL_LIGHTS].result;
    return known != NULL ? known->count : p->virtualLights - (asEmitters ? p->particlesPerStep[0] : 0);
}

static void countDraws(const Scale* s, vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    const int64_t objects = (int64_t)s->objects, supersample = o->output.supersample;
    p->passes = o->stop.passes;
    if (o->method == VPL_METHOD_PATH) {
        p->passes = vplPathsAreOpen(p) ? 0 : vplCountPathPasses(p);
        p->paths = vplPathsAreOpen(p) ? 0 : (int64_t)s->pixels * o->path.samples;
        return;
    }
    if (o->method == VPL_METHOD_SSVP) {
        p->drawCalls = objects * ((int64_t)vplReflectiveMapFaces(p) + supersample);
        return;
    }
    const int64_t perPass = o->pipeline.kind == VPL_ACCUMULATE_BATCHED ? o->pipeline.batch : 1;
    const int64_t passes =
        o->pipeline.kind >= VPL_ACCUMULATE_DEFERRED ? 0 : ((int64_t)s->drawn + perPass - 1) / perPass;
    const bool drawn = o->method == VPL_METHOD_RADIOSITY && !p->gathers;
    const int64_t patchDraws = drawn ? 2 : 0; // of fronts and of backs
    const int64_t faces = p->emitterRays ? 0 : vplEmitterMapFaces(p);
    p->drawCalls =
        objects * (faces + (1 + passes) * supersample) + patchDraws * supersample * vplCountPoints(p);
}

enum {
    SHADOW_MAPS = 1 << VPL_STAGE_EMITTER_MAPS | 1 << VPL_STAGE_REFLECTIVE_MAPS | 1 << VPL_STAGE_PARABOLOIDS |
                  1 << VPL_STAGE_SECOND_PARABOLOIDS | 1 << VPL_STAGE_FURTHER_BOUNCES,
    LIGHTS = 1 << VPL_STAGE_AREA_LIGHTS | 1 << VPL_STAGE_PARTICLES | 1 << VPL_STAGE_FIRST_BOUNCE |
             1 << VPL_STAGE_SECOND_BOUNCE | 1 << VPL_STAGE_CLUSTERED_LIGHTS | 1 << VPL_STAGE_VIRTUAL_LIGHTS,
    // Each pass makes them before it drops those of the last.
    REMADE = 1 << VPL_STAGE_PARABOLOIDS | 1 << VPL_STAGE_SECOND_PARABOLOIDS | 1 << VPL_STAGE_FURTHER_BOUNCES
};

// Links depend on what sees what, so a sample of them is found; not for a render, of which that takes 3 %.
static vplResult estimateLinks(const vplRunner* r, Scale* s)
{
    const vplPatchSides* sides = r->run.results[VPL_STAGE_SIDES];
    if (!r->foretells || !s->plan->linked || sides == NULL) {
        return VPL_SUCCESS;
    }
    vplLinkDef def = vplDefaultLinkDef();
    def.error = s->plan->options.radiosity.linkError;
    def.samples = s->plan->options.radiosity.formSamples;
    def.seed = s->plan->options.seed;
    return vplLinks_EstimateBytes(sides, &def, &s->links.held, &s->links.scratch);
}

vplResult vplEstimatePlan(const vplRunner* r, const vplMachine* machine, vplPlan* p)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    Scale s = {.plan = p,
               .workers = machine != NULL ? machine->workerCount : vplContext_GetWorkerCount(r->run.context),
               .triangles = g->triangleCount,
               .objects = g->objectCount,
               .smooth = g->shadingNormals != NULL,
               .pixels = (double)p->options.output.width * p->options.output.height,
               .lights = (double)p->virtualLights,
               .drawn = (double)drawnLights(r, p),
               .sides = p->patchSides};
    TRY(estimateLinks(r, &s));
    s.factors = vplEstimateFactors(r, p);
    // The caller's own memory in the context does not count, but the scene's does.
    const int64_t foreign = (int64_t)r->heldBytes - (int64_t)vplScene_GetBytes(r->run.scene);
    const int64_t peak = (int64_t)vplContext_GetPeakBytes(r->run.context), before = (int64_t)r->peakBytes;
    int64_t live = (int64_t)vplContext_GetBytes(r->run.context) - foreign, remade = 0;
    p->peakBytes = (peak > before ? peak : before) - foreign;
    for (int i = 0; i < p->stageCount; i++) {
        vplPlanStage* stage = &p->stages[i];
        const vplSlot* slot = &r->history->slots[stage->id];
        if (slot->result != NULL) { // it ran while decisions were made, and is part of `live`
            stage->bytes = slot->bytes;
            stage->scratch = slot->scratch;
        } else {
            const Bytes bytes = estimate(&s, (vplStageId)stage->id);
            stage->bytes = (int64_t)bytes.held;
            stage->scratch = (int64_t)bytes.scratch;
            live += stage->bytes;
            p->peakBytes = live + stage->scratch > p->peakBytes ? live + stage->scratch : p->peakBytes;
        }
        remade =
            p->progressive && (1 << stage->id & REMADE) != 0 && stage->bytes > remade ? stage->bytes : remade;
        p->shadowMapBytes += (1 << stage->id & SHADOW_MAPS) != 0 ? stage->bytes : 0;
        p->lightBytes += (1 << stage->id & LIGHTS) != 0 ? stage->bytes : 0;
    }
    const Bytes more = layers(&s);
    live += (int64_t)(more.held + more.scratch) + remade;
    p->peakBytes = live > p->peakBytes ? live : p->peakBytes;
    p->layerBytes = (int64_t)(12 * s.pixels) * __builtin_popcount((unsigned)p->options.output.aovs);
    p->pictureBytes = (int64_t)(12 * s.pixels);
    countDraws(&s, p);
    return VPL_SUCCESS;
}
