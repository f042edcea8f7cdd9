// SPDX-License-Identifier: MIT
// Tests of lightcuts: the error of clusters with shadows, and pictures.
#include "tree_lights.h"

#include "visibility/blocks.h"

// ---- clusters with shadows

// Makes 16 points on triangles of the geometry, on either side.
static void rollSeen(Dice* dice, const vplGeometry* g, vplSurface* s, vplPoints* points)
{
    for (int l = 0; l < VPL_LANES; l++) {
        const int t = (int)roll(dice, 0, (float)g->triangleCount - 0.01f);
        const vplVec3* corner[3];
        const int object = g->owners[t];
        for (int k = 0; k < 3; k++) {
            corner[k] = &g->positions[g->objects[object].firstVertex + g->indices[3 * t + k]];
        }
        float u = roll(dice, 0, 1), v = roll(dice, 0, 1);
        v = u + v > 1 ? 1 - v : v;
        u = u + v > 1 ? 1 - u : u;
        const vplVec3 p = vplAdd(*corner[0], vplAdd(vplScale(u, vplSub(*corner[1], *corner[0])),
                                                    vplScale(v, vplSub(*corner[2], *corner[0]))));
        const vplVec3 n = roll(dice, 0, 1) < 0.5f ? g->normals[t] : vplNegate(g->normals[t]);
        s->px[l] = p.x, s->py[l] = p.y, s->pz[l] = p.z;
        s->nx[l] = n.x, s->ny[l] = n.y, s->nz[l] = n.z;
        points->triangle[l] = t;
    }
    points->surface = points->plane = s;
}

// For each lane, r + g + b of a cluster's lights, of its representative in place of them, and of its bound.
typedef struct Judged {
    double all[VPL_LANES], one[VPL_LANES], bound[VPL_LANES];
} Judged;

static void judge(const vplShading* s, const vplLightTree* tree, vplCluster c, const vplPoints* points,
                  Judged* j)
{
    const vplLightNode* node = &tree->nodes[c.node];
    vplRayStarts starts;
    vplFindRayStarts(s, points, &starts);
    memset(j, 0, sizeof *j);
    float bound[VPL_LANES];
    s->kernels.clusterBound(points->surface, node, s->lights.inverseClamp, bound);
    for (int i = c.first; i < c.first + c.count; i++) {
        const vplShadeLight* light = &tree->lights[i].light;
        vplReceived received;
        int64_t rays = 0;
        const vplReceiver receiver = {s, points, &starts, &rays};
        if (!vplReceiveLight(&receiver, light, NULL, s->lights.inverseClamp, &received)) {
            continue;
        }
        const double scale = (double)node->intensity / (double)(light->r + light->g + light->b);
        for (int l = 0; l < VPL_LANES; l++) {
            const double given = (double)received.visible[l] *
                                 (double)(received.open[0][l] + received.open[1][l] + received.open[2][l]);
            j->all[l] += given;
            j->one[l] += i == node->representative ? scale * given : 0;
        }
    }
    for (int l = 0; l < VPL_LANES; l++) {
        j->bound[l] = (double)node->intensity * (double)bound[l];
    }
}

