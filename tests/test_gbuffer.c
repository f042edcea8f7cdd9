// SPDX-License-Identifier: MIT
// Tests of a G-buffer that several pictures share.
#include "stage.h"

#include "math/vec.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 150, HEIGHT = 140, COUNT = 60 }; // 3 x 3 tiles

typedef struct Setting {
    vplGeometry* geometry;
    vplView view;
    vplShadeLight* lights;
    vplEmitterDef lamp;
} Setting;

// Destroys the scene.
static Setting openSetting(vplScene* scene)
{
    Setting s = {.lights = rollLights(COUNT, 5)};
    s.view = vplView_Create(vplScene_GetCamera(scene, 0), WIDTH, HEIGHT);
    s.geometry = buildGeometry(scene);
    s.lamp = vplDefaultEmitterDef();
    s.lamp.position = vplVec(0.5f, 2, 1);
    return s;
}

static void closeSetting(Setting* s)
{
    free(s->lights);
    vplGeometry_Destroy(s->geometry);
}

// The room with a ball of 1,280 triangles and shading normals.
static vplScene* openRoomWithBall(vplContext* context)
{
    vplScene* scene = loadScene(context, "room.json");
    Shape ball = icosphere(3);
    const vplMat4 at = vplMat4_FromParts(vplVec(0.3f, 1.5f, 1), (const double[3]){0, 0, 0}, vplVec(1, 1, 1));
    addShape(scene, &ball, true, &at);
    freeShape(&ball);
    return scene;
}

static vplShadeDef defOf(const Setting* s, vplAccumulation accumulation, int samples)
{
    vplShadeDef def = vplDefaultShadeDef();
    def.accumulation = accumulation;
    def.interleave = 5;
    def.samples = samples;
    def.emission = true;
    def.lights = s->lights;
    def.lightCount = COUNT;
    def.emitters = &s->lamp;
    def.emitterCount = 1;
    return def;
}

static vplImage* newImage(const Setting* s)
{
    vplImage* image;
    assert_int_equal(vplImage_Create(s->geometry->context, WIDTH, HEIGHT, &image), VPL_SUCCESS);
    return image;
}

