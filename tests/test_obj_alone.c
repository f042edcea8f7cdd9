// SPDX-License-Identifier: MIT
// Tests of OBJ files that are scenes by themselves: the camera that fits them, the ground and the lamps.
#include "obj_support.h"

#include "math/double3.h"

static const double MARGIN = 0.05; // of the picture's shorter side, as model_look.c has it

typedef struct Model {
    const char* text;
    double tolerance; // of places in the picture, where floats are coarse
} Model;

// clang-format off
#define CUBE(a, b)                                                                                           \
    "v " a " " a " " a "\nv " b " " a " " a "\nv " b " " b " " a "\nv " a " " b " " a "\n"                   \
    "v " a " " a " " b "\nv " b " " a " " b "\nv " b " " b " " b "\nv " a " " b " " b "\n"                   \
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n"

static const Model MODELS[] = {
    {"v -5 0 0\nv 5 0 0\nv 5 0.2 0.3\nv -5 0.2 0.3\nf 1 2 3 4\n", 1e-4}, // long and thin
    {"v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 4 3 2 1\n", 1e-4},       // flat, lies on the ground
    {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1e-4},
    {CUBE("-1e-3", "1e-3"), 1e-4},
    {CUBE("-1e6", "1e6"), 1e-4},
    {CUBE("9999", "10001"), 1e-2},
    {"v 0 -3 0\nv 0.1 8 0\nv 0 8 0.1\nf 1 2 3\n", 1e-4}, // stands on its point
};
// clang-format on

static const double ASPECTS[] = {1, 16.0 / 9, 9.0 / 16};

enum { MODEL_COUNT = sizeof MODELS / sizeof *MODELS, ASPECT_COUNT = 3 };

// ---- the picture

// The picture of a camera: unit axes, and slopes of its right and upper edge.
typedef struct Frame {
    double eye[3], axes[3][3], slopes[2]; // right, up, ahead
} Frame;

static void normalizeTo(const double a[3], double out[3])
{
    const double length = sqrt(vplDot3(a, a));
    for (int k = 0; k < 3; k++) {
        out[k] = a[k] / length;
    }
}

static Frame frameOf(const vplCameraDef* camera, double aspect)
{
    Frame f;
    double target[3], up[3], way[3], right[3];
    vplToDouble3(camera->eye, f.eye);
    vplToDouble3(camera->target, target);
    vplToDouble3(camera->up, up);
    for (int k = 0; k < 3; k++) {
        way[k] = target[k] - f.eye[k];
    }
    normalizeTo(way, f.axes[2]);
    vplCross3(f.axes[2], up, right);
    normalizeTo(right, f.axes[0]);
    vplCross3(f.axes[0], f.axes[2], f.axes[1]);
    f.slopes[1] = tan(0.5 * camera->fovY);
    f.slopes[0] = aspect * f.slopes[1];
    return f;
}

// Writes a point along the axes of the picture.
static void see(const Frame* f, const double p[3], double out[3])
{
    const double way[3] = {p[0] - f->eye[0], p[1] - f->eye[1], p[2] - f->eye[2]};
    for (int k = 0; k < 3; k++) {
        out[k] = vplDot3(way, f->axes[k]);
    }
}

static vplScene* load(Desk* d, const char* text, double aspect, bool ground)
{
    vplScene* scene = NULL;
    vplModelSceneDef def = vplDefaultModelSceneDef();
    def.aspect = aspect;
    def.ground = ground;
    openDesk(d);
    writeText(d->obj, text);
    if (vplScene_LoadFor(d->context, d->obj, &def, &scene) != VPL_SUCCESS) {
        fail_msg("%s%s", text, d->said);
    }
    return scene;
}

// Calls a check for every model and aspect, with a ground.
static void forAll(void check(const vplScene* scene, const Frame* frame, double tolerance))
{
    for (int i = 0; i < MODEL_COUNT * ASPECT_COUNT; i++) {
        Desk d;
        const Model* model = &MODELS[i / ASPECT_COUNT];
        const double aspect = ASPECTS[i % ASPECT_COUNT];
        vplScene* scene = load(&d, model->text, aspect, true);
        const Frame frame = frameOf(vplScene_GetCamera(scene, 0), aspect);
        check(scene, &frame, model->tolerance);
        vplScene_Destroy(scene);
        closeDesk(&d);
    }
}

