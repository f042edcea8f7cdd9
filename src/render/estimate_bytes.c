// SPDX-License-Identifier: MIT
#include "render/estimate_bytes.h"

#include "render/options.h"
#include "render/stages/make.h"
#include "render/stages/ssvp.h"
#include "visibility/hemi_map.h"
#include "visibility/paraboloid_map.h"

#include <math.h>

// Bytes of one plane of a tile: a float or an int per pixel.
static const double TILE_PLANE = 4.0 * VPL_TILE_SIDE * VPL_TILE_SIDE;

// Bytes per triangle that the rasterizer holds while it draws a view, and the six faces of a cube map.
static const double RASTER_VIEW = 34, RASTER_CUBE = 150;

// Maps of both hemispheres, whether they are used or not, for the clusters of at most so many lights.
static vplStageBytes paraboloids(const vplPlanScale* s, double lights, double values)
{
    const int size = s->plan->options.ssvp.paraboloidSize;
    const double texels = 2 * (double)vplParaboloidMap_Texels(size), drawn = (double)vplHemiMap_Texels(size);
    const double most = vplSsvpMostClusters(s->plan), count = lights < most ? lights : most;
    return (vplStageBytes){4 * values * (count * texels + s->workers * drawn), 0};
}

// Lights of a bounce that are kept, and those that they are chosen from: so many.
static vplStageBytes chosen(double lights, double all)
{
    return (vplStageBytes){(lights + all) * sizeof(vplVirtualLight), 60 * all};
}

// Where there are no more candidates than lights, all are kept.
static vplStageBytes bounce(const vplPlanScale* s, double lights)
{
    const double all = vplSsvpCountCandidates(s->plan, (int)lights);
    return chosen(lights, all > lights ? all : 0);
}

// K-means, and where clusters are split, what each light sees.
static vplStageBytes clusters(const vplPlanScale* s, double lights)
{
    return vplSsvpSplits(s->plan)
               ? (vplStageBytes){7 * lights + 56.0 * vplSsvpMostClusters(s->plan), 45 * lights}
               : (vplStageBytes){3 * lights, 45 * lights};
}

// All bounces after the second: each has clusters and maps where it is sampled from maps; else they share one
// set of them.
static vplStageBytes furtherBounces(const vplPlanScale* s)
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
    const vplStageBytes made = chosen(lights, all), grouped = clusters(s, lights);
    held += sampled || !vplSsvpSees(p) ? 0 : paraboloids(s, lights, 1).held;
    scratch = made.scratch > grouped.scratch ? made.scratch : grouped.scratch;
    return (vplStageBytes){held + made.held + grouped.held, scratch};
}

vplSharedBytes vplEstimateFactors(const vplRunner* r, const vplPlan* p)
{
    const double sides = p->patchSides;
    const vplTeam* team = &r->run.context->team;
    return team->count > 1 ? vplSharedRows_Estimate(r->run.results[VPL_STAGE_SIDES], sides, team->count,
                                                    p->options.radiosity.formSamples)
                           : (vplSharedBytes){4 * sides * sides, 515 * sides};
}

static vplStageBytes formFactors(const vplPlanScale* s, double sides)
{
    const double part = s->sides > 0 ? sides / s->sides : 0; // drafts of adaptive patches have fewer
    return !s->plan->linked    ? (vplStageBytes){part * part * s->factors.held, part * s->factors.scratch}
           : s->links.held > 0 ? s->links
                               : (vplStageBytes){800 * sides, 700 * sides};
}

static vplStageBytes patchLight(const vplPlanScale* s, double sides)
{
    const double chunk = sides < 4096 ? sides : 4096;
    const double cells = s->plan->gathers ? 12.0 * VPL_PATCH_CELLS : 0;
    return (vplStageBytes){(28 + cells) * sides, 8 * vplPlan_PointSets(s->plan) * sides +
                                                     40 * chunk * s->plan->options.radiosity.lightSamples};
}

