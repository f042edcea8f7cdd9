// SPDX-License-Identifier: MIT
// Tests of scene files: broken ones are reported with reason and position, valid ones arrive as they were
// written.
#include "test.h"

#include "math/matrix.h"

#include <stdlib.h>
#include <unistd.h>

static const double DEGREE = VPL_PI / 180;

// Loads a scene from text through a temporary file.
static vplResult loadText(vplContext* context, const char* text, vplScene** sceneOut)
{
    char path[] = "/tmp/vpl-scene-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text));
    close(fd);
    vplResult result = vplScene_Load(context, path, sceneOut);
    unlink(path);
    return result;
}

static vplScene* mustLoad(vplContext* context, const char* text)
{
    vplScene* scene = NULL;
    if (loadText(context, text, &scene) != VPL_SUCCESS) {
        fail_msg("%s: %s", text, takeMessage());
    }
    return scene;
}

TEST(EveryBrokenSceneSaysWhatIsWrongWhere, 1)
{
    Table t = loadTable("broken/expected.csv");
    assert_true(t.rows >= 34);
    for (int row = 0; row < t.rows; row++) {
        char path[256], start[300];
        snprintf(path, sizeof path, "tests/data/broken/%s", cell(&t, row, "file"));
        snprintf(start, sizeof start, "%s:%s:%s: ", path, cell(&t, row, "line"), cell(&t, row, "column"));
        vplScene* scene = NULL;
        vplResult result = vplScene_Load(context, path, &scene);
        const char* message = takeMessage();
        if (result != VPL_PARSE_ERROR || scene != NULL) {
            fail_msg("%s: %s instead of a parse error", path, vplResult_GetName(result));
        }
        if (strncmp(message, start, strlen(start)) != 0 ||
            strstr(message, cell(&t, row, "message")) == NULL) {
            fail_msg("\"%s\" instead of \"%s... %s\"", message, start, cell(&t, row, "message"));
        }
        assert_int_equal(vplContext_GetBytes(context), 0);
    }
    freeTable(&t);
}

// Strings may contain brackets, quotes and backslashes; none may mislead the search for a position.
TEST(PositionsAreFoundBehindConfusingStrings, 1)
{
    vplScene* scene = NULL;
    const char* text =
        "{\"materials\": {\"]}\\\"[{\": {}, \"m\": {}},\n"
        " \"camera\": {\"eye\": [0, 0, 5], \"target\": [0, 0, 0]},\n"
        " \"objects\": [{\"name\": \"\\\\\", \"type\": \"quad\", \"material\": \"]}\\\"[{\"},\n"
        "  {\"name\": \"\\\\\\\"scale\\\": [0]\", \"type\": \"box\", \"material\": \"m\",\n"
        "   \"scale\": [1,\n"
        "     1, -1e20]}]}";
    assert_int_equal(loadText(context, text, &scene), VPL_PARSE_ERROR);
    assert_non_null(strstr(takeMessage(), ":5:13: objects[1].scale is -1e+20"));
}

TEST(WhatIsNoFileIsAFileError, 1)
{
    vplScene* scene = NULL;
    const char* const paths[] = {"tests/data/none.json", "tests/data", "tests/data/room.json/x", ""};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        assert_int_equal(vplScene_Load(context, paths[i], &scene), VPL_FILE_ERROR);
        assert_true(strncmp(takeMessage(), paths[i], strlen(paths[i])) == 0);
        assert_null(scene);
    }
}

// ---- valid files

static void assertVector(vplVec3 v, double x, double y, double z)
{
    assert_true(v.x == (float)x && v.y == (float)y && v.z == (float)z);
}

static void assertRgb(vplRgb c, double r, double g, double b)
{
    assert_true(c.r == (float)r && c.g == (float)g && c.b == (float)b);
}

// Compares by value: 0 and -0 are equal.
static void assertMatrix(const vplMat4* found, const vplMat4* wanted)
{
    for (int i = 0; i < 16; i++) {
        if (found->m[i] != wanted->m[i]) {
            fail_msg("element %d is %.9g, wanted %.9g", i, (double)found->m[i], (double)wanted->m[i]);
        }
    }
}