static uint64_t draw(const Setting* s, const vplShadeDef* def, vplShadeStats* stats)
{
    vplImage* image = newImage(s);
    if (vplShadeView(s->geometry, &s->view, def, image, stats) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    return hash;
}

static vplGbuffer* keep(const Setting* s, const vplShadeDef* def)
{
    vplGbuffer* g = NULL;
    vplRasterStats stats;
    if (vplGbuffer_Create(s->geometry, &s->view, def, &g, &stats) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    assert_int_equal(stats.drawCalls, s->geometry->objectCount);
    assert_true(stats.fragments > 0);
    return g;
}

// Draws with and without a kept G-buffer.
static void assertSameBits(const Setting* s, vplShadeDef* def)
{
    vplShadeStats drawn, kept;
    const uint64_t wanted = draw(s, def, &drawn);
    vplGbuffer* g = keep(s, def);
    def->gbuffer = g;
    for (int i = 0; i < 2; i++) { // it serves more than one picture
        assert_true(draw(s, def, &kept) == wanted);
        assert_int_equal(kept.raster.drawCalls, 0);
        assert_int_equal(kept.shadowRays, drawn.shadowRays);
    }
    assert_int_equal(drawn.raster.drawCalls, s->geometry->objectCount);
    def->gbuffer = NULL;
    vplGbuffer_Destroy(g);
}

static void assertAllWays(vplScene* scene)
{
    Setting s = openSetting(scene);
    for (vplAccumulation way = VPL_ACCUMULATE_DEFERRED; way <= VPL_ACCUMULATE_LIGHTCUTS; way++) {
        for (int samples = 0; samples <= 8; samples += 8) {
            vplShadeDef def = defOf(&s, way, samples);
            assertSameBits(&s, &def);
        }
    }
    closeSetting(&s);
}

TEST(FlatAndSmoothSurfacesHaveTheBitsOfDrawnOnes, 2)
{
    assertAllWays(loadScene(context, "room.json"));
    assertAllWays(openRoomWithBall(context));
}

TEST(CutOutsAreSeenThroughInKeptPixels, 2)
{
    assertAllWays(openScene(context, "examples/scenes/cut-outs.json"));
}

TEST(TheBackgroundIsThatOfDrawnSurfaces, 2)
{
    Setting s = openSetting(openScene(context, "examples/scenes/garden.json"));
    vplShadeDef def = vplDefaultShadeDef();
    def.output = VPL_OUTPUT_BACKGROUND;
    def.samples = 4;
    assertSameBits(&s, &def);
    closeSetting(&s);
}

// A G-buffer of some rows serves pictures of these rows, and of fewer.
TEST(RowsHaveTheBitsOfTheWholePicture, 2)
{
    Setting s = openSetting(openRoomWithBall(context));
    vplShadeDef def = defOf(&s, VPL_ACCUMULATE_INTERLEAVED, 4);
    def.firstRow = VPL_TILE_SIDE;
    def.endRow = HEIGHT;
    assertSameBits(&s, &def);
    vplGbuffer* g = keep(&s, &def);
    def.endRow = 2 * VPL_TILE_SIDE;
    const uint64_t wanted = draw(&s, &def, NULL);
    def.gbuffer = g;
    assert_true(draw(&s, &def, NULL) == wanted);
    vplGbuffer_Destroy(g);
    closeSetting(&s);
}

// Pictures of depth or irradiance, and passes over the scene for each light, do not use the G-buffer.
TEST(PicturesThatCannotUseItDrawTriangles, 2)
{
    static const struct {
        vplAccumulation accumulation;
        vplShadeOutput output;
    } CASES[] = {{VPL_ACCUMULATE_BATCHED, VPL_OUTPUT_RADIANCE},
                 {VPL_ACCUMULATE_DEFERRED, VPL_OUTPUT_DEPTH},
                 {VPL_ACCUMULATE_INTERLEAVED, VPL_OUTPUT_GATHER}};
    Setting s = openSetting(loadScene(context, "room.json"));
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        vplShadeStats stats;
        vplShadeDef def = defOf(&s, CASES[i].accumulation, 4);
        def.output = CASES[i].output;
        const uint64_t wanted = draw(&s, &def, NULL);
        vplGbuffer* g = keep(&s, &def);
        def.gbuffer = g;
        assert_true(draw(&s, &def, &stats) == wanted);
        assert_true(stats.raster.drawCalls >= s.geometry->objectCount);
        vplGbuffer_Destroy(g);
    }
    closeSetting(&s);
}

static void assertRefusedFor(const Setting* s, const vplShadeDef* def, const char* differs)
{
    char message[80];
    vplImage* image = newImage(s);
    snprintf(message, sizeof message, "vplShadeDef.gbuffer was made for another %s", differs);
    assertRefused(vplShadeView(s->geometry, &s->view, def, image, NULL), VPL_INVALID_ARGUMENT, message);
    vplImage_Destroy(image);
}

TEST(AGbufferOfAnotherPictureIsRefused, 1)
{
    Setting s = openSetting(loadScene(context, "room.json")), t = openSetting(openRoomWithBall(context));
    vplShadeDef def = defOf(&s, VPL_ACCUMULATE_DEFERRED, 4);
    def.firstRow = 0;
    def.endRow = VPL_TILE_SIDE;
    vplGbuffer* g = keep(&s, &def);
    def.gbuffer = g;
    draw(&s, &def, NULL);
    def.endRow = HEIGHT;
    assertRefusedFor(&s, &def, "rows");
    def.endRow = 0;
    assertRefusedFor(&s, &def, "rows");
    def.endRow = VPL_TILE_SIDE;
    def.samples = 6;
    assertRefusedFor(&s, &def, "number of samples");
    def.samples = 5; // rounded down
    draw(&s, &def, NULL);
    assertRefusedFor(&t, &def, "geometry");
    s.view.eye.x += 0.1f;
    assertRefusedFor(&s, &def, "view");
    def.samples = -1;
    assertRefused(vplGbuffer_Create(s.geometry, &s.view, &def, &g, NULL), VPL_INVALID_ARGUMENT,
                  "vplShadeDef.samples is -1");
    def.samples = 0;
    def.firstRow = 1;
    assertRefused(vplGbuffer_Create(s.geometry, &s.view, &def, &g, NULL), VPL_INVALID_ARGUMENT,
                  "vplShadeDef has rows 1 to 64");
    vplGbuffer_Destroy(g);
    vplGbuffer_Destroy(NULL);
    closeSetting(&s);
    closeSetting(&t);
}

// ---- in renders

// The room has 36 triangles: more than half a triangle per pixel in a picture of 8 x 8 pixels, less in one of 16 x 16.
TEST(PassesShareItWhereTrianglesAreMany, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    const int objects = vplScene_GetObjectCount(scene), maps = 6 * objects;
    vplRenderOptions o = vplDefaultRenderOptions();
    assert_int_equal(
        vplRenderOptions_SetAll(&o, "--method keller --particles 20 --passes 3 --pipeline interleaved"),
        VPL_SUCCESS);
    vplRenderStats stats;
    o.output.width = o.output.height = 8;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    assert_int_equal(stats.drawCalls, maps + objects);
    o.output.width = o.output.height = 16;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    assert_int_equal(stats.drawCalls, maps + 4 * objects); // direct light, and three passes
    o.output.width = o.output.height = 8;
    o.stop.passes = 0;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    assert_int_equal(stats.drawCalls, maps + objects);
    vplScene_Destroy(scene);
}
