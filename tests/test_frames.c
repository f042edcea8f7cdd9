// SPDX-License-Identifier: MIT
// Tests of paths of cameras and emitters, and of histories: data kept between frames never changes a picture.
#include "scenes.h"

#include "base/context.h"

#include <stdlib.h>

// ---- poses

static vplCameraKey cameraKey(const vplScene* scene, double frame, float x, double fovY)
{
    vplCameraKey key = vplMakeCameraKey(vplScene_GetCamera(scene, 0), frame);
    key.eye.x = x;
    key.fovY = fovY;
    return key;
}

static vplCameraDef poseCamera(const vplScene* scene, double frame)
{
    vplCameraDef def = vplDefaultCameraDef();
    if (vplScene_PoseCamera(scene, 0, frame, &def) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return def;
}

static vplEmitterDef poseEmitter(const vplScene* scene, double frame)
{
    vplEmitterDef def = vplDefaultEmitterDef();
    if (vplScene_PoseEmitter(scene, 0, frame, &def) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return def;
}

TEST(PosesAreLinearBetweenKeysAndHeldBeyondThem, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    const vplCameraDef declared = *vplScene_GetCamera(scene, 0);
    const vplCameraKey keys[] = {cameraKey(scene, -4, -1, 0.5), cameraKey(scene, 0, 0.1f, 0.7),
                                 cameraKey(scene, 10, 2, 0.9)};
    assert_int_equal(vplScene_SetCameraPath(scene, 0, keys, 3), VPL_SUCCESS);
    const struct {
        double frame, x, fovY;
    } cases[] = {{-1e300, -1, 0.5}, {-5, -1, 0.5},        {-4, -1, 0.5}, {-3, -0.725, 0.55}, {0, 0.1, 0.7},
                 {5, 1.05, 0.8},    {9.999, 2, 0.899999}, {10, 2, 0.9},  {11, 2, 0.9},       {1e300, 2, 0.9}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const vplCameraDef pose = poseCamera(scene, cases[i].frame);
        assertNear((double)pose.eye.x, cases[i].x, 2e-4, "eye.x", (int)i);
        assertNear(pose.fovY, cases[i].fovY, 2e-5, "fovY", (int)i);
        assert_memory_equal(&pose.target, &declared.target, sizeof pose.target);
        assert_memory_equal(&pose.up, &declared.up, sizeof pose.up);
        assert_true(pose.eye.y == declared.eye.y && pose.nearPlane == declared.nearPlane &&
                    pose.farPlane == declared.farPlane);
    }
    assert_true(poseCamera(scene, 0).eye.x == 0.1f); // poses at keys are exact
    assert_true(poseCamera(scene, 10).eye.x == 2 && poseCamera(scene, -4).fovY == 0.5);
    vplScene_Destroy(scene);
}

TEST(EmittersMoveTurnAndFade, 1)
{
    vplScene* scene = sceneOf(context, 0.5f);
    vplEmitterDef spot = vplDefaultEmitterDef();
    spot.type = VPL_EMITTER_SPOT;
    assert_int_equal(vplScene_AddEmitter(scene, &spot, NULL), VPL_SUCCESS);
    vplEmitterKey keys[] = {vplMakeEmitterKey(&spot, 2), vplMakeEmitterKey(&spot, 4)};
    keys[1].position = (vplVec3){4, 0, -8};
    keys[1].direction = (vplVec3){1, 0, 0};
    keys[1].intensity = (vplRgb){0, 1, 3};
    assert_int_equal(vplScene_SetEmitterPath(scene, 0, keys, 2), VPL_SUCCESS);
    const vplEmitterDef pose = poseEmitter(scene, 2.5);
    const vplVec3 position = {1, 0, -2}, direction = {0.25f, -0.75f, 0};
    assert_memory_equal(&pose.position, &position, sizeof position);
    assert_memory_equal(&pose.direction, &direction, sizeof direction);
    assert_true(pose.intensity.r == 0.75f && pose.intensity.g == 1 && pose.intensity.b == 1.5f);
    assert_true(pose.type == VPL_EMITTER_SPOT && pose.outerAngle == spot.outerAngle);
    vplScene_Destroy(scene);
}

TEST(OneKeyIsAConstantAndNoKeyTheDeclaration, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    vplEmitterKey key = vplMakeEmitterKey(vplScene_GetEmitter(scene, 0), 7);
    key.position.y = 1.25f;
    int count = -1;
    assert_null(vplScene_GetEmitterPath(scene, 0, &count));
    assert_int_equal(count, 0);
    for (int again = 0; again < 3; again++) { // a new path replaces the old one
        assert_int_equal(vplScene_SetEmitterPath(scene, 0, &key, 1), VPL_SUCCESS);
        assert_non_null(vplScene_GetEmitterPath(scene, 0, &count));
        assert_int_equal(count, 1);
    }
    for (int frame = 0; frame < 20; frame += 7) {
        assert_true(poseEmitter(scene, frame).position.y == 1.25f);
    }
    assert_int_equal(vplScene_SetEmitterPath(scene, 0, NULL, 0), VPL_SUCCESS);
    assert_null(vplScene_GetEmitterPath(scene, 0, &count));
    assert_true(poseEmitter(scene, 0).position.y == vplScene_GetEmitter(scene, 0)->position.y);
    vplScene_Destroy(scene);
}

static void refusePath(vplScene* scene, int index, const vplCameraKey* keys, int count, const char* sentence)
{
    assert_int_equal(vplScene_SetCameraPath(scene, index, keys, count), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), sentence);
}

TEST(BadPathsAreRefusedAndChangeNothing, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    const vplCameraKey good = cameraKey(scene, 0, 3, 0.5);
    vplCameraKey keys[3] = {good, cameraKey(scene, 1, 0, 0.5), cameraKey(scene, 1, 1, 0.5)};
    assert_int_equal(vplScene_SetCameraPath(scene, 0, &good, 1), VPL_SUCCESS);
    refusePath(scene, 0, keys, 3,
               "vplCameraKey 2: frame is 1, must be greater than that of the key before (1)");
    keys[2].frame = (double)NAN;
    refusePath(scene, 0, keys, 3, "vplCameraKey 2: frame is nan, must be in [-1000000000, 1000000000]");
    keys[2].frame = 2;
    keys[2].eye = keys[2].target;
    refusePath(scene, 0, keys + 2, 1,
               "vplCameraKey 0: target equals the eye (0, 2.5, 0), must differ from it");
    keys[2].eye.z = (float)INFINITY;
    refusePath(scene, 0, keys, 3, "vplCameraKey 2: eye[2] is inf, must be in [-1e+15, 1e+15]");
    refusePath(scene, 1, keys, 1, "vplCameraKey: index is 1, must be one of the scene's 1");
    refusePath(scene, 0, keys, -1, "vplCameraKey: count is -1, must be in [0, 1048576]");
    vplEmitterKey dark = vplMakeEmitterKey(vplScene_GetEmitter(scene, 0), 0);
    dark.intensity.g = -1;
    assert_int_equal(vplScene_SetEmitterPath(scene, 0, &dark, 1), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), "vplEmitterKey 0: intensity[1] is -1, must be in [0, 1e+15]");
    assert_true(poseCamera(scene, 5).eye.x == 3);
    vplScene_Destroy(scene);
}

