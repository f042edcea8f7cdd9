// SPDX-License-Identifier: MIT
// Scenes that are changed and rendered again: the bits of a scene that was declared so, and nothing made anew that did
// not change.
#include "failing.h"

#include "geometry/bvh.h"
#include "scene/scene.h"

enum { SIZE = 24 };

static vplRenderOptions optionsOf(vplMethod method, vplHistory* history)
{
    vplRenderOptions options = plainOptions();
    options.method = method;
    options.output.width = options.output.height = SIZE;
    options.particles.count = 60;
    options.path.samples = 2;
    options.radiosity.patches = 150;
    options.sequence.history = history;
    return options;
}

static uint64_t hashOf(const vplScene* scene, vplMethod method, vplHistory* history, vplRenderStats* statsOut)
{
    const vplRenderOptions options = optionsOf(method, history);
    vplImage* image = renderScene(scene, &options, statsOut);
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    return hash;
}

static void edit(vplScene* scene, int step)
{
    vplMaterialDef material = *vplScene_GetMaterial(scene, 0);
    vplCameraDef camera = *vplScene_GetCamera(scene, 0);
    vplEmitterDef light = *vplScene_GetEmitter(scene, 0);
    const int object = vplScene_GetObjectCount(scene) - 1;
    vplMat4 transform = vplScene_GetObject(scene, object)->transform;
    switch (step) {
    case 0:
        transform.m[12] += 0.2f;
        assert_int_equal(vplScene_SetTransform(scene, object, &transform), VPL_SUCCESS);
        break;
    case 1:
        material.diffuse = (vplRgb){0.1f, 0.6f, 0.2f};
        assert_int_equal(vplScene_SetMaterial(scene, 0, &material), VPL_SUCCESS);
        break;
    case 2:
        light.position.y -= 0.3f;
        assert_int_equal(vplScene_SetEmitter(scene, 0, &light), VPL_SUCCESS);
        break;
    case 3:
        camera.fovY *= 0.9;
        assert_int_equal(vplScene_SetCamera(scene, 0, &camera), VPL_SUCCESS);
        break;
    case 4:
        assert_int_equal(vplScene_SetObjectMaterial(scene, object, vplScene_GetMaterialCount(scene) - 1),
                         VPL_SUCCESS);
        break;
    case 5: // a lamp is switched on
        material.emission = (vplRgb){2, 2, 1};
        assert_int_equal(vplScene_SetMaterial(scene, 0, &material), VPL_SUCCESS);
        break;
    default: // and something is added
        assert_int_equal(vplScene_AddObject(scene, vplScene_GetObject(scene, object), NULL), VPL_SUCCESS);
        transform.m[13] += 0.5f;
        assert_int_equal(vplScene_SetTransform(scene, object + 1, &transform), VPL_SUCCESS);
    }
}

enum { STEPS = 7 };

static void assertEditsGiveTheBitsOfADeclaration(vplContext* context, vplMethod method)
{
    vplScene* scene = openScene(context, "tests/data/room-closed.json");
    vplHistory* history;
    assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
    uint64_t before = hashOf(scene, method, history, NULL);
    for (int step = 0; step < STEPS; step++) {
        edit(scene, step);
        const uint64_t edited = hashOf(scene, method, history, NULL),
                       anew = hashOf(scene, method, NULL, NULL);
        vplScene* declared = openScene(context, "tests/data/room-closed.json");
        for (int i = 0; i <= step; i++) {
            edit(declared, i);
        }
        assert_true(edited == anew);
        assert_true(edited == hashOf(declared, method, NULL, NULL));
        assert_true(vplScene_GetHash(scene) == vplScene_GetHash(declared));
        assert_true(edited != before);
        before = edited;
        vplScene_Destroy(declared);
    }
    vplHistory_Destroy(history);
    vplScene_Destroy(scene);
}

TEST(EditedScenesHaveTheBitsOfDeclaredOnes_Keller, 2, SLOW)
{
    assertEditsGiveTheBitsOfADeclaration(context, VPL_METHOD_KELLER);
}

TEST(EditedScenesHaveTheBitsOfDeclaredOnes_InstantRadiosity, 2)
{
    assertEditsGiveTheBitsOfADeclaration(context, VPL_METHOD_INSTANT_RADIOSITY);
}

TEST(EditedScenesHaveTheBitsOfDeclaredOnes_Path, 2)
{
    assertEditsGiveTheBitsOfADeclaration(context, VPL_METHOD_PATH);
}

TEST(EditedScenesHaveTheBitsOfDeclaredOnes_Direct, 2)
{
    assertEditsGiveTheBitsOfADeclaration(context, VPL_METHOD_DIRECT);
}