// Returns corner i of the unit quad, transformed by a matrix.
static vplVec3 cornerOf(const vplMat4* m, int i)
{
    return vplMat4_TransformPoint(m, (vplVec3){i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, 0});
}

// Asserts that both matrices give the same quad, to the bit, with the same front; the order of its corners
// may differ.
static void assertSameQuad(const vplMat4* a, const vplMat4* b, int row)
{
    for (int i = 0; i < 4; i++) {
        vplVec3 p = cornerOf(a, i);
        bool found = false;
        for (int j = 0; j < 4; j++) {
            vplVec3 q = cornerOf(b, j);
            found = found || (p.x == q.x && p.y == q.y && p.z == q.z);
        }
        if (!found) {
            fail_msg("object %d: corner %d (%g, %g, %g) is not in the table", row, i, (double)p.x,
                     (double)p.y, (double)p.z);
        }
    }
    for (int i = 8; i < 12; i++) {
        assert_true(a->m[i] == b->m[i]);
    }
}

static vplMat4 tableMatrix(const Table* t, int row)
{
    vplMat4 m = vplMat4_Identity();
    for (int i = 0; i < 12; i++) {
        char name[4] = {'m', (char)('0' + i / 4), (char)('0' + i % 4), 0};
        m.m[4 * (i % 4) + i / 4] = (float)number(t, row, name);
    }
    return m;
}

TEST(TheRoomIsThatOfTheTable, 1)
{
    vplScene* room = loadScene(context, "room.json");
    Table t = loadTable("room_objects.csv");
    assert_int_equal(vplScene_GetCameraCount(room), 1);
    assert_int_equal(vplScene_GetMaterialCount(room), 3);
    assert_int_equal(vplScene_GetObjectCount(room), t.rows);
    assert_int_equal(vplScene_GetEmitterCount(room), 1);
    for (int i = 0; i < t.rows; i++) {
        const vplObjectDef* o = vplScene_GetObject(room, i);
        const vplMaterialDef* m = vplScene_GetMaterial(room, o->material);
        bool box = strcmp(cell(&t, i, "type"), "box") == 0;
        vplMat4 wanted = tableMatrix(&t, i);
        assert_int_equal(o->type, box ? VPL_OBJECT_BOX : VPL_OBJECT_QUAD);
        assert_true(strncmp(o->name, cell(&t, i, "name"), strlen(cell(&t, i, "name"))) == 0);
        assertRgb(m->diffuse, number(&t, i, "rho_r"), number(&t, i, "rho_g"), number(&t, i, "rho_b"));
        assertRgb(m->emission, 0, 0, 0);
        if (box) {
            assertMatrix(&o->transform, &wanted);
        } else {
            assertSameQuad(&o->transform, &wanted, i);
        }
    }
    const vplCameraDef* camera = vplScene_GetCamera(room, 0);
    assertVector(camera->eye, 0, 2.5, 8.5);
    assertVector(camera->target, 0, 2.5, 0);
    assertNear(camera->fovY, 40 * DEGREE, 1e-15, "fovY", 0);
    assert_true(camera->nearPlane == 0.1 && camera->farPlane == 50);
    assert_int_equal(vplScene_GetEmitter(room, 0)->type, VPL_EMITTER_POINT);
    assertVector(vplScene_GetEmitter(room, 0)->position, 0, 4.5, 0);
    assertRgb(vplScene_GetEmitter(room, 0)->intensity, 10, 10, 10);
    freeTable(&t);
    vplScene_Destroy(room);
}

#define WITH(objects)                                                                                        \
    "{\"camera\": {\"eye\": [0, 0, 5], \"target\": [0, 0, 0]}, \"materials\": {\"m\": {}}, \"objects\": "    \
    "[" objects "]}"

// Rotates p about an axis, counter-clockwise seen from the axis' positive end.
static void turn(double p[3], int axis, double degrees)
{
    double c = cos(degrees * DEGREE), s = sin(degrees * DEGREE);
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double x = c * p[u] - s * p[v];
    p[v] = s * p[u] + c * p[v];
    p[u] = x;
}

