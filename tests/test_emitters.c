// SPDX-License-Identifier: MIT
// Spots, parallel light and lamps against formulas; the shadows of virtual lights; smooth surfaces; particles of
// all of them.
#include "shapes.h"

#include "geometry/emission.h"
#include "math/vec.h"

static uint64_t renderHash(const vplScene* scene, const vplRenderOptions* options)
{
    vplImage* image = renderScene(scene, options, NULL);
    uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    return hash;
}

// Looks straight down; `half` is the tangent of half the angle of view.
static void lookDown(vplScene* scene, float height, double half)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, height, 0);
    camera.target = vplVec(0, 0, 0);
    camera.up = vplVec(0, 0, -1);
    camera.fovY = 2 * atan(half);
    camera.near = 0.05;
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
}

// The floor point that a pixel of a square picture sees from above.
static void floorPoint(int pixel, int size, double height, double half, double* x, double* z)
{
    *x = (2 * (pixel % size + 0.5) / size - 1) * half * height;
    *z = (2 * (pixel / size + 0.5) / size - 1) * half * height;
}

// A quad that looks up (or down), of the scene's material `material`.
static void addLevel(vplScene* scene, vplVec3 centre, float size, bool down, int material)
{
    vplObjectDef object = vplDefaultObjectDef();
    object.material = material;
    object.transform =
        vplMat4_FromParts(centre, (double[3]){(down ? 1 : -1) * VPL_PI / 2, 0, 0}, vplVec(size, size, 1));
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
}

static int addGlow(vplScene* scene, vplRgb emission, float rho)
{
    vplMaterialDef material = vplDefaultMaterialDef();
    int index;
    material.emission = emission;
    material.diffuse = (vplRgb){rho, rho, rho};
    assert_int_equal(vplScene_AddMaterial(scene, &material, &index), VPL_SUCCESS);
    return index;
}

static void addColoured(vplScene* scene, vplEmitterType type, vplVec3 position, vplVec3 direction,
                        float intensity)
{
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.type = type;
    emitter.position = position;
    emitter.direction = direction;
    emitter.intensity = (vplRgb){intensity, 0.5f * intensity, 0.75f * intensity};
    assert_int_equal(vplScene_AddEmitter(scene, &emitter, NULL), VPL_SUCCESS);
}

// rho/pi E: E = I cos / d^2 times 3x^2 - 2x^3 of the cosine's way between the angles, or the irradiance times cos.
TEST(SpotAndSunAreAnalytic, 1)
{
    enum { SIZE = 64 };
    for (int which = 0; which < 4; which++) { // spot and sun, by maps and by rays
        const bool sun = which & 1;
        vplScene* scene = sceneOf(context, 0.5f);
        addLevel(scene, vplVec(0, 0, 0), 10, false, 0);
        lookDown(scene, 4, 0.3);
        const vplVec3 d = {0.1f, -1, 0.05f}, p = {0.3f, 2, -0.25f};
        addColoured(scene, sun ? VPL_EMITTER_DIRECTIONAL : VPL_EMITTER_SPOT, p, d, 3);
        vplRenderOptions o = vplDefaultRenderOptions();
        o.method = VPL_METHOD_DIRECT;
        o.output.width = o.output.height = SIZE;
        o.shadow.mapSize = 64;
        o.lights.shadows = which & 2 ? VPL_LIGHT_SHADOWS_RAY : VPL_LIGHT_SHADOWS_NONE;
        vplImage* image = renderScene(scene, &o, NULL);
        const double inner = cos(20 * VPL_PI / 180), outer = cos(30 * VPL_PI / 180), length = sqrt(1.0125);
        int seen[3] = {0};
        for (int i = 0; i < SIZE * SIZE; i++) {
            double x, z;
            floorPoint(i, SIZE, 4, 0.3, &x, &z);
            x -= (double)p.x;
            z -= (double)p.z;
            const double d2 = x * x + 4 + z * z;
            const double axis = ((double)d.x * x + 2 + (double)d.z * z) / length / sqrt(d2);
            const double way = (axis - outer) / (inner - outer);
            const double step = way <= 0 ? 0 : way >= 1 ? 1 : way * way * (3 - 2 * way);
            double wanted = 0.5 / VPL_PI * 3 * (sun ? 1 / length : step * 2 / sqrt(d2) / d2);
            seen[way <= 0 ? 0 : way >= 1 ? 1 : 2]++;
            assertNear((double)image->pixels[3 * i], wanted, 1e-6, "red", i);
            assertNear((double)image->pixels[3 * i + 1], wanted / 2, 1e-6, "green", i);
            assert_true(sun || way > -1e-6 || image->pixels[3 * i] == 0);
        }
        assert_true(seen[0] > 100 && seen[1] > 100 && seen[2] > 100);
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
    }
}