TEST(RepresentativesErrByLessThanTheBoundAlsoInShadow, 2)
{
    enum { COUNT = 600, ROUNDS = 150 };
    vplScene* scene = loadScene(context, "room.json");
    vplGeometry* g;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    Dice dice = {21, 0};
    double worst = 0;
    for (int kind = 0; kind < KIND_FAR; kind++) {
        vplShadeLight* lights = rollTreeLights((Kind)kind, COUNT, 3);
        vplLightTree* tree = plant(context, lights, COUNT);
        const vplShading s = {.geometry = g,
                              .kernels = *vplGetShadingKernels(context->isa, VPL_LIGHTING_PHYSICAL),
                              .lights = {.inverseClamp = 1 / 0.04f}};
        for (int round = 0; round < ROUNDS; round++) {
            vplSurface surface;
            vplPoints points;
            rollSeen(&dice, g, &surface, &points);
            vplCluster c = vplLightTree_Root(tree), halves[2];
            for (int steps = round % 16; steps > 0 && c.count > 2; steps--) {
                vplLightTree_Halves(tree, c, halves);
                c = halves[halves[0].count > halves[1].count ? 0 : 1];
            }
            Judged j;
            judge(&s, tree, c, &points, &j);
            for (int l = 0; l < VPL_LANES; l++) {
                // 1e-5 allows for rounding of the sum of 600 lights.
                assert_true(fabs(j.one[l] - j.all[l]) <= j.bound[l] + 1e-5 * j.all[l]);
                const double share = j.bound[l] > 0 ? fabs(j.one[l] - j.all[l]) / j.bound[l] : 0;
                worst = share > worst ? share : worst;
            }
        }
        vplLightTree_Destroy(tree);
        free(lights);
    }
    assert_true(worst > 0.25); // the bound is not too loose
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

// ---- pictures

static const char* const SCENES[] = {"examples/scenes/room.json", "examples/scenes/room-area.json"};

static vplRenderOptions optionsOf(int particles, vplLightShadows shadows)
{
    vplRenderOptions o = plainOptions();
    o.output.width = 68;
    o.output.height = 51;
    o.particles.count = particles;
    o.particles.sampler = VPL_SAMPLER_HALTON;
    o.lights.shadows = shadows;
    o.shadow.mapSize = 32;
    o.lights.mapSize = 16;
    o.lights.areaLightSamples = 4;
    o.pipeline.kind = VPL_ACCUMULATE_LIGHTCUTS;
    o.lights.compensation = VPL_COMPENSATION_NONE; // its rays depend on how lights are accumulated
    return o;
}

static double sumOf(const vplImage* image, int i)
{
    return (double)image->pixels[3 * i] + (double)image->pixels[3 * i + 1] + (double)image->pixels[3 * i + 2];
}

// Returns the largest error of a pixel relative to its light, or to a sixteenth of its unshadowed light if
// that is more.
static double worstPixel(const vplImage* image, const vplImage* truth, const vplImage* open)
{
    double worst = 0;
    for (int i = 0; i < image->width * image->height; i++) {
        const double all = sumOf(truth, i), dark = sumOf(open, i) / 16, of = all > dark ? all : dark;
        const double error = of > 0 ? fabs(sumOf(image, i) - all) / of : 0;
        worst = error > worst ? error : worst;
    }
    return worst;
}

// Covers every pixel, all kinds of shadows, both lighting models and three error thresholds.
TEST(NoPixelErrsByMoreThanAsked, 2, SLOW)
{
    static const float errors[] = {0.01f, 0.02f, 0.1f};
    for (int k = 0; k < 12; k++) {
        const vplLightShadows shadows = (vplLightShadows)(1 + k / 2 % 3);
        vplRenderOptions o = optionsOf(shadows == VPL_LIGHT_SHADOWS_MAP ? 80 : 2000, shadows), plain;
        o.method = k % 2 ? VPL_METHOD_KELLER : VPL_METHOD_INSTANT_RADIOSITY;
        o.lighting = k >= 6 && k % 2 == 0 ? VPL_LIGHTING_DOCUMENTED : VPL_LIGHTING_PHYSICAL;
        vplScene* scene = openScene(context, SCENES[k % 2]);
        o.output.width = 40;
        o.output.height = 30;
        o.output.show = VPL_SHOW_INDIRECT;
        plain = o;
        plain.pipeline.kind = VPL_ACCUMULATE_DEFERRED;
        vplImage* truth = renderScene(scene, &plain, NULL);
        plain.lights.shadows = VPL_LIGHT_SHADOWS_NONE;
        vplImage* open = renderScene(scene, &plain, NULL);
        for (int e = 0; e < 3; e++) {
            o.pipeline.cutError = errors[e];
            vplImage* image = renderScene(scene, &o, NULL);
            const double worst = worstPixel(image, truth, open);
            if (!(worst <= (double)o.pipeline.cutError)) {
                fail_msg("case %d: a pixel is off by %g, not %g", k, worst, (double)o.pipeline.cutError);
            }
            vplImage_Destroy(image);
        }
        vplImage_Destroy(open);
        vplImage_Destroy(truth);
        vplScene_Destroy(scene);
    }
}

// With almost no permitted error the cut reaches every light, also if the cut's memory is full first: 40,000
// lights are more than twice its capacity.
TEST(NoErrorIsTheSumOfAllLights, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = optionsOf(27000, VPL_LIGHT_SHADOWS_NONE);
    o.output.width = o.output.height = 12;
    o.output.show = VPL_SHOW_INDIRECT;
    o.pipeline.cutError = 1e-6f;
    vplRenderStats stats;
    vplImage* image = renderScene(scene, &o, &stats);
    o.pipeline.kind = VPL_ACCUMULATE_DEFERRED;
    vplImage* truth = renderScene(scene, &o, NULL);
    assert_true(stats.virtualLights > 40000 && stats.largestCut > 36000);
    assert_true(stats.largestCut <= stats.virtualLights);
    assert_true(stats.cutPixels == 12 * 12 && stats.lightEvaluations <= stats.largestCut * stats.cutPixels);
    for (int i = 0; i < 3 * 12 * 12; i++) {
        const double wanted = (double)truth->pixels[i];
        assertNear((double)image->pixels[i], wanted, 3e-6 * wanted, "radiance", i);
    }
    vplImage_Destroy(truth);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

TEST(TenfoldLightsAreLessThanTwofoldWork, 2, SLOW)
{
    for (int k = 0; k < 2; k++) {
        vplScene* scene = openScene(context, SCENES[k]);
        double before = 0;
        for (int particles = 1000; particles <= 100000; particles *= 10) {
            vplRenderOptions o = optionsOf(particles, VPL_LIGHT_SHADOWS_RAY);
            o.method = k ? VPL_METHOD_KELLER : VPL_METHOD_INSTANT_RADIOSITY;
            vplRenderStats stats;
            vplImage_Destroy(renderScene(scene, &o, &stats));
            const double now = (double)stats.lightEvaluations / (double)stats.cutPixels;
            assert_true(stats.virtualLights >= particles && stats.largestCut >= now);
            assert_true(before == 0 || now < 2 * before);
            before = now;
        }
        vplScene_Destroy(scene);
    }
}

// Doubling all lights doubles every pixel bit for bit, because errors are relative.
TEST(TwiceTheLightIsTwiceThePicture, 2)
{
    enum { COUNT = 3000, SIZE = 24 };
    vplGeometry* g = closedCube(context, 0.5f);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, 0, 0.9f);
    camera.target = vplVec(0, 0, 0);
    const vplView view = vplView_Create(&camera, SIZE, SIZE);
    vplShadeLight* lights = rollTreeLights(KIND_WALLS, COUNT, 4);
    vplImage* images[2];
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < COUNT; i++) {
            const float at = k ? 1 : 0.5f, scale = k ? 2 : 1;
            lights[i].px *= at, lights[i].py *= at, lights[i].pz *= at;
            lights[i].r *= scale, lights[i].g *= scale, lights[i].b *= scale;
        }
        vplShadeDef def = vplDefaultShadeDef();
        def.minDistance = 0.1f;
        def.accumulation = VPL_ACCUMULATE_LIGHTCUTS;
        def.lights = lights;
        def.lightCount = COUNT;
        def.lightRays = true;
        assert_int_equal(vplImage_Create(context, SIZE, SIZE, &images[k]), VPL_SUCCESS);
        assert_int_equal(vplShadeView(g, &view, &def, images[k], NULL), VPL_SUCCESS);
    }
    for (int i = 0; i < 3 * SIZE * SIZE; i++) {
        assert_true(images[0]->pixels[i] > 0 && images[1]->pixels[i] == 2 * images[0]->pixels[i]);
    }
    vplImage_Destroy(images[1]);
    vplImage_Destroy(images[0]);
    free(lights);
    vplGeometry_Destroy(g);
}