TEST(ScaleThenRotateXyzThenTranslate, 1)
{
    vplScene* scene =
        mustLoad(context, WITH("{\"type\": \"box\", \"material\": \"m\", \"translate\": [1, -2, 3],"
                               "\"rotate\": [20, -35, 70], \"scale\": [2, 3, 0.5]}"));
    const vplMat4* m = &vplScene_GetObject(scene, 0)->transform;
    const double rotate[3] = {20 * DEGREE, -35 * DEGREE, 70 * DEGREE};
    vplMat4 parts = vplMat4_FromParts((vplVec3){1, -2, 3}, rotate, (vplVec3){2, 3, 0.5f});
    for (int i = 0; i < 8; i++) {
        vplVec3 corner = {i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f};
        double p[3] = {2 * (double)corner.x, 3 * (double)corner.y, 0.5 * (double)corner.z};
        turn(p, 0, 20);
        turn(p, 1, -35);
        turn(p, 2, 70);
        vplVec3 found = vplMat4_TransformPoint(m, corner), same = vplMat4_TransformPoint(&parts, corner);
        assertNear((double)found.x, p[0] + 1, 1e-6, "x", i);
        assertNear((double)found.y, p[1] - 2, 1e-6, "y", i);
        assertNear((double)found.z, p[2] + 3, 1e-6, "z", i);
        assertNear((double)same.x, p[0] + 1, 1e-6, "x by vplMat4_FromParts", i);
    }
    vplScene_Destroy(scene);
}

// Every combination of quarter turns gives a matrix of exact 0, 1 and -1.
TEST(QuarterTurnsAreExact, 1)
{
    for (int i = 0; i < 125; i++) {
        int turns[3] = {90 * (i % 5 - 2), 90 * (i / 5 % 5 - 2), 90 * (i / 25 - 2) + 360};
        char text[400];
        snprintf(text, sizeof text,
                 WITH("{\"type\": \"quad\", \"material\": \"m\", \"rotate\": [%d, %d, %d]}"), turns[0],
                 turns[1], turns[2]);
        vplScene* scene = mustLoad(context, text);
        const vplMat4* m = &vplScene_GetObject(scene, 0)->transform;
        float sum = 0;
        for (int k = 0; k < 16; k++) {
            assert_true(m->m[k] == 0 || m->m[k] == 1 || m->m[k] == -1);
            sum += fabsf(m->m[k]);
        }
        assert_true(sum == 4);
        vplScene_Destroy(scene);
    }
}

TEST(MatricesAndUniformScales, 1)
{
    vplScene* scene = mustLoad(
        context, WITH("{\"type\": \"quad\", \"material\": \"m\","
                      " \"matrix\": [1, 2, 3, 0, -5, 6, 7, 0, 9, 10, -11, 0, 13, 14, 15, 1]},"
                      "{\"type\": \"box\", \"material\": \"m\", \"scale\": 0.003, \"name\": \"small\"},"
                      "{\"type\": \"quad\", \"material\": \"m\"}"));
    const vplMat4 columns = {{1, 2, 3, 0, -5, 6, 7, 0, 9, 10, -11, 0, 13, 14, 15, 1}};
    const vplMat4 small = {{0.003f, 0, 0, 0, 0, 0.003f, 0, 0, 0, 0, 0.003f, 0, 0, 0, 0, 1}};
    const vplMat4 identity = vplMat4_Identity();
    assertMatrix(&vplScene_GetObject(scene, 0)->transform, &columns);
    assertMatrix(&vplScene_GetObject(scene, 1)->transform, &small);
    assert_string_equal(vplScene_GetObject(scene, 1)->name, "small");
    assertMatrix(&vplScene_GetObject(scene, 2)->transform, &identity);
    assert_null(vplScene_GetObject(scene, 2)->name);
    assertRgb(vplScene_GetMaterial(scene, 0)->diffuse, 0.5, 0.5, 0.5);
    vplScene_Destroy(scene);
}

