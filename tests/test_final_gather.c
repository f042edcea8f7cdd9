// SPDX-License-Identifier: MIT
// Tests of the final gather of radiosity: rays from pixels over the solution of the patches.
#include "radiosity_pictures.h"

static vplRenderOptions gatherOptions(int patches, int rays, int interleave)
{
    vplRenderOptions o = radiosityOptions(patches);
    o.radiosity.gather = rays;
    o.pipeline.interleave = interleave;
    return o;
}

// Makes two pictures of indirect light by paths of independent noise.
static void traceTruth(const vplScene* scene, vplRenderOptions o, int spp, vplImage* truth[2])
{
    o.method = VPL_METHOD_PATH;
    o.path.pixel = VPL_PIXEL_CENTRE;
    o.path.samples = spp;
    for (int i = 0; i < 2; i++) {
        o.seed = (uint64_t)i;
        truth[i] = showOf(scene, o, VPL_SHOW_INDIRECT);
    }
}

static double errorOf(const vplScene* scene, vplRenderOptions o, vplImage* const truth[2])
{
    vplImage* image = showOf(scene, o, VPL_SHOW_INDIRECT);
    const double error = commonError(image, truth);
    vplImage_Destroy(image);
    return error;
}

// In a closed room whose walls all emit, radiance is Le / (1 - rho) everywhere, of which Le rho^2 / (1 - rho)
// has been reflected at least twice. Points on area lights, which light near hits, have noise, and their clamp
// takes some of their light: measured 0.4972 with 300 patches, 0.4996 with 5000 and shared rays.
TEST(FurnaceIsGatheredAsItIs, 2)
{
    vplScene* scene = closedCubeScene(context, 0.5f, 1);
    aim(scene, vplVec(0, 0, 0.9f), vplVec(0, -0.1f, -1));
    for (int fine = 0; fine < 2; fine++) {
        vplRenderOptions o = gatherOptions(fine ? 5000 : 300, 64, fine ? 4 : 1);
        o.lights.areaLightSamples = 1024;
        o.radiosity.rowSums = VPL_ROW_SUMS_NORMALISE;
        o.radiosity.residual = 1e-7;
        vplImage* image = showOf(scene, o, VPL_SHOW_INDIRECT);
        double red = 0, blue = 0, off = 0;
        for (int i = 0; i < 40 * 30; i++) {
            const double value = (double)image->pixels[3 * i];
            red += value / (40 * 30);
            blue += (double)image->pixels[3 * i + 2] / (40 * 30);
            off += fabs(value - 0.5) / (40 * 30);
        }
        assertNear(red, 0.5, fine ? 0.001 : 0.005, "mean radiance", fine);
        assertNear(blue, 0.125, fine ? 0.00025 : 0.00125, "mean in blue", fine);
        assertNear(off, 0, fine ? 0.01 : 0.03, "mean distance from it", fine);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
}

// Light of lamps is direct: a gather with a single patch per triangle of a black room finds none.
TEST(EmissionIsNotGathered, 2)
{
    vplScene* scene = closedCubeScene(context, 0, 1);
    aim(scene, vplVec(0, 0, 0.9f), vplVec(0, -0.1f, -1));
    vplImage* image = showOf(scene, gatherOptions(12, 8, 1), VPL_SHOW_INDIRECT);
    assert_true(meanOf(image) == 0);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

TEST(MoreRaysComeNearerToPaths, 2, SLOW)
{
    for (int i = 0; i < 3; i++) {
        vplScene* scene = boxRoom(context, 0.7f, i > 0);
        if (i == 2) { // near hits draw one of several emitters
            addEmitter(scene, VPL_EMITTER_POINT, vplVec(-0.3f, 0.6f, 0.2f), vplVec(0, -1, 0), 3);
            addEmitter(scene, VPL_EMITTER_SPOT, vplVec(0.5f, 0.8f, 0.3f), vplVec(-0.2f, -1, 0), 2);
        }
        vplImage* truth[2];
        traceTruth(scene, radiosityOptions(1), 128, truth);
        const double few = errorOf(scene, gatherOptions(400, 4, 1), truth),
                     many = errorOf(scene, gatherOptions(400, 64, 1), truth),
                     shared = errorOf(scene, gatherOptions(400, 4, 4), truth);
        assert_true(many < 0.2 * few && shared < 0.4 * few);
        vplImage_Destroy(truth[0]);
        vplImage_Destroy(truth[1]);
        vplScene_Destroy(scene);
    }
}

// The mean over the pixels that are darker than a quarter of the truth's mean, over that of the truth.
static double brightnessOfShadow(const vplScene* scene, vplRenderOptions o, const vplImage* truth)
{
    vplImage* image = showOf(scene, o, VPL_SHOW_INDIRECT);
    const double limit = 0.25 * meanOf(truth);
    double sum = 0, wanted = 0;
    for (int i = 0; i < 3 * image->width * image->height; i++) {
        const bool dark = (double)truth->pixels[i] < limit;
        sum += dark ? (double)image->pixels[i] : 0;
        wanted += dark ? (double)truth->pixels[i] : 0;
    }
    vplImage_Destroy(image);
    return sum / wanted;
}

// A flat box hangs 2 cm above the floor: under it there is hardly any light, which patches that are as large
// as the room's walls do not know: they show 4.2 times its light, a gather 1.35 times.
TEST(ContactShadowsAreThereOverCoarsePatches, 2, SLOW)
{
    vplScene* scene = closedCubeScene(context, 0.7f, 0);
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0, -0.93f, 0), 0, 0.3, vplVec(0.3f, 0.1f, 0.3f));
    aim(scene, vplVec(0, -0.75f, 0.7f), vplVec(0, -1, 0.1f));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(-0.3f, 0.6f, 0.2f), vplVec(0, -1, 0), 3);
    vplImage* truth[2];
    traceTruth(scene, radiosityOptions(1), 256, truth);
    const double coarse = brightnessOfShadow(scene, gatherOptions(30, 0, 1), truth[0]),
                 gathered = brightnessOfShadow(scene, gatherOptions(30, 64, 1), truth[0]);
    const double before = errorOf(scene, gatherOptions(30, 0, 1), truth),
                 after = errorOf(scene, gatherOptions(30, 64, 1), truth);
    assert_true(coarse > 3 && gathered < 1.5 && gathered > 0.8);
    assert_true(after < 0.1 * before);
    vplImage_Destroy(truth[0]);
    vplImage_Destroy(truth[1]);
    vplScene_Destroy(scene);
}