// ---- textures, cut-outs and environments

// Steps of a scene with a textured floor, two leaves cut out by a texture and a pane; all change surfaces.
static void editPainted(vplScene* scene, int step)
{
    enum { WHITE, TILES, RED, LEAVES, PANE };
    vplMaterialDef pane = *vplScene_GetMaterial(scene, PANE), tiles = *vplScene_GetMaterial(scene, TILES);
    vplEnvironmentDef sky = vplDefaultEnvironmentDef();
    const int last = vplScene_GetObjectCount(scene) - 1; // the pane
    vplMat4 transform = vplScene_GetObject(scene, last)->transform;
    switch (step) {
    case 0:
        transform.m[12] -= 0.4f;
        assert_int_equal(vplScene_SetTransform(scene, last, &transform), VPL_SUCCESS);
        break;
    case 1:
    case 2: // solid
        pane.opacity = step == 1 ? 0.6f : 1;
        assert_int_equal(vplScene_SetMaterial(scene, PANE, &pane), VPL_SUCCESS);
        break;
    case 3:
    case 4: // without its texture
        tiles.textureScale[0] *= 3;
        tiles.textureRotation = 0.5;
        tiles.texture = step == 3 ? tiles.texture : -1;
        assert_int_equal(vplScene_SetMaterial(scene, TILES, &tiles), VPL_SUCCESS);
        break;
    case 5:
    case 6:
        sky.type = VPL_ENVIRONMENT_CONSTANT;
        sky.radiance.r = (float)step;
        assert_int_equal(vplScene_SetEnvironment(scene, &sky), VPL_SUCCESS);
        break;
    case 7: // no texture and no cut-out is left
        for (int i = 0; i <= last; i++) {
            if (vplScene_GetObject(scene, i)->material == LEAVES) {
                assert_int_equal(vplScene_SetObjectMaterial(scene, i, RED), VPL_SUCCESS);
            }
        }
        break;
    default: // a material is added
        tiles.name = NULL;
        tiles.diffuse.b = 0.9f;
        tiles.opacity = 0.7f;
        assert_int_equal(vplScene_AddMaterial(scene, &tiles, NULL), VPL_SUCCESS);
        assert_int_equal(vplScene_SetObjectMaterial(scene, last, PANE + 1), VPL_SUCCESS);
    }
}

TEST(EditedScenesHaveTheBitsOfDeclaredOnes_Painted, 2, SLOW)
{
    static const vplMethod methods[] = {VPL_METHOD_KELLER, VPL_METHOD_INSTANT_RADIOSITY,
                                        VPL_METHOD_PATH,   VPL_METHOD_DIRECT,
                                        VPL_METHOD_SSVP,   VPL_METHOD_RADIOSITY};
    for (int m = 0; m < 6; m++) {
        vplScene* scene = openScene(context, "examples/scenes/cut-outs.json");
        vplHistory* history;
        assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
        uint64_t before = hashOf(scene, methods[m], history, NULL);
        for (int step = 0; step < 9; step++) {
            editPainted(scene, step);
            const uint64_t edited = hashOf(scene, methods[m], history, NULL);
            assert_true(edited == hashOf(scene, methods[m], NULL, NULL) && edited != before);
            before = edited;
        }
        vplHistory_Destroy(history);
        vplScene_Destroy(scene);
    }
}

// ---- what is made anew

// Frames of SSVP and radiosity go on from the last by design; after a change of surfaces they begin anew.
TEST(MethodsThatGoOnBeginAnewWhereSurfacesChange, 2)
{
    static const vplMethod methods[] = {VPL_METHOD_SSVP, VPL_METHOD_RADIOSITY};
    for (int i = 0; i < 2; i++) {
        vplScene* scene = openScene(context, "tests/data/room-closed.json");
        vplHistory* history;
        assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
        hashOf(scene, methods[i], history, NULL);
        for (int step = 0; step < 2; step++) {
            edit(scene, step);
            assert_true(hashOf(scene, methods[i], history, NULL) == hashOf(scene, methods[i], NULL, NULL));
        }
        vplHistory_Destroy(history);
        vplScene_Destroy(scene);
    }
}

