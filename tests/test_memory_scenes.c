// SPDX-License-Identifier: MIT
// Tests of scenes whose files are in memory: the same pictures as from disk, and the same sentences about mistakes.
#include "base/file.h"
#include "failing.h"

#include <stdlib.h>
#include <string.h>

// The scene's hash at a small size, by direct light; destroys the scene.
static uint64_t hashOf(vplScene* scene)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    assert_int_equal(vplRenderOptions_SetAll(&o, "--method direct --size 32x32"), VPL_SUCCESS);
    vplImage* image = renderScene(scene, &o, NULL);
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    return hash;
}

enum { MOST_FILES = 3 };

// Reads files of a folder into memory, under the paths of another folder.
static void readFiles(vplContext* context, const char* from, const char* to, const char* const* names,
                      vplMemoryFile* files, int count)
{
    static char paths[MOST_FILES][256];
    for (int i = 0; i < count; i++) {
        char path[256], *bytes;
        snprintf(path, sizeof path, "%s/%s", from, names[i]);
        snprintf(paths[i], sizeof paths[i], "%s%s", to, names[i]);
        files[i].path = paths[i];
        assert_int_equal(vplReadFile(context, path, &bytes, &files[i].size), VPL_SUCCESS);
        files[i].bytes = bytes;
    }
}

static void freeFiles(vplContext* context, vplMemoryFile* files, int count)
{
    for (int i = 0; i < count; i++) {
        vplFree(context, (void*)files[i].bytes);
    }
}

static vplScene* loadMemory(vplContext* context, const vplMemoryFile* files, int count)
{
    const vplModelSceneDef def = vplDefaultModelSceneDef();
    vplScene* scene = NULL;
    if (vplScene_LoadMemory(context, files, count, &def, &scene) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return scene;
}

TEST(ScenesInMemoryAreThoseOnDisk, 1)
{
    static const struct {
        const char* folder;
        const char* names[MOST_FILES];
        int count;
    } cases[] = {
        {"examples/scenes", {"textured-room.json", "textures/tiles.png", "textures/bricks.png"}, 3},
        {"examples/scenes", {"testmodel.json", "testmodel.obj", "testmodel.mtl"}, 3},
        {"examples/scenes", {"testmodel.obj", "testmodel.mtl"}, 2},
        {"tests/data/gltf", {"everything.gltf"}, 1},
        {"tests/data/gltf", {"everything.glb"}, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char path[256];
        snprintf(path, sizeof path, "%s/%s", cases[i].folder, cases[i].names[0]);
        const uint64_t wanted = hashOf(openScene(context, path));
        const char* const folders[] = {"", "no/such/folder/"};
        for (int k = 0; k < 2; k++) {
            vplMemoryFile files[MOST_FILES];
            readFiles(context, cases[i].folder, folders[k], cases[i].names, files, cases[i].count);
            vplScene* scene = loadMemory(context, files, cases[i].count);
            freeFiles(context, files, cases[i].count); // the scene has copies
            assert_true(hashOf(scene) == wanted);
        }
    }
}

TEST(WhatIsNotInMemoryIsReadFromDisk, 1)
{
    vplMemoryFile file;
    readFiles(context, "examples/scenes", "examples/scenes/", (const char* const[]){"testmodel.json"}, &file,
              1);
    vplScene* scene = loadMemory(context, &file, 1);
    freeFiles(context, &file, 1);
    assert_true(hashOf(scene) == hashOf(openScene(context, "examples/scenes/testmodel.json")));
}

TEST(MistakesInMemoryAreFoundLikeThoseOnDisk, 1)
{
    static const char text[] =
        "{ \"camera\": { \"eye\": [0, 0, 1], \"target\": [0, 0, 0] },\n  \"objects\": 3 }";
    const vplModelSceneDef def = vplDefaultModelSceneDef();
    const vplMemoryFile file = {"sent.json", text, sizeof text - 1}, unnamed = {"", text, 1};
    const vplMemoryFile unknown = {"sent.fbx", text, 4}, absent = {"absent.json", NULL, 1};
    vplScene* scene = NULL;
    assert_int_equal(vplScene_LoadMemory(context, &file, 1, &def, &scene), VPL_PARSE_ERROR);
    assert_non_null(strstr(takeMessage(), "sent.json:2:14: "));
    assert_int_equal(vplScene_LoadMemory(context, &unknown, 1, &def, &scene), VPL_PARSE_ERROR);
    assert_int_equal(vplScene_LoadMemory(context, &unnamed, 1, &def, &scene), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), "files[0].path is empty, must be a name");
    assert_int_equal(vplScene_LoadMemory(context, &absent, 1, &def, &scene), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), "files[0].bytes is NULL, must be 1 bytes");
    assert_int_equal(vplScene_LoadMemory(context, NULL, 1, &def, &scene), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplScene_LoadMemory(context, &file, 0, &def, &scene), VPL_INVALID_ARGUMENT);
    assert_null(scene);
    // Files in memory are forgotten after the call.
    assert_int_equal(vplScene_Load(context, "sent.json", &scene), VPL_FILE_ERROR);
}

static vplResult loadMesh(Attempt* a)
{
    static const char text[] = "{ \"camera\": { \"eye\": [0, 0, 1], \"target\": [0, 0, 0] },"
                               " \"objects\": [{ \"type\": \"mesh\", \"file\": \"a.obj\" }] }";
    static const char mesh[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const vplMemoryFile files[] = {{"a.json", text, sizeof text - 1}, {"a.obj", mesh, sizeof mesh - 1}};
    const vplModelSceneDef def = vplDefaultModelSceneDef();
    return vplScene_LoadMemory(a->context, files, 2, &def, &a->scene);
}

TEST_ALONE(ScenesInMemorySurviveEveryFailedAllocation)
{
    failSomeAllocations("scene in memory", loadMesh, 1);
}

// ---- files that are noted at one context and given to another

enum { MOST_NOTED = 16 };

typedef struct Noted {
    vplMemoryFile files[MOST_NOTED];
    int count;
} Noted;

static void note(void* user, const vplMemoryFile* file)
{
    Noted* n = user;
    void* bytes = malloc(file->size + 1);
    assert_true(n->count < MOST_NOTED && bytes != NULL);
    memcpy(bytes, file->bytes, file->size);
    n->files[n->count++] = (vplMemoryFile){strdup(file->path), bytes, file->size};
}

TEST(NotedFilesMakeTheSceneWithoutTheDisk, 1)
{
    Noted noted = {.count = 0}, none = {.count = 0};
    vplScene *scene, *again;
    vplContext_SetFileObserver(context, note, &noted);
    assert_int_equal(vplScene_Load(context, "examples/scenes/textured-room.json", &scene), VPL_SUCCESS);
    assert_true(noted.count >= 2); // the scene and at least one texture
    vplContext_SetFileObserver(context, note, &none);
    vplContext_SetFiles(context, noted.files, noted.count);
    assert_int_equal(vplScene_Load(context, "examples/scenes/textured-room.json", &again), VPL_SUCCESS);
    vplContext_SetFiles(context, NULL, 0);
    vplContext_SetFileObserver(context, NULL, NULL);
    assert_int_equal(none.count, 0); // nothing was read from disk
    assert_true(vplScene_GetHash(scene) == vplScene_GetHash(again));
    for (int i = 0; i < noted.count; i++) {
        free((char*)noted.files[i].path);
        free((void*)noted.files[i].bytes);
    }
    vplScene_Destroy(scene);
    vplScene_Destroy(again);
}
