// SPDX-License-Identifier: MIT
// Tests of scenes far from (0, 0, 0): X028.
#include "test.h"

#include "math/vec.h"

#include <stdlib.h>
#include <unistd.h>

// A closed room of 4 m with a box of 1e-3 m on a table, a moving camera and a moving light. Positions are sums
// of powers of two, so that moving them changes no digit of what is inside.
static const char* const ROOM =
    "{\"camera\": {\"eye\": [%.17g, %.17g, %.17g], \"target\": [%.17g, %.17g, %.17g], \"near\": 0.001, "
    "\"path\":\n"
    "  [{\"frame\": 0}, {\"frame\": 9, \"eye\": [%.17g, %.17g, %.17g]}]},\n"
    "\"materials\": {\"m\": {\"diffuse\": [0.7, 0.5, 0.25]}, \"lamp\": {\"emission\": [9, 9, 9]}},\n"
    "\"objects\": [\n"
    "  {\"type\": \"quad\", \"material\": \"m\", \"translate\": [%.17g, %.17g, %.17g], \"rotate\": [-90, 0, "
    "0],"
    "   \"scale\": 4},\n"
    "  {\"type\": \"quad\", \"material\": \"m\", \"matrix\": [4, 0, 0, 0,  0, 4, 0, 0,  0, 0, 4, 0,"
    "   %.17g, %.17g, %.17g, 1]},\n"
    "  {\"type\": \"box\", \"material\": \"m\", \"translate\": [%.17g, %.17g, %.17g], \"scale\": "
    "0.0009765625},\n"
    "  {\"type\": \"quad\", \"material\": \"lamp\", \"translate\": [%.17g, %.17g, %.17g], \"rotate\": [90, "
    "0, 0]}],\n"
    "\"lights\": [{\"type\": \"point\", \"position\": [%.17g, %.17g, %.17g], \"intensity\": [5, 5, 5], "
    "\"path\":\n"
    "  [{\"frame\": 0}, {\"frame\": 9, \"position\": [%.17g, %.17g, %.17g]}]}]}\n";

enum { POINTS = 9 };

// Eye, target, second eye; floor, wall, box, lamp; light, second light.
static const double AT[POINTS][3] = {{0.0078125, 0.0078125, 0.015625},
                                     {0, 0.00048828125, 0},
                                     {0.5, 1, 2},
                                     {0, 0, 0},
                                     {0, 2, -2},
                                     {0, 0.00048828125, 0},
                                     {0, 4, 0},
                                     {1, 3, 1},
                                     {-1, 3, 1}};

static vplScene* loadAt(vplContext* context, const double offset[3])
{
    char text[4096], path[] = "/tmp/vpl-origin-XXXXXX";
    double p[POINTS][3];
    for (int i = 0; i < POINTS; i++) {
        for (int k = 0; k < 3; k++) {
            p[i][k] = AT[i][k] + offset[k];
        }
    }
    const int length =
        snprintf(text, sizeof text, ROOM, p[0][0], p[0][1], p[0][2], p[1][0], p[1][1], p[1][2], p[2][0],
                 p[2][1], p[2][2], p[3][0], p[3][1], p[3][2], p[4][0], p[4][1], p[4][2], p[5][0], p[5][1],
                 p[5][2], p[6][0], p[6][1], p[6][2], p[7][0], p[7][1], p[7][2], p[8][0], p[8][1], p[8][2]);
    const int fd = mkstemp(path);
    assert_true(fd >= 0 && length < (int)sizeof text && write(fd, text, (size_t)length) == length);
    close(fd);
    vplScene* scene = openScene(context, path);
    unlink(path);
    return scene;
}

// Multiples of the power of two to which the origin is rounded.
static const double FAR[] = {1024, 1e4, 1e5, 1e6, 1e7, -3e6};