// Each key is valid, but the interpolated pose is not: the renderer logs a message and returns no picture.
TEST(PosesThatDegenerateAreRefused, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    vplCameraKey keys[] = {cameraKey(scene, 0, 0, 0.5), cameraKey(scene, 2, 0, 0.5)};
    keys[1].eye.z = -keys[0].eye.z; // the camera passes through the target
    assert_int_equal(vplScene_SetCameraPath(scene, 0, keys, 2), VPL_SUCCESS);
    vplRenderOptions options = plainOptions();
    options.output.width = options.output.height = 8;
    options.shadow.mapSize = 8;
    options.sequence.frame = 1;
    vplImage* image = NULL;
    assert_int_equal(vplRender(scene, &options, &image, NULL), VPL_INVALID_ARGUMENT);
    assert_null(image);
    assert_string_equal(takeMessage(),
                        "camera 0 at frame 1: target equals the eye (0, 2.5, 0), must differ from it");
    options.sequence.frame = 0.5;
    vplImage_Destroy(renderScene(scene, &options, NULL));
    vplScene_Destroy(scene);

    scene = sceneOf(context, 0.5f);
    vplEmitterDef sun = vplDefaultEmitterDef();
    sun.type = VPL_EMITTER_DIRECTIONAL;
    assert_int_equal(vplScene_AddEmitter(scene, &sun, NULL), VPL_SUCCESS);
    vplEmitterKey around[] = {vplMakeEmitterKey(&sun, 0), vplMakeEmitterKey(&sun, 4)};
    around[1].direction = (vplVec3){0, 1, 0};
    assert_int_equal(vplScene_SetEmitterPath(scene, 0, around, 2), VPL_SUCCESS);
    assert_int_equal(vplScene_PoseEmitter(scene, 0, 2, &sun), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(),
                        "light 0 at frame 2: direction is the zero vector, must have a direction");
    assert_int_equal(vplScene_PoseEmitter(scene, 0, 3, &sun), VPL_SUCCESS);
    vplScene_Destroy(scene);
}

