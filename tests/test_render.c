// SPDX-License-Identifier: MIT
// Tests of vplRender: exact relations between whole pictures, counts, and refusals.
#include "scenes.h"

#include <stdlib.h>

static vplRenderOptions smallOptions(void)
{
    vplRenderOptions o = plainOptions();
    o.output.width = 83;
    o.output.height = 61;
    o.shadow.mapSize = 128;
    return o;
}

static uint64_t renderHash(const vplScene* scene, const vplRenderOptions* options)
{
    vplRenderStats stats;
    vplImage* image = renderScene(scene, options, &stats);
    assert_true(stats.imageHash == vplImage_Hash(image));
    vplImage_Destroy(image);
    return stats.imageHash;
}

// Franchi and Ferrante: (7 + M) B draw calls, (7 + M/m) B batched; B = 8 objects, M = 18 lights.
TEST(DrawCallsAreThoseOfTheDocument, 2)
{
    vplScene* scene = loadScene(context, "room-closed.json");
    vplRenderOptions o = smallOptions();
    const struct {
        vplAccumulation accumulation;
        int batch, wanted;
    } cases[] = {{VPL_ACCUMULATE_MULTIPASS, 64, 200},
                 {VPL_ACCUMULATE_BATCHED, 18, 64},
                 {VPL_ACCUMULATE_BATCHED, 5, 88},
                 {VPL_ACCUMULATE_BATCHED, 1, 200},
                 {VPL_ACCUMULATE_DEFERRED, 64, 56}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplRenderStats stats;
        o.pipeline.kind = cases[i].accumulation;
        o.pipeline.batch = cases[i].batch;
        vplImage_Destroy(renderScene(scene, &o, &stats));
        assert_int_equal(stats.drawCalls, cases[i].wanted);
        assert_int_equal(stats.virtualLights, 18);
        assert_int_equal(stats.rayObjectTests, 144);
        assert_int_equal(stats.escaped, 0);
    }
    vplScene_Destroy(scene);
}

// X030
TEST(OpenRoomsKeepNominalCountsAndReportEscapes, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = smallOptions();
    int escaped = 0;
    for (o.seed = 0; o.seed < 20; o.seed++) {
        vplRenderStats stats;
        vplImage_Destroy(renderScene(scene, &o, &stats));
        assert_int_equal(stats.stepCount, 4);
        const int nominal[4] = {10, 5, 2, 1};
        int lights = 0;
        for (int i = 0; i < 4; i++) {
            assert_int_equal(stats.particlesPerStep[i], nominal[i]);
            assert_true(stats.lightsPerStep[i] <= nominal[i]);
            lights += stats.lightsPerStep[i];
        }
        assert_int_equal(lights, stats.virtualLights);
        assert_true(stats.virtualLights + stats.escaped <= 18);
        escaped += stats.escaped;
    }
    assert_true(escaped > 0);
    vplScene_Destroy(scene);
}

// X082
// All pipelines, batch sizes around the group size, numbers of threads and instruction sets give the same
// hash.
TEST_ALONE(EveryPipelineGivesTheSameBits)
{
    for (int lighting = 0; lighting < 2; lighting++) {
        uint64_t wanted = 0;
        const int batches[] = {1, 3, 63, 64, 65, 1000};
        for (int worker = 1; worker <= 7; worker += worker == 1 ? 1 : worker == 2 ? 1 : 4) {
            vplContext* context = openTestContext(worker);
            vplScene* scene = loadScene(context, "room.json");
            vplRenderOptions o = smallOptions();
            o.lighting = (vplLighting)lighting;
            o.particles.count = 130;
            o.particles.sampler = VPL_SAMPLER_HALTON;
            wanted = worker == 1 ? renderHash(scene, &o) : wanted;
            for (int p = 0; p < 3; p++) {
                o.pipeline.kind = (vplAccumulation)p;
                for (int i = 0; i < (p == VPL_ACCUMULATE_BATCHED ? 6 : 1); i++) {
                    o.pipeline.batch = batches[i];
                    assert_true(renderHash(scene, &o) == wanted);
                }
            }
            vplScene_Destroy(scene);
            closeTestContext(context);
        }
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            vplContext* context = openIsaContext(2, (vplIsa)isa);
            if (context == NULL) {
                continue;
            }
            vplScene* scene = loadScene(context, "room.json");
            vplRenderOptions o = smallOptions();
            o.lighting = (vplLighting)lighting;
            o.particles.count = 130;
            o.particles.sampler = VPL_SAMPLER_HALTON;
            assert_true(renderHash(scene, &o) == wanted);
            vplScene_Destroy(scene);
            closeTestContext(context);
        }
    }
}

