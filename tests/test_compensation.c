// SPDX-License-Identifier: MIT
// Tests of bias compensation: short rays must add exactly the light that clamping near virtual lights
// removes.
#include "shapes.h"

#include "math/vec.h"
#include "render/stages/results.h"
#include "shading/compensation.h"
#include "visibility/blocks.h"

#include <stdlib.h>

// ---- a plane of radiance 1 over a receiver: closed forms

enum { SIDE = 96, PLANE_RAYS = 1024 };

// Makes the plane at height h that faces down, above a floor that reflects nothing.
static vplGeometry* planeOver(vplContext* context, float h, float size)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    vplMaterialDef material = vplDefaultMaterialDef();
    material.diffuse = (vplRgb){0, 0, 0};
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    material.emission = (vplRgb){1, 1, 1};
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    for (int i = 0; i < 2; i++) {
        vplObjectDef object = vplDefaultObjectDef();
        object.material = i;
        object.transform =
            vplMat4_FromParts((vplVec3){0, i ? h : 0, 0}, (double[3]){(i ? 1 : -1) * VPL_PI / 2, 0, 0},
                              (vplVec3){i ? size : 1, i ? size : 1, 1});
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    }
    return buildGeometry(scene);
}

// Makes virtual lights that represent the plane within 2 D of the receiver.
static vplShadeLight* gridOver(float h, float distance)
{
    vplShadeLight* lights = malloc(SIDE * SIDE * sizeof *lights);
    const float cell = 4 * distance / SIDE, intensity = cell * cell;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const float x = ((float)(i % SIDE) + 0.5f) * cell - 2 * distance;
        const float z = ((float)(i / SIDE) + 0.5f) * cell - 2 * distance;
        lights[i] = (vplShadeLight){x, h, z, 0, -1, 0, intensity, intensity, intensity};
    }
    return lights;
}

// Returns the E / pi that compensation adds to the receiver, averaged over 16 points at one position.
static double givenBack(const vplGeometry* g, const vplShadeDef* def)
{
    vplView view = {.width = 1, .height = 1};
    vplShading shading = vplShading_Make(g, &view, def);
    vplSurface surface;
    vplPoints points = {.surface = &surface, .plane = &surface};
    uint32_t pixels[VPL_LANES];
    float irradiance[3][VPL_LANES] = {{0}};
    int64_t rays = 0;
    double sum = 0;
    memset(&surface, 0, sizeof surface);
    for (int l = 0; l < VPL_LANES; l++) {
        surface.ny[l] = 1;
        points.triangle[l] = 0;
        pixels[l] = (uint32_t)l;
    }
    shading.arena = vplArena_Create(g->context);
    assert_int_equal(vplCompensator_Open(&shading), VPL_SUCCESS);
    vplAddCompensation(&shading, &points, pixels, irradiance, &rays);
    vplArena_Destroy(shading.arena);
    assert_true(rays > 0);
    for (int l = 0; l < VPL_LANES; l++) {
        assert_true(irradiance[0][l] == irradiance[1][l] && irradiance[1][l] == irradiance[2][l]);
        sum += (double)irradiance[0][l] / VPL_LANES / VPL_PI;
    }
    return sum;
}

// For a plane at height h, clamping keeps the share (h^2/c)(1 + ln(c/h^2)). Rays alone must add the rest, and
// so must rays within a fifth of D combined with the lights beyond.
TEST(PlaneGetsBackWhatTheClampTakes, 1)
{
    Table t = loadTable("vpl_clamp_plane.csv");
    for (int row = 0; row < t.rows; row++) {
        const double c = number(&t, row, "c"), lost = 1 - number(&t, row, "fraction_kept_r2clamp");
        const float h = (float)number(&t, row, "h"), distance = (float)sqrt(c);
        vplGeometry* g = planeOver(context, h, 8 * distance);
        vplShadeLight* lights = gridOver(h, distance);
        vplCompensationDef near = vplDefaultCompensationDef();
        near.rayCount = PLANE_RAYS;
        near.lights = lights;
        near.lightCount = near.hitLights = near.emitterLightCount = SIDE * SIDE;
        near.emitterLightDistance = distance;
        near.seesReflection = false;
        vplShadeDef def = vplDefaultShadeDef();
        def.minDistance = distance;
        def.lights = lights;
        def.lightCount = SIDE * SIDE;
        def.compensation = &near;
        assertNear(givenBack(g, &def), lost, 1e-3, "by rays alone", row);
        near.emitterLightDistance = 0.2f * distance; // the grid's cells measure D / 24
        assertNear(givenBack(g, &def), lost, 4e-3, "by rays and lights", row);
        free(lights);
        vplGeometry_Destroy(g);
    }
    freeTable(&t);
}