TEST(FilesSayWhatChangesAndTheRestIsAsDeclared, 1)
{
    vplScene* scene = NULL;
    assert_int_equal(vplScene_Load(context, "examples/scenes/room-path.json", &scene), VPL_SUCCESS);
    int count;
    const vplCameraKey* keys = vplScene_GetCameraPath(scene, 0, &count);
    assert_int_equal(count, 3);
    const vplCameraDef* camera = vplScene_GetCamera(scene, 0);
    assert_true(keys[0].eye.x == -1.2f && keys[0].target.y == camera->target.y &&
                keys[0].fovY == camera->fovY);
    assert_true(keys[1].frame == 30 && keys[1].target.y == 2 && keys[1].up.y == 1);
    assertNear(keys[2].fovY, 36 * VPL_PI / 180, 1e-15, "fov_y", 2);
    assert_true(keys[2].target.y == camera->target.y); // not the value of the key before
    const vplEmitterKey* lights = vplScene_GetEmitterPath(scene, 0, &count);
    assert_int_equal(count, 2);
    assert_true(lights[0].position.x == -1 && lights[1].position.x == 1 && lights[1].direction.x == 0.5f);
    assert_memory_equal(&lights[1].intensity, &vplScene_GetEmitter(scene, 0)->intensity, sizeof(vplRgb));
    vplScene_Destroy(scene);
}

// ---- frames

typedef struct Kind {
    vplMethod method;
    vplAccumulation accumulation;
    vplLightShadows shadows;
    vplLightPlacement placement;
} Kind;

static const Kind kinds[] = {
    {VPL_METHOD_DIRECT, VPL_ACCUMULATE_DEFERRED, VPL_LIGHT_SHADOWS_USUAL, VPL_PLACEMENT_PARTICLES},
    {VPL_METHOD_INSTANT_RADIOSITY, VPL_ACCUMULATE_MULTIPASS, VPL_LIGHT_SHADOWS_NONE, VPL_PLACEMENT_VIEW},
    {VPL_METHOD_INSTANT_RADIOSITY, VPL_ACCUMULATE_DEFERRED, VPL_LIGHT_SHADOWS_MAP, VPL_PLACEMENT_RSM},
    {VPL_METHOD_INSTANT_RADIOSITY, VPL_ACCUMULATE_INTERLEAVED, VPL_LIGHT_SHADOWS_RAY,
     VPL_PLACEMENT_PARTICLES},
    {VPL_METHOD_INSTANT_RADIOSITY, VPL_ACCUMULATE_LIGHTCUTS, VPL_LIGHT_SHADOWS_RAY, VPL_PLACEMENT_PARTICLES},
    {VPL_METHOD_KELLER, VPL_ACCUMULATE_DEFERRED, VPL_LIGHT_SHADOWS_USUAL, VPL_PLACEMENT_PARTICLES},
    {VPL_METHOD_PATH, VPL_ACCUMULATE_DEFERRED, VPL_LIGHT_SHADOWS_USUAL, VPL_PLACEMENT_PARTICLES}};
enum { KINDS = sizeof kinds / sizeof *kinds };

static vplRenderOptions optionsOf(const Kind* kind)
{
    vplRenderOptions o = plainOptions();
    o.method = kind->method;
    o.pipeline.kind = kind->accumulation;
    o.lights.shadows = kind->shadows;
    o.particles.placement = kind->placement;
    o.output.width = 40;
    o.output.height = 30;
    o.particles.count = 12;
    o.path.samples = 2;
    o.shadow.mapSize = 32;
    o.shadow.rsmSize = 32;
    o.lights.mapSize = 16;
    return o;
}

static vplScene* movingRoom(vplContext* context)
{
    vplScene* scene = NULL;
    assert_int_equal(vplScene_Load(context, "examples/scenes/room-path.json", &scene), VPL_SUCCESS);
    return scene;
}

static uint64_t hashOf(const vplScene* scene, const vplRenderOptions* options)
{
    vplRenderStats stats;
    vplImage_Destroy(renderScene(scene, options, &stats));
    return stats.imageHash;
}