// Uses all arrangements of lights, unclamped, some on the surfaces that they light: pixels must be finite and
// not negative, and 0 where the picture of all lights is 0.
TEST(NastyLightsLeaveNoNan, 2)
{
    enum { COUNT = 500, SIZE = 20 };
    vplGeometry* g = closedCube(context, 0.5f);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0.2f, 0.1f, 0.9f);
    camera.target = vplVec(0, 0, 0);
    const vplView view = vplView_Create(&camera, SIZE, SIZE);
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        vplShadeLight* lights = rollTreeLights((Kind)kind, COUNT, 6);
        for (int i = 0; i < COUNT && kind == KIND_WALLS; i++) {
            lights[i].px *= 0.5f, lights[i].py *= 0.5f, lights[i].pz *= 0.5f;
        }
        vplImage* images[2];
        for (int k = 0; k < 2; k++) {
            vplShadeDef def = vplDefaultShadeDef();
            def.accumulation = k ? VPL_ACCUMULATE_DEFERRED : VPL_ACCUMULATE_LIGHTCUTS;
            def.lights = lights;
            def.lightCount = COUNT;
            def.lightRays = true;
            assert_int_equal(vplImage_Create(context, SIZE, SIZE, &images[k]), VPL_SUCCESS);
            assert_int_equal(vplShadeView(g, &view, &def, images[k], NULL), VPL_SUCCESS);
        }
        for (int i = 0; i < 3 * SIZE * SIZE; i++) {
            assert_true(isfinite(images[0]->pixels[i]) && images[0]->pixels[i] >= 0);
            assert_true(images[1]->pixels[i] > 0 || images[0]->pixels[i] == 0);
        }
        vplImage_Destroy(images[1]);
        vplImage_Destroy(images[0]);
        free(lights);
    }
    vplGeometry_Destroy(g);
}

