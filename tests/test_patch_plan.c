// SPDX-License-Identifier: MIT
// Tests of --method auto where it chooses radiosity for an error: in which scenes, and how it goes on.
#include "shapes.h"

#include "math/vec.h"
#include "render/planner/patch_plan.h"
#include "render/renderer.h"

static vplRenderOptions optionsFor(double error)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    o.output.width = 120;
    o.output.height = 72;
    o.stop.maxError = error;
    return o;
}

static vplMethod methodFor(const vplScene* scene, const vplRenderOptions* o)
{
    return plannedOptions(scene, o).method;
}

TEST(PatchesAreChosenWhereTheyAreLikelyToBeCheaper, 2)
{
    static const struct {
        const char* scene;
        int width, height;
        double error;
        bool patches;
    } ROWS[] = {
        {"closed-room", 120, 72, 0.05, true},
        {"closed-room", 64, 36, 0.05, false}, // a pass of virtual lights is cheap for so few pixels
        {"closed-room", 96, 54, 0.05, true},
        {"closed-room", 120, 72, 0, false},
        {"loft", 120, 72, 0.05, false}, // 492 triangles
        {"textured-room", 120, 72, 0.05, false},
        {"door-ajar", 120, 72, 0.05, false}, // 84 triangles, and many lights are behind the door
        {"flat", 120, 72, 0.05, true},       // 19 % of the lights reach the picture
        {"flat", 120, 72, 0, false},
        {"flat", 32, 20, 0.3, false}, // 1,000 patches need more rays than virtual lights
    };
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        char path[64];
        snprintf(path, sizeof path, "examples/scenes/%s.json", ROWS[i].scene);
        vplScene* scene = openScene(context, path);
        vplRenderOptions o = optionsFor(ROWS[i].error);
        o.output.width = ROWS[i].width;
        o.output.height = ROWS[i].height;
        if ((methodFor(scene, &o) == VPL_METHOD_RADIOSITY) != ROWS[i].patches) {
            fail_msg("%s at an error of %g", ROWS[i].scene, ROWS[i].error);
        }
        vplScene_Destroy(scene);
    }
}

// The look at the room would choose patches; what the caller says comes first.
TEST(PatchesAreNotChosenAgainstTheOptionsOrTheMemory, 1)
{
    vplScene* scene = openScene(context, "examples/scenes/closed-room.json");
    vplRenderOptions o = optionsFor(0.05);
    assert_int_equal(methodFor(scene, &o), VPL_METHOD_RADIOSITY);
    o.particles.count = 500;
    assert_int_equal(methodFor(scene, &o), VPL_METHOD_KELLER);
    o = optionsFor(0);
    o.stop.budgetMs = 1000;
    assert_int_equal(methodFor(scene, &o), VPL_METHOD_KELLER);
    o = optionsFor(0.01);
    assert_int_equal(methodFor(scene, &o), VPL_METHOD_RADIOSITY);
    vplContext_SetMemoryLimit(context,
                              64 << 20); // form factors of 3,675 patches would be more than a third of it
    assert_int_equal(methodFor(scene, &o), VPL_METHOD_KELLER);
    vplScene_Destroy(scene);
}

// The camera looks at the floor below a plate, and the lamp is above it. If all of a hundred virtual lights miss what the camera sees, a few
// may still find a way in: patches come first, as where one light in a hundred reaches the picture.
TEST(PatchesComeFirstWhereNoLightReachesThePicture, 1)
{
    vplScene* scene = closedCubeScene(context, 0.8f, 0);
    addThing(scene, VPL_OBJECT_BOX, 0, (vplVec3){0, 0, 0}, 0, 0, (vplVec3){2.2f, 0.1f, 2.2f});
    addEmitter(scene, VPL_EMITTER_POINT, (vplVec3){0, 0.5f, 0}, (vplVec3){0, -1, 0}, 1);
    aim(scene, (vplVec3){0, -0.3f, 0}, (vplVec3){0.1f, -1, 0.05f});
    const vplRenderOptions o = optionsFor(0.1);
    vplPlan* plan;
    assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
    assert_true(plan->look.lights >= 100 && plan->look.reaching == 0);
    assert_int_equal(plan->options.method, VPL_METHOD_RADIOSITY);
    assert_true(isfinite(vplForeseenLightRays(plan)));
    vplPlan_Destroy(plan);
    vplScene_Destroy(scene);
}

