// SPDX-License-Identifier: MIT
// Tests of spot, directional and area lights against formulas; shadows of virtual lights; smooth surfaces.
#include "emitter_scenes.h"
#include "path_scenes.h"

TEST(SpotAndSunAreAnalytic, 1)
{
    enum { SIZE = 64 };
    for (int which = 0; which < 4; which++) { // spot and directional light, each by maps and by rays
        const bool sun = which & 1;
        vplScene* scene = sceneOf(context, 0.5f);
        addLevel(scene, vplVec(0, 0, 0), 10, false, 0);
        lookDown(scene, 4, 0.3);
        const vplVec3 d = {0.1f, -1, 0.05f}, p = {0.3f, 2, -0.25f};
        addColoured(scene, sun ? VPL_EMITTER_DIRECTIONAL : VPL_EMITTER_SPOT, p, d, 3);
        vplRenderOptions o = plainOptions();
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

// Returns the form factor from a point to the rectangle [0, a] x [0, b] in a parallel plane at distance 1,
// with the point below a corner. Source: Howell, A Catalog of Radiation Heat Transfer Configuration Factors,
// B-3.
static double cornerFactor(double a, double b)
{
    const double p = sqrt(1 + a * a), q = sqrt(1 + b * b);
    return (a / p * atan(b / p) + b / q * atan(a / q)) / (2 * VPL_PI);
}

// An area light of 1 x 1 m hangs 1 m above the floor; the floor's radiance is rho L F.
TEST(AreaLightsConvergeToTheFormFactor, 1)
{
    enum { SIZE = 8 };
    // Each case gives the largest relative error below the area light and within 0.1 m around it; it falls as
    // 1 / count.
    const struct {
        int count;
        double error;
    } cases[] = {{1, 0.32}, {16, 0.029}, {64, 0.0062}, {1024, 0.00032}};
    vplScene* scene = sceneOf(context, 0.5f);
    addLevel(scene, vplVec(0, 0, 0), 10, false, 0);
    addLevel(scene, vplVec(0, 1, 0), 1, true, addGlow(scene, (vplRgb){4, 4, 4}, 0));
    lookDown(scene, 0.5f, 1.2);
    for (int n = 0; n < 4; n++) {
        vplRenderOptions o = plainOptions();
        o.method = VPL_METHOD_DIRECT;
        o.output.width = o.output.height = SIZE;
        o.lights.areaLightSamples = cases[n].count;
        vplImage* image = renderScene(scene, &o, NULL);
        double worst = 0;
        for (int i = 0; i < SIZE * SIZE; i++) {
            double x, z, factor = 0;
            floorPoint(i, SIZE, 0.5, 1.2, &x, &z);
            for (int corner = 0; corner < 4; corner++) { // rectangles with a corner above the point
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

// Compares indirect light of the room. Maps of 512 x 512 texels (as many texels as 6 faces of 209 x 209)
// differ from rays by 0.1 %; shadows remove 10 % of the light.
TEST(RayAndMapShadowsAgree, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = plainOptions();
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

// ---- scenes with lights made by hand

enum { VIEW = 48 };

// Renders `geometry` from its scene's camera, with one virtual light whose shadows come from rays or a map.
static vplImage* shadeOne(const vplGeometry* g, const vplView* view, const vplShadeLight* light, bool map)
{
    vplShadeDef def = vplDefaultShadeDef();
    def.accumulation = VPL_ACCUMULATE_DEFERRED;
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
    if (vplShadeView(g, view, &def, image, NULL) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    vplHemiMaps_Destroy(maps);
    return image;
}

enum { BY_POINT, BY_SPOT, BY_SUN, BY_AREA_LIGHT, BY_VIRTUAL_LIGHT, LIGHT_KINDS };

// Renders direct light of one source at `place` that shines towards `aim`, or the light of one virtual light
// there.
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
        vplGeometry* g = buildGeometry(scene);
        const vplView view = vplView_Create(camera, VIEW, VIEW);
        const vplShadeLight light = {place.x, place.y, place.z, d.x, d.y, d.z, 1, 2, 3};
        image = shadeOne(g, &view, &light, map);
        vplGeometry_Destroy(g);
        return image;
    }
    if (kind == BY_AREA_LIGHT) { // so small that one virtual light represents it
        Shape areaLight = {0};
        vplVec3 t, b;
        vplTangentFrame(d, &t, &b);
        addTriangle(&areaLight, vplAdd(place, vplScale(-1e-4f, t)), vplAdd(place, vplScale(1e-4f, t)),
                    vplAdd(place, vplScale(1e-4f, b)));
        vplMeshDef mesh = vplDefaultMeshDef();
        vplObjectDef object = vplDefaultObjectDef();
        mesh.positions = areaLight.corners;
        mesh.indices = (const uint32_t[]){0, 1, 2};
        mesh.vertexCount = 3;
        mesh.triangleCount = 1;
        object.type = VPL_OBJECT_MESH;
        object.material = addGlow(scene, (vplRgb){1e8f, 1e8f, 1e8f}, 0);
        assert_int_equal(vplScene_AddMesh(scene, &mesh, &object.mesh), VPL_SUCCESS);
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
        freeShape(&areaLight);
    } else {
        addColoured(scene, (vplEmitterType)kind, place, d, 2);
    }
    vplRenderOptions o = plainOptions();
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

// A square of 1 m hangs halfway between the light and the floor: pixels in its shadow are black, pixels
// beside it have the bits of the unshadowed picture.
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
            const double share = kind == BY_SUN ? 0 : 0.5; // the square's place on the way to the light
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

// Irradiance uses the interpolated normal, but only light from the triangle's own side counts, for every type
// of light.
TEST(SmoothTrianglesAreDarkFromBehind, 1)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.up = vplVec(0, 0, -1);
    // The triangle lies in the plane y = 0, around (0, 0, 0.1); its corners, used as normals, lean up to 80
    // degrees from the true one.
    Shape shape = {0};
    addTriangle(&shape, vplVec(-1, 0.2f, -1), vplVec(0, 0.2f, 1), vplVec(1, 0.2f, -1));
    for (int below = 0; below < 2; below++) {
        camera.eye = vplVec(0, below ? -3 : 3, 0);
        for (int kind = 0; kind < LIGHT_KINDS; kind++) {
            for (int map = 0; map < 2; map++) {
                for (int behind = 0; behind < 2; behind++) {
                    // The light is 0.15 m off the plane: normals that lean towards it see it even where it is
                    // behind.
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

// Two triangles form a roof with shared normals at the ridge. With normals, radiance changes across the ridge
// as it does beside it; without normals it jumps.
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
        vplRenderOptions o = plainOptions();
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

// X064: half of a floor below the light is dark, and a warning says why.
TEST(WithoutBiasSurfacesShadowThemselvesAndAWarningSaysSo, 1)
{
    enum { SIZE = 32 };
    vplScene* scene = sceneOf(context, 0.5f);
    addLevel(scene, vplVec(0, 0, 0), 10, false, 0);
    lookDown(scene, 4, 0.3);
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(0.3f, 2, -0.25f), vplVec(0, -1, 0), 3);
    for (int k = 0; k < 4; k++) { // 0, and what needs no warning: a length, automatic, rays
        vplRenderOptions o = plainOptions();
        o.method = VPL_METHOD_DIRECT;
        o.output.width = o.output.height = SIZE;
        o.shadow.mapSize = 64;
        o.shadow.pcfSamples = 1;
        o.shadow.bias = k == 1 ? 0.2f : k == 2 ? VPL_BIAS_OPTION_AUTO : 0;
        o.shadow.biasSlope = k == 2 ? -1 : 0;
        o.lights.shadows = k == 3 ? VPL_LIGHT_SHADOWS_RAY : VPL_LIGHT_SHADOWS_NONE;
        takeMessage();
        vplImage* image = renderScene(scene, &o, NULL);
        assert_true((strstr(takeMessage(), "--bias 0: surfaces lie in their own shadow") != NULL) ==
                    (k == 0));
        int dark = 0;
        for (int i = 0; i < SIZE * SIZE; i++) {
            dark += image->pixels[3 * i] == 0;
        }
        assert_true(k == 0 ? dark > SIZE * SIZE / 4 : dark == 0);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
}

// With a radius of a 128th of the scene's size the shadow of the plate is gone.
TEST(AWideGroundDoesNotBlurTheShadowsOfSmallThings, 1)
{
    enum { SIZE = 64 };
    vplScene* scene = sceneOf(context, 0.5f);
    addLevel(scene, vplVec(0, 0, 0), 400, false, 0);
    addLevel(scene, vplVec(0, 0.5f, 0), 1, false, 0);
    lookDown(scene, 4, 0.3);
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(3, 2, 0), (vplVec3){0, 0, 0}, 3);
    int dark[2] = {0, 0};
    double off = 0, sum = 0;
    vplImage* images[2];
    for (int rays = 0; rays < 2; rays++) {
        vplRenderOptions o = vplDefaultRenderOptions();
        o.method = VPL_METHOD_DIRECT;
        o.output.width = o.output.height = SIZE;
        o.lights.shadows = rays ? VPL_LIGHT_SHADOWS_RAY : VPL_LIGHT_SHADOWS_MAP;
        images[rays] = renderScene(scene, &o, NULL);
        for (int i = 0; i < SIZE * SIZE; i++) {
            dark[rays] += images[rays]->pixels[3 * i] == 0;
        }
    }
    for (int i = 0; i < SIZE * SIZE; i++) {
        off += fabs((double)images[0]->pixels[3 * i] - (double)images[1]->pixels[3 * i]);
        sum += (double)images[1]->pixels[3 * i];
    }
    assert_true(dark[1] > 50 && dark[0] > 0.8 * dark[1] && dark[0] < 1.05 * dark[1]);
    assert_true(off > 0 && off < 0.005 * sum);
    vplImage_Destroy(images[0]);
    vplImage_Destroy(images[1]);
    vplScene_Destroy(scene);
}

// ---- a sample of the emitters

enum { LAMPS = 100 };

// A floor below lamps of strengths 1 to LAMPS.
static vplScene* lampScene(vplContext* context, int lamps)
{
    vplScene* scene = sceneOf(context, 0.5f);
    addLevel(scene, vplVec(0, 0, 0), 10, false, 0);
    lookDown(scene, 4, 0.3);
    for (int i = 0; i < lamps; i++) {
        addEmitter(scene, VPL_EMITTER_POINT,
                   vplVec(0.3f * (float)(i % 10) - 1.5f, 2, 0.3f * (float)(i / 10 % 10) - 1.5f),
                   (vplVec3){0, 0, 0}, (float)(i % LAMPS + 1));
    }
    return scene;
}

TEST(ASampleOfEmittersForMapsKeepsTheirSum, 1)
{
    static const int WANTED[] = {1, 7, 50, 99, 100, 1000, 0};
    vplScene* scene = lampScene(context, LAMPS);
    for (int w = 0; w < 7; w++) {
        vplRenderOptions o = plainOptions();
        vplPlan* plan;
        o.method = VPL_METHOD_DIRECT;
        o.lights.emitterSamples = WANTED[w];
        o.seed = 5;
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        const int most = WANTED[w] > 0 && WANTED[w] < LAMPS ? WANTED[w] : LAMPS;
        const double total = LAMPS * (LAMPS + 1) / 2, step = total / most;
        double sum = 0;
        int strong = 0;
        for (int i = 0; i < plan->mapEmitterCount; i++) {
            const double scaled = (double)plan->mapEmitters[i].intensity.r;
            sum += scaled;
            strong += most < LAMPS && scaled >= step * 0.999;
        }
        assertNear(sum / total, 1, 1e-5, "share of the sum", WANTED[w]);
        assert_true(plan->mapEmitterCount <= most && (most < LAMPS || plan->mapEmitterCount == LAMPS));
        assert_true(most == LAMPS || strong == plan->mapEmitterCount); // none is weaker than one choice
        assert_int_equal(plan->emitterCount, LAMPS);
        assert_int_equal(plan->emittersPerPoint, most < LAMPS ? most : 0);
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}

// A tree holds no directional lights: all of them light every point.
TEST(DirectionalLightsAreNotChosenFrom, 1)
{
    vplScene* scene = lampScene(context, 6);
    for (int i = 0; i < 8; i++) {
        addEmitter(scene, VPL_EMITTER_DIRECTIONAL, vplVec(0, 3, 0), vplVec(0, -1, 0.1f * (float)i), 0.1f);
    }
    for (int wanted = 5; wanted <= 6; wanted++) {
        vplRenderOptions o = plainOptions();
        vplPlan* plan;
        o.lights.emitterSamples = wanted;
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assert_int_equal(plan->emittersPerPoint, wanted < 6 ? wanted : 0);
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}

// The noise depends on the position of a point, so the mean is that of many pixels.
TEST(EmitterSamplesHaveTheMeanOfAll, 1)
{
    enum { SIDE = 64, VALUES = 3 * SIDE * SIDE };
    static const int CHOICES[] = {1, 8, 64};
    static const double LARGEST[] = {0.1, 0.02, 0.004}; // rms of the relative error of a pixel
    vplScene* scene = lampScene(context, LAMPS);
    vplRenderOptions o = plainOptions();
    vplRenderStats stats;
    o.method = VPL_METHOD_DIRECT;
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o.output.width = o.output.height = SIDE;
    vplImage* all = renderScene(scene, &o, NULL);
    for (int i = 0; i < 3; i++) {
        o.lights.emitterSamples = CHOICES[i];
        vplImage* image = renderScene(scene, &o, NULL);
        double sum = 0, square = 0;
        for (int k = 0; k < VALUES; k++) {
            const double ratio = (double)image->pixels[k] / (double)all->pixels[k];
            sum += ratio / VALUES;
            square += (ratio - 1) * (ratio - 1) / VALUES;
        }
        print_message("%d choices: mean %.4f, error of a pixel %.3f\n", CHOICES[i], sum, sqrt(square));
        assertNear(sum, 1, 0.02, "mean share of all", CHOICES[i]);
        assert_true(sqrt(square) < LARGEST[i] && square > 0);
        vplImage_Destroy(image);
    }
    o.method = VPL_METHOD_PATH; // chooses lights by itself
    o.path.samples = 1;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    const uint64_t hash = stats.imageHash;
    o.lights.emitterSamples = 0;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    assert_true(stats.imageHash == hash);
    vplImage_Destroy(all);
    vplScene_Destroy(scene);
}

static double relativeError(const vplImage* image, const vplImage* truth)
{
    vplComparison c;
    assert_int_equal(vplImage_Compare(image, truth, &c), VPL_SUCCESS);
    return c.relativeRmse;
}

// The rims of the shadow of a plate. More than 64 lamps take four of 8 or 16 samples.
TEST(FewSamplesStandForAllAtRimsOfManyEmitters, 1)
{
    double raysOf[2][2], errors[2][2];
    for (int many = 0; many < 2; many++) {
        const int lamps = many ? 65 : 64;
        vplScene* scene = lampScene(context, lamps);
        addLevel(scene, vplVec(0.1f, 0.6f, 0.05f), 0.5f, false, 0);
        vplRenderOptions o = plainOptions();
        o.method = VPL_METHOD_DIRECT;
        o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
        o.output.width = o.output.height = 32;
        o.output.supersample = 64;
        vplImage* truth = renderScene(scene, &o, NULL);
        o.output.supersample = 1;
        for (int i = 0; i < 2; i++) {
            vplRenderStats stats;
            o.output.antialias = i == 0 ? 8 : 16;
            vplImage* image = renderScene(scene, &o, &stats);
            raysOf[many][i] = (double)stats.rays / lamps;
            errors[many][i] = relativeError(image, truth);
            vplImage_Destroy(image);
        }
        vplImage_Destroy(truth);
        vplScene_Destroy(scene);
        print_message("%d lamps: %.0f and %.0f rays each, error %.4f and %.4f\n", lamps, raysOf[many][0],
                      raysOf[many][1], errors[many][0], errors[many][1]);
    }
    assert_true(raysOf[1][0] < 0.8 * raysOf[0][0] && raysOf[1][1] < 0.6 * raysOf[0][1]);
    assert_true(errors[1][0] < 1.15 * errors[0][0] && errors[1][1] < 1.2 * errors[0][1]);
}

// Light that short rays find at hits, from all of 64 lamps or from four of 65 that a tree chooses.
TEST(ATreeChoosesEmittersAtHitsOfShortRays, 1)
{
    double light[2], raysOf[2];
    for (int many = 0; many < 2; many++) {
        const int lamps = many ? 65 : 64;
        vplScene* scene = lampScene(context, lamps);
        addLevel(scene, vplVec(0, 5, 0), 10, true, 0); // above the camera
        vplRenderOptions o = vplDefaultRenderOptions();
        vplRenderStats stats;
        o.method = VPL_METHOD_KELLER;
        o.output.width = o.output.height = 32;
        o.output.show = VPL_SHOW_INDIRECT;
        o.output.antialias = 1;
        o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
        o.lights.minDistance = 8; // short rays find nearly all of the light
        o.particles.count = 256;
        vplImage* image = renderScene(scene, &o, &stats);
        double all = 0;
        for (int i = 0; i < lamps; i++) {
            all += i % LAMPS + 1;
        }
        light[many] = meanOfImage(image, 0) / all;
        raysOf[many] = (double)stats.rays;
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
    }
    print_message("light by 65 lamps %.3f of that by 64, rays %.2f\n", light[1] / light[0],
                  raysOf[1] / raysOf[0]);
    assertNear(light[1] / light[0], 1, 0.03, "light by 65 lamps over that by 64", 65);
    assert_true(raysOf[1] < 0.6 * raysOf[0]);
}

// A thousandth of the time that all lamps would take.
TEST(ThousandsOfLampsHaveAPictureInTime, 2)
{
    vplScene* scene = lampScene(context, 20000);
    vplRenderOptions o = vplDefaultRenderOptions();
    vplRenderer* r;
    vplImage* image;
    bool done = false;
    o.output.width = 64;
    o.output.height = 36;
    o.stop.budgetMs = 30;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    while (!done) {
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    }
    const int samples = vplRenderer_GetPlan(r)->options.lights.emitterSamples;
    assert_true(samples >= 0 && samples < 64); // 0: there was time for the 64 of 20,000
    assert_int_equal(vplRenderer_GetImage(r, &image, NULL), VPL_SUCCESS);
    assert_true(image->pixels[3 * (18 * 64 + 32)] > 0);
    vplImage_Destroy(image);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

// How many of 1,000 lamps a tree chooses for each point of the first picture.
static int chosenInTime(const vplScene* scene, double ms)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    vplRenderer* r;
    o.output.width = 1280;
    o.output.height = 720;
    o.stop.budgetMs = ms;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    const int samples = vplRenderer_GetPlan(r)->options.lights.emitterSamples;
    vplRenderer_Destroy(r);
    return samples;
}

TEST(AFirstPictureInAShortTimeHasOneLampForEachPoint, 1)
{
    vplScene* scene = lampScene(context, 1000);
    assert_int_equal(chosenInTime(scene, 20), 1);
    assert_int_equal(chosenInTime(scene, 20000), 4);
    vplScene_Destroy(scene);
}