static uint64_t hashOf(vplContext* context, const vplRenderOptions* o)
{
    vplRenderStats stats;
    vplScene* scene = loadScene(context, "room.json");
    vplImage_Destroy(renderScene(scene, o, &stats));
    vplScene_Destroy(scene);
    closeTestContext(context);
    return stats.imageHash ^ (uint64_t)stats.lightEvaluations << 20 ^ (uint64_t)stats.largestCut;
}

TEST_ALONE(ThreadsAndInstructionSetsChangeNoBit)
{
    static const int workers[] = {2, 3, 7};
    for (int i = 0; i < 4; i++) {
        vplRenderOptions o = optionsOf(i == 1 ? 60 : 3000, (vplLightShadows)(1 + i % 3));
        o.lighting = i == 3 ? VPL_LIGHTING_DOCUMENTED : VPL_LIGHTING_PHYSICAL;
        const uint64_t wanted = hashOf(openTestContext(1), &o);
        for (int k = 0; k < 3; k++) {
            assert_true(hashOf(openTestContext(workers[k]), &o) == wanted);
        }
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            vplContext* context = openIsaContext(2, (vplIsa)isa);
            assert_true(context == NULL || hashOf(context, &o) == wanted);
        }
    }
}

TEST(NoLightsAndOneLightAreDeferred, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    for (int particles = 0; particles < 2; particles++) {
        vplRenderOptions o = optionsOf(particles, VPL_LIGHT_SHADOWS_RAY);
        vplImage* image = renderScene(scene, &o, NULL);
        o.pipeline.kind = VPL_ACCUMULATE_DEFERRED;
        vplImage* truth = renderScene(scene, &o, NULL);
        for (int i = 0; i < 3 * o.output.width * o.output.height; i++) {
            const double wanted = (double)truth->pixels[i];
            assertNear((double)image->pixels[i], wanted, 1e-6 * wanted, "radiance", i);
        }
        vplImage_Destroy(truth);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
}

static bool stopAtOnce(void* user, double fraction)
{
    (void)fraction;
    ++*(int*)user;
    return false;
}

TEST(CutsCanBeCancelledAndWrongErrorsAreRefused, 1)
{
    vplGeometry* g = closedCube(context, 0.5f);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, 0, 0.9f);
    camera.target = vplVec(0, 0, 0);
    const vplView view = vplView_Create(&camera, 8, 8);
    vplShadeLight* lights = rollTreeLights(KIND_CLOUD, 5000, 1);
    vplImage* image;
    assert_int_equal(vplImage_Create(context, 8, 8, &image), VPL_SUCCESS);
    vplShadeDef def = vplDefaultShadeDef();
    def.accumulation = VPL_ACCUMULATE_LIGHTCUTS;
    def.lights = lights;
    def.lightCount = 5000;
    static const float wrong[] = {0, -1, 1.5f, NAN};
    for (int i = 0; i < 4; i++) {
        def.cutError = wrong[i];
        assert_int_equal(vplShadeView(g, &view, &def, image, NULL), VPL_INVALID_ARGUMENT);
        assert_true(strstr(takeMessage(), "vplShadeDef.cutError is ") != NULL);
    }
    def.cutError = 0.02f;
    int asked = 0;
    def.progress = stopAtOnce;
    def.progressUser = &asked;
    assert_int_equal(vplShadeView(g, &view, &def, image, NULL), VPL_CANCELLED);
    assert_int_equal(asked, 1);
    vplImage_Destroy(image);
    free(lights);
    vplGeometry_Destroy(g);
}

// Bias compensation works with lightcuts, too, by the same short rays as in deferred shading.
TEST(CompensatedCutsKeepTheLight, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_KELLER;
    o.output.width = 48;
    o.output.height = 36;
    o.shadow.mapSize = 64;
    o.particles.count = 300;
    o.lights.minDistance = 3; // clamps nearly all light of virtual lights
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o.output.show = VPL_SHOW_INDIRECT;
    vplImage* deferred = renderScene(scene, &o, NULL);
    o.pipeline.kind = VPL_ACCUMULATE_LIGHTCUTS;
    vplImage* cut = renderScene(scene, &o, NULL);
    o.lights.compensation = VPL_COMPENSATION_NONE;
    vplImage* clamped = renderScene(scene, &o, NULL);
    vplComparison same, less;
    assert_int_equal(vplImage_Compare(cut, deferred, &same), VPL_SUCCESS);
    assert_int_equal(vplImage_Compare(clamped, deferred, &less), VPL_SUCCESS);
    assertNear(same.energyRatio, 1, 0.005, "energy", 0);
    assert_true(less.energyRatio < 0.8);
    vplImage_Destroy(deferred);
    vplImage_Destroy(cut);
    vplImage_Destroy(clamped);
    vplScene_Destroy(scene);
}
