// SPDX-License-Identifier: MIT
// Refusals of arguments that no other test meets: each returns its code with a sentence that names what is wrong.
#include "emitter_scenes.h"
#include "patch_support.h"
#include "raster_support.h"

#include "math/vec.h"

#include <limits.h>

TEST(ReinhardsValuesAreChecked, 1)
{
    vplImage* image;
    assert_int_equal(vplImage_Create(context, 2, 2, &image), VPL_SUCCESS);
    const vplReinhardDef good = vplDefaultReinhardDef();
    vplReinhardDef def = {0};
    assertRefused(vplToneMap_Reinhard(image, &def), VPL_INVALID_ARGUMENT, "vplDefaultReinhardDef");
    def = good;
    def.key = 1.5f;
    assertRefused(vplToneMap_Reinhard(image, &def), VPL_INVALID_ARGUMENT, "key is 1.5");
    def = good;
    def.delta = -1;
    assertRefused(vplToneMap_Reinhard(image, &def), VPL_INVALID_ARGUMENT, "delta is -1");
    def = good;
    def.white = NAN;
    assertRefused(vplToneMap_Reinhard(image, &def), VPL_INVALID_ARGUMENT, "white is nan");
    vplImage_Destroy(image);
}

TEST(PicturesAreWrittenAsTheirOptionsAllow, 1)
{
    vplImage *image, *layer = NULL;
    assert_int_equal(vplImage_Create(context, 2, 2, &image), VPL_SUCCESS);
    vplWriteOptions o = {0};
    assertRefused(vplImage_Write(image, "/tmp/vpl-refused.png", &o), VPL_INVALID_ARGUMENT,
                  "vplDefaultWriteOptions");
    o = vplDefaultWriteOptions();
    o.exposure = 65;
    assertRefused(vplImage_Write(image, "/tmp/vpl-refused.png", &o), VPL_INVALID_ARGUMENT, "exposure is 65");
    o = vplDefaultWriteOptions();
    o.tonemap = (vplToneMap)99;
    assertRefused(vplImage_Write(image, "/tmp/vpl-refused.png", &o), VPL_INVALID_ARGUMENT, "tonemap is 99");
    assertRefused(vplImage_ReadLayer(context, "/tmp/vpl-refused.png", "direct", &layer), VPL_INVALID_ARGUMENT,
                  "only .exr files");
    vplImage_Destroy(image);
}

TEST(ASceneWithoutACameraHasNoPicture, 1)
{
    vplScene* scene;
    vplImage* image = NULL;
    const vplRenderOptions o = vplDefaultRenderOptions();
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    assertRefused(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT, "no camera");
    vplScene_Destroy(scene);
}

TEST(DocumentedParticlesWantPointLights, 1)
{
    vplScene* scene = sceneOf(context, 0.5f);
    vplGeometry* geometry;
    vplLightSet* set = NULL;
    addLevel(scene, vplVec(0, 0, 0), 10, false, 0);
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    vplEmitterDef sun = vplDefaultEmitterDef();
    sun.type = VPL_EMITTER_DIRECTIONAL;
    vplParticleDef def = vplDefaultParticleDef();
    def.lighting = VPL_LIGHTING_DOCUMENTED;
    assertRefused(vplSimulateParticles(geometry, &sun, 1, &def, &set), VPL_INVALID_ARGUMENT,
                  "light 0 is not a point light");
    assertRefused(vplSimulateParticles(geometry, NULL, 0, &def, &set), VPL_INVALID_ARGUMENT, "no emitter");
    const vplVec3 ways[1] = {{0, INFINITY, 0}};
    sun.type = VPL_EMITTER_POINT;
    def.particleCount = 1;
    def.directions = ways;
    assertRefused(vplSimulateParticles(geometry, &sun, 1, &def, &set), VPL_INVALID_ARGUMENT, "directions[0]");
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
}

TEST(AContextWantsAPlaceAndAnInstructionSetThatExists, 1)
{
    vplContextDef def = vplDefaultContextDef();
    vplContext* none = NULL;
    assert_int_equal(vplContext_Create(&def, NULL), VPL_INVALID_ARGUMENT);
    def.isa = (vplIsa)77;
    assert_int_equal(vplContext_Create(&def, &none), VPL_INVALID_ARGUMENT);
    assert_null(none);
    (void)context;
}

// ---- defs of stages