// From a point to the rectangle [0, a] x [0, b] in a plane parallel to it at distance 1, the point below a corner.
// Source: Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3.
static double cornerFactor(double a, double b)
{
    const double p = sqrt(1 + a * a), q = sqrt(1 + b * b);
    return (a / p * atan(b / p) + b / q * atan(a / q)) / (2 * VPL_PI);
}

// A lamp of 1 x 1 m, 1 m above the floor: the radiance of the floor is rho L F.
TEST(LampLightsConvergeToTheFormFactor, 1)
{
    enum { SIZE = 8 };
    // Largest relative error below the lamp and 0.1 m around; it falls as 1 / count.
    const struct {
        int count;
        double error;
    } cases[] = {{1, 1.42}, {16, 0.18}, {64, 0.063}, {1024, 0.0061}};
    vplScene* scene = sceneOf(context, 0.5f);
    addLevel(scene, vplVec(0, 0, 0), 10, false, 0);
    addLevel(scene, vplVec(0, 1, 0), 1, true, addGlow(scene, (vplRgb){4, 4, 4}, 0));
    lookDown(scene, 0.5f, 1.2);
    for (int n = 0; n < 4; n++) {
        vplRenderOptions o = vplDefaultRenderOptions();
        o.method = VPL_METHOD_DIRECT;
        o.output.width = o.output.height = SIZE;
        o.lights.areaLightSamples = cases[n].count;
        vplImage* image = renderScene(scene, &o, NULL);
        double worst = 0;
        for (int i = 0; i < SIZE * SIZE; i++) {
            double x, z, factor = 0;
            floorPoint(i, SIZE, 0.5, 1.2, &x, &z);
            for (int corner = 0; corner < 4; corner++) { // four rectangles with a corner above the point
                double a = 0.5 + (corner & 1 ? x : -x), b = 0.5 + (corner & 2 ? z : -z);
                factor += copysign(1, a) * copysign(1, b) * cornerFactor(fabs(a), fabs(b));
            }
            worst = fmax(worst, fabs((double)image->pixels[3 * i] / (0.5 * 4 * factor) - 1));
        }
        assert_true(worst < cases[n].error);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
}

// Indirect light of the room: maps of 512 x 512 texels (as many as 6 of 209 x 209) are 0.1 % of it off, where shadows
// stop 10 %.
TEST(RayAndMapShadowsAgree, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = vplDefaultRenderOptions();
    o.output.width = 64;
    o.output.height = 48;
    o.particles.count = 8;
    o.output.show = VPL_SHOW_INDIRECT;
    vplImage* none = renderScene(scene, &o, NULL);
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    vplImage* rays = renderScene(scene, &o, NULL);
    o.lights.shadows = VPL_LIGHT_SHADOWS_MAP;
    o.lights.mapSize = 512;
    vplImage* maps = renderScene(scene, &o, NULL);
    double sum = 0, apart = 0, stopped = 0;
    for (int i = 0; i < 3 * o.output.width * o.output.height; i++) {
        sum += (double)rays->pixels[i];
        apart += fabs((double)rays->pixels[i] - (double)maps->pixels[i]);
        stopped += (double)none->pixels[i] - (double)rays->pixels[i];
        assert_true(rays->pixels[i] <= none->pixels[i] && maps->pixels[i] <= none->pixels[i]);
    }
    printf("# %g %g\n", apart / sum, stopped / sum);
    assert_true(apart < 0.002 * sum && stopped > 0.05 * sum);
    vplImage_Destroy(none);
    vplImage_Destroy(rays);
    vplImage_Destroy(maps);
    vplScene_Destroy(scene);
}

// ---- stages with lights given by hand

enum { VIEW = 48 };

// A picture of `geometry` from its scene's camera, by one virtual light with shadows by rays or a map.
static vplImage* shadeOne(const vplGeometry* g, const vplView* view, const vplShadeLight* light, bool map)
{
    vplShadeDef def = {
        .lighting = VPL_LIGHTING_PHYSICAL, .accumulation = VPL_ACCUMULATE_DEFERRED, .batch = 1};
    vplHemiMaps* maps = NULL;
    if (map) {
        const vplHemiMapPlace place = {{light->px, light->py, light->pz}, {light->nx, light->ny, light->nz}};
        assert_int_equal(vplHemiMaps_Create(g->context, 256, 1, &maps), VPL_SUCCESS);
        assert_int_equal(vplHemiMaps_Draw(maps, g, &place, 1, NULL, NULL), VPL_SUCCESS);
    }
    def.lights = light;
    def.lightCount = 1;
    def.lightRays = !map;
    def.lightShadows = map ? maps->maps : NULL;
    vplImage* image;
    assert_int_equal(vplImage_Create(g->context, view->width, view->height, &image), VPL_SUCCESS);
    if (vplShadeView(g, view, &def, NULL, NULL, image, NULL) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    vplHemiMaps_Destroy(maps);
    return image;
}

enum { BY_POINT, BY_SPOT, BY_SUN, BY_LAMP, BY_VIRTUAL_LIGHT, LIGHT_KINDS };

// Direct light of one source, above or wherever `place` is, shining towards `aim`; or of one virtual light there.
static vplImage* shadeBy(int kind, vplContext* context, const Shape* shape, bool smooth, float blocker,
                         const vplCameraDef* camera, vplVec3 place, vplVec3 aim, bool map)
{
    const vplVec3 d = vplNormalize(vplSub(aim, place));
    vplScene* scene = sceneOf(context, 0.5f);
    assert_int_equal(vplScene_AddCamera(scene, camera, NULL), VPL_SUCCESS);
    if (shape != NULL) {
        addShape(scene, shape, smooth, NULL);
    } else {
        addLevel(scene, vplVec(0, 0, 0), 10, false, 0);
    }
    if (blocker > 0) {
        addLevel(scene, vplVec(0, 1, 0), blocker, false, 0);
    }
    vplImage* image;
    if (kind == BY_VIRTUAL_LIGHT) {
        vplGeometry* g = freezeScene(scene);
        const vplView view = vplView_Create(camera, VIEW, VIEW);
        const vplShadeLight light = {place.x, place.y, place.z, d.x, d.y, d.z, 1, 2, 3};
        image = shadeOne(g, &view, &light, map);
        vplGeometry_Destroy(g);
        return image;
    }
    if (kind == BY_LAMP) { // so small that one light stands for it
        Shape lamp = {0};
        vplVec3 t, b;
        vplFrame(d, &t, &b);
        addTriangle(&lamp, vplAdd(place, vplScale(-1e-4f, t)), vplAdd(place, vplScale(1e-4f, t)),
                    vplAdd(place, vplScale(1e-4f, b)));
        vplMeshDef mesh = vplDefaultMeshDef();
        vplObjectDef object = vplDefaultObjectDef();
        mesh.positions = lamp.corners;
        mesh.indices = (const uint32_t[]){0, 1, 2};
        mesh.vertexCount = 3;
        mesh.triangleCount = 1;
        object.type = VPL_OBJECT_MESH;
        object.material = addGlow(scene, (vplRgb){1e8f, 1e8f, 1e8f}, 0);
        assert_int_equal(vplScene_AddMesh(scene, &mesh, &object.mesh), VPL_SUCCESS);
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
        freeShape(&lamp);
    } else {
        addColoured(scene, (vplEmitterType)kind, place, d, 2);
    }
    vplRenderOptions o = vplDefaultRenderOptions();
    o.method = VPL_METHOD_DIRECT;
    o.output.width = o.output.height = VIEW;
    o.shadow.mapSize = 256;
    o.shadow.pcfSamples = 1;
    o.lights.areaLightSamples = 1;
    o.lights.shadows = map ? VPL_LIGHT_SHADOWS_MAP : VPL_LIGHT_SHADOWS_RAY;
    image = renderScene(scene, &o, NULL);
    vplScene_Destroy(scene);
    return image;
}

// A square of 1 m halfway between the light and the floor: nothing in its shadow, the unshadowed bits beside it.
TEST(RayShadowsAreExact, 1)
{
    vplCameraDef camera = vplDefaultCameraDef();
    const double height = 0.9, half = 1.7;
    camera.eye = vplVec(0, (float)height, 0);
    camera.up = vplVec(0, 0, -1);
    camera.fovY = 2 * atan(half);
    for (int kind = 0; kind < LIGHT_KINDS; kind++) {
        const vplVec3 place = {0.1f, 2, -0.05f}, aim = {0.1f, 0, -0.05f};
        vplImage* with = shadeBy(kind, context, NULL, false, 1, &camera, place, aim, false);
        vplImage* without = shadeBy(kind, context, NULL, false, 0, &camera, place, aim, false);
        int dark = 0, lit = 0;
        for (int i = 0; i < VIEW * VIEW; i++) {
            double x, z;
            floorPoint(i, VIEW, (double)camera.eye.y, half, &x, &z);
            const double share = kind == BY_SUN ? 0 : 0.5; // of the way to the light, where the square is
            const double across =
                fmax(fabs(x + share * ((double)place.x - x)), fabs(z + share * ((double)place.z - z)));
            if (across < 0.5 - 1e-3) {
                assert_true(with->pixels[3 * i] == 0 && with->pixels[3 * i + 2] == 0);
                dark += without->pixels[3 * i] > 0;
            } else if (across > 0.5 + 1e-3) {
                assert_memory_equal(&with->pixels[3 * i], &without->pixels[3 * i], 3 * sizeof(float));
                lit += with->pixels[3 * i] > 0;
            }
        }
        assert_true(dark > 100 && lit > 100);
        vplImage_Destroy(with);
        vplImage_Destroy(without);
    }
}

// ---- smooth surfaces

// Light is received with the interpolated normal, but from the triangle's own side only, by every kind of light.
TEST(SmoothTrianglesAreDarkFromBehind, 1)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.up = vplVec(0, 0, -1);
    // In the plane y = 0, around (0, 0, 0.1); as its own normals the corners point up to 80 degrees away.
    Shape shape = {0};
    addTriangle(&shape, vplVec(-1, 0.2f, -1), vplVec(0, 0.2f, 1), vplVec(1, 0.2f, -1));
    for (int below = 0; below < 2; below++) {
        camera.eye = vplVec(0, below ? -3 : 3, 0);
        for (int kind = 0; kind < LIGHT_KINDS; kind++) {
            for (int map = 0; map < 2; map++) {
                for (int behind = 0; behind < 2; behind++) {
                    // 0.15 m off the plane: seen by normals that lean towards it, also where it is behind
                    const float side = (below != behind) ? 0.05f : 0.35f;
                    const vplVec3 place = {1.5f, side, -1}, aim = {0, 0.2f, -0.2f};
                    vplImage* image = shadeBy(kind, context, &shape, true, 0, &camera, place, aim, map);
                    int lit = 0;
                    for (int i = 0; i < VIEW * VIEW; i++) {
                        lit += image->pixels[3 * i] > 0;
                    }
                    if (behind ? lit > 0 : lit < 20) {
                        fail_msg("kind %d%s, camera %s, light %s: %d pixels are lit", kind,
                                 map ? " by map" : " by rays", below ? "below" : "above",
                                 behind ? "behind" : "in front", lit);
                    }
                    vplImage_Destroy(image);
                }
            }
        }
    }
    freeShape(&shape);
}

// A roof of two triangles that share their ridge, and normals there. Across it the light goes on as it goes on
// beside it; without normals it jumps.
TEST(SmoothMeshesShadeWithoutSeams, 1)
{
    const vplVec3 corners[4] = {{0, 0, -1}, {0, 0, 1}, {-1, -0.3f, 0}, {1, -0.3f, 0}};
    const vplVec3 normals[4] = {{0, 1, 0}, {0, 1, 0}, {-0.3f, 1, 0}, {0.3f, 1, 0}};
    double jump[2];
    for (int smooth = 0; smooth < 2; smooth++) {
        vplScene* scene = sceneOf(context, 0.5f);
        vplMeshDef mesh = vplDefaultMeshDef();
        vplObjectDef object = vplDefaultObjectDef();
        mesh.positions = corners;
        mesh.normals = smooth ? normals : NULL;
        mesh.indices = (const uint32_t[]){0, 2, 1, 0, 1, 3};
        mesh.vertexCount = 4;
        mesh.triangleCount = 2;
        object.type = VPL_OBJECT_MESH;
        assert_int_equal(vplScene_AddMesh(scene, &mesh, &object.mesh), VPL_SUCCESS);
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
        lookDown(scene, 3, 0.1);
        addColoured(scene, VPL_EMITTER_POINT, vplVec(1, 2, 0), vplVec(0, -1, 0), 10);
        vplRenderOptions o = vplDefaultRenderOptions();
        o.method = VPL_METHOD_DIRECT;
        o.output.width = o.output.height = VIEW;
        o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
        vplImage* image = renderScene(scene, &o, NULL);
        double across = 0, beside = 0;
        for (int row = 0; row < VIEW; row++) {
            const float* p = image->pixels + 3 * (row * VIEW + VIEW / 2);
            across = fmax(across, fabs((double)p[0] - (double)p[-3]));
            beside =
                fmax(beside, fmax(fabs((double)p[-3] - (double)p[-6]), fabs((double)p[3] - (double)p[0])));
        }
        jump[smooth] = across / beside;
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
    }
    assert_true(jump[1] < 1.05 && jump[0] > 20);
}

// ---- all kinds of emitters at once

// A room with a smooth ball, a box that glows, a spot, the sun and a point; all light multiplied by `factor`.
static vplScene* zoo(vplContext* context, float factor)
{
    vplScene* scene = sceneOf(context, 0.6f);
    const int lamp = addGlow(scene, (vplRgb){2 * factor, 3 * factor, factor}, 0.25f);
    addLevel(scene, vplVec(0, 0, 0), 4, false, 0);
    addLevel(scene, vplVec(0.5f, 2, 0.1f), 0.5f, true, lamp);
    vplObjectDef object = vplDefaultObjectDef();
    object.transform = vplMat4_FromParts(vplVec(0, 1, -1), (double[3]){0.1, 0.2, 0}, vplVec(4, 3, 1));
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    object.type = VPL_OBJECT_BOX;
    object.material = lamp;
    object.transform =
        vplMat4_FromParts(vplVec(-1, 0.5f, 0.3f), (double[3]){0.3, 0.4, 0.5}, vplVec(0.4f, 0.3f, 0.5f));
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    Shape ball = icosphere(1);
    const vplMat4 place =
        vplMat4_FromParts(vplVec(0.5f, 0.6f, 0.2f), (double[3]){0, 0, 0}, vplVec(0.5f, 0.4f, 0.5f));
    addShape(scene, &ball, true, &place);
    freeShape(&ball);
    addColoured(scene, VPL_EMITTER_POINT, vplVec(-0.5f, 1.5f, 0.5f), vplVec(0, -1, 0), 2 * factor);
    addColoured(scene, VPL_EMITTER_SPOT, vplVec(0.5f, 2.5f, 1), vplVec(0, -2, -0.7f), 5 * factor);
    addColoured(scene, VPL_EMITTER_DIRECTIONAL, vplVec(0, 0, 0), vplVec(-0.3f, -1, -0.4f), factor);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, 1.5f, 4);
    camera.target = vplVec(0, 0.7f, 0);
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
    return scene;
}

