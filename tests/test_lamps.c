// SPDX-License-Identifier: MIT
// Tests of many lamps: the tree from which paths and pixels choose emitters, and refusals of pictures that need too much memory.
#include "failing.h"
#include "geometry/emitter_tree.h"
#include "geometry/triangle.h"
#include "path_scenes.h"

enum { LAMPS = 100, QUADS = 40, POINTS = 60 };

static vplVec3 pointAt(uint64_t index, float size)
{
    const double u[3] = {uniformAt(71, 3 * index), uniformAt(71, 3 * index + 1),
                         uniformAt(71, 3 * index + 2)};
    return vplVec(size * (float)(2 * u[0] - 1), size * (float)(2 * u[1] - 1), size * (float)(2 * u[2] - 1));
}

// A room with lamps of every kind; a camera in it.
static vplScene* hall(vplContext* context)
{
    vplScene* scene = newScene(context);
    addRoom(scene, addGrey(scene, 0.5f, 0));
    for (int i = 0; i < LAMPS; i++) {
        const bool spot = i % 3 == 0;
        const vplVec3 aim = pointAt(1000 + (uint64_t)i, 1);
        addEmitter(scene,
                   i == 50 ? VPL_EMITTER_DIRECTIONAL
                   : spot  ? VPL_EMITTER_SPOT
                           : VPL_EMITTER_POINT,
                   pointAt((uint64_t)i, 0.9f), aim, i == 50 ? 1 : 0.02f * (float)(1 + i % 5));
    }
    const int glow = addGrey(scene, 0.2f, 2);
    for (int i = 0; i < QUADS; i++) {
        addQuad(scene, glow, pointAt(2000 + (uint64_t)i, 0.8f), i % 2, 0.05f + 0.002f * (float)i);
    }
    addCamera(scene, vplVec(0, 0, 0.95f), vplVec(0, -0.1f, -1), 1.4);
    return scene;
}

static vplEmission* emissionOf(const vplScene* scene, const vplGeometry* g, vplEmitterDef emitters[LAMPS])
{
    vplEmission* e;
    for (int i = 0; i < LAMPS; i++) {
        emitters[i] = *vplScene_GetEmitter(scene, i);
    }
    assert_int_equal(vplEmission_Create(g, emitters, LAMPS, &e), VPL_SUCCESS);
    return e;
}

// Checks the probabilities of all sources for a point against 4,096 evenly spread choices. With those that end without a
// source they add up to 1.
static void checkPoint(const vplEmitterTree* tree, const vplEmission* e, int first, int end, vplVec3 p,
                       vplVec3 n)
{
    enum { CHOICES = 4096 };
    static int counts[LAMPS + 2 * QUADS + 8];
    double sum = 0;
    int without = 0;
    memset(counts, 0, sizeof counts);
    for (int i = 0; i < CHOICES; i++) {
        const vplChosenSource c = vplEmitterTree_Choose(tree, p, n, (i + 0.5) / CHOICES);
        if (c.source >= 0) {
            counts[c.source]++;
            assertNear(c.probability, vplEmitterTree_Probability(tree, p, n, c.source), 1e-12, "chosen",
                       c.source);
            assert_true(c.rest >= 0 && c.rest < 1);
        }
        without += c.source < 0;
    }
    for (int i = first; i < end; i++) {
        const vplEmissionSource* s = &e->sources[i];
        if (s->triangle >= 0 || e->emitters[s->emitter].type != VPL_EMITTER_DIRECTIONAL) {
            const double probability = vplEmitterTree_Probability(tree, p, n, i);
            sum += probability;
            assertNear(counts[i], probability * CHOICES, 1.01, "count", i); // an interval of this length
        }
    }
    assert_true(sum <= 1 + 1e-9);
    assertNear(sum + (double)without / CHOICES, 1, 0.02, "sum", 0); // intervals without a source are few
}