TEST_ALONE(AHostsOwnSchedulerGivesTheSameBits)
{
    uint64_t hashes[2];
    for (int hosted = 0; hosted < 2; hosted++) {
        vplContextDef def = vplDefaultContextDef();
        def.workerCount = 3;
        def.parallelFor = hosted ? threadedFor : NULL;
        vplContext* context;
        assert_int_equal(vplContext_Create(&def, &context), VPL_SUCCESS);
        vplScene* scene = loadScene(context, "room.json");
        vplRenderOptions o = smallOptions();
        hashes[hosted] = renderHash(scene, &o);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
    assert_true(hashes[0] == hashes[1]);
}

// X083: two floors are coplanar: with the depth test EQUAL alone, both would be lit and added.
TEST(CoplanarSurfacesAreLitOnce, 1)
{
    uint64_t hashes[5];
    vplRenderOptions o = smallOptions();
    for (int p = 0; p < 5; p++) {
        vplScene* scene = loadScene(context, "room.json");
        vplObjectDef copy = *vplScene_GetObject(scene, 0);
        if (p < 4) { // the last has one floor
            assert_int_equal(vplScene_AddObject(scene, &copy, NULL), VPL_SUCCESS);
        }
        o.pipeline.kind = (vplAccumulation)(p % 3);
        o.particles.count = p < 3 ? 50 : 0; // particles may hit either floor
        hashes[p] = renderHash(scene, &o);
        vplScene_Destroy(scene);
        assert_true(hashes[p] == hashes[p < 3 ? 0 : 3]);
    }
}

// Builds the room by hand, scaled and lit by `intensity`: powers of two change only exponents.
static vplImage* scaledRoom(vplContext* context, float scale, float intensity, vplLighting lighting)
{
    vplScene *from = loadScene(context, "room.json"), *scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    for (int i = 0; i < vplScene_GetMaterialCount(from); i++) {
        assert_int_equal(vplScene_AddMaterial(scene, vplScene_GetMaterial(from, i), NULL), VPL_SUCCESS);
    }
    for (int i = 0; i < vplScene_GetObjectCount(from); i++) {
        vplObjectDef def = *vplScene_GetObject(from, i);
        for (int k = 0; k < 15; k++) {
            def.transform.m[k] *= scale;
        }
        assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
    }
    vplEmitterDef emitter = *vplScene_GetEmitter(from, 0);
    emitter.position.y *= scale;
    emitter.intensity = (vplRgb){intensity, intensity, intensity};
    assert_int_equal(vplScene_AddEmitter(scene, &emitter, NULL), VPL_SUCCESS);
    vplCameraDef camera = *vplScene_GetCamera(from, 0);
    camera.eye.y *= scale;
    camera.eye.z *= scale;
    camera.target.y *= scale;
    camera.nearPlane *= scale;
    camera.farPlane *= scale;
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
    vplRenderOptions o = smallOptions();
    o.lighting = lighting;
    o.particles.count = 30;
    vplImage* image = renderScene(scene, &o, NULL);
    vplScene_Destroy(scene);
    vplScene_Destroy(from);
    return image;
}

TEST(DoublingTheLightDoublesEveryPixel, 2)
{
    for (int lighting = 0; lighting < 2; lighting++) {
        vplImage* one = scaledRoom(context, 1, 8, (vplLighting)lighting);
        vplImage* two = scaledRoom(context, 1, 16, (vplLighting)lighting);
        for (int i = 0; i < 3 * one->width * one->height; i++) {
            assert_true(2 * one->pixels[i] == two->pixels[i]);
        }
        vplImage_Destroy(one);
        vplImage_Destroy(two);
    }
}

// X066
// Physical light is scale-invariant: twice the size with four times the intensity gives the same picture, bit
// for bit.
TEST(TwiceTheSizeWithFourTimesTheLightIsTheSamePicture, 2)
{
    vplImage* small = scaledRoom(context, 1, 8, VPL_LIGHTING_PHYSICAL);
    vplImage* large = scaledRoom(context, 2, 32, VPL_LIGHTING_PHYSICAL);
    vplImage* huge = scaledRoom(context, 1024, 8 * 1048576, VPL_LIGHTING_PHYSICAL);
    assert_true(vplImage_Hash(small) == vplImage_Hash(large));
    assert_true(vplImage_Hash(small) == vplImage_Hash(huge));
    vplImage_Destroy(small);
    vplImage_Destroy(large);
    vplImage_Destroy(huge);
}

// A point light above a plane: rho/pi I cos / d^2, compared at each pixel's own point.
TEST(APlaneUnderAPointLightIsLitAsInTheBook, 1)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    vplMaterialDef material = vplDefaultMaterialDef();
    vplScene_AddMaterial(scene, &material, NULL);
    vplObjectDef object = vplDefaultObjectDef();
    object.transform =
        vplMat4_FromParts((vplVec3){0, 0, 0}, (double[3]){-VPL_PI / 2, 0, 0}, (vplVec3){10, 10, 1});
    vplScene_AddObject(scene, &object, NULL);
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.position = (vplVec3){0.5f, 2, -0.25f};
    emitter.intensity = (vplRgb){3, 5, 7};
    vplScene_AddEmitter(scene, &emitter, NULL);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = (vplVec3){0, 4, 0};
    camera.target = (vplVec3){0, 0, 0};
    camera.up = (vplVec3){0, 0, -1};
    vplScene_AddCamera(scene, &camera, NULL);
    vplRenderOptions o = smallOptions();
    o.method = VPL_METHOD_DIRECT;
    vplImage* image = renderScene(scene, &o, NULL);
    double half = tan(20 * VPL_PI / 180) * 4;
    for (int i = 0; i < o.output.width * o.output.height; i++) {
        double x =
            (2 * (i % o.output.width + 0.5) / o.output.width - 1) * half * o.output.width / o.output.height;
        double z = -(1 - 2 * (i / o.output.width + 0.5) / o.output.height) * half;
        double dx = x - 0.5, dz = z + 0.25, d2 = dx * dx + 4 + dz * dz;
        double wanted = 0.5 / VPL_PI * 3 * (2 / sqrt(d2)) / d2;
        assertNear((double)image->pixels[3 * i], wanted, 1e-6 * wanted, "red", i);
        assertNear((double)image->pixels[3 * i + 2], wanted * 7 / 3, 1e-6 * wanted * 7 / 3, "blue", i);
    }
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

// The sum of all values of a picture.
static double sumOf(const vplScene* scene, const vplRenderOptions* options)
{
    double sum = 0;
    vplImage* image = renderScene(scene, options, NULL);
    for (int i = 0; i < 3 * image->width * image->height; i++) {
        sum += (double)image->pixels[i];
    }
    vplImage_Destroy(image);
    return sum;
}

// X090: documented direct light decreases as 1/N and the indirect sum does not; physical light does not
// depend on N.
TEST(DocumentedDirectLightFallsWithN, 2)
{
    vplScene* scene = loadScene(context, "room-closed.json");
    double sums[2][2], indirect[2][2];
    for (int lighting = 0; lighting < 2; lighting++) {
        for (int k = 0; k < 2; k++) {
            vplRenderOptions o = smallOptions();
            o.lighting = (vplLighting)lighting;
            o.shadow.bias = VPL_BIAS_OPTION_EXACT;
            o.output.show = VPL_SHOW_DIRECT;
            o.particles.count = k ? 200 : 100;
            sums[lighting][k] = sumOf(scene, &o);
            o.output.show = VPL_SHOW_INDIRECT;
            indirect[lighting][k] = sumOf(scene, &o);
        }
    }
    assertNear(sums[VPL_LIGHTING_PHYSICAL][0], sums[VPL_LIGHTING_PHYSICAL][1], 0, "physical", 0);
    assertNear(sums[VPL_LIGHTING_DOCUMENTED][0] / sums[VPL_LIGHTING_DOCUMENTED][1], 2, 1e-6, "documented", 0);
    for (int lighting = 0; lighting < 2; lighting++) {
        assertNear(indirect[lighting][0] / indirect[lighting][1], 1, 0.05, "indirect", lighting);
    }
    vplScene_Destroy(scene);
}

TEST(DirectAndEachLightAddUpToThePicture, 2)
{
    vplScene* scene = loadScene(context, "room-closed.json");
    vplRenderOptions o = smallOptions();
    o.lights.minDistance = 0.5f;
    vplImage* picture = renderScene(scene, &o, NULL);
    o.output.show = VPL_SHOW_DIRECT;
    vplImage* sum = renderScene(scene, &o, NULL);
    o.output.show = VPL_SHOW_INDIRECT;
    vplImage* indirect = renderScene(scene, &o, NULL);
    int count = 3 * o.output.width * o.output.height;
    for (int i = 0; i < count; i++) {
        double wanted = (double)sum->pixels[i] + (double)indirect->pixels[i];
        assertNear((double)picture->pixels[i], wanted, 3e-7 * wanted, "direct + indirect", i);
    }
    o.output.show = VPL_SHOW_LIGHT;
    for (o.output.showIndex = 0; o.output.showIndex < 18; o.output.showIndex++) {
        vplImage* one = renderScene(scene, &o, NULL);
        for (int i = 0; i < count; i++) {
            sum->pixels[i] += one->pixels[i];
        }
        vplImage_Destroy(one);
    }
    for (int i = 0; i < count; i++) {
        assertNear((double)sum->pixels[i], (double)picture->pixels[i], 2e-6 * (double)picture->pixels[i],
                   "sum", i);
    }
    o.output.showIndex = 18;
    vplImage* none = NULL;
    assert_int_equal(vplRender(scene, &o, &none, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "light 18 does not exist"));
    vplImage_Destroy(picture);
    vplImage_Destroy(sum);
    vplImage_Destroy(indirect);
    vplScene_Destroy(scene);
}

TEST(StagesShowWhatTheySay, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = smallOptions();
    int middle = 3 * (o.output.height / 3 * o.output.width + 2 * o.output.width / 3),
        count = 3 * o.output.width * o.output.height;
    o.output.show = VPL_SHOW_DEPTH;
    vplImage* image = renderScene(scene, &o, NULL);
    assertNear((double)image->pixels[middle], 11, 1e-4, "depth of the back wall", 0);
    vplImage_Destroy(image);
    o.output.show = VPL_SHOW_NORMALS;
    image = renderScene(scene, &o, NULL);
    assert_true(image->pixels[middle] == 0 && image->pixels[middle + 1] == 0 &&
                image->pixels[middle + 2] == 1);
    vplImage_Destroy(image);
    o.output.show = VPL_SHOW_SHADOW_FACTOR;
    image = renderScene(scene, &o, NULL);
    int lit = 0, dark = 0;
    for (int i = 0; i < count; i++) {
        assert_true(image->pixels[i] >= 0 && image->pixels[i] <= 1);
        lit += image->pixels[i] == 0;
        dark += image->pixels[i] == 1;
    }
    assert_true(lit > count / 3 && dark > count / 50);
    vplImage_Destroy(image);
    o.output.show = VPL_SHOW_SHADOW_MAP;
    image = renderScene(scene, &o, NULL);
    assert_int_equal(image->width, 4 * o.shadow.mapSize);
    assert_int_equal(image->height, 3 * o.shadow.mapSize);
    // Straight up, in the centre of the upper face, is the ceiling, half a metre away.
    int above = 3 * (o.shadow.mapSize / 2 * image->width + o.shadow.mapSize + o.shadow.mapSize / 2);
    assertNear((double)image->pixels[above], 0.5, 1e-3, "distance of the ceiling", 0);
    vplImage_Destroy(image);
    o.output.show = VPL_SHOW_OVERLAY;
    o.particles.count = 100;
    image = renderScene(scene, &o, NULL);
    o.output.show = VPL_SHOW_PICTURE;
    vplImage* plain = renderScene(scene, &o, NULL);
    int marked = 0;
    for (int i = 0; i < count; i += 3) {
        marked += memcmp(image->pixels + i, plain->pixels + i, 12) != 0;
    }
    assert_true(marked > 100 && marked < count / 3 * 2 / 3);
    vplImage_Destroy(image);
    vplImage_Destroy(plain);
    vplScene_Destroy(scene);
}

// Only the front of a quad emits light.
TEST(EmissionLeavesTheFrontOnly, 1)
{
    for (int back = 0; back < 2; back++) {
        vplScene* scene;
        assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
        vplMaterialDef material = vplDefaultMaterialDef();
        material.diffuse = (vplRgb){0, 0, 0};
        material.emission = (vplRgb){1, 2, 3};
        vplScene_AddMaterial(scene, &material, NULL);
        vplObjectDef object = vplDefaultObjectDef();
        object.transform =
            vplMat4_FromParts((vplVec3){0, 0, 0}, (double[3]){0, back * VPL_PI, 0}, (vplVec3){10, 10, 1});
        vplScene_AddObject(scene, &object, NULL);
        vplCameraDef camera = vplDefaultCameraDef();
        vplScene_AddCamera(scene, &camera, NULL);
        vplRenderOptions o = smallOptions();
        o.method = VPL_METHOD_DIRECT;
        vplImage* image = renderScene(scene, &o, NULL);
        for (int i = 0; i < 3 * o.output.width * o.output.height; i++) {
            assert_true(image->pixels[i] == (back ? 0 : (float)(i % 3 + 1)));
        }
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
    }
}

typedef struct Watch {
    int calls, stopAt;
    double last;
} Watch;

static bool watch(void* user, double fraction)
{
    Watch* w = user;
    assert_true(fraction >= w->last - 1e-9 && fraction <= 1);
    w->last = fraction;
    return ++w->calls != w->stopAt;
}

TEST(ProgressRisesAndCancels, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = smallOptions();
    Watch w = {0, -1, 0};
    o.output.width = o.output.height = 300;
    o.progress = watch;
    o.progressUser = &w;
    vplImage_Destroy(renderScene(scene, &o, NULL));
    assertNear(w.last, 1, 1e-9, "last fraction", 0);
    int total = w.calls;
    assert_true(total > 20);
    for (int stop = 1; stop < total; stop += 7) {
        vplImage* image = NULL;
        w = (Watch){0, stop, 0};
        assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_CANCELLED);
        assert_null(image);
        assert_int_equal(w.calls, stop);
    }
    vplScene_Destroy(scene);
}

