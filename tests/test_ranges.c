// SPDX-License-Identifier: MIT
// The promised range of each number of a scene, as src/base/README.md lists them: at both ends every method gives
// a finite picture or says in a sentence why not, and beyond them the number is refused by name.
#include "scenes.h"

#include <float.h>

// What a scene is made of: a floor, a box on it, a point light, a spot and a camera.
typedef struct Parts {
    vplCameraDef camera;
    vplMaterialDef material;
    vplObjectDef ground, box;
    vplEmitterDef point, spot;
} Parts;

static Parts plainParts(void)
{
    Parts p = {.camera = vplDefaultCameraDef(),
               .material = vplDefaultMaterialDef(),
               .ground = vplDefaultObjectDef(),
               .box = vplDefaultObjectDef(),
               .point = vplDefaultEmitterDef(),
               .spot = vplDefaultEmitterDef()};
    p.camera.eye = (vplVec3){0, 1.5f, 4};
    p.ground.transform =
        vplMat4_FromParts((vplVec3){0, -1, 0}, (double[3]){-VPL_PI / 2, 0, 0}, (vplVec3){6, 6, 1});
    p.box.type = VPL_OBJECT_BOX;
    p.point.position = (vplVec3){0.5f, 2, 0.25f};
    p.spot = p.point;
    p.spot.type = VPL_EMITTER_SPOT;
    return p;
}

// ---- the numbers

static void setEye(Parts* p, double value)
{
    p->camera.eye.x = (float)value;
}
static void setTarget(Parts* p, double value)
{
    p->camera.target.x = (float)value;
}
static void setUp(Parts* p, double value)
{
    p->camera.up = (vplVec3){0, (float)value, 0};
}
static void setFov(Parts* p, double value)
{
    p->camera.fovY = value;
}
static void setNear(Parts* p, double value)
{
    p->camera.nearPlane = value;
    p->camera.farPlane = fmax(p->camera.farPlane, 1e15);
}
static void setFar(Parts* p, double value)
{
    p->camera.farPlane = value;
}
static void setDiffuse(Parts* p, double value)
{
    p->material.diffuse = (vplRgb){(float)value, 0.5f, 0.5f};
}
static void setEmission(Parts* p, double value)
{
    p->material.emission.g = (float)value;
}
static void setPlace(Parts* p, double value)
{
    p->box.transform.m[13] = (float)value;
}
static void setSize(Parts* p, double value)
{
    p->box.transform.m[0] = p->box.transform.m[5] = p->box.transform.m[10] = (float)value;
}
static void setThickness(Parts* p, double value)
{
    p->box.transform.m[5] = (float)value;
}
// The angle between two axes, radians.
static void setShear(Parts* p, double value)
{
    p->box.transform.m[4] = 1;
    p->box.transform.m[5] = (float)value;
}
static void setLight(Parts* p, double value)
{
    p->point.position.z = (float)value;
}
static void setIntensity(Parts* p, double value)
{
    p->point.intensity.b = (float)value;
}
static void setDirection(Parts* p, double value)
{
    p->spot.direction = (vplVec3){0, (float)value, 0};
}
static void setInner(Parts* p, double value)
{
    p->spot.innerAngle = value;
}
static void setOuter(Parts* p, double value)
{
    p->spot.innerAngle = 0;
    p->spot.outerAngle = value;
}

typedef struct Quantity {
    const char* field; // as the sentence names it
    void (*set)(Parts* parts, double value);
    double low, high;     // the ends of the range
    double below, beyond; // refused
} Quantity;

#define MOST (double)VPL_MAX_MAGNITUDE
#define MORE 1.0001e15