// The last draft of adaptive patches has two thirds of the final sides.
static vplStageBytes adaptivePatches(const vplPlanScale* s)
{
    const double sides = s->sides / 1.5;
    const vplStageBytes factors = formFactors(s, sides), light = patchLight(s, sides);
    const bool cut =
        s->plan->options.radiosity.cuts == VPL_PATCH_CUTS_ON; // nodes and positions of hidden parts
    return (vplStageBytes){(cut ? 150.0 : 70.0) * s->plan->patches,
                           factors.held + light.held + light.scratch + 24 * sides + 300 * sides};
}

static double pipelineScratch(const vplPlanScale* s)
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
    return ceil(vplRenderedWidth(&o->output) / (double)VPL_TILE_SIDE) *
           ceil(vplRenderedHeight(&o->output) / (double)VPL_TILE_SIDE);
}

// Memory of smooth edges: each worker holds the samples of a tile; interleaved shading a share per pixel and
// the edges of every tile; radiosity one more picture.
static double sampleScratch(const vplPlanScale* s)
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
static double lightScratch(const vplPlanScale* s)
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
static vplStageBytes gbuffer(const vplPlanScale* s)
{
    const vplRenderOptions* o = &s->plan->options;
    const double samples = o->output.antialias & ~1, kept = (s->smooth ? 7 : 4) + samples;
    return (vplStageBytes){countTiles(o) * kept * TILE_PLANE,
                           (9 + samples) * TILE_PLANE * s->workers + RASTER_VIEW * s->triangles};
}

static vplStageBytes picture(const vplPlanScale* s)
{
    const vplRenderOptions* o = &s->plan->options;
    double scratch = pipelineScratch(s) + sampleScratch(s);
    scratch += s->plan->keepsGbuffer ? 0 : RASTER_VIEW * s->triangles;
    scratch += drawsDirect(s->plan) ? 12 * s->pixels : 0;
    scratch += o->output.supersample > 1 ? 24 * s->pixels : 0;
    // The background is a picture of its own, which is drawn when the memory of interleaved shading is free again.
    scratch += s->plan->hasSky && s->plan->showsDirect && !vplPixelsShareLight(s->plan) ? 12 * s->pixels : 0;
    scratch += s->plan->showsVirtual ? lightScratch(s) : 0;
    scratch += 48.0 * s->plan->emitterCount * (s->plan->compensates ? 2 : 1); // emitters as kernels read them
    scratch += s->plan->gathers ? 12 * s->sides + 4.0 * s->plan->patches : 0; // what rays meet
    return (vplStageBytes){(s->plan->progressive ? 72 : 12) * s->pixels, scratch};
}

// True if the path tracer keeps a copy of its sums, because a later pass may be cancelled.
static bool isUndone(const vplPlan* p)
{
    return p->options.progress != NULL && vplCountPathPasses(p) > 1;
}

// Sources, and the trees of those that are many (emitter_tree.h).
static vplStageBytes emitterTrees(const vplPlan* p)
{
    const vplTreesWanted wanted = vplTreesOf(p);
    const double emitters = p->emitterCount, triangles = p->emittingTriangles;
    const double chosen =
        (emitters >= wanted.emitters ? emitters : 0) + (triangles >= wanted.triangles ? triangles : 0);
    return (vplStageBytes){sizeof(vplEmitterDef) * emitters + 32 * (emitters + triangles) + 120 * chosen,
                           120 * chosen};
}