// Pictures by all methods, and the ends of the paths.
TEST(ASceneFarAwayHasThePicturesOfTheSceneAtHome, 1, SLOW)
{
    static const vplMethod methods[] = {VPL_METHOD_DIRECT, VPL_METHOD_KELLER, VPL_METHOD_RADIOSITY,
                                        VPL_METHOD_SSVP, VPL_METHOD_PATH};
    uint64_t home[5];
    vplVec3 ends[2];
    int pictures = 0;
    for (int i = -1; i < 6; i++) {
        const double d = i < 0 ? 0 : FAR[i], offset[3] = {d, d / 2, -d};
        vplScene* scene = loadAt(context, offset);
        double origin[3];
        vplCameraDef camera;
        vplEmitterDef light;
        vplScene_GetOrigin(scene, origin);
        assert_true((i < 0) == (origin[0] == 0));
        assert_int_equal(vplScene_PoseCamera(scene, 0, 9, &camera), VPL_SUCCESS);
        assert_int_equal(vplScene_PoseEmitter(scene, 0, 9, &light), VPL_SUCCESS);
        ends[0] = i < 0 ? camera.eye : ends[0];
        ends[1] = i < 0 ? light.position : ends[1];
        assert_memory_equal(&camera.eye, &ends[0], sizeof camera.eye);
        assert_memory_equal(&light.position, &ends[1], sizeof light.position);
        for (int m = 0; m < 5; m++) {
            vplRenderOptions options = plainOptions();
            options.method = methods[m];
            options.output.width = 48;
            options.output.height = 36;
            options.path.samples = 2;
            vplRenderStats stats;
            vplImage_Destroy(renderScene(scene, &options, &stats));
            home[m] = i < 0 ? stats.imageHash : home[m];
            assert_true(stats.imageHash == home[m]);
            pictures++;
        }
        vplScene_Destroy(scene);
    }
    assert_int_equal(pictures, 35);
}

// What comes out is where the caller put it: lights lie on its surfaces.
TEST(TheOriginLeadsBackToTheCallersSpace, 1)
{
    const double offset[3] = {1e6, 5e5, -1e6};
    vplScene* scene = loadAt(context, offset);
    double origin[3];
    vplScene_GetOrigin(scene, origin);
    for (int k = 0; k < 3; k++) {
        assertNear(origin[k], offset[k], 0, "origin", k);
    }
    const vplCameraDef* camera = vplScene_GetCamera(scene, 0);
    assertNear(origin[0] + (double)camera->eye.x, offset[0] + AT[0][0], 1e-9, "eye", 0);
    vplGeometry* g;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    assert_memory_equal(g->origin, origin, sizeof origin);
    assertNear(g->origin[1] + (double)g->boundsMax.y, offset[1] + 4, 1e-6, "top", 0);
    assert_int_equal(g->formulaCount, 0); // a box of 1e-3 m is as good as any
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

TEST(OriginsOutOfRangeAreRefusedAndNewScenesHaveNone, 1)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    double origin[3] = {1, 2, 3};
    vplScene_GetOrigin(scene, origin);
    assert_true(origin[0] == 0 && origin[1] == 0 && origin[2] == 0);
    assert_int_equal(vplScene_SetOrigin(scene, (double[3]){0, NAN, 0}), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "origin[1] is nan"));
    assert_int_equal(vplScene_SetOrigin(scene, (double[3]){0, 0, 2e15}), VPL_INVALID_ARGUMENT);
    vplScene_GetOrigin(scene, origin);
    assert_true(origin[2] == 0);
    vplScene_Destroy(scene);
}

// Vertices of a baked mesh are doubles in the caller's space.
TEST(BakedVerticesAreInTheCallersSpace, 1)
{
    const double offset[3] = {1e6, 5e5, -1e6};
    vplScene* scene = loadAt(context, offset);
    vplRenderOptions options = plainOptions();
    options.method = VPL_METHOD_RADIOSITY;
    options.radiosity.patches = 60;
    char path[] = "/tmp/vpl-origin-XXXXXX";
    close(mkstemp(path));
    assert_int_equal(vplBake(scene, &options, 0, path, NULL), VPL_SUCCESS);
    vplScene_Destroy(scene);
    static char bytes[1 << 18];
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    const size_t size = fread(bytes, 1, sizeof bytes - 1, file);
    fclose(file);
    unlink(path);
    int count = 0;
    assert_non_null(strstr(bytes, "property double x\nproperty double y\nproperty double z\n"));
    assert_int_equal(sscanf(strstr(bytes, "element vertex"), "element vertex %d", &count), 1);
    const char* at = strstr(bytes, "end_header\n") + 11;
    assert_true(count > 30 && at + (size_t)count * 51 < bytes + size);
    for (int i = 0; i < count; i++, at += 51) {
        double p[3];
        memcpy(p, at, sizeof p);
        assertNear(p[0], offset[0], 2, "x", i);
        assertNear(p[1], offset[1] + 2, 2, "y", i);
        assertNear(p[2], offset[2], 2, "z", i);
    }
}