static vplRenderOptions zooOptions(int shadows)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    o.output.width = 35;
    o.output.height = 25;
    o.particles.count = 36; // about 70 lights, more than a group of them
    o.lights.areaLightSamples = 9;
    o.shadow.mapSize = 32;
    o.lights.mapSize = 8;
    o.lights.shadows = (vplLightShadows)shadows;
    return o;
}

static void checkAccumulations(vplContext* context, int shadows, uint64_t wanted)
{
    vplScene* scene = zoo(context, 1);
    vplRenderOptions o = zooOptions(shadows);
    for (int way = VPL_ACCUMULATE_MULTIPASS; way <= VPL_ACCUMULATE_DEFERRED; way++) {
        o.pipeline.kind = (vplAccumulation)way;
        o.pipeline.batch = 13;
        assert_true(renderHash(scene, &o) == wanted);
    }
    vplScene_Destroy(scene);
    closeTestContext(context);
}

TEST_ALONE(AccumulationsAgreeWithEveryShadow, SLOW)
{
    static const int workers[] = {1, 2, 3, 7};
    uint64_t hashes[1 + VPL_LIGHT_SHADOWS_RAY];
    for (int shadows = VPL_LIGHT_SHADOWS_NONE; shadows <= VPL_LIGHT_SHADOWS_RAY; shadows++) {
        vplContext* context = openTestContext(1);
        vplScene* scene = zoo(context, 1);
        vplRenderOptions o = zooOptions(shadows);
        hashes[shadows] = renderHash(scene, &o);
        vplScene_Destroy(scene);
        closeTestContext(context);
        for (int i = 0; i < 4; i++) {
            checkAccumulations(openTestContext(workers[i]), shadows, hashes[shadows]);
        }
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            context = openIsaContext(2, (vplIsa)isa);
            if (context != NULL) {
                checkAccumulations(context, shadows, hashes[shadows]);
            }
        }
    }
    assert_true(hashes[1] != hashes[2] && hashes[2] != hashes[3] && hashes[1] != hashes[3]);
}