// A loft with 1,000 point lights, in pictures of 57,600 pixels.
static vplRenderOptions plannedForLamps(vplContext* context, int lamps, double error)
{
    vplScene* scene = openScene(context, "examples/scenes/loft.json");
    vplEmitterDef lamp = *vplScene_GetEmitter(scene, 0);
    lamp.type = VPL_EMITTER_POINT;
    for (int i = vplScene_GetEmitterCount(scene); i < lamps; i++) {
        int added;
        lamp.position = vplVec(0.3f * (float)(i % 10) - 1.5f, 1 + 0.1f * (float)(i / 100),
                               0.3f * (float)(i / 10 % 10) - 1.5f);
        assert_int_equal(vplScene_AddEmitter(scene, &lamp, &added), VPL_SUCCESS);
    }
    vplRenderOptions o = optionsFor(error);
    o.output.width = 320;
    o.output.height = 180;
    o = plannedOptions(scene, &o);
    vplScene_Destroy(scene);
    return o;
}

// Large errors ask some of many lights at each point. Small ones begin with patches, which hardly count beside the shadow rays of so
// many lights, but not with fewer lights: the loft has 492 triangles.
TEST(ManyLightsHaveAPlanForEachError, 1)
{
    static const struct {
        int lamps;
        double error;
        vplMethod method;
        int emitterSamples, antialias;
    } ROWS[] = {{1000, 0.2, VPL_METHOD_KELLER, 32, 4},     {1000, 0.1, VPL_METHOD_KELLER, 0, 2},
                {1000, 0.05, VPL_METHOD_RADIOSITY, 0, 16}, {100, 0.2, VPL_METHOD_KELLER, 0, 4},
                {100, 0.05, VPL_METHOD_KELLER, 0, 16},     {1000, 0, VPL_METHOD_KELLER, 0, 8}};
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        const vplRenderOptions o = plannedForLamps(context, ROWS[i].lamps, ROWS[i].error);
        print_message("%d lights at %g: method %d, %d of them, %d samples\n", ROWS[i].lamps, ROWS[i].error,
                      (int)o.method, o.lights.emitterSamples, o.output.antialias);
        assert_int_equal(o.method, ROWS[i].method);
        assert_int_equal(o.lights.emitterSamples, ROWS[i].emitterSamples);
        assert_int_equal(o.output.antialias, ROWS[i].antialias);
    }
}

// A room whose walls emit has no few points that could stand for them.
TEST(PatchesAreNotChosenWhereMostSurfacesEmit, 1)
{
    vplScene* scene = openScene(context, "examples/scenes/closed-room.json");
    const vplRenderOptions o = optionsFor(0.05);
    for (int i = 0; i < vplScene_GetMaterialCount(scene); i++) {
        vplMaterialDef m = *vplScene_GetMaterial(scene, i);
        m.emission = (vplRgb){0.5f, 0.5f, 0.5f};
        assert_int_equal(vplScene_SetMaterial(scene, i, &m), VPL_SUCCESS);
    }
    assert_true(methodFor(scene, &o) != VPL_METHOD_RADIOSITY);
    vplScene_Destroy(scene);
}

// Renders to the end. *plansOut: how many plans had a picture; *patchesOut: of the last, 0 without any.
static vplRenderStats renderPlans(const vplScene* scene, const vplRenderOptions* o, vplImage** imageOut,
                                  int* plansOut, int* patchesOut)
{
    vplRenderer* r;
    vplRenderStats stats;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    *plansOut = stepToEnd(r);
    assert_int_equal(vplRenderer_GetImage(r, imageOut, &stats), VPL_SUCCESS);
    const vplRenderOptions* last = &vplRenderer_GetPlan(r)->options;
    *patchesOut = last->method == VPL_METHOD_RADIOSITY ? last->radiosity.patches : 0;
    vplRenderer_Destroy(r);
    return stats;
}