static void refusePatches(const vplGeometry* g, const vplPatchDef* def, vplResult wanted,
                          const char* sentence)
{
    vplPatches* patches = NULL;
    assertRefused(vplPatches_Create(g, def, &patches), wanted, sentence);
    assert_null(patches);
}

TEST(PatchDefsAreChecked, 1)
{
    vplGeometry* g = closedCube(context, 0.5f);
    vplPatchDef def = {0};
    refusePatches(g, &def, VPL_INVALID_ARGUMENT, "vplPatchDef was not made by vplDefaultPatchDef");
    def = vplDefaultPatchDef();
    def.size = (float)NAN;
    refusePatches(g, &def, VPL_INVALID_ARGUMENT, "vplPatchDef.size is nan, must be finite");
    def.size = -1;
    refusePatches(g, &def, VPL_INVALID_ARGUMENT, "vplPatchDef.size is -1, must be finite and at least 0");
    def.size = 1e-6f;
    def.rounds = VPL_MAX_PATCH_ROUNDS;
    refusePatches(g, &def, VPL_LIMIT, "patches with edges up to 1e-06 m are more than");
    def = vplDefaultPatchDef();
    def.count = 0;
    refusePatches(g, &def, VPL_INVALID_ARGUMENT, "vplPatchDef.count is 0, must be in [1, ");
    def.count = VPL_MAX_PATCHES + 1;
    refusePatches(g, &def, VPL_INVALID_ARGUMENT, "must be in [1, ");
    def.count = 1;
    def.rounds = -1;
    refusePatches(g, &def, VPL_INVALID_ARGUMENT, "vplPatchDef.rounds is -1, must be in [0, ");
    def.rounds = VPL_MAX_PATCH_ROUNDS + 1;
    refusePatches(g, &def, VPL_INVALID_ARGUMENT, "vplPatchDef.rounds is ");
    vplGeometry_Destroy(g);
}

TEST(DefsOfMapsAreChecked, 1)
{
    vplGeometry* g = closedCube(context, 0.5f);
    vplCubeMapDef cubeDef = {0};
    vplShadowDef shadowDef = {0};
    vplCubeMap* cube = NULL;
    vplShadow shadow;
    assertRefused(vplCubeMap_Create(g, &cubeDef, NULL, NULL, &cube), VPL_INVALID_ARGUMENT,
                  "vplCubeMapDef was not made by vplDefaultCubeMapDef");
    assert_null(cube);
    cubeDef = vplDefaultCubeMapDef();
    cubeDef.size = 4;
    assert_int_equal(vplCubeMap_Create(g, &cubeDef, NULL, NULL, &cube), VPL_SUCCESS);
    assertRefused(vplShadow_Create(cube, &shadowDef, &shadow), VPL_INVALID_ARGUMENT,
                  "vplShadowDef was not made by vplDefaultShadowDef");
    vplCubeMap_Destroy(cube);
    vplGeometry_Destroy(g);
}