TEST(DoublingEmittersDoublesEveryBit, 2)
{
    for (int shadows = 0; shadows < 3; shadows++) {
        vplScene *one = zoo(context, 1), *two = zoo(context, 2), *small = zoo(context, 0x1p-40f);
        const vplRenderOptions o = zooOptions(shadows);
        vplImage *a = renderScene(one, &o, NULL), *b = renderScene(two, &o, NULL),
                 *c = renderScene(small, &o, NULL);
        int lit = 0;
        for (int i = 0; i < 3 * o.output.width * o.output.height; i++) {
            assert_true(b->pixels[i] == 2 * a->pixels[i] && c->pixels[i] == 0x1p-40f * a->pixels[i]);
            lit += a->pixels[i] > 0;
        }
        assert_true(lit > 1000);
        vplImage_Destroy(a);
        vplImage_Destroy(b);
        vplImage_Destroy(c);
        vplScene_Destroy(one);
        vplScene_Destroy(two);
        vplScene_Destroy(small);
    }
}

TEST(DocumentedLightingRefusesOtherEmitters, 1)
{
    for (int type = VPL_EMITTER_SPOT; type <= VPL_EMITTER_DIRECTIONAL; type++) {
        vplScene* scene = sceneOf(context, 0.5f);
        addLevel(scene, vplVec(0, 0, 0), 10, false, 0);
        lookDown(scene, 4, 0.3);
        addColoured(scene, VPL_EMITTER_POINT, vplVec(0, 2, 0), vplVec(0, -1, 0), 1);
        addColoured(scene, (vplEmitterType)type, vplVec(0, 2, 0), vplVec(0, -1, 0), 1);
        vplRenderOptions o = zooOptions(0);
        for (int direct = 0; direct < 2; direct++) {
            vplImage* image = NULL;
            o.method = direct ? VPL_METHOD_DIRECT : VPL_METHOD_INSTANT_RADIOSITY;
            o.lighting = VPL_LIGHTING_DOCUMENTED;
            assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT);
            assert_null(image);
            assert_string_equal(takeMessage(),
                                "light 1 is not a point light, and documented lighting knows no "
                                "others; use physical");
            o.lighting = VPL_LIGHTING_PHYSICAL;
            vplImage_Destroy(renderScene(scene, &o, NULL));
        }
        vplScene_Destroy(scene);
    }
}