// Few patches are enough for 5 %, more for 2 %.
TEST(ThePatchesFollowFromTheError, 2, SLOW)
{
    static const double ERRORS[] = {0.05, 0.02};
    vplScene* scene = openScene(context, "examples/scenes/closed-room.json");
    int before = 0;
    for (int i = 0; i < 2; i++) {
        const vplRenderOptions o = optionsFor(ERRORS[i]);
        vplImage* image;
        int plans, patches;
        const vplRenderStats stats = renderPlans(scene, &o, &image, &plans, &patches);
        assert_true(stats.relativeErrorEstimate > 0 && stats.relativeErrorEstimate <= ERRORS[i]);
        assert_true(patches > before);
        before = patches;
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
}

TEST(PatchesLeaveLessThanTheErrorAskedFor, 2, SLOW)
{
    vplScene* scene = openScene(context, "examples/scenes/closed-room.json");
    vplRenderOptions o = optionsFor(0.02);
    vplImage* image;
    int plans, patches;
    o.output.width = 160;
    o.output.height = 90;
    renderPlans(scene, &o, &image, &plans, &patches);
    assert_true(patches > 0);
    assert_true(errorAgainstPaths(scene, image) <= 0.02);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

static uint64_t hashOf(vplContext* context)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    const vplRenderOptions o = optionsFor(0.05);
    vplRenderStats stats;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    vplScene_Destroy(scene);
    closeTestContext(context);
    return stats.imageHash;
}

TEST_ALONE(PatchesForAnErrorGiveTheSameBitsEverywhere, SLOW)
{
    assertSameEverywhere(hashOf);
}

// A room with a spot, whose rim runs through patches.
static vplScene* openSpotRoom(vplContext* context)
{
    vplScene* scene = openScene(context, "examples/scenes/closed-room.json");
    vplEmitterDef spot = *vplScene_GetEmitter(scene, 0);
    spot.type = VPL_EMITTER_SPOT;
    spot.innerAngle = 0.3;
    spot.outerAngle = 0.31;
    assert_int_equal(vplScene_SetEmitter(scene, 0, &spot), VPL_SUCCESS);
    return scene;
}

// Memory allows no more of them, and layers have no paths at edges: virtual lights follow.
TEST(VirtualLightsFollowWherePatchesEnd, 2, SLOW)
{
    vplScene* scene = openSpotRoom(context);
    vplRenderOptions o = optionsFor(0.1);
    vplImage* image;
    int plans, patches;
    o.output.aovs = VPL_AOV_DEPTH;
    vplContext_SetMemoryLimit(context, 7 << 20);
    assert_int_equal(methodFor(scene, &o), VPL_METHOD_RADIOSITY);
    const vplRenderStats stats = renderPlans(scene, &o, &image, &plans, &patches);
    vplContext_SetMemoryLimit(context, 0);
    assert_true(plans > 1 && patches == 0);
    assert_true(stats.relativeErrorEstimate <= 0.1);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

// A render that goes on from patches to more patches, or to virtual lights, is saved and resumed to the same bits.
TEST(ARenderWithPatchesIsResumedToTheSameBits, 2, SLOW)
{
    vplScene* scene = openSpotRoom(context);
    const char* path = temporaryName(".patches");
    const vplRenderOptions o = optionsFor(0.05);
    vplImage* image;
    int plans, patches;
    const vplRenderStats whole = renderPlans(scene, &o, &image, &plans, &patches);
    vplImage_Destroy(image);
    assert_true(plans > 1);
    for (int steps = 1; steps <= plans; steps++) {
        vplRenderStats stats;
        bool ended;
        saveAfter(scene, &o, steps, path, &ended);
        finishSaved(scene, &o, path, &stats);
        assert_true(stats.imageHash == whole.imageHash);
    }
    remove(path);
    vplScene_Destroy(scene);
}

// Renders `file` until its error is below `error`. The render must begin with method `first` and end with patches, and its picture must
// have the bits of a render of the last plan alone, also if the render was saved after a step and resumed.
static void endWithPatches(vplContext* context, const char* file, int width, double error, uint64_t seed,
                           vplMethod first)
{
    vplScene* scene = openScene(context, file);
    const char* path = temporaryName(".taken");
    vplRenderOptions o = optionsFor(error);
    vplRenderer* r;
    vplRenderStats stats, alone;
    vplImage* image;
    o.output.width = width;
    o.output.height = width * 9 / 16;
    o.seed = seed; // with which no edges are traced in the end
    const vplRenderOptions asked = o;
    assert_int_equal(methodFor(scene, &o), first);
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    assert_true(stepToEnd(r) >= 2);
    assert_int_equal(vplRenderer_GetImage(r, &image, &stats), VPL_SUCCESS);
    o = vplRenderer_GetPlan(r)->options;
    assert_int_equal(o.method, VPL_METHOD_RADIOSITY);
    assert_int_equal(o.radiosity.gather > 0, first == VPL_METHOD_RADIOSITY);
    assert_true(stats.relativeErrorEstimate <= error);
    o.stop.maxError = 0;
    vplImage_Destroy(renderScene(scene, &o, &alone));
    assert_true(alone.imageHash == stats.imageHash);
    bool ended;
    saveAfter(scene, &asked, 1, path, &ended);
    finishSaved(scene, &asked, path, &alone);
    assert_true(alone.imageHash == stats.imageHash);
    remove(path);
    vplImage_Destroy(image);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

// A pass of virtual lights tells that patches are quicker.
TEST(PatchesTakeOverWhereLightsNeedFarMore, 2, SLOW)
{
    endWithPatches(context, "examples/scenes/six-rooms.json", 320, 0.15, 4, VPL_METHOD_KELLER);
}

// A fifth of the virtual lights reaches the picture: patches come first, and more of them follow, not virtual lights.
TEST(PatchesComeFirstWhereDoorsHideLights, 2, SLOW)
{
    endWithPatches(context, "examples/scenes/flat.json", 144, 0.08, 6, VPL_METHOD_RADIOSITY);
}

// A renderer whose picture of hidden light was made by patches at once, with an error below 20 %.
static vplRenderer* rendererOfHiddenLight(const vplScene* scene)
{
    vplRenderOptions o = optionsFor(0.2);
    vplRenderer* r;
    bool done;
    o.output.width = 96;
    o.output.height = 54;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    assert_true(done && r->plan->options.method == VPL_METHOD_RADIOSITY && r->lightRays > 0);
    return r;
}

// A large error that a few paths through each pixel have told may be chance. So they get more before another plan follows.
TEST(PatchesAreNotLeftForAnErrorThatMayBeChance, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    for (int i = 0; i < 2; i++) {
        vplRenderer* r = rendererOfHiddenLight(scene);
        bool more = false, done;
        const double mean = r->judged.mean;
        const int paths = vplTruth_Paths(r->truth);
        r->judged.rays = 1;
        r->spreadBefore = INFINITY;
        r->edgeTries = 100; // none is left: all of the error is that of patches
        r->error.total = sqrt(0.3);
        r->judged.square = 0.3 * mean * mean;
        r->judged.spread = (i == 0 ? 0.2 : 0.1) * mean * mean;
        assert_int_equal(vplReconsider(r, 0.1, &done, &more), VPL_SUCCESS);
        assert_true((vplTruth_Paths(r->truth) == 2 * paths) == (i == 0));
        assert_true((r->done == 0) == (i == 1)); // another plan
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
}

// Where no way reaches the error, more patches come before virtual lights if they cost little beside what these are foreseen to need.
TEST(PatchesAreDividedBeforeTheyAreGivenUp, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    for (int i = 0; i < 2; i++) {
        vplRenderer* r = rendererOfHiddenLight(scene);
        bool more = false, done;
        const int patches = r->plan->options.radiosity.patches;
        const double mean = r->judged.mean;
        r->edgeTries = 100; // none is left: all of the error is that of patches
        r->error.total = 10;
        r->judged.square = 100 * mean * mean;
        r->judged.spread = 0.01 * mean * mean;
        r->lightRays = (i == 0 ? 100 : 2) * VPL_MORE_PATCHES_COST * vplRaysOfPlan(r);
        assert_int_equal(vplReconsider(r, 0.1, &done, &more), VPL_SUCCESS);
        assert_int_equal(r->done, 0); // another plan
        assert_true((r->plan->options.method == VPL_METHOD_RADIOSITY) == (i == 0));
        assert_true(i == 1 || r->plan->options.radiosity.patches == VPL_MORE_PATCHES * patches);
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
}

// Tiny pictures, which have no gather, begin with three times as many patches where these are cheap beside what virtual lights need.
TEST(TinyPicturesBeginWithMorePatches, 2)
{
    static const struct {
        int width;
        double error;
        int patches;
    } ROWS[] = {{96, 0.05, 3000}, {96, 0.2, 1000}, {320, 0.05, 1000}};
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        vplRenderOptions o = optionsFor(ROWS[i].error);
        o.output.width = ROWS[i].width;
        o.output.height = ROWS[i].width * 9 / 16;
        o = plannedOptions(scene, &o);
        assert_int_equal(o.method, VPL_METHOD_RADIOSITY);
        assert_int_equal(o.radiosity.patches, ROWS[i].patches);
    }
    vplScene_Destroy(scene);
}

// A truth gets a share of as many paths as it has, at least two through each pixel.
TEST(ATruthIsRefinedInPart, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    vplRenderer* r = rendererOfHiddenLight(scene);
    assert_true(r->truth != NULL);
    const int paths = vplTruth_Paths(r->truth);
    assert_int_equal(vplRefineTruth(r, 0.5), VPL_SUCCESS);
    assert_int_equal(vplTruth_Paths(r->truth), paths + paths / 2);
    assert_int_equal(vplRefineTruth(r, 0), VPL_SUCCESS);
    assert_int_equal(vplTruth_Paths(r->truth), paths + paths / 2 + 2);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

// The side of the squares of pixels that share lights, or the rays of the gather if patches come first, for a picture of 16:9.
static int sharedBy(const vplScene* scene, int width, double error, double ms)
{
    vplRenderOptions o = optionsFor(error);
    o.stop.budgetMs = ms;
    o.output.width = width;
    o.output.height = width * 9 / 16;
    o = plannedOptions(scene, &o);
    return o.method == VPL_METHOD_RADIOSITY ? o.radiosity.gather : o.pipeline.interleave;
}

// Where 8 pixels are a large part of a surface, fewer pixels share lights, and none share the rays of a gather.
TEST(TinyPicturesShareLittle, 1)
{
    vplScene* flat = openScene(context, "examples/scenes/flat.json");
    vplScene* loft = openScene(context, "examples/scenes/loft.json");
    assert_int_equal(sharedBy(flat, 128, 0.1, 0), 0);
    assert_int_equal(sharedBy(flat, 144, 0.1, 0), 16);
    assert_int_equal(sharedBy(loft, 128, 0.2, 0), 4);
    assert_int_equal(sharedBy(loft, 144, 0.2, 0), 8);
    assert_int_equal(sharedBy(loft, 128, 0, 1000), 4);
    assert_int_equal(sharedBy(loft, 144, 0, 1000), 8);
    vplScene_Destroy(flat);
    vplScene_Destroy(loft);
}

static int patchesFor(const vplScene* scene, double error)
{
    vplRenderOptions o = optionsFor(error);
    o.output.width = 320;
    o.output.height = 180;
    o = plannedOptions(scene, &o);
    assert_int_equal(o.method, VPL_METHOD_RADIOSITY);
    return o.radiosity.patches;
}

// A scene of many small triangles begins with 2,000 patches, unless the error is so small that a second plan follows anyway.
TEST(ManyTrianglesBeginWithMorePatches, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    assert_int_equal(patchesFor(scene, 0.1), 1000);
    Shape shape = icosphere(3); // 1,280 triangles
    const vplMat4 place =
        vplMat4_FromParts((vplVec3){1.5f, 0.5f, 2}, (double[3]){0, 0, 0}, (vplVec3){0.1f, 0.1f, 0.1f});
    addShape(scene, &shape, false, &place);
    freeShape(&shape);
    assert_int_equal(patchesFor(scene, 0.2), 2000);
    assert_int_equal(patchesFor(scene, 0.08), 2000);
    assert_int_equal(patchesFor(scene, 0.07), 1000);
    vplScene_Destroy(scene);
}

// Takes `steps` steps, and counts those that ended with a plan of patches, of which there was none before.
static int countPatchSteps(vplRenderer* r, int steps)
{
    int count = 0;
    bool done = false;
    for (int i = 0; i < steps && !done; i++) {
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
        count += r->plan->options.method == VPL_METHOD_RADIOSITY;
    }
    return count;
}

// Two renders have done the same number of passes, to the same bits.
static void assertSamePictures(vplRenderer* a, vplRenderer* b)
{
    vplImage* images[2];
    assert_int_equal(vplRenderer_Resolve(a, &images[0]), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Resolve(b, &images[1]), VPL_SUCCESS);
    assert_int_equal(a->done, b->done);
    assert_true(vplImage_Hash(images[0]) == vplImage_Hash(images[1]));
    vplImage_Destroy(images[0]);
    vplImage_Destroy(images[1]);
}

// Where a door stands ajar patches err by the light that comes through it: a few are tried once, and virtual lights go on, also
// where the render was saved in between.
TEST(PatchesInVainAreTriedOnce, 2, SLOW)
{
    enum { STEPS = 16 };
    vplScene* scene = openScene(context, "examples/scenes/door-ajar.json");
    const char* path = temporaryName(".tried");
    vplRenderOptions o = optionsFor(0.1);
    vplRenderer *r, *loaded;
    int steps = 0;
    bool done;
    o.output.width = 64;
    o.output.height = 36;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    while (countPatchSteps(r, 1) == 0 && steps < STEPS) {
        steps++;
    }
    assert_int_equal(countPatchSteps(r, 1), 0); // the step draws the patches, and its end leaves them
    assert_int_equal(vplRenderer_Save(r, path), VPL_SUCCESS);
    assert_int_equal(countPatchSteps(r, STEPS), 0);
    assert_int_equal(vplRenderer_Create(scene, &o, &loaded), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Load(loaded, path, &done), VPL_SUCCESS); // takes the first step of a plan
    assert_int_equal(countPatchSteps(loaded, STEPS - 1), 0);
    assertSamePictures(r, loaded);
    vplRenderer_Destroy(r);
    vplRenderer_Destroy(loaded);
    remove(path);
    vplScene_Destroy(scene);
}

// A truth with more pixels replaces the one before; a render that was saved with it goes on to the same bits.
TEST(ATruthWithMorePixelsIsSaved, 2, SLOW)
{
    enum { PASSES = 2, MORE = 3 };
    vplScene* scene = openScene(context, "examples/scenes/loft.json");
    const char* path = temporaryName(".wider");
    vplRenderOptions o = optionsFor(0.02);
    vplRenderer *r, *loaded;
    bool done = false;
    o.output.width = 112;
    o.output.height = 64;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    // A plan that begins has no picture yet.
    for (int i = 0; i < PASSES || r->truth == NULL || r->done == 0; i++) {
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
        assert_false(done);
    }
    for (int i = 0; i < 2; i++) { // a few of the first paths through more pixels would tell less
        assert_int_equal(vplRefineTruth(r, 1), VPL_SUCCESS);
    }
    const int pixels = vplTruth_CountPixels(r->truth), paths = vplTruth_Paths(r->truth);
    assert_int_equal(vplWidenTruth(r), VPL_SUCCESS);
    assert_in_range(vplTruth_CountPixels(r->truth), 2 * pixels, VPL_WIDER_TRUTH * pixels);
    // At least 0.8 of the paths before, as their number through each pixel doubles.
    assert_in_range(vplTruth_Paths(r->truth) * vplTruth_CountPixels(r->truth), 4 * pixels * paths / 5,
                    8 * pixels * paths / 5);
    assert_int_equal(vplRenderer_Save(r, path), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Create(scene, &o, &loaded), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Load(loaded, path, &done), VPL_SUCCESS);
    assert_int_equal(vplTruth_CountPixels(r->truth), vplTruth_CountPixels(loaded->truth));
    for (int i = 0; i < MORE || r->done == 0; i++) { // a plan that begins has no picture yet
        bool ends[2];
        assert_int_equal(vplRenderer_Step(r, &ends[0]), VPL_SUCCESS);
        assert_int_equal(vplRenderer_Step(loaded, &ends[1]), VPL_SUCCESS);
        assert_int_equal(r->truth != NULL, loaded->truth != NULL); // another plan has none yet
        assert_true(r->error.bound == loaded->error.bound && ends[0] == ends[1]);
    }
    assertSamePictures(r, loaded);
    vplRenderer_Destroy(r);
    vplRenderer_Destroy(loaded);
    remove(path);
    vplScene_Destroy(scene);
}

// Sides of an empty hall around the lit room that the camera is in. A caller's own camera may move there, and the documents have no cuts.
TEST(FaintSidesAreKeptForOtherCameras, 2)
{
    vplScene* scene = openScene(context, "tests/data/hall.json");
    for (int i = 0; i < 4; i++) {
        vplRenderOptions o = vplDefaultRenderOptions();
        const vplCameraDef view = *vplScene_GetCamera(scene, 0);
        vplPlan* plan;
        o.method = VPL_METHOD_RADIOSITY;
        o.radiosity.faintSides = i == 3 ? VPL_FAINT_SIDES_KEEP : VPL_FAINT_SIDES_AUTO;
        o.radiosity.patchSize = i == 2 ? 0.4f : 0;
        o.view = i == 1 ? &view : NULL;
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assert_int_equal(plan->options.radiosity.faintSides,
                         i == 0 ? VPL_FAINT_SIDES_LEAVE : VPL_FAINT_SIDES_KEEP);
        assert_int_equal(plan->faintSides > 1000, i == 0);
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}