static const Quantity QUANTITIES[] = {
    {"vplCameraDef.eye[0]", setEye, -MOST, MOST, -MORE, MORE},
    {"vplCameraDef.target[0]", setTarget, -MOST, MOST, -MORE, MORE},
    {"vplCameraDef.up", setUp, 1e-15, MOST, 0, MORE},
    {"vplCameraDef.fovY", setFov, 1e-9, 3.1415926, 0, 3.1415927},
    {"vplCameraDef.nearPlane", setNear, 1e-15, 1e14, 0, MORE},
    {"vplCameraDef.farPlane", setFar, 0.10001, 1e15, 0.1, MORE},
    {"vplMaterialDef.diffuse[0]", setDiffuse, 0, 1, -1e-30, 1.0000002},
    {"vplMaterialDef.emission[1]", setEmission, 0, MOST, -1e-30, MORE},
    {"vplObjectDef.transform[13]", setPlace, -MOST, MOST, -MORE, MORE},
    {"vplObjectDef.transform", setSize, 1e-15, MOST, 0, MORE},
    {"vplObjectDef.transform", setThickness, 1e-15, MOST, 1e-16, MORE},
    {"vplObjectDef.transform", setShear, 2e-10, MOST, 0.5e-10, MORE},
    {"vplEmitterDef.position[2]", setLight, -MOST, MOST, -MORE, MORE},
    {"vplEmitterDef.intensity[2]", setIntensity, 0, MOST, -1e-30, MORE},
    {"vplEmitterDef.direction", setDirection, 1e-15, MOST, 0, MORE},
    {"vplEmitterDef.innerAngle", setInner, 0, 0.52, -1e-9, 0.53},
    {"vplEmitterDef.outerAngle", setOuter, 1e-6, 1.5707, 0, 1.5708},
};

enum { QUANTITY_COUNT = sizeof QUANTITIES / sizeof *QUANTITIES };

// Adds all parts to a scene; the first refusal ends it.
static vplResult addParts(vplScene* scene, const Parts* p)
{
    vplResult result = vplScene_AddCamera(scene, &p->camera, NULL);
    result = result == VPL_SUCCESS ? vplScene_AddMaterial(scene, &p->material, NULL) : result;
    result = result == VPL_SUCCESS ? vplScene_AddObject(scene, &p->ground, NULL) : result;
    result = result == VPL_SUCCESS ? vplScene_AddObject(scene, &p->box, NULL) : result;
    result = result == VPL_SUCCESS ? vplScene_AddEmitter(scene, &p->point, NULL) : result;
    return result == VPL_SUCCESS ? vplScene_AddEmitter(scene, &p->spot, NULL) : result;
}

// Sets a number and makes the scene.
static vplResult tryValue(vplContext* context, const Quantity* q, double value, vplScene** sceneOut)
{
    Parts parts = plainParts();
    q->set(&parts, value);
    assert_int_equal(vplScene_Create(context, sceneOut), VPL_SUCCESS);
    takeMessage();
    return addParts(*sceneOut, &parts);
}

static const char* const METHODS[] = {
    "--method direct",
    "--method direct --light-shadows ray",
    "--method keller --particles 20 --light-shadows map --light-map 16",
    "--method keller --particles 20 --light-shadows ray --pipeline interleaved",
    "--method path --spp 1",
    "--method ssvp --rsm-size 16 --paraboloid 16 --first-bounce 16 --second-bounce 16",
    "--method radiosity --patches 60"};

enum { METHOD_COUNT = sizeof METHODS / sizeof *METHODS };

// Fails unless a picture is finite.
static void checkPicture(const vplScene* scene, const Quantity* q, double value, int method)
{
    vplRenderOptions o = plainOptions();
    assert_int_equal(vplRenderOptions_SetAll(&o, METHODS[method]), VPL_SUCCESS);
    o.output.width = 6;
    o.output.height = 5;
    o.shadow.mapSize = 16;
    vplImage* image = NULL;
    takeMessage();
    if (vplRender(scene, &o, &image, NULL) != VPL_SUCCESS) {
        fail_msg("%s = %g, %s: %s", q->field, value, METHODS[method], takeMessage());
    }
    for (int i = 0; i < 3 * 6 * 5; i++) {
        if (!(image->pixels[i] >= 0 && image->pixels[i] <= FLT_MAX)) {
            fail_msg("%s = %g, %s: %g", q->field, value, METHODS[method], (double)image->pixels[i]);
        }
    }
    vplImage_Destroy(image);
}

TEST(EveryMethodHasAPictureAtTheEndsOfEveryRange, 1, SLOW)
{
    for (int i = 0; i < QUANTITY_COUNT; i++) {
        const Quantity* q = &QUANTITIES[i];
        for (int end = 0; end < 2; end++) {
            const double value = end ? q->high : q->low;
            vplScene* scene;
            if (tryValue(context, q, value, &scene) != VPL_SUCCESS) {
                fail_msg("%s = %g: %s", q->field, value, takeMessage());
            }
            for (int m = 0; m < METHOD_COUNT; m++) {
                checkPicture(scene, q, value, m);
            }
            vplScene_Destroy(scene);
        }
    }
}