// ---- a ceiling that lamps light from below

enum { LAMPS = 12, POINTS_PER_LAMP = 16, LAMP_RAYS = 512 };

// Makes a black floor below the ceiling, with lamps around it that face up.
static vplGeometry* ceilingOverLamps(vplContext* context)
{
    vplScene* scene = sceneOf(context, 0);
    const int white = addMaterial(scene, (vplRgb){0.5f, 0.5f, 0.5f}, 0);
    const int lamp = addMaterial(scene, (vplRgb){0, 0, 0}, 1);
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, 0), -VPL_PI / 2, 0, vplVec(1, 1, 1));
    addThing(scene, VPL_OBJECT_QUAD, white, vplVec(0, 0.5f, 0), VPL_PI / 2, 0, vplVec(6, 6, 1));
    for (int i = 0; i < LAMPS; i++) {
        const double turn = 2 * VPL_PI * i / LAMPS;
        addThing(scene, VPL_OBJECT_QUAD, lamp, vplVec(1.2f * (float)cos(turn), 0.1f, 1.2f * (float)sin(turn)),
                 -VPL_PI / 2, 0, vplVec(0.3f, 0.3f, 1));
    }
    return buildGeometry(scene);
}

// However few of the triangles that emit a hit chooses, the mean is the light of all, for which points on them stand.
TEST(ChosenTrianglesLightWhatRaysHit, 1)
{
    static const int chosen[] = {1, 16, 17, 64, 200};
    static vplShadeLight points[LAMPS * POINTS_PER_LAMP];
    vplGeometry* g = ceilingOverLamps(context);
    vplEmission* emission;
    assert_int_equal(vplEmission_Create(g, NULL, 0, &emission), VPL_SUCCESS);
    vplCompensationDef near = vplDefaultCompensationDef();
    near.rayCount = LAMP_RAYS;
    near.areaLights = points;
    near.areaLightCount = vplSampleAreaLights(emission, LAMPS * POINTS_PER_LAMP, points);
    vplShadeDef def = vplDefaultShadeDef();
    def.minDistance = 1;
    def.compensation = &near;
    const double all = givenBack(g, &def);
    near.areaLightCount = 0;
    assert_true(all > 0.001 && givenBack(g, &def) == 0);
    for (int i = 0; i < 5; i++) {
        near.trianglesPerPoint = chosen[i];
        assertNear(givenBack(g, &def), all, 0.03 * all, "light of chosen triangles", chosen[i]);
    }
    vplEmission_Destroy(emission);
    vplGeometry_Destroy(g);
}

// ---- a closed room whose walls reflect and emit equally: radiance is E / (1 - rho) everywhere