// ---- particles

static vplLightSet* simulate(const vplGeometry* g, int particles, vplParticleGeometry geometry)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = particles;
    def.geometry = geometry;
    vplLightSet* set;
    if (vplSimulateParticles(g, NULL, 0, &def, &set) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return set;
}

// A closed cube of 2 m, reflectance 0.5, with lamps of one or two colours in it, turned any way.
static vplScene* lampCube(vplContext* context, int lamps, float rho)
{
    vplScene* scene = sceneOf(context, rho);
    vplObjectDef object = vplDefaultObjectDef();
    object.type = VPL_OBJECT_BOX;
    object.transform = vplMat4_FromParts(vplVec(0, 0, 0), (double[3]){0.2, 0.1, 0.3}, vplVec(2, 2, 2));
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    for (int i = 0; i < lamps; i++) {
        object.type = i == 0 ? VPL_OBJECT_QUAD : VPL_OBJECT_BOX;
        object.material = addGlow(scene, i == 0 ? (vplRgb){8, 1, 0.5f} : (vplRgb){0, 1, 3}, rho);
        object.transform = vplMat4_FromParts(vplVec(0.3f * (float)(2 * i - 1), 0.2f, 0.1f),
                                             (double[3]){0.5, 0.6, 0.7 + i}, vplVec(0.4f, 0.3f, 0.2f));
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    }
    return scene;
}