// Asserts that all vertices are between near and far and inside the margin, and that in one direction they
// reach the margin on both sides.
static void assertTight(const vplScene* scene, const Frame* f, double tolerance)
{
    const vplMeshDef* mesh = vplScene_GetMesh(scene, 0);
    const vplCameraDef* camera = vplScene_GetCamera(scene, 0);
    double least[2] = {1, 1}, most[2] = {-1, -1};
    for (int i = 0; i < mesh->vertexCount; i++) {
        double p[3], at[3];
        vplToDouble3(mesh->positions[i], p);
        see(f, p, at);
        assert_true(at[2] > camera->nearPlane && at[2] < camera->farPlane);
        for (int k = 0; k < 2; k++) {
            const double inner = f->slopes[k] - 2 * MARGIN * fmin(f->slopes[0], f->slopes[1]);
            const double place = at[k] / (inner * at[2]);
            assert_true(fabs(place) <= 1 + tolerance);
            least[k] = fmin(least[k], place);
            most[k] = fmax(most[k], place);
        }
    }
    assert_true((least[0] <= -1 + tolerance && most[0] >= 1 - tolerance) ||
                (least[1] <= -1 + tolerance && most[1] >= 1 - tolerance));
    assert_true(camera->farPlane < 100 * camera->nearPlane);
}

TEST_ALONE(TheCameraFitsTheVerticesExactly)
{
    forAll(assertTight);
}

// A needle that points at the eye would otherwise be fitted by a camera at its tip.
TEST_ALONE(ANeedleThatPointsAtTheCameraIsSeen)
{
    Desk d;
    vplScene* scene = load(&d, "v 42 38 90\nv -42 -38 -90\nv -42.001 -38 -90\nf 1 2 3\n", 1, false);
    const vplCameraDef* camera = vplScene_GetCamera(scene, 0);
    const Frame f = frameOf(camera, 1);
    double at[3];
    see(&f, (double[3]){42, 38, 90}, at);
    assert_true(at[2] > 10 && at[2] > camera->nearPlane && camera->farPlane < 100 * camera->nearPlane);
    vplScene_Destroy(scene);
    closeDesk(&d);
}

// ---- the ground

static const vplObjectDef* find(const vplScene* scene, const char* name)
{
    for (int i = 0; i < vplScene_GetObjectCount(scene); i++) {
        if (strcmp(vplScene_GetObject(scene, i)->name, name) == 0) {
            return vplScene_GetObject(scene, i);
        }
    }
    return NULL;
}

// Column k of a transform.
static void column(const vplObjectDef* object, int k, double out[3])
{
    const float* m = object->transform.m + 4 * k;
    vplToDouble3(vplVec(m[0], m[1], m[2]), out);
}

// Asserts that the ground is below the lowest vertex by no more than a thousandth of the size, and that the
// corners of the picture show ground.
static void assertGrounded(const vplScene* scene, const Frame* f, double tolerance)
{
    const vplMeshDef* mesh = vplScene_GetMesh(scene, 0);
    const vplObjectDef* ground = find(scene, "ground");
    const vplCameraDef* camera = vplScene_GetCamera(scene, 0);
    double lowest = INFINITY, size = 0, centre[3], front[3];
    for (int i = 0; i < mesh->vertexCount; i++) { // gcc 12 for aarch64 fails to compile fmin and fmax here
        const double y = (double)mesh->positions[i].y;
        const double far = (double)vplLength(vplSub(mesh->positions[i], mesh->positions[0]));
        lowest = y < lowest ? y : lowest;
        size = far > size ? far : size;
    }
    column(ground, 2, front);
    column(ground, 3, centre);
    assert_true(centre[1] < lowest && centre[1] > lowest - tolerance * size - 1e-3 * size);
    assert_true(front[0] == 0 && front[1] == 1 && front[2] == 0);
    assertColour(vplScene_GetMaterial(scene, ground->material)->diffuse, 0.3f, 0.3f, 0.3f);
    for (int corner = 0; corner < 4; corner++) {
        double way[3], p[3];
        for (int k = 0; k < 3; k++) {
            way[k] = f->axes[2][k] + (corner & 1 ? 1 : -1) * f->slopes[0] * f->axes[0][k] +
                     (corner & 2 ? 1 : -1) * f->slopes[1] * f->axes[1][k];
        }
        assert_true(way[1] < 0); // no horizon in the picture
        const double depth = (centre[1] - f->eye[1]) / way[1];
        assert_true(depth > camera->nearPlane && depth < camera->farPlane);
        for (int k = 0; k < 3; k++) {
            p[k] = f->eye[k] + depth * way[k] - centre[k];
        }
        for (int k = 0; k < 2; k++) {
            double side[3];
            column(ground, k, side);
            assert_true(fabs(vplDot3(p, side)) < 0.5 * vplDot3(side, side));
        }
    }
}

TEST_ALONE(TheGroundTouchesTheMeshAndFillsThePicture)
{
    forAll(assertGrounded);
}

TEST_ALONE(NoGroundIsAddedIfNoneIsWanted)
{
    Desk d;
    vplScene* scene = load(&d, MODELS[2].text, 1, false);
    assert_null(find(scene, "ground"));
    assert_int_equal(countOf(d.said, "ground"), 0);
    vplScene_Destroy(scene);
    closeDesk(&d);
}

// ---- the lamps