static vplScene* furnace(vplContext* context, float rho, vplVec3 eye, vplVec3 target, double fovY)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    vplMaterialDef material = vplDefaultMaterialDef();
    material.diffuse = (vplRgb){rho, rho, rho};
    material.emission = (vplRgb){1, 1, 1};
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    for (int face = 0; face < 6; face++) {
        static const vplVec3 places[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                          {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
        static const double turns[6][2] = {{0, -1}, {0, 1}, {1, 0}, {-1, 0}, {0, 2}, {0, 0}}; // about x and y
        vplObjectDef def = vplDefaultObjectDef();
        const double rotate[3] = {turns[face][0] * VPL_PI / 2, turns[face][1] * VPL_PI / 2, 0};
        def.transform = vplMat4_FromParts(places[face], rotate, (vplVec3){2, 2, 1});
        assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
    }
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = eye;
    camera.target = target;
    camera.nearPlane = 1e-3;
    camera.fovY = fovY;
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
    return scene;
}

static vplRenderOptions kellerOptions(int size, int particles, float distance)
{
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_KELLER;
    o.output.width = o.output.height = size;
    o.particles.count = particles;
    o.particles.reflectivity = -1;
    o.lights.minDistance = distance;
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    return o;
}

static double meanOf(const vplScene* scene, const vplRenderOptions* options, vplRenderStats* stats)
{
    vplImage* image = renderScene(scene, options, stats);
    double sum = 0;
    const int count = 3 * image->width * image->height;
    for (int i = 0; i < count; i++) {
        assert_true(isfinite(image->pixels[i]) && image->pixels[i] >= 0);
        sum += (double)image->pixels[i];
    }
    vplImage_Destroy(image);
    return sum / count;
}

TEST(FurnaceIsRightWhateverTheClampDistance, 2, SLOW)
{
    static const float distances[] = {0.25f, 0.5f, 2, 100};
    vplScene* middle =
        furnace(context, 0.5f, (vplVec3){0.3f, 0.2f, 0.6f}, (vplVec3){-0.2f, 0, -1}, VPL_PI / 2);
    vplScene* corner = furnace(context, 0.5f, (vplVec3){0.5f, 0.5f, 0.5f}, (vplVec3){1, 1, 1}, VPL_PI / 6);
    for (int i = 0; i < 4; i++) {
        vplRenderOptions o = kellerOptions(24, 2000, distances[i]);
        assertNear(meanOf(middle, &o, NULL), 2, 0.02, "middle", i);
        assertNear(meanOf(corner, &o, NULL), 2, 0.04, "corner", i);
        o.lights.compensation = VPL_COMPENSATION_NONE;
        assert_true(meanOf(corner, &o, NULL) < 1.9);
    }
    vplScene_Destroy(middle);
    vplScene_Destroy(corner);
}

TEST(LossIsWhatCompensationAdds, 2, SLOW)
{
    static const float distances[] = {0.3f, 1};
    vplScene* scene =
        furnace(context, 0.5f, (vplVec3){0.3f, 0.2f, 0.6f}, (vplVec3){-0.2f, 0, -1}, VPL_PI / 2);
    for (int i = 0; i < 2; i++) {
        vplRenderStats with, without;
        vplRenderOptions o = kellerOptions(64, 2000, distances[i]);
        meanOf(scene, &o, &with);
        o.lights.compensation = VPL_COMPENSATION_NONE;
        const double lost = 2 - meanOf(scene, &o, &without); // of the 1 that virtual lights contribute
        assertNear(without.clampLoss, lost, 0.03 + 0.05 * lost, "estimated without", i);
        assertNear(with.clampLoss, lost, 0.03 + 0.05 * lost, "estimated with", i);
        o.output.show = VPL_SHOW_LIGHT;
        meanOf(scene, &o, &without);
        assert_true(without.clampLoss < 0);
    }
    vplScene_Destroy(scene);
}

// White walls lose no energy and the clamp distance is infinite: only the limit on the path length ends a
// walk.
TEST(WhiteWallsAndAnInfiniteClampDistanceEnd, 2)
{
    vplScene* scene = furnace(context, 1, (vplVec3){0.3f, 0.2f, 0.6f}, (vplVec3){-0.2f, 0, -1}, VPL_PI / 2);
    vplRenderOptions o = kellerOptions(2, 10, 1e15f);
    o.particles.reflectivity = 0.5;
    const double mean = meanOf(scene, &o, NULL);
    assert_true(mean > 900 && mean < 1100); // each bounce adds one emission
    vplScene_Destroy(scene);
}

// ---- a room

static uint64_t hashOf(const vplScene* scene, const vplRenderOptions* options)
{
    vplRenderStats stats;
    vplImage_Destroy(renderScene(scene, options, &stats));
    return stats.imageHash;
}

static uint64_t hashWith(vplContext* context, const vplRenderOptions* options)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    const uint64_t hash = hashOf(scene, options);
    vplScene_Destroy(scene);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(ThreadsAndInstructionSetsGiveTheSameBits)
{
    static const int threads[] = {2, 3, 7};
    for (int pipeline = 0; pipeline < 2; pipeline++) {
        vplRenderOptions o = kellerOptions(50, 30, -1);
        o.pipeline.kind = pipeline ? VPL_ACCUMULATE_INTERLEAVED : VPL_ACCUMULATE_DEFERRED;
        o.stop.passes = 2;
        const uint64_t wanted = hashWith(openTestContext(1), &o);
        for (int i = 0; i < 3; i++) {
            assert_true(hashWith(openTestContext(threads[i]), &o) == wanted);
        }
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            vplContext* context = openIsaContext(2, (vplIsa)isa);
            assert_true(context == NULL || hashWith(context, &o) == wanted);
        }
        o.lights.compensation = VPL_COMPENSATION_NONE;
        assert_true(hashWith(openTestContext(1), &o) != wanted);
    }
}