vplStageBytes vplEstimateStage(const vplPlanScale* s, vplStageId id)
{
    const vplPlan* p = s->plan;
    const vplRenderOptions* o = &p->options;
    const double rsmTexels = (double)o->shadow.rsmSize * o->shadow.rsmSize;
    const bool sampled = vplSsvpSamplesMaps(p),
               surfaces = (vplSsvpHasSecondBounce(p) && sampled) || vplSsvpShowsClusters(p);
    switch (id) {
    case VPL_STAGE_EMITTER_MAPS:
        return (vplStageBytes){vplEmitterMapBytes(p) + p->emitterCount * (double)sizeof(vplShadow),
                               2e5 + RASTER_CUBE * s->triangles};
    case VPL_STAGE_EMITTER_TREES:
        return emitterTrees(p);
    case VPL_STAGE_AREA_LIGHTS:
        return (vplStageBytes){(2.0 * o->lights.areaLightSamples + (p->hasSky ? o->lights.skySamples : 0)) *
                                   (double)sizeof(vplShadeLight),
                               0};
    case VPL_STAGE_REFLECTIVE_MAPS: // a distance and a triangle per texel
        return (vplStageBytes){vplReflectiveMapFaces(p) * rsmTexels * 8, 1.5e5 + RASTER_VIEW * s->triangles};
    case VPL_STAGE_PARTICLES: // two counts and a flag per particle
        return (vplStageBytes){s->lights * sizeof(vplVirtualLight), 3e4 + 9.0 * o->particles.count};
    case VPL_STAGE_FIRST_BOUNCE: // and the samples of the map
        return vplSsvpChooses(p) ? bounce(s, o->ssvp.firstBounce)
                                 : (vplStageBytes){o->ssvp.firstBounce * (double)sizeof(vplVirtualLight),
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
        return (vplStageBytes){s->lights * sizeof(vplVirtualLight), 2 * s->lights * sizeof(vplVirtualLight)};
    case VPL_STAGE_PARABOLOIDS: // distances, and triangles where surfaces are asked for
        return paraboloids(s, o->ssvp.firstBounce, surfaces ? 2 : 1);
    case VPL_STAGE_SECOND_PARABOLOIDS:
        return paraboloids(s, o->ssvp.secondBounce, vplSsvpHasFurtherBounces(p) && sampled ? 2 : 1);
    case VPL_STAGE_VIRTUAL_LIGHTS: // twice where they are sorted by cluster
        return (vplStageBytes){s->lights * (double)(o->lights.shadows == VPL_LIGHT_SHADOWS_CLUSTER
                                                        ? 2 * sizeof(vplShadeLight) + sizeof(int)
                                                        : sizeof(vplShadeLight)),
                               0};
    case VPL_STAGE_PATCHES:
        return adaptivePatches(s);
    case VPL_STAGE_PATCH_MESH: // faces of cut patches have vertices of their own
        return o->radiosity.cuts == VPL_PATCH_CUTS_ON
                   ? (vplStageBytes){320 * vplPlan_DrawnPatches(p), 300 * vplPlan_DrawnPatches(p)}
                   : (vplStageBytes){98 * vplPlan_DrawnPatches(p), 98 * vplPlan_DrawnPatches(p)};
    case VPL_STAGE_FORM_FACTORS:
        return formFactors(s, s->sides);
    case VPL_STAGE_PATCH_LIGHT:
        return patchLight(s, s->sides);
    case VPL_STAGE_SOLUTION:
        return (vplStageBytes){24 * s->sides, (p->linked ? 152 : 72) * s->sides};
    case VPL_STAGE_VERTEX_LIGHT:
        return (vplStageBytes){14 * vplPlan_DrawnPatches(p), 57.0 * p->patches + 16.0 * p->groupedTriangles +
                                                                 (p->gathers ? 12 * s->sides : 0)};
    case VPL_STAGE_GBUFFER:
        return gbuffer(s);
    case VPL_STAGE_PICTURE:
        return picture(s);
    case VPL_STAGE_PATHS: // sums of two halves, and the picture that they resolve to
        return (vplStageBytes){((p->splitsLight ? 2 : 1) * (isUndone(p) ? 96 : 48) + 12) * s->pixels, 0};
    default: // little
        return (vplStageBytes){0, 0};
    }
}

vplStageBytes vplEstimateLayers(const vplPlanScale* s)
{
    const vplPlan* p = s->plan;
    const int aovs = p->options.output.aovs, light = aovs & (VPL_AOV_DIRECT | VPL_AOV_INDIRECT);
    const bool path = p->options.method == VPL_METHOD_PATH;
    if (aovs == 0) {
        return (vplStageBytes){0, 0};
    }
    const int pictures = !path && !p->progressive, direct = drawsDirect(p) + (light == VPL_AOV_INDIRECT);
    const double scratch = RASTER_VIEW * s->triangles + 1.4e5 * s->workers;
    return (vplStageBytes){12 * s->pixels * (__builtin_popcount((unsigned)aovs) + pictures + direct),
                           light == aovs ? 0 : scratch + (vplCountLayerSamples(p) > 1 ? 12 * s->pixels : 0)};
}
