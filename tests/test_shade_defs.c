// SPDX-License-Identifier: MIT
// Tests of the defaults of shading's definitions, and of definitions that were not made by them.
#include "shapes.h"

#include "stage.h"

#include "math/vec.h"

#include <stdlib.h>

enum { WIDTH = 45, HEIGHT = 33, COUNT = 100 };

typedef struct Setting {
    vplContext* context;
    vplGeometry* geometry;
    vplView view;
    vplShadeLight* lights;
    vplEmitterDef lamp;
    vplImage* image;
} Setting;

static Setting openSetting(void)
{
    Setting s = {.context = openTestContext(2)};
    s.geometry = stage(s.context);
    s.view = stageView(vplVec(1, 2, 5), WIDTH, HEIGHT);
    s.lights = rollLights(COUNT, 5);
    s.lamp = vplDefaultEmitterDef();
    s.lamp.position = vplVec(0.5f, 2, 1);
    assert_int_equal(vplImage_Create(s.context, WIDTH, HEIGHT, &s.image), VPL_SUCCESS);
    return s;
}

static void closeSetting(Setting* s)
{
    free(s->lights);
    vplImage_Destroy(s->image);
    vplGeometry_Destroy(s->geometry);
    closeTestContext(s->context);
}

static uint64_t draw(const Setting* s, const vplShadeDef* def)
{
    if (vplShadeView(s->geometry, &s->view, def, s->image, NULL) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return vplImage_Hash(s->image);
}

static vplMetLight meetWhite(const void* user, const vplHit* hit, vplVec3 direction)
{
    (void)user;
    (void)hit;
    return (vplMetLight){.radiosity = {1, 1, direction.y * direction.y}};
}

// Zeros that have a cookie.
static vplShadeDef zeroShade(void)
{
    return (vplShadeDef){.cookie = vplDefaultShadeDef().cookie};
}

static void light(const Setting* s, vplShadeDef* def)
{
    def->lights = s->lights;
    def->lightCount = COUNT;
    def->emitters = &s->lamp;
    def->emitterCount = 1;
}

// ---- defaults

TEST_ALONE(DefaultsDrawWhatZerosDraw)
{
    static const vplAccumulation accumulations[] = {VPL_ACCUMULATE_MULTIPASS, VPL_ACCUMULATE_DEFERRED};
    Setting s = openSetting();
    for (int lighting = 0; lighting <= VPL_LIGHTING_DOCUMENTED; lighting++) {
        for (int i = 0; i < 2; i++) {
            vplShadeDef def = vplDefaultShadeDef(), zero = zeroShade();
            def.accumulation = zero.accumulation = accumulations[i];
            def.lighting = zero.lighting = (vplLighting)lighting;
            const uint64_t black = draw(&s, &def);
            assert_true(draw(&s, &zero) == black);
            light(&s, &def);
            light(&s, &zero);
            const uint64_t lit = draw(&s, &def);
            assert_true(draw(&s, &zero) == lit && lit != black);
        }
    }
    const vplShadeDef def = vplDefaultShadeDef();
    assert_int_equal(def.lighting, VPL_LIGHTING_PHYSICAL);
    assert_int_equal(def.accumulation, VPL_ACCUMULATE_MULTIPASS);
    closeSetting(&s);
}

TEST_ALONE(DefaultCompensationIsThatOfZerosWithItsFiveFields)
{
    Setting s = openSetting();
    vplShadeDef def = vplDefaultShadeDef();
    light(&s, &def);
    def.minDistance = 2;
    const uint64_t clamped = draw(&s, &def);
    vplCompensationDef near = vplDefaultCompensationDef();
    near.lights = s.lights;
    near.lightCount = COUNT;
    def.compensation = &near;
    const uint64_t compensated = draw(&s, &def);
    assert_true(compensated != clamped);
    near = (vplCompensationDef){.rayCount = 2,
                                .hitLights = 16,
                                .lights = s.lights,
                                .lightCount = COUNT,
                                .reflection = 1,
                                .seesEmission = true,
                                .seesReflection = true,
                                .cookie = near.cookie};
    assert_true(draw(&s, &def) == compensated);
    closeSetting(&s);
}

TEST_ALONE(DefaultGatherIsThatOfZerosWith64Rays)
{
    Setting s = openSetting();
    vplShadeDef def = vplDefaultShadeDef();
    vplGatherDef gather = vplDefaultGatherDef();
    gather.meet = meetWhite;
    def.gather = &gather;
    def.accumulation = VPL_ACCUMULATE_DEFERRED;
    const uint64_t gathered = draw(&s, &def);
    gather = (vplGatherDef){.rayCount = 64, .meet = meetWhite, .cookie = gather.cookie};
    assert_true(draw(&s, &def) == gathered);
    gather.rayCount = 63;
    assert_true(draw(&s, &def) != gathered);
    closeSetting(&s);
}

// Numbers that an accumulation needs are those of renders.
TEST_ALONE(DefaultsOfAccumulationsAreThoseOfRenders)
{
    Setting s = openSetting();
    vplScene* scene = loadScene(s.context, "room.json");
    vplRenderOptions options = vplDefaultRenderOptions();
    vplPlan* plan;
    options.method = VPL_METHOD_INSTANT_RADIOSITY;
    options.pipeline.kind = VPL_ACCUMULATE_INTERLEAVED;
    assert_int_equal(vplPlan_Create(scene, &options, NULL, &plan), VPL_SUCCESS);
    vplShadeDef def = vplDefaultShadeDef();
    assert_int_equal(def.batch, plan->options.pipeline.batch);
    assert_int_equal(def.interleave, plan->options.pipeline.interleave);
    assert_true(def.cutError == plan->options.pipeline.cutError);
    light(&s, &def);
    for (int i = 0; i < VPL_ACCUMULATE_USUAL; i++) { // none is refused
        def.accumulation = (vplAccumulation)i;
        draw(&s, &def);
    }
    vplPlan_Destroy(plan);
    vplScene_Destroy(scene);
    closeSetting(&s);
}

// ---- refusals

static void expectRefusal(const Setting* s, const vplShadeDef* def, const char* sentence)
{
    const uint64_t before = vplImage_Hash(s->image);
    takeMessage();
    assert_int_equal(vplShadeView(s->geometry, &s->view, def, s->image, NULL), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), sentence);
    assert_true(vplImage_Hash(s->image) == before);
}