static bool ranStage(const vplRenderStats* stats, const char* name)
{
    for (int i = 0; i < stats->stageCount; i++) {
        if (strcmp(stats->stages[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

TEST(OnlyWhatChangedIsMadeAnew, 2)
{
    vplScene* scene = openScene(context, "tests/data/room-closed.json");
    vplHistory* history;
    vplRenderStats stats;
    assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
    hashOf(scene, VPL_METHOD_KELLER, history, &stats);
    assert_true(ranStage(&stats, "geometry"));
    edit(scene, 2);
    hashOf(scene, VPL_METHOD_KELLER, history, &stats);
    assert_false(ranStage(&stats, "geometry"));
    assert_true(ranStage(&stats, "particles"));
    const int lights = stats.virtualLights;
    edit(scene, 3);
    hashOf(scene, VPL_METHOD_KELLER, history, &stats);
    assert_false(ranStage(&stats, "geometry"));
    assert_int_equal(stats.virtualLights, lights);
    vplHistory_Destroy(history);

    vplGeometry *g, *anew;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    const vplBvh* tree = g->rayTree;
    const size_t bytes = vplContext_GetBytes(context);
    edit(scene, 1);
    assert_true(vplGeometry_CanUpdate(g, scene));
    assert_int_equal(vplGeometry_Update(g, scene), VPL_SUCCESS);
    assert_ptr_equal(g->rayTree, tree); // colours do not matter to rays
    edit(scene, 0);
    assert_int_equal(vplGeometry_Update(g, scene), VPL_SUCCESS);
    assert_int_equal(vplContext_GetBytes(context), bytes);
    assert_int_equal(vplGeometry_Create(scene, &anew), VPL_SUCCESS);
    assert_memory_equal(g->positions, anew->positions, (size_t)g->vertexCount * sizeof *g->positions);
    assert_memory_equal(g->normals, anew->normals, (size_t)g->triangleCount * sizeof *g->normals);
    assert_true(g->area == anew->area && g->meanReflectance == anew->meanReflectance &&
                g->emits == anew->emits);
    edit(scene, 6);
    assert_false(vplGeometry_CanUpdate(g, scene));
    vplGeometry_Destroy(anew);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

TEST(WrongChangesAreRefusedAndChangeNothing, 1)
{
    vplScene* scene = openScene(context, "tests/data/room-closed.json");
    const uint64_t hash = vplScene_GetHash(scene);
    vplCameraDef camera = vplDefaultCameraDef();
    vplMaterialDef material = vplDefaultMaterialDef();
    vplEmitterDef light = vplDefaultEmitterDef();
    const vplMat4 singular = {{0}}, identity = vplMat4_Identity();
    assert_int_equal(vplScene_SetCamera(scene, 9, &camera), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), "camera 9 does not exist, the scene has 1");
    camera.nearPlane = 0;
    assert_int_equal(vplScene_SetCamera(scene, 0, &camera), VPL_INVALID_ARGUMENT);
    material.name = vplScene_GetMaterial(scene, 1)->name;
    assert_int_equal(vplScene_SetMaterial(scene, 0, &material), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "is taken"));
    light.intensity.r = -1;
    assert_int_equal(vplScene_SetEmitter(scene, 0, &light), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplScene_SetEmitter(scene, -1, &light), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplScene_SetTransform(scene, 0, &singular), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplScene_SetTransform(scene, 1000, &identity), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplScene_SetObjectMaterial(scene, 0, 77), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplScene_SetObjectMaterial(scene, 0, -1), VPL_INVALID_ARGUMENT);
    assert_true(vplScene_GetHash(scene) == hash);
    vplScene_Destroy(scene);
}

TEST(ARendererEndsWithTheSceneThatItWasCreatedFor, 1)
{
    vplScene* scene = openScene(context, "tests/data/room-closed.json");
    vplRenderOptions options = optionsOf(VPL_METHOD_KELLER, NULL);
    options.stop.passes = 3;
    vplRenderer* renderer;
    bool done;
    assert_int_equal(vplRenderer_Create(scene, &options, &renderer), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Step(renderer, &done), VPL_SUCCESS);
    edit(scene, 0);
    assert_int_equal(vplRenderer_Step(renderer, &done), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "the scene was changed"));
    vplRenderer_Destroy(renderer);
    vplScene_Destroy(scene);
}

// Renders, changes and renders again with the same history.
static vplResult renderEdited(Attempt* a)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_KELLER, NULL);
    TRY(vplScene_Load(a->context, "tests/data/room-closed.json", &a->scene));
    TRY(vplHistory_Create(a->context, &a->history));
    options.sequence.history = a->history;
    TRY(vplRender(a->scene, &options, &a->image, NULL));
    const int object = vplScene_GetObjectCount(a->scene) - 1;
    vplMat4 transform = vplScene_GetObject(a->scene, object)->transform;
    vplMaterialDef material = *vplScene_GetMaterial(a->scene, 0);
    transform.m[12] += 0.2f;
    material.emission = (vplRgb){2, 2, 1};
    TRY(vplScene_SetTransform(a->scene, object, &transform));
    TRY(vplScene_SetMaterial(a->scene, 0, &material));
    TRY(vplScene_SetObjectMaterial(a->scene, object, 0));
    return vplRender(a->scene, &options, &a->other, NULL);
}

TEST_ALONE(EditsSurviveFailedAllocations)
{
    failSomeAllocations("edits", renderEdited, 1);
}

// ---- objects that move

static vplMat4 movedBy(const vplScene* scene, int object, float x, float y)
{
    vplMat4 m = vplScene_GetObject(scene, object)->transform;
    m.m[12] += x;
    m.m[13] += y;
    return m;
}

// Frames of a sequence are the pictures of scenes that were declared at these poses; nothing is made anew in a frame in
// which nothing moves.
static void assertFramesAreDeclaredPoses(vplContext* context, vplMethod method)
{
    vplScene* scene = openScene(context, "tests/data/room-closed.json");
    const int object = vplScene_GetObjectCount(scene) - 1;
    const vplTransformKey keys[3] = {{1, movedBy(scene, object, 0, 0)},
                                     {3, movedBy(scene, object, 0.25f, 0)},
                                     {4, movedBy(scene, object, 0.25f, 0.5f)}};
    vplHistory* history;
    assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
    assert_int_equal(vplScene_SetObjectPath(scene, object, keys, 3), VPL_SUCCESS);
    static const float across[7] = {0, 0, 0.125f, 0.25f, 0.25f, 0.25f, 0.25f},
                       up[7] = {0, 0, 0, 0, 0.5f, 0.5f, 0.5f};
    uint64_t hashes[7];
    for (int frame = 0; frame < 7; frame++) {
        vplScene* declared = openScene(context, "tests/data/room-closed.json");
        const vplMat4 pose = movedBy(declared, object, across[frame], up[frame]);
        assert_int_equal(vplScene_SetTransform(declared, object, &pose), VPL_SUCCESS);
        assert_int_equal(vplScene_SetFrame(scene, frame), VPL_SUCCESS);
        hashes[frame] = hashOf(scene, method, history, NULL);
        assert_true(hashes[frame] == hashOf(declared, method, NULL, NULL));
        assert_true(vplScene_GetHash(scene) == vplScene_GetHash(declared));
        vplScene_Destroy(declared);
    }
    assert_true(hashes[0] == hashes[1] && hashes[1] != hashes[2] && hashes[2] != hashes[3]);
    assert_true(hashes[3] != hashes[4] && hashes[4] == hashes[6]);
    vplHistory_Destroy(history);
    vplScene_Destroy(scene);
}

TEST(FramesOfMovingObjectsAreDeclaredPoses_Keller, 2)
{
    assertFramesAreDeclaredPoses(context, VPL_METHOD_KELLER);
}

TEST(FramesOfMovingObjectsAreDeclaredPoses_Path, 2)
{
    assertFramesAreDeclaredPoses(context, VPL_METHOD_PATH);
}

TEST(FramesOfMovingObjectsAreDeclaredPoses_Direct, 2)
{
    assertFramesAreDeclaredPoses(context, VPL_METHOD_DIRECT);
}

TEST(PathsOfObjectsAreChecked, 1)
{
    vplScene* scene = openScene(context, "tests/data/room-closed.json");
    vplTransformKey keys[2] = {{0, movedBy(scene, 0, 0, 0)}, {2, movedBy(scene, 0, 1, 0)}};
    int count;
    assert_int_equal(vplScene_SetObjectPath(scene, 10000, keys, 2), VPL_INVALID_ARGUMENT);
    keys[1].frame = 0;
    assert_int_equal(vplScene_SetObjectPath(scene, 0, keys, 2), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "vplTransformKey 1: "));
    keys[1].frame = 2;
    for (int i = 0; i < 12; i++) { // turned inside out: flat in the middle
        keys[1].transform.m[i] = -keys[0].transform.m[i];
    }
    assert_int_equal(vplScene_SetObjectPath(scene, 0, keys, 2), VPL_SUCCESS);
    assert_int_equal(vplScene_SetFrame(scene, 1), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "object 0 at frame 1: "));
    assert_int_equal(vplScene_SetFrame(scene, 2), VPL_SUCCESS);
    assert_non_null(vplScene_GetObjectPath(scene, 0, &count));
    assert_int_equal(vplScene_SetTransform(scene, 0, &keys[0].transform), VPL_SUCCESS); // stands still now
    assert_null(vplScene_GetObjectPath(scene, 0, &count));
    assert_int_equal(vplScene_SetObjectPath(scene, 0, keys, 2), VPL_SUCCESS);
    assert_int_equal(vplScene_SetObjectPath(scene, 0, NULL, 0), VPL_SUCCESS);
    assert_int_equal(vplScene_SetFrame(scene, 1), VPL_SUCCESS);
    vplScene_Destroy(scene);
}