TEST(ProbabilitiesOfATreeOfEmittersAreThoseOfItsChoices, 1)
{
    vplScene* scene = hall(context);
    vplEmitterDef emitters[LAMPS];
    vplGeometry* g;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    vplEmission* e = emissionOf(scene, g, emitters);
    const int ends[3] = {0, e->firstTriangle, e->sourceCount};
    assert_int_equal(ends[2] - ends[1], 2 * QUADS);
    for (int k = 0; k < 2; k++) {
        vplEmitterTree* tree;
        vplArena* arena = vplArena_Create(context);
        assert_int_equal(vplEmitterTree_Create(arena, e, ends[k], ends[k + 1], &tree), VPL_SUCCESS);
        for (uint64_t i = 0; i < POINTS; i++) {
            checkPoint(tree, e, ends[k], ends[k + 1], pointAt(3000 + i, 1),
                       vplNormalize(pointAt(4000 + i, 1)));
        }
        vplArena_Destroy(arena);
    }
    vplEmission_Destroy(e);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

// Every emitter that lights a point unoccluded can be chosen there.
TEST(NoEmitterThatLightsAPointIsLeftOut, 1)
{
    vplScene* scene = hall(context);
    vplEmitterDef emitters[LAMPS];
    vplGeometry* g;
    vplEmitterTree* tree;
    int lit = 0;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    vplEmission* e = emissionOf(scene, g, emitters);
    vplArena* arena = vplArena_Create(context);
    assert_int_equal(vplEmitterTree_Create(arena, e, 0, e->firstTriangle, &tree), VPL_SUCCESS);
    for (uint64_t i = 0; i < 1000; i++) {
        const vplVec3 p = pointAt(5000 + i, 1), n = vplNormalize(pointAt(7000 + i, 1));
        for (int k = 0; k < e->firstTriangle; k++) {
            const vplEmitterDef* emitter = &emitters[e->sources[k].emitter];
            const vplVec3 to = vplSub(emitter->position, p);
            const vplRgb light = vplEmitter_Intensity(emitter, vplNegate(vplNormalize(to)));
            if (emitter->type != VPL_EMITTER_DIRECTIONAL && vplDot(n, to) > 1e-4f && light.r > 0) {
                assert_true(vplEmitterTree_Probability(tree, p, n, k) > 0);
                lit++;
            }
        }
    }
    printf("# %d pairs of a point and an emitter that lights it\n", lit);
    assert_true(lit > 20000);
    vplArena_Destroy(arena);
    vplEmission_Destroy(e);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

// The mean of a picture of `size` pixels a side, with trees or without.
static double meanOf(const vplGeometry* g, vplPathDef def, int samples, bool trees, double* errorOut)
{
    vplPathTracer* tracer;
    vplPathStats stats;
    vplImage* image;
    def.emittersOfTree = def.trianglesOfTree = trees ? 1 : INT32_MAX;
    assert_int_equal(vplPathTracer_Create(g, &def, &tracer), VPL_SUCCESS);
    assert_int_equal(vplPathTracer_Pass(tracer, samples, NULL, NULL, 0, 1), VPL_SUCCESS);
    assert_int_equal(vplImage_Create(g->context, def.width, def.height, &image), VPL_SUCCESS);
    vplPathTracer_Resolve(tracer, image, &stats);
    const double mean = meanOfImage(image, 0);
    *errorOut = stats.errorEstimate / sqrt((double)def.width * def.height);
    vplImage_Destroy(image);
    vplPathTracer_Destroy(tracer);
    return mean;
}

// Light of all lamps, reflected up to twice, has the same mean whether vertices choose lamps from trees or ask all.
TEST(TreesOfEmittersChangeNoMean, 2)
{
    static const int ways[] = {VPL_PATH_LIGHT_SAMPLING, VPL_PATH_LIGHT_SAMPLING | VPL_PATH_BSDF_SAMPLING,
                               VPL_PATH_ALL};
    vplScene* scene = hall(context);
    vplGeometry* g;
    vplEmitterDef emitters[LAMPS];
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    for (int i = 0; i < LAMPS; i++) {
        emitters[i] = *vplScene_GetEmitter(scene, i);
    }
    vplPathDef def = vplDefaultPathDef();
    def.camera = vplScene_GetCamera(scene, 0);
    def.emitters = emitters;
    def.emitterCount = LAMPS;
    def.width = def.height = 16;
    def.emission = false;
    def.lastBounce = 2;
    for (int i = 0; i < 3; i++) {
        double errors[2];
        def.techniques = ways[i];
        const double with = meanOf(g, def, 256, true, &errors[0]);
        const double without = meanOf(g, def, 256, false, &errors[1]);
        const double error = sqrt(errors[0] * errors[0] + errors[1] * errors[1]);
        printf("# techniques %d: with trees %.5f, without %.5f, standard error %.5f\n", ways[i], with,
               without, error);
        assertNear(with, without, 4 * error, "mean", i);
        assert_true(error < 0.01 * without);
    }
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

static uint64_t hashOfHall(vplContext* context)
{
    vplScene* scene = hall(context);
    vplRenderOptions o = pathOptions(16, 4);
    vplImage* image = renderScene(scene, &o, NULL);
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(PathsAmongLampsAreTheSameEverywhere)
{
    assertSameEverywhere(hashOfHall);
}

static vplResult renderCrowd(Attempt* a, const vplRenderOptions* o, int lamps)
{
    TRY(vplScene_Create(a->context, &a->scene));
    for (int i = 0; i < lamps; i++) {
        vplEmitterDef emitter = vplDefaultEmitterDef();
        emitter.position = pointAt((uint64_t)i, 1);
        TRY(vplScene_AddEmitter(a->scene, &emitter, NULL));
    }
    vplCameraDef camera = vplDefaultCameraDef();
    vplObjectDef object = vplDefaultObjectDef();
    vplMaterialDef material = vplDefaultMaterialDef();
    TRY(vplScene_AddCamera(a->scene, &camera, NULL));
    TRY(vplScene_AddMaterial(a->scene, &material, &object.material));
    TRY(vplScene_AddObject(a->scene, &object, NULL));
    return vplRender(a->scene, o, &a->image, NULL);
}

static vplResult traceCrowd(Attempt* a)
{
    const vplRenderOptions o = pathOptions(8, 1);
    return renderCrowd(a, &o, LAMPS);
}

static vplResult lightCrowd(Attempt* a)
{
    vplRenderOptions o = pathOptions(8, 1);
    o.method = VPL_METHOD_DIRECT;
    return renderCrowd(a, &o, 1025);
}

TEST_ALONE(TreesOfEmittersSurviveEveryFailedAllocation)
{
    failSomeAllocations("paths among lamps", traceCrowd, 1);
    failSomeAllocations("direct light of many lamps", lightCrowd, 7);
}

// ---- direct light

enum { CLOSE = 1024, MANY = 1100 };

// Points of one side of a wall, so close to each other that they receive the same light; each chooses for itself.
static void lightClosePoints(const vplGeometry* g, const vplShadeDef* def, int triangle, vplVec3 centre,
                             double sumsOut[2])
{
    static vplSurfacePoint points[CLOSE];
    static vplRgb irradiance[CLOSE];
    int64_t rays = 0;
    for (int i = 0; i < CLOSE; i++) {
        vplVec3 offset = pointAt(9000 + (uint64_t)i, 0.002f);
        offset = vplSub(offset, vplScale(vplDot(offset, g->normals[triangle]), g->normals[triangle]));
        points[i] = (vplSurfacePoint){
            .position = vplAdd(centre, offset), .normal = g->normals[triangle], .triangle = triangle};
    }
    sumsOut[0] = sumsOut[1] = 0;
    assert_int_equal(vplShadePoints(g, def, points, CLOSE, irradiance, &rays), VPL_SUCCESS);
    for (int i = 0; i < CLOSE; i++) {
        sumsOut[0] += (double)irradiance[i].r / CLOSE;
        sumsOut[1] += (double)irradiance[i].r * (double)irradiance[i].r / CLOSE;
    }
}

// The mean over many choices is the sum of all emitters, directional ones among them, with their shadows.
TEST(ChosenEmittersHaveTheMeanOfAll, 2)
{
    static vplShadow shadows[LAMPS];
    vplScene* scene = hall(context);
    vplEmitterDef emitters[LAMPS];
    vplGeometry* g;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    for (int i = 0; i < LAMPS; i++) {
        emitters[i] = *vplScene_GetEmitter(scene, i);
    }
    vplShadeDef def = vplDefaultShadeDef();
    def.emitters = emitters;
    def.shadows = shadows;
    def.emitterCount = LAMPS;
    double squares = 0;
    int checked = 0;
    for (int triangle = 0; triangle < g->triangleCount; triangle += 5) {
        const vplTriangleCorners t = vplGeometry_Corners(g, triangle);
        const vplVec3 centre = vplScale(1.0f / 3, vplAdd(t.corner[0], vplAdd(t.corner[1], t.corner[2])));
        double all[2], chosen[2];
        def.emittersPerPoint = 0;
        lightClosePoints(g, &def, triangle, centre, all);
        def.emittersPerPoint = 4;
        lightClosePoints(g, &def, triangle, centre, chosen);
        const double error = sqrt(fmax(chosen[1] - chosen[0] * chosen[0], 0) / CLOSE);
        assertNear(chosen[0], all[0], 4 * error + 0.003 * all[0], "irradiance", triangle);
        squares += error > 0 ? (chosen[0] - all[0]) * (chosen[0] - all[0]) / (error * error) : 0;
        checked += error > 0;
    }
    printf("# %d places, mean square of the difference in standard errors %.2f\n", checked,
           squares / checked);
    assert_true(checked >= 8 && squares < 2.5 * checked);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

// A room with points, whose pictures are small.
static vplScene* crowded(vplContext* context, int lamps)
{
    vplScene* scene = newScene(context);
    addRoom(scene, addGrey(scene, 0.5f, 0));
    addCamera(scene, vplVec(0, 0, 0.9f), vplVec(0, 0, -1), 1.4);
    for (int i = 0; i < lamps; i++) {
        addEmitter(scene, VPL_EMITTER_POINT, pointAt((uint64_t)i, 0.9f), vplVec(0, -1, 0), 0.01f);
    }
    return scene;
}

TEST(OnlyManyEmittersAreChosenFrom, 1)
{
    static const vplMethod methods[] = {VPL_METHOD_DIRECT, VPL_METHOD_KELLER, VPL_METHOD_RADIOSITY,
                                        VPL_METHOD_SSVP, VPL_METHOD_PATH};
    for (int many = 0; many < 2; many++) {
        vplScene* scene = crowded(context, many ? 1025 : 1024);
        for (int i = 0; i < 5; i++) {
            vplRenderOptions o = plainOptions();
            vplPlan* plan;
            o.method = methods[i];
            assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
            assert_int_equal(plan->emittersPerPoint, many && i < 4 ? 64 : 0);
            assert_int_equal(plan->emitterCount, many ? 1025 : 1024);
            assert_true(plan->mapEmitterCount > 0 && plan->mapEmitterCount <= 256);
            vplPlan_Destroy(plan);
            o.lights.emitterSamples = 100;
            assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
            assert_int_equal(plan->emittersPerPoint, i < 4 ? 100 : 0);
            assert_true(plan->emitterCount >= 1024 && plan->mapEmitterCount <= 100);
            vplPlan_Destroy(plan);
        }
        vplScene_Destroy(scene);
    }
}

// Hits of short rays choose from a hundred lamps, and few samples stand for all at rims of their shadows.
static uint64_t hashOfSmallCrowd(vplContext* context)
{
    vplScene* scene = crowded(context, 100);
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_KELLER;
    o.output.width = o.output.height = 16;
    o.output.antialias = 16;
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o.lights.compensation = VPL_COMPENSATION_RAYS;
    o.lights.minDistance = 1;
    vplImage* image = renderScene(scene, &o, NULL);
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    return hash;
}

static uint64_t hashOfCrowd(vplContext* context)
{
    static const vplMethod methods[] = {VPL_METHOD_DIRECT, VPL_METHOD_KELLER, VPL_METHOD_SSVP};
    vplScene* scene = crowded(context, MANY);
    uint64_t hash = hashOfSmallCrowd(context);
    for (int i = 0; i < 3; i++) {
        vplRenderOptions o = plainOptions();
        o.method = methods[i];
        o.output.width = o.output.height = 8;
        o.shadow.rsmSize = 16;
        o.ssvp.firstBounce = 64;
        vplImage* image = renderScene(scene, &o, NULL);
        hash = 31 * hash + vplImage_Hash(image);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(PixelsAmongManyLampsAreTheSameEverywhere)
{
    assertSameEverywhere(hashOfCrowd);
}

// ---- memory

TEST(PicturesThatNeedMoreMemoryThanAllowedAreRefused, 1)
{
    vplScene* scene = openScene(context, ROOM);
    vplRenderOptions o = vplDefaultRenderOptions();
    vplImage* image = NULL;
    o.method = VPL_METHOD_DIRECT;
    vplContext_SetMemoryLimit(context, 1 << 20);
    assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_OUT_OF_MEMORY);
    assert_non_null(strstr(takeMessage(), "1 MiB are allowed"));
    assert_null(image);
    vplContext_SetMemoryLimit(context, 0);
    o.output.width = o.output.height = 16;
    vplImage_Destroy(renderScene(scene, &o, NULL));
    vplScene_Destroy(scene);
}

// A thousand point lights had 24 GB of shadow maps. Rays replace maps where all together would take more than 1 GiB.
TEST(ShadowMapsOfManyLampsAreReplacedByRays, 1)
{
    vplScene* scene = newScene(context);
    addRoom(scene, addGrey(scene, 0.5f, 0));
    addCamera(scene, vplVec(0, 0, 0.9f), vplVec(0, 0, -1), 1.4);
    for (int i = 0; i < 1000; i++) {
        addEmitter(scene, VPL_EMITTER_POINT, pointAt((uint64_t)i, 0.9f), vplVec(0, -1, 0), 0.01f);
    }
    static const vplMethod methods[] = {VPL_METHOD_DIRECT, VPL_METHOD_INSTANT_RADIOSITY, VPL_METHOD_KELLER,
                                        VPL_METHOD_SSVP};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        vplRenderOptions o = vplDefaultRenderOptions();
        vplPlan* plan;
        o.method = methods[i];
        o.output.width = o.output.height = 32;
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        printf("# method %d: %.0f MiB\n", methods[i], (double)plan->peakBytes / 1048576);
        assert_true(plan->emitterRays && plan->peakBytes < (int64_t)2 << 30);
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}

// The method that is planned for an error and a time; 0: none is asked for.
static vplMethod methodFor(const vplScene* scene, int width, double error, double ms)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    o.output.width = width;
    o.output.height = width * 9 / 16;
    o.stop.maxError = error;
    o.stop.budgetMs = ms;
    return plannedOptions(scene, &o).method;
}

// Pixels sample area lights by rays unless the time is limited, or the error is large and the picture is not tiny.
TEST(AreaLightsAreSampledWhereThatIsWorthIt, 1)
{
    vplScene* scene = openScene(context, "examples/scenes/textured-room.json");
    assert_int_equal(methodFor(scene, 320, 0, 0), VPL_METHOD_INSTANT_RADIOSITY);
    assert_int_equal(methodFor(scene, 320, 0.1, 0), VPL_METHOD_INSTANT_RADIOSITY);
    assert_int_equal(methodFor(scene, 320, 0.2, 0), VPL_METHOD_KELLER);
    assert_int_equal(methodFor(scene, 96, 0.2, 0), VPL_METHOD_INSTANT_RADIOSITY);
    assert_int_equal(methodFor(scene, 320, 0.1, 1000), VPL_METHOD_KELLER);
    vplScene_Destroy(scene);
}

// Direct light is enough above dark ground. But for a large error virtual lights serve the sky in less time, except in tiny pictures.
TEST(TheSkyIsSampledWhereThatIsWorthIt, 1)
{
    vplScene* scene = newScene(context);
    vplEnvironmentDef sky = vplDefaultEnvironmentDef();
    addThing(scene, VPL_OBJECT_QUAD, addGrey(scene, 0.05f, 0), vplVec(0, 0, 0), -1.5707963, 0,
             vplVec(20, 20, 1));
    addCamera(scene, vplVec(0, 2, 6), vplVec(0, 0, 0), 1);
    addEmitter(scene, VPL_EMITTER_DIRECTIONAL, vplVec(0, 0, 0), vplVec(0, -1, 0), 1);
    assert_int_equal(methodFor(scene, 320, 0.2, 0), VPL_METHOD_DIRECT);
    sky.type = VPL_ENVIRONMENT_CONSTANT;
    sky.radiance = (vplRgb){1, 1, 1};
    assert_int_equal(vplScene_SetEnvironment(scene, &sky), VPL_SUCCESS);
    assert_int_equal(methodFor(scene, 320, 0.12, 0), VPL_METHOD_DIRECT);
    assert_int_equal(methodFor(scene, 320, 0.2, 0), VPL_METHOD_KELLER);
    assert_int_equal(methodFor(scene, 96, 0.2, 0), VPL_METHOD_DIRECT);
    vplScene_Destroy(scene);
}