// These maps are drawn through the ray tree, which is built only where something needs it.
TEST(MapsOfVirtualLightsNeedTheRayTree, 1)
{
    static const char* const sentence = "these maps are drawn through the ray tree";
    vplScene* scene = loadScene(context, "room.json");
    vplGeometry* g;
    vplHemiMaps* hemi;
    vplParaboloidMaps* paraboloids;
    const vplHemiMapPlace place = {vplVec(0, 1, 0), vplVec(0, 1, 0)};
    const vplParaboloidPlace above = {vplVec(0, 1, 0), vplVec(0, 1, 0), 1, true};
    assert_int_equal(vplGeometry_CreateForRaster(scene, &g), VPL_SUCCESS);
    assert_int_equal(vplHemiMaps_Create(context, 8, 1, &hemi), VPL_SUCCESS);
    assert_int_equal(vplParaboloidMaps_Create(context, 8, 1, false, &paraboloids), VPL_SUCCESS);
    assertRefused(vplHemiMaps_Draw(hemi, g, &place, 1, NULL, NULL), VPL_INVALID_ARGUMENT, sentence);
    assertRefused(vplParaboloidMaps_Draw(paraboloids, g, &above, 1, NULL, NULL), VPL_INVALID_ARGUMENT,
                  sentence);
    assert_int_equal(vplGeometry_BuildRayTree(g), VPL_SUCCESS);
    assert_int_equal(vplHemiMaps_Draw(hemi, g, &place, 1, NULL, NULL), VPL_SUCCESS);
    assert_int_equal(vplParaboloidMaps_Draw(paraboloids, g, &above, 1, NULL, NULL), VPL_SUCCESS);
    vplParaboloidMaps_Destroy(paraboloids);
    vplHemiMaps_Destroy(hemi);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

TEST(DefsOfLightsAreChecked, 1)
{
    vplGeometry* g = closedCube(context, 0.5f);
    vplLightSet* set = NULL;
    vplParticleDef particles = vplDefaultParticleDef();
    const vplEmitterDef emitter = vplDefaultEmitterDef();
    const vplRsmSampleDef samples = vplDefaultRsmSampleDef();
    vplSecondBounceDef second = vplDefaultSecondBounceDef();
    particles.firstParticle = -1;
    assertRefused(vplSimulateParticles(g, &emitter, 1, &particles, &set), VPL_INVALID_ARGUMENT,
                  "vplParticleDef.firstParticle is -1, must be in [0, 2^40]");
    assertRefused(vplSampleReflectiveMaps(g, NULL, -1, &samples, &set), VPL_INVALID_ARGUMENT,
                  "mapCount is -1");
    vplParaboloidMaps* maps;
    const vplLightClusters none = {.context = context};
    assert_int_equal(vplParaboloidMaps_Create(context, 8, 1, true, &maps), VPL_SUCCESS);
    second.step = 0;
    assertRefused(vplSampleParaboloidMaps(g, &none, maps, &second, &set), VPL_INVALID_ARGUMENT,
                  "vplSecondBounceDef.step is 0, must be in [1, 63]");
    second.step = 64;
    assertRefused(vplSampleParaboloidMaps(g, &none, maps, &second, &set), VPL_INVALID_ARGUMENT,
                  "vplSecondBounceDef.step is 64");
    assert_null(set);
    vplParaboloidMaps_Destroy(maps);
    vplGeometry_Destroy(g);
}

TEST(PipelinesThatWereNeverFilledInAreRefused, 1)
{
    static const ClipVertex vertices[3];
    static const uint32_t indices[3] = {0, 1, 2};
    float depth[16];
    vplFramebuffer framebuffer = vplDefaultFramebuffer(4, 4);
    vplRaster* raster;
    vplMesh mesh = {.indices = indices, .vertexCount = 3, .triangleCount = 1};
    const vplPipeline empty = {0};
    const vplPipeline pipeline = showPipeline(vertices);
    framebuffer.depth.pixels = depth;
    assert_int_equal(vplRaster_Create(context, &framebuffer, &raster), VPL_SUCCESS);
    assertRefused(vplRaster_Draw(raster, &mesh, &empty), VPL_INVALID_ARGUMENT,
                  "vplPipeline was not made by vplDefaultPipeline");
    mesh.triangleCount = -1;
    assertRefused(vplRaster_Draw(raster, &mesh, &pipeline), VPL_INVALID_ARGUMENT,
                  "vplMesh has 3 vertices and -1 triangles, must not be negative");
    vplRaster_Destroy(raster);
}

TEST(ArgumentsOfPicturesAndOptionsAreChecked, 1)
{
    vplImage* image;
    float pixel[3];
    uint8_t* bytes = NULL;
    size_t size = 0;
    assert_int_equal(vplImage_Create(context, 1, 1, &image), VPL_SUCCESS);
    const vplPixelsDef pixels = {.first = pixel};
    assertRefused(vplImage_CopyTo(image, &pixels), VPL_INVALID_ARGUMENT,
                  "vplPixelsDef was not made by vplDefaultPixelsDef");
    const vplLayer layer = {.name = "a", .image = image};
    assert_int_equal(vplImage_EncodeLayers(&layer, 0, &bytes, &size), VPL_INVALID_ARGUMENT);
    assert_null(bytes);
    vplImage_Destroy(image);
    vplRenderOptions o = vplDefaultRenderOptions();
    assert_int_equal(vplRenderOptions_Set(&o, NULL, "1"), VPL_INVALID_ARGUMENT);
    assert_string_equal(o.problem, "name is NULL");
    assert_int_equal(vplRenderOptions_Set(&o, "particles", NULL), VPL_INVALID_ARGUMENT);
    assert_string_equal(o.problem, "value is NULL");
    vplScene* scene;
    vplObjectDef object = vplDefaultObjectDef();
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    object.type = (vplObjectType)7;
    assertRefused(vplScene_AddObject(scene, &object, NULL), VPL_INVALID_ARGUMENT,
                  "vplObjectDef.type is 7, must be a vplObjectType");
    vplScene_Destroy(scene);
}