TEST(PipelinesGiveTheSameBits, 2)
{
    static const char* const scenes[] = {"examples/scenes/room.json", "examples/scenes/room-area.json"};
    for (int i = 0; i < 2; i++) {
        vplScene* scene = openScene(context, scenes[i]);
        vplRenderOptions o = kellerOptions(50, 70, -1);
        const uint64_t wanted = hashOf(scene, &o);
        o.pipeline.kind = VPL_ACCUMULATE_MULTIPASS;
        assert_true(hashOf(scene, &o) == wanted);
        o.pipeline.kind = VPL_ACCUMULATE_BATCHED;
        assert_true(hashOf(scene, &o) == wanted);
        vplScene_Destroy(scene);
    }
}

// Different rays find the direct light of area lights and the remaining light; their pictures must still add
// up to one.
TEST(PartsAddUpOnAverage, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    vplRenderOptions o = kellerOptions(48, 300, 1);
    const double picture = meanOf(scene, &o, NULL);
    o.output.show = VPL_SHOW_DIRECT;
    double parts = meanOf(scene, &o, NULL);
    o.output.show = VPL_SHOW_INDIRECT;
    parts += meanOf(scene, &o, NULL);
    assertNear(parts, picture, 0.005 * picture, "direct + indirect", 0);
    vplScene_Destroy(scene);
}

static double pathMean(const vplScene* scene)
{
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_PATH;
    o.path.pixel = VPL_PIXEL_CENTRE;
    o.output.width = o.output.height = 32;
    o.path.samples = 256;
    return meanOf(scene, &o, NULL);
}

// Covers instant radiosity with its area lights and shadow maps, Keller's with a point light, shadows by
// maps, and interleaving.
TEST(EveryKindOfLightIsGivenBack, 2, SLOW)
{
    static const struct {
        const char* scene;
        vplMethod method;
        vplLightShadows shadows;
        vplAccumulation accumulation;
    } cases[] = {
        {"examples/scenes/room.json", VPL_METHOD_INSTANT_RADIOSITY, VPL_LIGHT_SHADOWS_RAY,
         VPL_ACCUMULATE_DEFERRED},
        {"examples/scenes/room-area.json", VPL_METHOD_INSTANT_RADIOSITY, VPL_LIGHT_SHADOWS_RAY,
         VPL_ACCUMULATE_DEFERRED},
        {"examples/scenes/room.json", VPL_METHOD_KELLER, VPL_LIGHT_SHADOWS_RAY, VPL_ACCUMULATE_DEFERRED},
        {"examples/scenes/room-area.json", VPL_METHOD_KELLER, VPL_LIGHT_SHADOWS_MAP, VPL_ACCUMULATE_DEFERRED},
        {"examples/scenes/room-area.json", VPL_METHOD_KELLER, VPL_LIGHT_SHADOWS_RAY,
         VPL_ACCUMULATE_INTERLEAVED},
    };
    for (int i = 0; i < 5; i++) {
        vplScene* scene = openScene(context, cases[i].scene);
        const double truth = pathMean(scene);
        vplRenderOptions o = kellerOptions(32, cases[i].shadows == VPL_LIGHT_SHADOWS_MAP ? 500 : 1000, 1.5f);
        o.method = cases[i].method;
        o.lights.shadows = cases[i].shadows;
        o.lights.mapSize = 48;
        o.pipeline.kind = cases[i].accumulation;
        o.pipeline.interleave = 4;
        o.lights.compensation = VPL_COMPENSATION_RAYS;
        o.particles.sampler = VPL_SAMPLER_HALTON;
        assertNear(meanOf(scene, &o, NULL), truth, 0.01 * truth, cases[i].scene, i);
        o.lights.compensation = VPL_COMPENSATION_NONE;
        assert_true(meanOf(scene, &o, NULL) < 0.985 * truth);
        vplScene_Destroy(scene);
    }
}