// Asserts that the lamps are above the upper edge of the picture, face the mesh, and that the key lamp lights
// the side that the camera sees with the irradiance pi.
static void assertLit(const vplScene* scene, const Frame* f, double tolerance)
{
    (void)tolerance;
    static const char* const names[] = {"key lamp", "fill lamp"};
    double middle[3] = {0, 0, 0};
    const vplMeshDef* mesh = vplScene_GetMesh(scene, 0);
    vplVec3 low = mesh->positions[0], high = low;
    for (int i = 0; i < mesh->vertexCount; i++) {
        const vplVec3 p = mesh->positions[i];
        low = vplVec(fminf(low.x, p.x), fminf(low.y, p.y), fminf(low.z, p.z));
        high = vplVec(fmaxf(high.x, p.x), fmaxf(high.y, p.y), fmaxf(high.z, p.z));
    }
    vplToDouble3(vplAdd(vplScale(0.5f, low), vplScale(0.5f, high)), middle);
    for (int i = 0; i < 2; i++) {
        const vplObjectDef* lamp = find(scene, names[i]);
        const vplMaterialDef* material = vplScene_GetMaterial(scene, lamp->material);
        double x[3], y[3], front[3], at[3], to[3], eye[3];
        column(lamp, 0, x);
        column(lamp, 1, y);
        column(lamp, 2, front);
        column(lamp, 3, at);
        for (int corner = 0; corner < 4; corner++) {
            double p[3], seen[3];
            for (int k = 0; k < 3; k++) {
                p[k] = at[k] + (corner & 1 ? 0.5 : -0.5) * x[k] + (corner & 2 ? 0.5 : -0.5) * y[k];
            }
            see(f, p, seen);
            assert_true(seen[1] > f->slopes[1] * seen[2]);
        }
        for (int k = 0; k < 3; k++) {
            to[k] = middle[k] - at[k];
            eye[k] = middle[k] - f->eye[k];
        }
        const double distance = sqrt(vplDot3(to, to)), area = sqrt(vplDot3(x, x) * vplDot3(y, y));
        const double irradiance = (double)material->emission.r * area / (distance * distance);
        assert_true(vplDot3(front, to) > 0.999 * distance);
        assert_true(vplDot3(to, eye) > 0);
        assertColour(material->diffuse, 0, 0, 0);
        assert_true(i == 0 ? fabs(irradiance - VPL_PI) < 1e-2 : irradiance < 0.1 * VPL_PI);
    }
}

TEST_ALONE(TheLampsAreOutsideThePictureAndLightTheMesh)
{
    forAll(assertLit);
}

TEST_ALONE(APointLightStandsInPlaceOfTheLampsIfWanted)
{
    Desk d;
    vplScene* scene = NULL;
    vplModelSceneDef def = vplDefaultModelSceneDef();
    def.areaLight = false;
    openDesk(&d);
    writeText(d.obj, MODELS[2].text);
    assert_int_equal(vplScene_LoadFor(d.context, d.obj, &def, &scene), VPL_SUCCESS);
    assert_int_equal(countOf(d.said, "nothing emits light; a point light of "), 1);
    assert_int_equal(vplScene_GetEmitterCount(scene), 1);
    assert_null(find(scene, "key lamp"));
    vplScene_Destroy(scene);
    closeDesk(&d);
}

TEST_ALONE(EveryMethodLightsAnObjAlone)
{
    for (vplMethod method = 0; method <= VPL_METHOD_PATH; method++) {
        Desk d;
        vplImage* image = NULL;
        vplScene* scene = load(&d, MODELS[2].text, 1, true);
        vplRenderOptions options = plainOptions();
        options.method = method;
        options.output.width = options.output.height = 16;
        options.radiosity.patches = 100;
        assert_int_equal(vplRender(scene, &options, &image, NULL), VPL_SUCCESS);
        double sum = 0;
        for (int i = 0; i < 3 * 16 * 16; i++) {
            sum += (double)image->pixels[i];
        }
        assert_in_range((int)(100 * sum / (3 * 16 * 16)), 10, 60);
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
        closeDesk(&d);
    }
}

// ---- the def

TEST_ALONE(ABadObjSceneDefIsRefused)
{
    static const double aspects[] = {0, -1, 1e-7, 1e7, NAN, INFINITY};
    vplModelSceneDef def = vplDefaultModelSceneDef();
    vplScene* scene = NULL;
    Desk d;
    openDesk(&d);
    writeText(d.obj, MODELS[2].text);
    for (int i = 0; i < 6; i++) {
        def.aspect = aspects[i];
        assert_int_equal(vplScene_LoadFor(d.context, d.obj, &def, &scene), VPL_INVALID_ARGUMENT);
    }
    assert_int_equal(countOf(d.said, "vplModelSceneDef.aspect is "), 6);
    def.aspect = 1;
    def.cookie = 0;
    assert_int_equal(vplScene_LoadFor(d.context, d.obj, &def, &scene), VPL_INVALID_ARGUMENT);
    assert_int_equal(countOf(d.said, "vplModelSceneDef was not made by its default function"), 1);
    assert_null(scene);
    closeDesk(&d);
}
