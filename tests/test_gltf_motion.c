// SPDX-License-Identifier: MIT
// Tests of the motion of nodes in glTF files.
#include "gltf_support.h"

#include <unistd.h>

#define CURVE(path, node)                                                                                    \
    "\"animations\":[{\"samplers\":[{\"input\":2,\"output\":3,\"interpolation\":\"%s\"}],\"channels\":[{"    \
    "\"sampler\":0,\"target\":{"                                                                             \
    "\"node\":" node ",\"path\":\"" path "\"}}]}],"

#define CURVE_VIEWS(count, values, type)                                                                     \
    ",{\"bufferView\":1,\"componentType\":5126,\"count\":" count                                             \
    ",\"type\":\"SCALAR\"},{\"bufferView\":2,\"componentType\":5126,"                                        \
    "\"count\":" values ",\"type\":\"" type "\"}" VIEWS                                                      \
    ",{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":%d},{\"buffer\":0,"                                     \
    "\"byteOffset\":%d,\"byteLength\":%d}],"

static const char POINT_LIGHT[] =
    "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\"}]}}";

static const char LIGHT_NODES[] =
    "{\"children\":[2]},{\"translation\":[0,0,-1],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}";

// A light one metre before a node, which moves from x = 0 to x = 8 within a second, by each kind of curve.
TEST_ALONE(CurvesMoveLights)
{
    static const float times[2] = {0, 1}, linear[6] = {0, 0, 0, 8, 0, 0};
    static const float cubic[18] = {9, 9, 9, 0, 0, 0, 16, 0, 0, 0, 8, 0, 8, 0, 0, 9, 9, 9};
    static const char* const forms[] = {"LINEAR", "STEP", "CUBICSPLINE"};
    Desk d;
    openDesk(&d);
    for (int form = 0; form < 3; form++) {
        Blob blob = {.size = 0};
        addFloats(&blob, POINTS, 9);
        const int input = addFloats(&blob, times, 2);
        const int output = addFloats(&blob, form == 2 ? cubic : linear, form == 2 ? 18 : 6);
        writeGltf(
            deskPath(&d, "a.gltf"), &blob,
            NODES_HEAD "\"nodes\":[{\"mesh\":0},%s]," CURVE("translation", "1") TRIANGLE
            ",{\"bufferView\":1,\"componentType\":5126,\"count\":2,\"type\":\"SCALAR\"},{\"bufferView\":2,"
            "\"componentType\":5126,\"count\":%d,\"type\":\"VEC3\"}" VIEWS
            ",{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":8},{\"buffer\":0,\"byteOffset\":%d,"
            "\"byteLength\":%d}],%s",
            LIGHT_NODES, forms[form], form == 2 ? 6 : 2, input, output, form == 2 ? 72 : 24, POINT_LIGHT);
        vplScene* scene = loadGltf(&d, "a.gltf");
        int count;
        vplScene_GetEmitterPath(scene, 0, &count);
        assert_int_equal(count, 25);
        for (int frame = -3; frame <= 30; frame += 3) {
            vplEmitterDef def;
            const double t = fmin(fmax(frame / 24.0, 0), 1), t2 = t * t, t3 = t2 * t;
            const double x = form == 0   ? 8 * t
                             : form == 1 ? (t < 1 ? 0 : 8)
                                         : 16 * (t3 - 2 * t2 + t) + 8 * (3 * t2 - 2 * t3);
            const double y = form == 2 ? 8 * (t3 - t2) : 0;
            assert_int_equal(vplScene_PoseEmitter(scene, 0, frame, &def), VPL_SUCCESS);
            assertAround((double)def.position.x, x, 1e-6);
            assertAround((double)def.position.y, y, 1e-6);
            assertAround((double)def.position.z, -1, 1e-6);
        }
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

// A node turns by 90 degrees about y in half a second; the light before it goes round with even speed.
TEST_ALONE(TurnsAreSphericalAndGoTheShorterWay)
{
    static const float times[2] = {0.5f, 1}, h = 0.70710678f;
    Desk d;
    openDesk(&d);
    for (int sign = -1; sign <= 1; sign += 2) { // both quaternions are the same turn
        const float turns[8] = {0, 0, 0, 1, 0, (float)sign * h, 0, (float)sign * h};
        Blob blob = {.size = 0};
        addFloats(&blob, POINTS, 9);
        const int input = addFloats(&blob, times, 2), output = addFloats(&blob, turns, 8);
        writeGltf(deskPath(&d, "a.gltf"), &blob,
                  NODES_HEAD "\"nodes\":[{\"mesh\":0},%s]," CURVE("rotation", "1")
                      TRIANGLE CURVE_VIEWS("2", "2", "VEC4") "%s",
                  LIGHT_NODES, "LINEAR", input, 8, output, 32, POINT_LIGHT);
        vplScene* scene = loadGltf(&d, "a.gltf");
        for (int frame = 12; frame <= 24; frame += 4) {
            vplEmitterDef def;
            const double angle = (frame - 12) / 12.0 * VPL_PI / 2;
            assert_int_equal(vplScene_PoseEmitter(scene, 0, frame, &def), VPL_SUCCESS);
            assertAround((double)def.position.x, -sin(angle), 1e-6);
            assertAround((double)def.position.z, -cos(angle), 1e-6);
            assertAround((double)def.direction.x, -sin(angle), 1e-6);
        }
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

TEST_ALONE(CamerasMoveAndMeshesThatHaveNoCurveStandStill)
{
    static const float times[3] = {0, 1, 2}, places[9] = {0, 0, 4, 0, 0, 6, 3, 0, 6};
    Blob blob = {.size = 0};
    addFloats(&blob, POINTS, 9);
    const int input = addFloats(&blob, times, 3), output = addFloats(&blob, places, 9);
    Desk d;
    openDesk(&d);
    writeGltf(
        deskPath(&d, "a.gltf"), &blob,
        NODES_HEAD
        "\"nodes\":[{\"mesh\":0},{\"camera\":0,\"children\":[2]},{\"mesh\":0}]," CURVE("translation", "1")
            TRIANGLE CURVE_VIEWS(
                "3", "3",
                "VEC3") "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":0.1}}]",
        "LINEAR", input, 12, output, 36);
    vplScene* scene = loadGltf(&d, "a.gltf");
    vplCameraDef def;
    assert_int_equal(vplScene_PoseCamera(scene, 0, 36, &def), VPL_SUCCESS);
    assertAround((double)def.eye.x, 1.5, 1e-6);
    assertAround((double)def.eye.z, 6, 1e-6);
    assertAround((double)def.target.x, 1.5, 1e-6);
    assert_true(def.target.z < def.eye.z);
    assert_null(vplScene_GetObjectPath(scene, 0, &(int){0}));
    assert_non_null(vplScene_GetObjectPath(scene, 1, &(int){0}));
    vplScene_Destroy(scene);
    closeDesk(&d);
}

// Writes a triangle that three keys move by a curve, below a node that is turned, and a second one that stands.
static void writeMover(const char* path, const char* form, const float* values, int count)
{
    static const float times[3] = {0, 1, 1.5f};
    Blob blob = {.size = 0};
    addFloats(&blob, POINTS, 9);
    const int input = addFloats(&blob, times, 3), output = addFloats(&blob, values, 3 * count);
    char views[16];
    snprintf(views, sizeof views, "%d", count);
    writeGltf(path, &blob,
              NODES_HEAD
              "\"nodes\":[{\"mesh\":0},{\"rotation\":[0,0.6,0,0.8],\"children\":[2]},{\"mesh\":0}]," CURVE(
                  "translation", "2") TRIANGLE
              ",{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"SCALAR\"},{\"bufferView\":2,"
              "\"componentType\":5126,\"count\":%s,\"type\":\"VEC3\"}" VIEWS
              ",{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":12},{\"buffer\":0,\"byteOffset\":%d,"
              "\"byteLength\":%d}],%s",
              form, views, input, output, 12 * count, POINT_LIGHT);
}

// By the formula of glTF 2.0, appendix C, written out for each of the two pieces: at its second piece, too, a spline begins
// with the tangent behind the key and ends with the one before the next.
static double expectedAt(int form, const float* v, int axis, double time)
{
    const int stride = form == 2 ? 9 : 3, offset = form == 2 ? 3 : 0, piece = time < 1 ? 0 : 1;
    const double length = piece == 0 ? 1 : 0.5, t = fmin((time - piece) / length, 1), t2 = t * t, t3 = t2 * t;
    const float *a = v + piece * stride, *b = a + stride;
    const double from = (double)a[offset + axis], to = (double)b[offset + axis];
    return form == 0   ? from + t * (to - from)
           : form == 1 ? (t < 1 ? from : to)
                       : (2 * t3 - 3 * t2 + 1) * from + length * (t3 - 2 * t2 + t) * (double)a[6 + axis] +
                             (3 * t2 - 2 * t3) * to + length * (t3 - t2) * (double)b[axis];
}

TEST_ALONE(CurvesMoveObjects)
{
    static const float straight[9] = {0, 0, 0, 8, 1, 2, -3, 4, 5},
                       cubic[27] = {9, 9, 9,  0, 0,  0,  16, 1,  2, 3, -4, 5, 8, 1,
                                    2, 6, -7, 8, -9, 10, 11, -3, 4, 5, 9,  9, 9};
    static const char* const forms[] = {"LINEAR", "STEP", "CUBICSPLINE"};
    Desk d;
    openDesk(&d);
    for (int form = 0; form < 3; form++) {
        const float* values = form == 2 ? cubic : straight;
        writeMover(deskPath(&d, "a.gltf"), forms[form], values, form == 2 ? 9 : 3);
        vplScene* scene = loadGltf(&d, "a.gltf");
        int count;
        assert_non_null(vplScene_GetObjectPath(scene, 1, &count));
        assert_int_equal(count, 37);
        for (int frame = 0; frame <= 36; frame++) {
            double p[3];
            assert_int_equal(vplScene_SetFrame(scene, frame), VPL_SUCCESS);
            for (int k = 0; k < 3; k++) {
                p[k] = expectedAt(form, values, k, frame / 24.0);
            }
            const float* m = vplScene_GetObject(scene, 1)->transform.m; // 0.6, 0.8: cosine 0.28, sine 0.96
            assertAround((double)m[12], 0.28 * p[0] + 0.96 * p[2], 1e-5);
            assertAround((double)m[13], p[1], 1e-5);
            assertAround((double)m[14], -0.96 * p[0] + 0.28 * p[2], 1e-5);
            assertAround((double)m[0], 0.28, 1e-6);
        }
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

TEST_ALONE(EndlessAnimationsAreRefused)
{
    static const float times[2] = {0, 1e9f}, places[6] = {0};
    Blob blob = {.size = 0};
    addFloats(&blob, POINTS, 9);
    const int input = addFloats(&blob, times, 2), output = addFloats(&blob, places, 6);
    vplScene* scene = NULL;
    Desk d;
    openDesk(&d);
    writeGltf(deskPath(&d, "a.gltf"), &blob,
              NODES_HEAD "\"nodes\":[{\"mesh\":0},%s]," CURVE("translation", "1")
                  TRIANGLE CURVE_VIEWS("2", "2", "VEC3") "%s",
              LIGHT_NODES, "LINEAR", input, 8, output, 24, POINT_LIGHT);
    assert_int_equal(vplScene_Load(d.context, deskPath(&d, "a.gltf"), &scene), VPL_LIMIT);
    assert_null(scene);
    assert_int_equal(countOf(d.said, "an animation of 1e+09 s is longer than 100000 frames"), 1);
    unlink(deskPath(&d, "a.gltf"));
    closeDesk(&d);
}

// A cubic spline has every polynomial of third degree whose values and slopes its keys take, and straight pieces have a
// broken line, however many keys there are and wherever.
TEST_ALONE(CurvesOfManyKeysAreTheFunctionTheyWereTakenFrom)
{
    enum { KEYS = 6 };
    static const float times[KEYS] = {0, 0.25f, 0.5f, 1, 1.125f, 2};
    static const char* const forms[] = {"LINEAR", "CUBICSPLINE"};
    Desk d;
    openDesk(&d);
    for (int cubic = 0; cubic < 2; cubic++) {
        float values[9 * KEYS];
        for (int k = 0; k < KEYS; k++) {
            const float t = times[k];
            for (int axis = 0; axis < 3; axis++) {
                const float a = (float)(axis + 1),
                            value = cubic ? a * t * t * t - t * t + a : a * fabsf(t - 1);
                float* at = values + (cubic ? 9 * k : 3 * k) + axis;
                at[0] = value;
                if (cubic) {
                    at[0] = at[6] = 3 * a * t * t - 2 * t;
                    at[3] = value;
                }
            }
        }
        Blob blob = {.size = 0};
        addFloats(&blob, POINTS, 9);
        const int count = (cubic ? 9 : 3) * KEYS, input = addFloats(&blob, times, KEYS),
                  output = addFloats(&blob, values, count);
        char views[1024];
        snprintf(views, sizeof views, CURVE_VIEWS("6", "%d", "VEC3"), count / 3, input, 4 * KEYS, output,
                 4 * count);
        writeGltf(deskPath(&d, "a.gltf"), &blob,
                  NODES_HEAD "\"nodes\":[{\"mesh\":0},%s]," CURVE("translation", "1") TRIANGLE "%s%s",
                  LIGHT_NODES, forms[cubic], views, POINT_LIGHT);
        vplScene* scene = loadGltf(&d, "a.gltf");
        for (int frame = 0; frame <= 48; frame++) {
            const double t = frame / 24.0;
            vplEmitterDef def;
            assert_int_equal(vplScene_PoseEmitter(scene, 0, frame, &def), VPL_SUCCESS);
            const float* place = &def.position.x;
            for (int axis = 0; axis < 3; axis++) { // the light is one metre before its node
                const double a = axis + 1, value = cubic ? a * t * t * t - t * t + a : a * fabs(t - 1);
                assertAround((double)place[axis], value - (axis == 2), 2e-6);
            }
        }
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}