static void expectRefusedLoss(const Setting* s, const vplShadeDef* def, const char* sentence)
{
    vplClampLoss loss = {-1, -1};
    takeMessage();
    assert_int_equal(vplEstimateClampLoss(s->geometry, &s->view, def, 16, &loss), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), sentence);
    assert_true(loss.lost == -1 && loss.all == -1);
}

TEST_ALONE(ShadingWithoutItsDefaultFunctionIsRefused)
{
    static const char sentence[] = "vplShadeDef was not made by vplDefaultShadeDef";
    Setting s = openSetting();
    const vplSurfacePoint point = {.normal = {0, 1, 0}};
    vplRgb irradiance = {-1, -1, -1};
    vplShadeDef def = vplDefaultShadeDef();
    light(&s, &def);
    draw(&s, &def); // the image is not black
    assert_int_equal(vplShadePoints(s.geometry, &def, &point, 1, &irradiance, NULL), VPL_SUCCESS);
    assert_true(irradiance.r >= 0);
    const uint32_t wrong[] = {0, def.cookie + 1, vplDefaultCompensationDef().cookie,
                              vplDefaultGatherDef().cookie};
    for (int i = 0; i < 4; i++) {
        int64_t rays = 7;
        irradiance.r = -1;
        def.cookie = wrong[i];
        expectRefusal(&s, &def, sentence);
        expectRefusedLoss(&s, &def, sentence);
        assert_int_equal(vplShadePoints(s.geometry, &def, &point, 1, &irradiance, &rays),
                         VPL_INVALID_ARGUMENT);
        assert_string_equal(takeMessage(), sentence);
        assert_true(irradiance.r == -1 && rays == 7);
    }
    closeSetting(&s);
}

TEST_ALONE(CompensationWithoutItsDefaultFunctionIsRefused)
{
    static const char sentence[] = "vplCompensationDef was not made by vplDefaultCompensationDef";
    Setting s = openSetting();
    vplShadeDef def = vplDefaultShadeDef();
    vplCompensationDef near = vplDefaultCompensationDef();
    light(&s, &def);
    def.minDistance = 2;
    draw(&s, &def);
    def.compensation = &near;
    near.cookie = 0;
    expectRefusal(&s, &def, sentence);
    expectRefusedLoss(&s, &def, sentence);
    near = vplDefaultCompensationDef();
    near.rayCount = 0;
    static const char rays[] =
        "vplCompensationDef.rayCount and hitLights are 0 and 16, must be in [1, 1048576] and at least 1";
    expectRefusal(&s, &def, rays);
    expectRefusedLoss(&s, &def, rays);
    closeSetting(&s);
}

TEST_ALONE(GatherWithoutItsDefaultFunctionIsRefused)
{
    Setting s = openSetting();
    vplShadeDef def = vplDefaultShadeDef();
    vplGatherDef gather = vplDefaultGatherDef();
    light(&s, &def);
    draw(&s, &def);
    def.gather = &gather;
    def.accumulation = VPL_ACCUMULATE_DEFERRED;
    expectRefusal(&s, &def, "vplGatherDef.meet is NULL, must be a function");
    gather.meet = meetWhite;
    gather.cookie = 0;
    expectRefusal(&s, &def, "vplGatherDef was not made by vplDefaultGatherDef");
    closeSetting(&s);
}

TEST_ALONE(ChoicesOutOfRangeAreRefused)
{
    Setting s = openSetting();
    vplShadeDef lighting = vplDefaultShadeDef(), accumulation = lighting, output = lighting;
    lighting.lighting = (vplLighting)2;
    accumulation.accumulation = (vplAccumulation)-1;
    output.output = (vplShadeOutput)99;
    expectRefusal(&s, &lighting, "vplShadeDef.lighting is 2, must be in [0, 1]");
    expectRefusal(&s, &accumulation, "vplShadeDef.accumulation is -1, must be in [0, 5]");
    expectRefusal(&s, &output, "vplShadeDef.output is 99, must be in [0, 8]");
    closeSetting(&s);
}

TEST_ALONE(NumbersOutOfRangeAndMissingPartsAreRefused)
{
    Setting s = openSetting();
    const vplShadeDef def = vplDefaultShadeDef();
    vplShadeDef batch = def, samples = def, background = def, shadow = def;
    batch.accumulation = VPL_ACCUMULATE_BATCHED;
    batch.batch = 0;
    samples.samples = -1;
    background.output = VPL_OUTPUT_BACKGROUND;
    shadow.output = VPL_OUTPUT_SHADOW_FACTOR;
    expectRefusal(&s, &batch, "vplShadeDef.batch is 0, must be at least 1");
    expectRefusal(&s, &samples, "vplShadeDef.samples is -1, must be in [0, 16]");
    expectRefusal(&s, &background, "a background needs an environment");
    expectRefusal(&s, &shadow, "a shadow factor needs an emitter with a shadow map");
    s.view = stageView(vplVec(1, 2, 5), WIDTH, HEIGHT + 1);
    expectRefusal(&s, &def, "image is 45x33, must be 45x34 as the view");
    closeSetting(&s);
}