// Makes a scene without paths whose camera and light are set to their poses at a frame.
static vplScene* standingRoom(vplContext* context, double frame)
{
    vplScene* moving = movingRoom(context);
    const vplCameraDef camera = poseCamera(moving, frame);
    const vplEmitterDef emitter = poseEmitter(moving, frame);
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    for (int i = 0; i < vplScene_GetMaterialCount(moving); i++) {
        vplScene_AddMaterial(scene, vplScene_GetMaterial(moving, i), NULL);
    }
    for (int i = 0; i < vplScene_GetObjectCount(moving); i++) {
        vplScene_AddObject(scene, vplScene_GetObject(moving, i), NULL);
    }
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
    assert_int_equal(vplScene_AddEmitter(scene, &emitter, NULL), VPL_SUCCESS);
    vplScene_Destroy(moving);
    return scene;
}

TEST(AFrameIsThePictureOfItsPose, 2)
{
    vplScene* moving = movingRoom(context);
    const double frames[] = {0, 17.5, 60};
    for (int f = 0; f < 3; f++) {
        vplScene* standing = standingRoom(context, frames[f]);
        for (int k = 0; k < KINDS; k++) {
            vplRenderOptions options = optionsOf(&kinds[k]);
            const uint64_t wanted = hashOf(standing, &options), still = hashOf(moving, &options);
            options.sequence.frame = frames[f];
            assert_true(hashOf(moving, &options) == wanted);
            assert_true((still == wanted) == (frames[f] == 0));
        }
        vplScene_Destroy(standing);
    }
    vplScene_Destroy(moving);
}

TEST_ALONE(AHistoryChangesNoPicture, SLOW)
{
    const int workers[] = {1, 2, 3, 7};
    const double frames[] = {0, 1, 2, 40, 1, 1};
    uint64_t first[KINDS][6];
    for (int w = 0; w < 4; w++) {
        vplContext* context = openTestContext(workers[w]);
        vplScene* scene = movingRoom(context);
        vplHistory* history = NULL;
        assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
        for (int k = 0; k < KINDS; k++) { // all methods use one history
            for (int f = 0; f < 6; f++) {
                vplRenderOptions options = optionsOf(&kinds[k]);
                options.sequence.frame = frames[f];
                if (w == 0) {
                    first[k][f] = hashOf(scene, &options);
                }
                options.sequence.history = history;
                assert_true(hashOf(scene, &options) == first[k][f]);
            }
        }
        vplHistory_Destroy(history);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

TEST(AHistoryBuildsTheGeometryOnce, 1)
{
    vplScene* scene = movingRoom(context);
    vplHistory* history = NULL;
    assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
    vplRenderOptions options = optionsOf(&kinds[0]);
    options.sequence.history = history;
    hashOf(scene, &options);
    const size_t held = vplContext_GetBytes(context);
    for (int f = 1; f < 4; f++) {
        options.sequence.frame = f;
        hashOf(scene, &options);
        assert_true(vplContext_GetBytes(context) == held);
    }
    vplLightSet* set = NULL; // vplMakeLights uses the history, too
    assert_int_equal(vplMakeLights(scene, &options, &set), VPL_SUCCESS);
    vplLightSet_Destroy(set);
    vplHistory_Destroy(history);
    assert_true(vplContext_GetBytes(context) < held);
    vplScene_Destroy(scene);
}

static void refuseHistory(const vplScene* scene, const vplRenderOptions* options, const char* sentence)
{
    vplImage* image = NULL;
    assert_int_equal(vplRender(scene, options, &image, NULL), VPL_INVALID_ARGUMENT);
    assert_null(image);
    assert_string_equal(takeMessage(), sentence);
}

TEST_ALONE(AHistoryOfAnotherSceneIsRefused)
{
    vplContext *context = openTestContext(1), *foreign = openTestContext(1);
    vplScene *scene = movingRoom(context), *other = movingRoom(context), *abroad = movingRoom(foreign);
    vplHistory* history = NULL;
    assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
    vplRenderOptions options = optionsOf(&kinds[0]);
    options.sequence.history = history;
    hashOf(scene, &options);
    refuseHistory(other, &options, "vplRenderOptions.sequence.history is of another scene");
    refuseHistory(abroad, &options,
                  "vplRenderOptions.sequence.history was made with another context than the scene's");
    hashOf(scene, &options); // the history is still usable
    vplScene_SetCameraPath(scene, 0, NULL, 0);
    hashOf(scene, &options); // paths may change between frames
    vplObjectDef object = vplDefaultObjectDef();
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    const uint64_t added = hashOf(scene, &options);
    options.sequence.history = NULL;
    assert_true(added == hashOf(scene, &options));
    vplHistory_Destroy(history);
    vplHistory_Destroy(NULL);
    vplScene_Destroy(scene);
    vplScene_Destroy(other);
    vplScene_Destroy(abroad);
    closeTestContext(foreign);
    closeTestContext(context);
}