// All that lamps send out reaches a wall, and rho of it goes on: of the flux of the lights of step 0 the mean of
// the channels is exact for every single particle, the colour within what N choices of a source leave open.
TEST(LampsShootTheirPower, 2)
{
    enum { N = 20000 };
    for (int lamps = 1; lamps <= 2; lamps++) {
        vplGeometry* g = freezeScene(lampCube(context, lamps, 0.5f));
        vplEmission* emission;
        assert_int_equal(vplEmission_Create(g, NULL, 0, &emission), VPL_SUCCESS);
        const double power = vplEmission_Power(emission);
        double wanted[3] = {0}, sums[3] = {0}, first = 0;
        for (int i = 0; i < emission->sourceCount; i++) {
            const vplEmissionSource* s = &emission->sources[i];
            wanted[0] += (double)s->power.r;
            wanted[1] += (double)s->power.g;
            wanted[2] += (double)s->power.b;
            const bool red = s->power.r > s->power.b;
            first += red ? ((double)s->power.r + (double)s->power.g + (double)s->power.b) / 3 / power : 0;
        }
        vplLightSet* set = simulate(g, N, VPL_PARTICLE_GEOMETRY_EXACT);
        assert_int_equal(set->escaped, 0);
        assert_int_equal(set->lightsInStep[0], N);
        for (int i = 0; i < N; i++) {
            const vplVirtualLight* l = &set->lights[i];
            const double mean = ((double)l->light.r + (double)l->light.g + (double)l->light.b) / 3;
            assertNear(mean, 0.5 * power, 1e-6 * power, "flux", i);
            sums[0] += (double)l->light.r * (double)l->weight / N;
            sums[1] += (double)l->light.g * (double)l->weight / N;
            sums[2] += (double)l->light.b * (double)l->weight / N;
        }
        const double sigma =
            sqrt(fmax(first * (1 - first), 0) / N); // of the share of the first lamp's colour
        for (int c = 0; c < 3; c++) {
            assertNear(sums[c], 0.5 * wanted[c], (1e-5 + 4 * sigma) * 3 * power, "power", c);
        }
        vplLightSet_Destroy(set);
        vplEmission_Destroy(emission);
        vplGeometry_Destroy(g);
    }
}