// Compensation rays bring nearly all light here: the error falls only if later passes cast different rays.
TEST(PassesCastOtherRays, 2)
{
    vplScene* scene =
        furnace(context, 0.5f, (vplVec3){0.3f, 0.2f, 0.6f}, (vplVec3){-0.2f, 0, -1}, VPL_PI / 2);
    double errors[2];
    for (int i = 0; i < 2; i++) {
        vplRenderOptions o = kellerOptions(16, 10, 100);
        o.stop.passes = i ? 32 : 2;
        vplImage* image = renderScene(scene, &o, NULL);
        errors[i] = 0;
        for (int k = 0; k < 3 * 16 * 16; k++) {
            errors[i] += ((double)image->pixels[k] - 2) * ((double)image->pixels[k] - 2);
        }
        vplImage_Destroy(image);
    }
    assert_true(errors[1] < errors[0] / 8);
    vplScene_Destroy(scene);
}

// From inside a unit sphere, cosine-distributed rays have length d = 2 cos, whose square is uniform in [0,
// 4]: the mean of max(0, 1 - d^2/D^2) is D^2/8 up to D = 2. If no surface is visible, the distance is the
// scene's diagonal.
TEST(NearDistanceOfASphereIsThatOfItsChords, 2)
{
    Shape shape = icosphere(4);
    vplScene* scene = sceneOf(context, 0.5f);
    addShape(scene, &shape, false, NULL);
    freeShape(&shape);
    vplGeometry* sphere = buildGeometry(scene);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, 0, 0);
    camera.target = vplVec(0, 0, -1);
    camera.fovY = 1;
    camera.nearPlane = 0.01;
    vplView view = vplView_Create(&camera, 100, 100);
    static const double shares[] = {0.1, 0.2, 0.45}; // below, flat triangles do not see themselves
    for (int i = 0; i < 3; i++) {
        float distance;
        assert_int_equal(vplFindNearDistance(sphere, &view, shares[i], &distance), VPL_SUCCESS);
        assertNear((double)distance, sqrt(8 * shares[i]), 0.02 * sqrt(8 * shares[i]), "distance", i);
    }
    float distance;
    camera.eye = vplVec(0, 0, -9); // looks away from the sphere
    camera.target = vplVec(0, 0, -10);
    view = vplView_Create(&camera, 100, 100);
    assert_int_equal(vplFindNearDistance(sphere, &view, 0.2, &distance), VPL_SUCCESS);
    assertNear((double)distance, (double)vplGeometry_Diagonal(sphere), 1e-6, "diagonal", 0);
    vplGeometry_Destroy(sphere);
}

// ---- lights of a hit

TEST(HitsTakeFewLightsWherePixelsDo, 1)
{
    (void)context;
    const double area = VPL_PI * 20; // 20 circles of a clamp distance of 1 m
    static const struct {
        double distance, pixelLights, expected;
    } ROWS[] = {
        {1, 30, 20},   // as many as there are circles
        {0.1, 30, 32}, // at most 32
        {10, 30, 16},  // at least 16
        {1, 9, 18},    // at most twice those of a pixel
        {0.1, 9, 18},  // the same for a small clamp distance
        {10, 9, 16},   // 16 is less than twice those of a pixel
        {1, 3.6, 8},   // 8, if twice those of a pixel is less: a pass of 125 particles, interleaved 8 x 8
        {1, 0, 8},     // no lights at pixels
    };
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        const double lights = vplLightsOfHit(area, ROWS[i].distance, ROWS[i].pixelLights);
        assertNear(lights, ROWS[i].expected, 1e-12, "lights", (int)i);
    }
}