enum { ODD_PLACES = 6 };

// A light in a box, outside, on the ceiling, on the floor, at the eye, far away.
static const vplVec3 ODD_LIGHTS[ODD_PLACES] = {{-0.9f, 1.65f, -0.8f}, {0, 4.5f, 30},     {0, 5, 0}, {0, 0, 0},
                                               {0, 2.5f, 8.5f},       {1e6f, 1e6f, 1e6f}};

// Renders the room with a second light in an odd place, and returns the picture's hash.
static uint64_t oddHash(vplContext* context, vplVec3 place, vplLighting lighting)
{
    vplScene* scene = loadScene(context, "room.json");
    vplEmitterDef emitter = *vplScene_GetEmitter(scene, 0);
    emitter.position = place;
    assert_int_equal(vplScene_AddEmitter(scene, &emitter, NULL), VPL_SUCCESS);
    vplRenderOptions o = smallOptions();
    o.lighting = lighting;
    o.lights.minDistance = 0;
    o.particles.count = 60;
    vplImage* image = renderScene(scene, &o, NULL);
    for (int k = 0; k < 3 * o.output.width * o.output.height; k++) {
        assert_true(isfinite(image->pixels[k]) && image->pixels[k] >= 0);
    }
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    return hash;
}

// X031, X042, X059, X092: unusual scenes give finite pictures, and the same bits with any number of threads.
TEST(OddScenesGiveFinitePictures, 2)
{
    vplContext* three = openTestContext(3);
    for (int i = 0; i < ODD_PLACES; i++) {
        for (int lighting = 0; lighting < 2; lighting++) {
            const uint64_t hash = oddHash(context, ODD_LIGHTS[i], (vplLighting)lighting);
            assert_true(oddHash(three, ODD_LIGHTS[i], (vplLighting)lighting) == hash);
        }
    }
    closeTestContext(three);
}