// Where all objects are boxes and quads, they are their own bounding boxes.
TEST(BoxesInsteadOfBoxesGiveTheSameLights, 2)
{
    vplGeometry* g = freezeScene(lampCube(context, 2, 0.5f));
    vplLightSet* exact = simulate(g, 5000, VPL_PARTICLE_GEOMETRY_EXACT);
    vplLightSet* boxes = simulate(g, 5000, VPL_PARTICLE_GEOMETRY_OBB);
    assert_int_equal(exact->lightCount, boxes->lightCount);
    assert_int_equal(exact->escaped, boxes->escaped);
    for (int i = 0; i < exact->lightCount; i++) {
        const vplVirtualLight *a = &exact->lights[i], *b = &boxes->lights[i];
        if (a->object != b->object || memcmp(&a->position, &b->position, sizeof a->position) != 0) {
            fail_msg("light %d of step %d, particle %d: on object %d, with boxes on %d", i, a->step,
                     a->particle, a->object, b->object);
        }
        assert_memory_equal(&a->normal, &b->normal, sizeof a->normal);
        assert_memory_equal(&a->light, &b->light, sizeof a->light);
    }
    vplLightSet_Destroy(exact);
    vplLightSet_Destroy(boxes);
    vplGeometry_Destroy(g);
}

