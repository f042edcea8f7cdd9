// SPDX-License-Identifier: MIT
// Refusals of arguments that no other test meets: each returns its code with a sentence that names what is wrong.
#include "emitter_scenes.h"

#include <limits.h>

static void assertRefused(vplResult result, vplResult wanted, const char* said)
{
    const char* message = takeMessage();
    if (result != wanted || strstr(message, said) == NULL) {
        fail_msg("%d \"%s\" instead of %d \"%s\"", (int)result, message, (int)wanted, said);
    }
}

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