TEST(TheOriginMayBeAnywhereInItsRange, 1)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    double origin[3];
    assert_int_equal(vplScene_SetOrigin(scene, (double[3]){1e15, -1e15, 0}), VPL_SUCCESS);
    assert_int_equal(vplScene_SetOrigin(scene, (double[3]){0, 1.0001e15, 0}), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "origin[1] is 1.0001e+15, must be in [-1e+15, 1e+15]"));
    vplScene_GetOrigin(scene, origin);
    assert_true(origin[0] == 1e15 && origin[1] == -1e15 && origin[2] == 0);
    vplScene_Destroy(scene);
}

TEST(NumbersBeyondTheirRangeAreRefusedByName, 1)
{
    for (int i = 0; i < QUANTITY_COUNT; i++) {
        const Quantity* q = &QUANTITIES[i];
        const double bad[4] = {q->below, q->beyond, (double)NAN, (double)INFINITY};
        for (int k = 0; k < 4; k++) {
            vplScene* scene;
            assert_int_equal(tryValue(context, q, bad[k], &scene), VPL_INVALID_ARGUMENT);
            const char* message = takeMessage();
            if (strncmp(message, q->field, strlen(q->field)) != 0) {
                fail_msg("%s = %g: %s", q->field, bad[k], message);
            }
            vplScene_Destroy(scene);
        }
    }
}

TEST_ALONE(WorkersBeyondTheirRangeAreRefused)
{
    const int counts[] = {-1, 1025, INT_MAX, 1, 1024};
    for (int i = 0; i < 5; i++) {
        vplContextDef def = vplDefaultContextDef();
        vplContext* context = NULL;
        def.workerCount = counts[i];
        assert_int_equal(vplContext_Create(&def, &context), i < 3 ? VPL_INVALID_ARGUMENT : VPL_SUCCESS);
        assert_true((context == NULL) == (i < 3));
        assert_true(context == NULL || vplContext_GetWorkerCount(context) == counts[i]);
        vplContext_Destroy(context);
    }
}

// 2^15 + 1 copies of a mesh of 2^16 triangles are counted before memory is asked for.
TEST(MoreTrianglesThanAreAllowedAreRefused, 1)
{
    enum { TRIANGLES = 1 << 16, COPIES = (1 << 15) + 1 };
    static uint32_t indices[3 * TRIANGLES];
    const vplVec3 corners[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (int i = 0; i < 3 * TRIANGLES; i++) {
        indices[i] = (uint32_t)i % 3;
    }
    vplScene* scene = sceneOf(context, 0.5f);
    vplMeshDef mesh = vplDefaultMeshDef();
    mesh.positions = corners;
    mesh.indices = indices;
    mesh.vertexCount = 3;
    mesh.triangleCount = TRIANGLES;
    vplObjectDef object = vplDefaultObjectDef();
    object.type = VPL_OBJECT_MESH;
    assert_int_equal(vplScene_AddMesh(scene, &mesh, &object.mesh), VPL_SUCCESS);
    for (int i = 0; i < COPIES; i++) {
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    }
    vplGeometry* g = NULL;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_LIMIT);
    assert_non_null(
        strstr(takeMessage(), "the scene has 2147549184 triangles, at most 2147483647 are allowed"));
    assert_null(g);
    vplScene_Destroy(scene);
}

// The message names the index, and the vertex that is not there.
TEST(IndicesBeyondTheVerticesAreRefused, 1)
{
    const vplVec3 corners[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    vplScene* scene = sceneOf(context, 0.5f);
    for (int wrong = 0; wrong < 6; wrong++) {
        uint32_t indices[6] = {0, 1, 2, 0, 2, 1};
        char wanted[80];
        vplMeshDef mesh = vplDefaultMeshDef();
        indices[wrong] = wrong % 2 ? 3 : UINT32_MAX;
        mesh.positions = corners;
        mesh.indices = indices;
        mesh.vertexCount = 3;
        mesh.triangleCount = 2;
        snprintf(wanted, sizeof wanted, "indices[%d] is %u, must be less than the vertexCount 3", wrong,
                 indices[wrong]);
        assert_int_equal(vplScene_AddMesh(scene, &mesh, NULL), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), wanted));
    }
    vplScene_Destroy(scene);
}