// X031: direct light from inside a box reaches nothing outside it: no bit of the picture moves. Shadows are rays, because
// a texel of a map reaches over the foot of the box.
TEST(ALightInABoxLightsNothingOutsideIt, 2)
{
    uint64_t hashes[2];
    for (int inside = 0; inside < 2; inside++) {
        vplScene* scene = loadScene(context, "room.json");
        vplEmitterDef emitter = *vplScene_GetEmitter(scene, 0);
        emitter.position = ODD_LIGHTS[0];
        if (inside) {
            assert_int_equal(vplScene_AddEmitter(scene, &emitter, NULL), VPL_SUCCESS);
        }
        vplRenderOptions o = smallOptions();
        o.method = VPL_METHOD_DIRECT;
        o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
        hashes[inside] = renderHash(scene, &o);
        vplScene_Destroy(scene);
    }
    assert_true(hashes[0] == hashes[1]);
}

// X040: without particles the picture is its direct light, bit for bit, in both lightings.
TEST(WithoutParticlesThereIsDirectLightAlone, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    for (int lighting = 0; lighting < 2; lighting++) {
        vplRenderOptions o = smallOptions();
        o.lighting = (vplLighting)lighting;
        o.method = VPL_METHOD_DIRECT;
        o.particles.count = 1; // documented direct light is divided by their number
        const uint64_t direct = renderHash(scene, &o);
        o.method = VPL_METHOD_INSTANT_RADIOSITY;
        o.particles.count = 0;
        vplRenderStats stats;
        vplImage* image = renderScene(scene, &o, &stats);
        assert_int_equal(stats.virtualLights, 0);
        assert_true(stats.imageHash == direct && image->pixels[3 * 83 * 40 + 120] > 0);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
}

// Returns the share of pixel `i` of 8 that the interval [a, b] of the picture's [-1, 1] covers.
static double coverage(int i, double a, double b)
{
    double from = fmax((a + 1) * 4, i), to = fmin((b + 1) * 4, i + 1);
    return to > from ? to - from : 0;
}

// A square that emits light covers parts of pixels: a pixel's mean is the share that the square covers.
TEST(AntialiasingIsTheBoxFilter, 2)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    vplCameraDef camera = vplDefaultCameraDef(); // at z = 5; half the picture is 5 tan(fov / 2) metres
    camera.fovY = 2 * atan(0.2);
    vplScene_AddCamera(scene, &camera, NULL);
    vplMaterialDef material = vplDefaultMaterialDef();
    material.emission = (vplRgb){2, 2, 2};
    vplScene_AddMaterial(scene, &material, NULL);
    vplObjectDef object = vplDefaultObjectDef();
    object.transform.m[0] = 1.17f; // x from -0.425 to 0.745 of half a picture
    object.transform.m[5] = 0.74f; // y from -0.42 to 0.32
    object.transform.m[12] = 0.16f;
    object.transform.m[13] = -0.05f;
    vplScene_AddObject(scene, &object, NULL);
    vplRenderOptions o = plainOptions();
    o.output.width = o.output.height = 8;
    o.method = VPL_METHOD_DIRECT;
    double worst[3];
    const int samples[3] = {1, 16, 256};
    for (int k = 0; k < 3; k++) {
        vplImage* image;
        o.output.supersample = samples[k];
        assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_SUCCESS);
        worst[k] = 0;
        for (int i = 0; i < 64; i++) {
            double share = coverage(i % 8, -0.425, 0.745) * coverage(7 - i / 8, -0.42, 0.32);
            worst[k] = fmax(worst[k], fabs((double)image->pixels[3 * i] / 2 - share));
        }
        vplImage_Destroy(image);
    }
    assert_true(worst[0] > 0.4); // the centre alone is either in or out
    assert_true(worst[1] < 0.1);
    assert_true(worst[2] < 0.012);
    o.output.supersample = 0;
    assert_int_equal(vplRender(scene, &o, &(vplImage*){NULL}, NULL), VPL_INVALID_ARGUMENT);
    vplScene_Destroy(scene);
}
