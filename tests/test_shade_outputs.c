// SPDX-License-Identifier: MIT
// Tests of the outputs of indirect irradiance before and after neighbouring pixels share it.
#include "shapes.h"

#include "stage.h"

#include "math/vec.h"

#include <stdlib.h>

enum { WIDTH = 131, HEIGHT = 75, COUNT = 300 };

typedef struct Setting {
    vplContext* context;
    vplGeometry* geometry;
    vplView view;
    vplShadeLight* lights;
    vplEmitterDef sun; // direct light, which these outputs leave out
    vplShadow shadow;
} Setting;

static Setting openSetting(void)
{
    Setting s = {.context = openTestContext(2)};
    s.geometry = stage(s.context); // its reflectance is 1/2
    s.view = stageView(vplVec(1, 2, 5), WIDTH, HEIGHT);
    s.lights = rollLights(COUNT, 11);
    s.sun = vplDefaultEmitterDef();
    s.sun.type = VPL_EMITTER_DIRECTIONAL;
    s.sun.direction = vplVec(0.1f, -1, -0.2f);
    s.sun.intensity = (vplRgb){100, 100, 100};
    return s;
}

static void closeSetting(Setting* s)
{
    free(s->lights);
    vplGeometry_Destroy(s->geometry);
    closeTestContext(s->context);
}

static vplImage* show(const Setting* s, vplAccumulation accumulation, int side, vplShadeOutput output)
{
    vplShadeDef def = stageDef(s->lights, COUNT, side);
    def.accumulation = accumulation;
    def.output = output;
    def.batch = 7;
    def.cutError = 1e-6f; // small enough that every light is evaluated
    if (output != VPL_OUTPUT_RADIANCE) {
        def.emitters = &s->sun;
        def.shadows = &s->shadow;
        def.emitterCount = 1;
        def.emission = true;
    }
    return shadeStage(s->geometry, &s->view, &def);
}

// Asserts that image is factor times other. Returns the number of nonzero values.
static int assertTimes(const vplImage* image, const vplImage* other, double factor)
{
    int lit = 0;
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        const double wanted = factor * (double)other->pixels[i];
        assertNear((double)image->pixels[i], wanted, 2e-6 * wanted, "irradiance", i);
        lit += wanted > 0;
    }
    return lit;
}

TEST_ALONE(DenoisedIrradianceTimesReflectanceIsThePicture)
{
    Setting s = openSetting();
    for (int side = 2; side <= 5; side++) {
        vplImage* picture = show(&s, VPL_ACCUMULATE_INTERLEAVED, side, VPL_OUTPUT_RADIANCE);
        vplImage* irradiance = show(&s, VPL_ACCUMULATE_INTERLEAVED, side, VPL_OUTPUT_DENOISED);
        assert_true(assertTimes(irradiance, picture, VPL_PI / 0.5) > WIDTH * HEIGHT);
        vplImage_Destroy(picture);
        vplImage_Destroy(irradiance);
    }
    closeSetting(&s);
}

// Pixels of class c get the lights c, c + K^2, ..., which are K^2 times as bright.
TEST_ALONE(GatheredIrradianceIsThatOfEachPixelsClass)
{
    enum { SIDE = 3 };
    Setting s = openSetting();
    vplImage* gather = show(&s, VPL_ACCUMULATE_INTERLEAVED, SIDE, VPL_OUTPUT_GATHER);
    int lit = 0;
    for (int c = 0; c < SIDE * SIDE; c++) {
        vplShadeLight own[COUNT];
        int ownCount = 0;
        for (int i = c; i < COUNT; i += SIDE * SIDE) {
            own[ownCount++] = s.lights[i];
        }
        vplShadeDef def = stageDef(own, ownCount, 0);
        def.output = VPL_OUTPUT_DENOISED;
        vplImage* class = shadeStage(s.geometry, &s.view, &def);
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            if (i / WIDTH % SIDE * SIDE + i % WIDTH % SIDE == c) {
                const double wanted = SIDE * SIDE * (double)class->pixels[3 * i + 1];
                assertNear((double)gather->pixels[3 * i + 1], wanted, 1e-6 * wanted, "irradiance", i);
                lit += wanted > 0;
            }
        }
        vplImage_Destroy(class);
    }
    assert_true(lit > WIDTH * HEIGHT / 3);
    vplImage_Destroy(gather);
    closeSetting(&s);
}

// The outputs are the same for all ways of accumulating virtual lights, and exclude the emitters' light.
TEST_ALONE(WhereNobodySharesBothAreTheIrradiance)
{
    Setting s = openSetting();
    vplImage* picture = show(&s, VPL_ACCUMULATE_DEFERRED, 1, VPL_OUTPUT_RADIANCE);
    for (int k = 0; k < 10; k++) {
        vplImage* irradiance =
            show(&s, (vplAccumulation)(k / 2), 1, k % 2 ? VPL_OUTPUT_DENOISED : VPL_OUTPUT_GATHER);
        assert_true(assertTimes(irradiance, picture, VPL_PI / 0.5) > WIDTH * HEIGHT);
        vplImage_Destroy(irradiance);
    }
    vplImage_Destroy(picture);
    closeSetting(&s);
}

// X084: the camera's near plane, however near, and a far plane a thousand times further change no bit of what is seen.
TEST(NearAndFarPlanesDoNotChangeWhatIsSeen, 2)
{
    static const double planes[][2] = {{0.1, 50}, {1e-4, 50}, {1e-7, 50}, {1e-9, 5e4}};
    vplScene* scene = loadScene(context, "room.json");
    vplGeometry* g = buildGeometry(scene);
    vplImage* images[4];
    for (int i = 0; i < 4; i++) {
        vplCameraDef camera = vplDefaultCameraDef();
        camera.eye = vplVec(0, 2.5f, 8.5f);
        camera.target = vplVec(0, 2.5f, 0);
        camera.nearPlane = planes[i][0];
        camera.farPlane = planes[i][1];
        const vplView view = vplView_Create(&camera, 128, 128);
        vplShadeDef def = vplDefaultShadeDef();
        def.output = VPL_OUTPUT_OBJECT;
        assert_int_equal(vplImage_Create(context, 128, 128, &images[i]), VPL_SUCCESS);
        assert_int_equal(vplShadeView(g, &view, &def, images[i], NULL), VPL_SUCCESS);
        assert_memory_equal(images[i]->pixels, images[0]->pixels, 3 * 128 * 128 * sizeof(float));
    }
    for (int i = 0; i < 4; i++) {
        vplImage_Destroy(images[i]);
    }
    vplGeometry_Destroy(g);
}