TEST(CamerasAndLightsOfEveryKind, 1)
{
    vplScene* scene = mustLoad(
        context,
        "{\"cameras\": [{\"eye\": [0, 0, 5], \"target\": [0, 0, 0]},\n"
        "  {\"eye\": [1, 2, 3], \"target\": [4, 5, 6], \"up\": [0, 0, 1], \"fov_y\": 90, \"near\": 1e-2,\n"
        "   \"far\": 100000000000000}],\n"
        " \"objects\": [], \"lights\": [\n"
        "  {\"type\": \"spot\", \"name\": \"s\", \"position\": [1, 2, 3], \"direction\": [0, -2, 0],\n"
        "   \"intensity\": [4, 5, 6], \"inner_angle\": 0, \"outer_angle\": 45},\n"
        "  {\"type\": \"spot\", \"position\": [0, 0, 0], \"direction\": [1, 0, 0], \"intensity\": [0, 0, "
        "0]},\n"
        "  {\"type\": \"directional\", \"direction\": [0.25, -1, -0.15], \"irradiance\": [60, 57, 51]}]}");
    assert_int_equal(vplScene_GetCameraCount(scene), 2);
    assert_int_equal(vplScene_GetObjectCount(scene), 0);
    assert_int_equal(vplScene_GetEmitterCount(scene), 3);
    const vplCameraDef *plain = vplScene_GetCamera(scene, 0), *full = vplScene_GetCamera(scene, 1);
    const vplCameraDef defaults = vplDefaultCameraDef();
    assert_true(plain->fovY == defaults.fovY && plain->nearPlane == defaults.nearPlane &&
                plain->farPlane == defaults.farPlane);
    assertVector(plain->up, 0, 1, 0);
    assertVector(full->up, 0, 0, 1);
    assert_true(full->nearPlane == 1e-2 && full->farPlane == 1e14);
    assertNear(full->fovY, VPL_PI / 2, 1e-15, "fovY", 1);
    const vplEmitterDef *spot = vplScene_GetEmitter(scene, 0), *sun = vplScene_GetEmitter(scene, 2);
    assert_true(spot->type == VPL_EMITTER_SPOT && spot->innerAngle == 0);
    assertNear(spot->outerAngle, VPL_PI / 4, 1e-15, "outerAngle", 0);
    assertVector(spot->direction, 0, -2, 0);
    assertRgb(spot->intensity, 4, 5, 6);
    assertNear(vplScene_GetEmitter(scene, 1)->innerAngle, 20 * DEGREE, 1e-15, "innerAngle", 1);
    assertNear(vplScene_GetEmitter(scene, 1)->outerAngle, 30 * DEGREE, 1e-15, "outerAngle", 1);
    assert_int_equal(sun->type, VPL_EMITTER_DIRECTIONAL);
    assertVector(sun->direction, 0.25, -1, -0.15);
    assertRgb(sun->intensity, 60, 57, 51);
    vplScene_Destroy(scene);
}

// JSON has escapes and numbers of any length; keys are compared after their escapes are decoded.
TEST(JsonIsReadAsJson, 1)
{
    vplScene* scene =
        mustLoad(context, "\r\n\t{\"\\u0063amera\": {\"eye\": [0, -0, 5.0e0], \"target\": [0, 0, 0]},"
                          "\"materials\": {\"\\u00e9\\ud83d\\ude00\": {}}, \"objects\": "
                          "[{\"type\": \"\\u0062ox\", \"material\": \"\xc3\xa9\xf0\x9f\x98\x80\"}]}\n");
    assert_int_equal(vplScene_GetObject(scene, 0)->type, VPL_OBJECT_BOX);
    assert_string_equal(vplScene_GetMaterial(scene, 0)->name, "\xc3\xa9\xf0\x9f\x98\x80");
    vplScene_Destroy(scene);
    const char* beyond64Bits =
        WITH("{\"type\": \"box\", \"material\": \"m\", \"scale\": 100000000000000000000}");
    assert_int_equal(loadText(context, beyond64Bits, &scene), VPL_PARSE_ERROR);
    assert_non_null(strstr(takeMessage(), "objects[0].scale is 1e+20, must be in"));
}