// A ball is met at its box, all around; a ball that glows lets its own light out.
TEST(ParticlesStopAtTheBoxOfAMesh, 2)
{
    for (int glows = 0; glows < 2; glows++) {
        vplScene* scene = lampCube(context, glows ? 0 : 1, 0.5f);
        Shape ball = icosphere(2);
        vplMeshDef mesh = vplDefaultMeshDef();
        vplObjectDef object = vplDefaultObjectDef();
        uint32_t indices[3 * 320];
        for (uint32_t i = 0; i < 3 * 320; i++) {
            indices[i] = i;
        }
        mesh.positions = ball.corners;
        mesh.indices = indices;
        mesh.vertexCount = 3 * (mesh.triangleCount = ball.triangleCount);
        object.type = VPL_OBJECT_MESH;
        object.material = glows ? addGlow(scene, (vplRgb){1, 1, 1}, 0.5f) : 0;
        object.transform =
            vplMat4_FromParts(vplVec(0.3f, -0.2f, 0.1f), (double[3]){0.4, 0, 0}, vplVec(0.4f, 0.3f, 0.3f));
        assert_int_equal(vplScene_AddMesh(scene, &mesh, &object.mesh), VPL_SUCCESS);
        int index;
        assert_int_equal(vplScene_AddObject(scene, &object, &index), VPL_SUCCESS);
        vplGeometry* g = freezeScene(scene);
        vplLightSet* set = simulate(g, 4000, VPL_PARTICLE_GEOMETRY_OBB);
        int on = 0, first = 0;
        for (int i = 0; i < set->lightCount; i++) {
            const vplVirtualLight* l = &set->lights[i];
            if (l->object != index) {
                continue;
            }
            double largest = 0;
            for (int row = 0; row < 3; row++) {
                const double* m = g->objects[index].bounds.toLocal[row];
                largest = fmax(largest, fabs(m[0] * (double)l->position.x + m[1] * (double)l->position.y +
                                             m[2] * (double)l->position.z + m[3]));
            }
            assertNear(largest, 0.5, 1e-6, "distance from the box", i);
            first += l->step == 0;
            on++;
        }
        assert_true(on > 100 && (first > 0) == !glows);
        assert_int_equal(set->escaped, 0);
        vplLightSet_Destroy(set);
        vplGeometry_Destroy(g);
        freeShape(&ball);
    }
}

static double energyOf(const vplScene* scene, const vplRenderOptions* options)
{
    vplImage* image;
    double sum = 0;
    assert_int_equal(vplRender(scene, options, &image, NULL), VPL_SUCCESS);
    for (int i = 0; i < 3 * image->width * image->height; i++) {
        sum += (double)image->pixels[i];
    }
    vplImage_Destroy(image);
    return sum;
}

// Virtual lights with shadows by rays and path tracing are two estimates of one picture. Four seeds of 512
// particles leave about 1 % of noise in the mean (tests/bench/energy.sh: larger pictures, more particles).
TEST(EnergyIsThatOfPathTracing, 2, SLOW)
{
    static const char* const scenes[] = {"examples/scenes/room.json", "examples/scenes/room-area.json"};
    for (int i = 0; i < 2; i++) {
        vplScene* scene;
        assert_int_equal(vplScene_Load(context, scenes[i], &scene), VPL_SUCCESS);
        vplRenderOptions o = vplDefaultRenderOptions();
        o.output.width = o.output.height = 16;
        o.path.pixel = VPL_PIXEL_CENTRE;
        o.method = VPL_METHOD_PATH;
        o.path.samples = 1024;
        const double truth = energyOf(scene, &o);
        o.method = VPL_METHOD_INSTANT_RADIOSITY;
        o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
        o.particles.sampler = VPL_SAMPLER_HALTON;
        o.particles.count = 512;
        double sum = 0;
        for (o.seed = 1; o.seed <= 4; o.seed++) {
            sum += energyOf(scene, &o);
        }
        assertNear(sum / 4 / truth, 1, 0.025, scenes[i], i);
        o.lights.shadows = VPL_LIGHT_SHADOWS_NONE; // light through boxes is seen
        assert_true(energyOf(scene, &o) > 1.01 * sum / 4);
        vplScene_Destroy(scene);
    }
}
