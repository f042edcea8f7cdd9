// SPDX-License-Identifier: MIT
// The stages that vpl bench times. Each can run alone: it makes everything that it needs beyond openBench.
#include "cli/bench/bench.h"

static vplResult runParticles(Bench* b, const Stage* stage, Outcome* outcome)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = stage->lights;
    def.sampler = VPL_SAMPLER_HALTON;
    vplLightSet* set;
    TRY(vplSimulateParticles(b->geometry, vplScene_GetEmitter(b->scene, 0), 1, &def, &set));
    outcome->hash = (uint64_t)set->lightCount << 32 | (uint64_t)set->escaped;
    outcome->rays = set->rays;
    outcome->work = (double)set->rays;
    outcome->unit = "rays";
    vplLightSet_Destroy(set);
    return VPL_SUCCESS;
}

static vplResult runCubeMap(Bench* b, const Stage* stage, Outcome* outcome)
{
    (void)stage;
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.position = vplScene_GetEmitter(b->scene, 0)->position;
    vplCubeMap* map;
    TRY(vplCubeMap_Create(b->geometry, &def, NULL, NULL, &map));
    outcome->raster = map->stats;
    outcome->work = 6.0 * def.size * def.size;
    outcome->unit = "texels";
    for (int i = 0; i < 6 * def.size * def.size; i += 997) {
        addFloat(&outcome->hash, map->texels[i]);
    }
    vplCubeMap_Destroy(map);
    return VPL_SUCCESS;
}

// Each map is bounded once, for the soft shadows of direct light.
static vplResult runMapBounds(Bench* b, const Stage* stage, Outcome* outcome)
{
    (void)stage;
    TRY(needShadow(b));
    outcome->work = 6.0 * b->map->size * b->map->size;
    outcome->unit = "texels";
    return vplCubeMap_FindBounds(b->map);
}

vplResult shadeInto(Bench* b, const vplGeometry* geometry, const Stage* stage, vplImage* image,
                    Outcome* outcome)
{
    const bool rays = (stage->flags & RAYS) != 0, direct = (stage->flags & DIRECT) != 0;
    TRY(direct ? needShadow(b) : VPL_SUCCESS);
    vplShadeDef def = vplDefaultShadeDef();
    def.lighting = stage->lighting;
    def.accumulation = stage->accumulation;
    def.batch = stage->batch;
    def.interleave = 4;
    def.minDistance = 0.2f;
    def.emitters = vplScene_GetEmitter(b->scene, 0);
    def.shadows = &b->shadow;
    def.emitterCount = direct;
    def.particleCount = 10;
    def.lights = b->lights;
    def.lightCount = stage->lights;
    def.lightRays = rays;
    def.output = stage->flags & NORMALS ? VPL_OUTPUT_NORMALS : VPL_OUTPUT_RADIANCE;
    vplView view = vplView_Create(vplScene_GetCamera(b->scene, 0), image->width, image->height);
    vplShadeStats stats;
    TRY(vplShadeView(geometry, &view, &def, image, &stats));
    const double pixels = (double)image->width * image->height;
    outcome->raster = stats.raster;
    outcome->rays = stats.shadowRays;
    outcome->pixelLights = pixels * stage->lights;
    outcome->work = rays ? (double)stats.shadowRays : stage->lights ? outcome->pixelLights : pixels;
    outcome->unit = rays ? "rays" : stage->lights ? "pixel-lights" : "pixels";
    outcome->image = image;
    return VPL_SUCCESS;
}

vplResult runShading(Bench* b, const Stage* stage, Outcome* outcome)
{
    return shadeInto(b, b->geometry, stage, stage->flags & RAYS ? b->quarter : b->image, outcome);
}

static vplResult runFieldView(Bench* b, const Stage* stage, Outcome* outcome)
{
    TRY(needField(b));
    TRY(shadeInto(b, b->fieldGeometry, stage, b->image, outcome));
    outcome->work = (double)outcome->raster.trianglesIn;
    outcome->unit = "triangles";
    return VPL_SUCCESS;
}

static vplResult runPng(Bench* b, const Stage* stage, Outcome* outcome)
{
    (void)stage;
    vplWriteOptions options = vplDefaultWriteOptions();
    options.tonemap = VPL_TONEMAP_REINHARD;
    uint8_t* bytes;
    size_t size;
    TRY(needPicture(b));
    TRY(vplImage_Encode(b->picture, ".png", &options, &bytes, &size));
    for (size_t i = 0; i < size; i++) {
        outcome->hash = (outcome->hash ^ bytes[i]) * 0x100000001B3u;
    }
    outcome->work = (double)b->picture->width * b->picture->height;
    outcome->unit = "pixels";
    vplBytes_Free(b->context, bytes);
    return VPL_SUCCESS;
}