static uint64_t hashOf(vplContext* context)
{
    if (context == NULL) {
        return 0;
    }
    vplScene* scene = boxRoom(context, 0.7f, true);
    vplRenderOptions o = gatherOptions(100, 3, 3);
    o.output.antialias = 4;
    vplImage* image = showOf(scene, o, VPL_SHOW_PICTURE);
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(GatheredPicturesAreTheSameEverywhere)
{
    assertSameEverywhere(hashOf);
}

TEST(WithoutAGatherSharedRaysMoveNoBit, 2)
{
    vplScene* scene = boxRoom(context, 0.7f, false);
    vplImage *a = showOf(scene, gatherOptions(100, 0, -1), VPL_SHOW_PICTURE),
             *b = showOf(scene, gatherOptions(100, 0, 8), VPL_SHOW_PICTURE);
    assert_true(vplImage_Hash(a) == vplImage_Hash(b));
    vplImage_Destroy(a);
    vplImage_Destroy(b);
    vplScene_Destroy(scene);
}

// A picture is direct light and what rays find; smooth edges show both. Each pixel casts its rays once; near hits cast
// some more.
TEST(AGatheredPictureIsDirectAndIndirectLight, 2)
{
    vplScene* scene = boxRoom(context, 0.6f, false);
    vplRenderOptions o = gatherOptions(100, 5, 1);
    vplRenderStats plain, stats;
    vplRenderOptions without = gatherOptions(100, 0, 1);
    o.output.show = without.output.show = VPL_SHOW_INDIRECT;
    vplImage_Destroy(renderScene(scene, &without, &plain));
    vplImage* indirect = renderScene(scene, &o, &stats);
    vplImage *picture = showOf(scene, o, VPL_SHOW_PICTURE), *direct = showOf(scene, o, VPL_SHOW_DIRECT);
    for (int i = 0; i < 3 * 40 * 30; i++) {
        const double sum = (double)direct->pixels[i] + (double)indirect->pixels[i];
        assertNear((double)picture->pixels[i], sum, 1e-6 * sum, "picture", i);
    }
    assert_in_range(stats.rays - plain.rays, 5 * 40 * 30, 2 * 5 * 40 * 30); // those of near hits, too
    vplImage_Destroy(picture);
    vplImage_Destroy(direct);
    vplImage_Destroy(indirect);
    vplScene_Destroy(scene);
}

static vplMetLight meetGrey(const void* user, const vplHit* hit, vplVec3 direction)
{
    const float* radiosity = user;
    (void)hit;
    (void)direction;
    return (vplMetLight){{*radiosity, *radiosity, *radiosity}, 0};
}

// A caller of vplShadeView says what rays meet; without lights nothing else is there.
TEST(CallersSayWhatRaysMeet, 2)
{
    vplGeometry* g = closedCube(context, 0.5f);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, 0, 0.5f);
    camera.target = vplVec(0, 0, -1);
    camera.nearPlane = 0.01;
    const vplView view = vplView_Create(&camera, 12, 8);
    const float radiosity = 3;
    vplGatherDef gather = vplDefaultGatherDef();
    gather.rayCount = 4;
    gather.meet = meetGrey;
    gather.user = &radiosity;
    vplShadeDef def = vplDefaultShadeDef();
    def.accumulation = VPL_ACCUMULATE_DEFERRED;
    def.gather = &gather;
    vplImage* image;
    assert_int_equal(vplImage_Create(context, 12, 8, &image), VPL_SUCCESS);
    assert_int_equal(vplShadeView(g, &view, &def, image, NULL), VPL_SUCCESS);
    for (int i = 0; i < 3 * 12 * 8; i++) {
        assertNear((double)image->pixels[i], 0.5 * 3 / VPL_PI, 1e-6, "radiance", i);
    }
    gather.rayCount = 0;
    assert_int_equal(vplShadeView(g, &view, &def, image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "rayCount is 0"));
    gather.rayCount = 4;
    def.lighting = VPL_LIGHTING_DOCUMENTED;
    assert_int_equal(vplShadeView(g, &view, &def, image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "physical lighting"));
    vplImage_Destroy(image);
    vplGeometry_Destroy(g);
}
