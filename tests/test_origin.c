// SPDX-License-Identifier: MIT
// Tests of scenes far from (0, 0, 0): X028.
#include "scenes.h"

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

// X028
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

// ---- positions given as floats, without an origin

// A quad of 3 m x 4 m, 5 m from corner to corner, whose farthest corner is at this x.
static const char* messageAt(vplContext* context, float farthest)
{
    vplScene* scene = sceneOf(context, 0.5f);
    vplGeometry* g;
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(farthest - 1.5f, 0, 0), 0, 0, vplVec(3, 4, 1));
    takeMessage();
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
    return takeMessage();
}

// A scene warns from 4,096 times its size on, on either side, and says how far it is and by how much it is off.
TEST(FloatsFarFromTheOriginAreAWarning, 1)
{
    assert_string_equal(messageAt(context, 0), "");
    assert_string_equal(messageAt(context, 20480), "");
    assert_string_equal(
        messageAt(context, 20480.5f),
        "the scene is 5 m large and 20480.5 m from (0, 0, 0): positions are off by up to 0.0012 m. "
        "Nearer vertices, or vplScene_SetOrigin, keep them exact");
    assert_string_equal(
        messageAt(context, -2e6f),
        "the scene is 5 m large and 2e+06 m from (0, 0, 0): positions are off by up to 0.12 m. "
        "Nearer vertices, or vplScene_SetOrigin, keep them exact");
}

// A closed room of 4 m x 3 m x 4 m with a box and a point light, as floats.
static vplScene* floatRoom(vplContext* context, vplVec3 offset)
{
    static const struct {
        vplVec3 at;
        double turnX, turnY;
        vplVec3 size;
    } walls[7] = {{{0, 0, 0}, -VPL_PI / 2, 0, {4, 4, 1}},
                  {{0, 3, 0}, VPL_PI / 2, 0, {4, 4, 1}},
                  {{0, 1.5f, -2}, 0, 0, {4, 3, 1}},
                  {{0, 1.5f, 2}, 0, VPL_PI, {4, 3, 1}},
                  {{-2, 1.5f, 0}, 0, VPL_PI / 2, {4, 3, 1}},
                  {{2, 1.5f, 0}, 0, -VPL_PI / 2, {4, 3, 1}},
                  {{0.6f, 0.5f, -0.3f}, 0, 0.35, {0.8f, 1, 0.9f}}};
    vplScene* scene = sceneOf(context, 0.5f);
    for (int i = 0; i < 7; i++) {
        addThing(scene, i < 6 ? VPL_OBJECT_QUAD : VPL_OBJECT_BOX, 0, vplAdd(walls[i].at, offset),
                 walls[i].turnX, walls[i].turnY, walls[i].size);
    }
    aim(scene, vplAdd(vplVec(-0.3f, 1.4f, 1.9f), offset), vplAdd(vplVec(0.1f, 1, -1), offset));
    addEmitter(scene, VPL_EMITTER_POINT, vplAdd(vplVec(-0.5f, 2.6f, 0.2f), offset), vplVec(0, -1, 0), 10);
    return scene;
}

static vplImage* floatPicture(vplContext* context, vplVec3 offset, const char* words)
{
    vplScene* scene = floatRoom(context, offset);
    vplRenderOptions o = plainOptions();
    assert_int_equal(vplRenderOptions_SetAll(&o, words), VPL_SUCCESS);
    o.output.width = 32;
    o.output.height = 24;
    o.shadow.mapSize = 256;
    vplImage* image = renderScene(scene, &o, NULL);
    vplScene_Destroy(scene);
    return image;
}

// What src/base/README.md promises of 100 m, 25 times the side of the room, and of 1,000 m. Rounding moves virtual lights and the
// edges of their shadows, and SSVP's choice of lights.
TEST(FloatsKeepTheirPicturesAsFarAsIsPromised, 2)
{
    static const struct {
        const char* words;
        double near, far; // rmse over the mean
    } cases[] = {
        {"--method direct --light-shadows map", 1e-5, 3e-3},
        {"--method direct --light-shadows ray", 1e-5, 3e-3},
        {"--method path --spp 4 --pixel centre --max-bounces 8", 1e-5, 3e-3},
        {"--method keller --particles 100 --pipeline batched --light-shadows ray", 1e-3, 3e-3},
        {"--method keller --particles 100 --pipeline deferred --light-shadows map --light-map 64", 1e-3,
         3e-3},
        {"--method keller --particles 1000 --pipeline interleaved --interleave 4 --light-shadows ray", 1e-3,
         3e-3},
        {"--method radiosity --patches 200 --iterations 2000 --residual 1e-6", 1e-3, 3e-3},
        {"--method keller --particles 1000 --pipeline lightcuts --light-shadows ray", 2e-2, 4e-2},
        {"--method radiosity --patches 200 --hierarchy on --iterations 2000 --residual 1e-6", 2e-2, 4e-2},
        {"--method radiosity --patches 200 --patch-placement adaptive", 2e-2, 4e-2},
        {"--method ssvp --rsm-size 256 --next-bounce maps --max-bounces 2 --max-clusters 8 --paraboloid 128",
         1e-2, 4e-2},
    };
    for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++) {
        vplImage* home = floatPicture(context, vplVec(0, 0, 0), cases[i].words);
        for (int far = 0; far < 2; far++) {
            const float d = far ? 1000 : 100;
            vplComparison c;
            vplImage* image = floatPicture(context, vplVec(d, d / 3, -d), cases[i].words);
            assert_int_equal(vplImage_Compare(image, home, &c), VPL_SUCCESS);
            assertNear(c.relativeRmse, 0, far ? cases[i].far : cases[i].near, cases[i].words, (int)d);
            vplImage_Destroy(image);
        }
        vplImage_Destroy(home);
    }
}