static vplResult runToneMap(Bench* b, const Stage* stage, Outcome* outcome)
{
    (void)stage;
    const size_t bytes = 3 * sizeof(float) * (size_t)b->image->width * (size_t)b->image->height;
    vplReinhardDef def = vplDefaultReinhardDef();
    TRY(needPicture(b));
    memcpy(b->image->pixels, b->picture->pixels, bytes);
    outcome->work = (double)b->image->width * b->image->height;
    outcome->unit = "pixels";
    outcome->image = b->image;
    return vplToneMap_Reinhard(b->image, &def);
}

#define DOCUMENTED VPL_LIGHTING_DOCUMENTED
#define PHYSICAL   VPL_LIGHTING_PHYSICAL
#define MULTIPASS  VPL_ACCUMULATE_MULTIPASS
#define BATCHED    VPL_ACCUMULATE_BATCHED
#define DEFERRED   VPL_ACCUMULATE_DEFERRED
#define MIXED      VPL_ACCUMULATE_INTERLEAVED

const Stage STAGES[] = {
    {"particles, N = 3000", runParticles, PHYSICAL, 0, 3000, 1, 0},
    {"geometry and tree, 262144 triangles", runGeometry, PHYSICAL, 0, 0, 1, 0},
    {"closest hits, 262144 triangles, 1/16", runClosestHits, PHYSICAL, 0, 0, 1, SERIAL},
    {"path tracing, 1 spp, 1/16", runPath, PHYSICAL, 0, 0, 1, 0},
    {"shadow rays of 64 lights, 1/16", runShading, PHYSICAL, DEFERRED, 64, 1, RAYS},
    {"cube shadow map, 6 x 1024^2", runCubeMap, PHYSICAL, 0, 0, 1, 0},
    {"bounds of the map", runMapBounds, PHYSICAL, 0, 0, 1, 0},
    {"depth fill, 8 layers", runFill, PHYSICAL, 0, 0, 1, 0},
    {"additive fill, 8 layers, 4 planes", runAdditiveFill, PHYSICAL, 0, 0, 1, 0},
    {"triangles of 2 pixels", runSmallTriangles, PHYSICAL, 0, 0, 1, 0},
    {"G-buffer", runShading, PHYSICAL, DEFERRED, 0, 1, 0},
    {"G-buffer, 262144 triangles", runFieldView, PHYSICAL, DEFERRED, 0, 1, NORMALS},
    {"direct light, 16 PCF samples", runShading, PHYSICAL, DEFERRED, 0, 1, DIRECT},
    {"multipass, 18 lights, documented", runShading, DOCUMENTED, MULTIPASS, 18, 1, 0},
    {"batched, 18 lights, documented", runShading, DOCUMENTED, BATCHED, 18, 18, 0},
    {"deferred, 18 lights, documented", runShading, DOCUMENTED, DEFERRED, 18, 1, 0},
    {"multipass, 198 lights, documented", runShading, DOCUMENTED, MULTIPASS, 198, 1, 0},
    {"batched, 198 lights, documented", runShading, DOCUMENTED, BATCHED, 198, 64, 0},
    {"deferred, 198 lights, documented", runShading, DOCUMENTED, DEFERRED, 198, 1, 0},
    {"deferred, 512 lights, documented", runShading, DOCUMENTED, DEFERRED, 512, 1, 0},
    {"interleaved 4x4, 512 lights, documented", runShading, DOCUMENTED, MIXED, 512, 1, 0},
    {"deferred, 1998 lights, documented", runShading, DOCUMENTED, DEFERRED, 1998, 1, SLOW},
    {"multipass, 18 lights, physical", runShading, PHYSICAL, MULTIPASS, 18, 1, SLOW},
    {"batched, 18 lights, physical", runShading, PHYSICAL, BATCHED, 18, 18, SLOW},
    {"deferred, 18 lights, physical", runShading, PHYSICAL, DEFERRED, 18, 1, 0},
    {"multipass, 198 lights, physical", runShading, PHYSICAL, MULTIPASS, 198, 1, SLOW},
    {"batched, 198 lights, physical", runShading, PHYSICAL, BATCHED, 198, 64, SLOW},
    {"deferred, 198 lights, physical", runShading, PHYSICAL, DEFERRED, 198, 1, 0},
    {"deferred, 512 lights, physical", runShading, PHYSICAL, DEFERRED, 512, 1, 0},
    {"deferred, 1998 lights, physical", runShading, PHYSICAL, DEFERRED, 1998, 1, 0},
    {"multipass, 512 lights, physical", runShading, PHYSICAL, MULTIPASS, 512, 1, SLOW},
    {"batched, 512 lights, physical", runShading, PHYSICAL, BATCHED, 512, 64, SLOW},
    {"batched, 1998 lights, physical", runShading, PHYSICAL, BATCHED, 1998, 64, SLOW},
    {"tone map, Reinhard", runToneMap, PHYSICAL, 0, 0, 1, 0},
    {"tone map and PNG", runPng, PHYSICAL, 0, 0, 1, 0},
};

const int STAGE_COUNT = sizeof STAGES / sizeof *STAGES;
