// SPDX-License-Identifier: MIT
// SSVP in rooms with walls between lights and camera: further bounces, lights by rays, and clusters that are
// split by what their lights see.
#include "scenes.h"
#include "shapes.h"

#include "math/vec.h"

static vplRenderOptions ssvpOptions(int width, int height)
{
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_SSVP;
    o.output.width = width;
    o.output.height = height;
    o.output.show = VPL_SHOW_INDIRECT;
    o.shadow.rsmSize = 256;
    return o;
}

static double meanOfRender(const vplScene* scene, const vplRenderOptions* o, vplRenderStats* stats)
{
    vplImage* image = renderScene(scene, o, stats);
    const size_t values = 3 * (size_t)image->width * (size_t)image->height;
    double sum = 0;
    for (size_t i = 0; i < values; i++) {
        assert_true(isfinite(image->pixels[i]));
        sum += (double)image->pixels[i];
    }
    vplImage_Destroy(image);
    return sum / (double)values;
}

// ---- further bounces

// In a furnace of emission E and reflectance 1/2, light that k bounces sent on before the surface that is seen
// reflects it is E 2^-(k + 1). The first k add up to E (1 - 2^-k) / 2 everywhere, and all of them to E / 2, of
// which 1.6 % or less is left out.
TEST(BouncesOfAFurnaceAddUpToTheClosedForm, 2)
{
    static const int limits[] = {1, 2, 3, 5, -1};
    vplScene* scene = closedCubeScene(context, 0.5f, 4);
    aim(scene, vplVec(0, 0, 0.9f), vplVec(0, 0, -1));
    for (int i = 0; i < 5; i++) {
        vplRenderOptions o = ssvpOptions(32, 32);
        o.maxBounces = limits[i];
        o.lights.minDistance = 0.05f;
        o.ssvp.firstBounce = o.ssvp.secondBounce = 1024;
        const double found = meanOfRender(scene, &o, NULL) / (2 * (1 + 0.5 + 0.25) / 3);
        const double wanted = limits[i] < 0 ? 1 : 1 - pow(0.5, limits[i]);
        printf("# %d bounces: %.4f, closed form %.4f\n", limits[i], found, wanted);
        assertNear(found / wanted, 1, 0.03, "energy", i);
    }
    vplScene_Destroy(scene);
}

// The same by maps of clusters, as the document makes its second bounce.
TEST(MapsAddUpToTheClosedFormToo, 2)
{
    vplScene* scene = closedCubeScene(context, 0.5f, 4);
    aim(scene, vplVec(0, 0, 0.9f), vplVec(0, 0, -1));
    vplRenderOptions o = ssvpOptions(32, 32);
    o.ssvp.nextBounce = VPL_NEXT_BOUNCE_MAPS;
    o.lights.minDistance = 0.05f;
    o.ssvp.firstBounce = o.ssvp.secondBounce = 1024;
    assertNear(meanOfRender(scene, &o, NULL) / (2 * (1 + 0.5 + 0.25) / 3), 1, 0.05, "energy", 0);
    vplScene_Destroy(scene);
}

static vplRgb fluxOf(const vplLightSet* set)
{
    double sum[3] = {0};
    for (int i = 0; i < set->lightCount; i++) {
        const vplVirtualLight* v = &set->lights[i];
        const double share = (double)v->weight / set->particleCount;
        sum[0] += share * (double)v->light.r;
        sum[1] += share * (double)v->light.g;
        sum[2] += share * (double)v->light.b;
    }
    return (vplRgb){(float)sum[0], (float)sum[1], (float)sum[2]};
}

static vplLightSet* particlesIn(const vplGeometry* geometry, int count)
{
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.position = vplVec(0.2f, 0.1f, -0.3f);
    emitter.intensity = (vplRgb){4, 2, 1};
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = count;
    def.reflectivity = 0;
    vplLightSet* set;
    assert_int_equal(vplSimulateParticles(geometry, &emitter, 1, &def, &set), VPL_SUCCESS);
    return set;
}

// In a closed box of reflectance a every ray hits a wall, so the next bounce carries a times the last.
TEST_ALONE(RaysOfAClosedBoxCarryAlbedoTimesTheLastBounce)
{
    vplContext* context = openTestContext(2);
    vplGeometry* geometry = closedCube(context, 0.6f);
    vplLightSet* first = particlesIn(geometry, 100);
    vplNextBounceDef def = vplDefaultNextBounceDef();
    for (int count = 1; count <= 1000; count *= 10) {
        vplLightSet* next;
        def.count = count;
        def.step = 3;
        assert_int_equal(vplShootNextBounce(geometry, first, &def, &next), VPL_SUCCESS);
        assert_int_equal(next->lightCount, count);
        assert_int_equal(next->lightsInStep[3], count);
        assertNear((double)(fluxOf(next).r / fluxOf(first).r), 0.6, 1e-5, "flux", count);
        for (int i = 0; i < count; i++) { // they lie on walls and face the room
            const vplVirtualLight* v = &next->lights[i];
            assertNear((double)vplLargestOf(v->position), 1, 1e-5, "wall", i);
            assert_true(vplDot(v->position, v->normal) < 0);
        }
        vplLightSet_Destroy(next);
    }
    def.step = 64;
    vplLightSet* none = NULL;
    assert_int_equal(vplShootNextBounce(geometry, first, &def, &none), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "step is 64, must be in [1, 63]"));
    def = (vplNextBounceDef){.count = 1};
    assert_int_equal(vplShootNextBounce(geometry, first, &def, &none), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "vplDefaultNextBounceDef"));
    def = vplDefaultNextBounceDef();
    def.count = -1;
    assert_int_equal(vplShootNextBounce(geometry, first, &def, &none), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "count is -1"));
    assert_null(none);
    vplLightSet_Destroy(first);
    vplGeometry_Destroy(geometry);
    closeTestContext(context);
}

// ---- splitting

// Makes the cube [-1, 1]^3 with a wall at x = 0 that leaves 0.2 m open.
static vplGeometry* twoRooms(vplContext* context)
{
    vplScene* scene = closedCubeScene(context, 0.6f, 0);
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0, 0, -0.1f), 0, 0, vplVec(0.05f, 2, 1.8f));
    return buildGeometry(scene);
}

static vplClusterSplitDef splitDef(void)
{
    vplClusterSplitDef def = vplDefaultClusterSplitDef();
    def.view.camera.eye = vplVec(-0.9f, 0.3f, 0.9f);
    def.view.camera.target = vplVec(-0.4f, -0.3f, -0.5f);
    def.view.camera.fovY = 1.2;
    def.view.camera.nearPlane = 0.01;
    def.view.minDistance = 0.1f;
    return def;
}

// Every light has a cluster, every viewpoint is one of its cluster's lights, and clusters hold all flux.
static void checkClusters(const vplLightSet* set, const vplLightClusters* c)
{
    int lights = 0;
    double flux = 0;
    for (int i = 0; i < set->lightCount; i++) {
        assert_in_range(c->of[i], 0, c->count - 1);
    }
    for (int j = 0; j < c->count; j++) {
        assert_true(c->clusters[j].lightCount == 0 || c->of[c->clusters[j].nearest] == j);
        lights += c->clusters[j].lightCount;
        flux += (double)c->clusters[j].flux.r;
    }
    assert_int_equal(lights, set->lightCount);
    assertNear(flux / (double)fluxOf(set).r, 1, 1e-5, "flux", 0);
}

TEST_ALONE(ClustersAreSplitUntilTheySeeWhatTheirLightsSee)
{
    vplContext* context = openTestContext(2);
    vplGeometry* geometry = twoRooms(context);
    vplLightSet* set = particlesIn(geometry, 300);
    vplClusterDef few = vplDefaultClusterDef();
    vplLightClusters *whole, *split;
    few.count = 3;
    assert_int_equal(vplFindClusters(set, &few, &whole), VPL_SUCCESS);
    vplClusterSplitDef def = splitDef();
    vplClusterAgreement agreement;
    double last = INFINITY;
    for (int most = 3; most <= 300; most = most < 4 ? 6 : 4 * most) {
        def.maxCount = most;
        assert_int_equal(vplSplitClusters(geometry, set, whole, &def, &split, &agreement), VPL_SUCCESS);
        printf("# %d clusters: %.3f of the light is wrong\n", split->count,
               agreement.wrong / agreement.light);
        assert_true(agreement.rays > 1000 && agreement.wrong <= last && split->count <= most);
        assert_true(split->count == most || agreement.wrong <= def.wrong * agreement.light);
        checkClusters(set, split);
        last = agreement.wrong;
        vplLightClusters_Destroy(split);
    }
    assert_true(last <= def.wrong * agreement.light);
    def.wrong = 1; // so nothing is split
    assert_int_equal(vplSplitClusters(geometry, set, whole, &def, &split, &agreement), VPL_SUCCESS);
    assert_true(agreement.wrong > 0.1 * agreement.light);
    assert_int_equal(split->count, 3);
    assert_memory_equal(split->of, whole->of, (size_t)set->lightCount * sizeof *whole->of);
    assert_memory_equal(split->clusters, whole->clusters, 3 * sizeof *whole->clusters);
    vplLightClusters_Destroy(split);
    vplLightClusters_Destroy(whole);
    vplLightSet_Destroy(set);
    vplGeometry_Destroy(geometry);
    closeTestContext(context);
}

// Lights on one wall of an empty room see the same points, so their clusters stay as they are.
TEST_ALONE(ClustersThatAgreeAreNotSplit)
{
    vplContext* context = openTestContext(1);
    vplGeometry* geometry = closedCube(context, 0.6f);
    vplLightSet* all = particlesIn(geometry, 300);
    vplLightSet floor = *all;
    vplVirtualLight lights[300];
    floor.lights = lights;
    floor.lightCount = 0;
    for (int i = 0; i < all->lightCount; i++) {
        if (all->lights[i].normal.y > 0.9f) {
            lights[floor.lightCount++] = all->lights[i];
        }
    }
    assert_true(floor.lightCount > 20);
    vplClusterDef few = vplDefaultClusterDef();
    vplLightClusters *whole, *split;
    vplClusterSplitDef def = splitDef();
    vplClusterAgreement agreement;
    few.count = 2;
    def.wrong = 0;
    assert_int_equal(vplFindClusters(&floor, &few, &whole), VPL_SUCCESS);
    assert_int_equal(vplSplitClusters(geometry, &floor, whole, &def, &split, &agreement), VPL_SUCCESS);
    assertNear(agreement.wrong, 0, 0, "wrong", 0);
    assert_true(agreement.light > 0);
    assert_int_equal(split->count, 2);
    vplLightClusters_Destroy(split);
    def.maxCount = 0;
    split = NULL;
    assert_int_equal(vplSplitClusters(geometry, &floor, whole, &def, &split, &agreement),
                     VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "maxCount is 0"));
    def = (vplClusterSplitDef){.maxCount = 4};
    assert_int_equal(vplSplitClusters(geometry, &floor, whole, &def, &split, &agreement),
                     VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "vplDefaultClusterSplitDef"));
    def = splitDef();
    def.wrong = 1.5;
    assert_int_equal(vplSplitClusters(geometry, &floor, whole, &def, &split, &agreement),
                     VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "wrong is 1.5"));
    assert_int_equal(vplSplitClusters(geometry, all, whole, &def, &split, &agreement), VPL_INVALID_ARGUMENT);
    takeMessage();
    assert_null(split);
    vplLightClusters_Destroy(whole);
    vplLightSet_Destroy(all);
    vplGeometry_Destroy(geometry);
    closeTestContext(context);
}

// ---- rooms

// The document's two bounces from 8 clusters have 0.3 to 0.7 of the light of paths in these rooms.
TEST(RoomsHaveTheLightOfPaths, 2, SLOW)
{
    static const char* const scenes[] = {"examples/scenes/door-ajar.json", "tests/data/ssvp-crossing.json",
                                         "tests/data/ssvp-sunk.json", "tests/data/ssvp-thin.json",
                                         "tests/data/ssvp-flat.json"};
    for (int i = 0; i < 5; i++) {
        vplScene* scene;
        assert_int_equal(vplScene_Load(context, scenes[i], &scene), VPL_SUCCESS);
        vplRenderOptions o = ssvpOptions(64, 36);
        o.shadow.rsmSize = 1024;
        vplRenderStats stats;
        const double found = meanOfRender(scene, &o, &stats);
        assert_true(stats.clusterDisagreement >= 0 && stats.clusterDisagreement < 0.06);
        o.maxBounces = 2;
        o.ssvp.nextBounce = VPL_NEXT_BOUNCE_MAPS;
        o.ssvp.maxClusters = o.ssvp.clusters;
        o.ssvp.paraboloidSize = 128;
        const double documented = meanOfRender(scene, &o, &stats);
        assert_true(stats.clusterDisagreement < 0); // no rays tested it
        o = plainOptions();
        o.output.width = 64;
        o.output.height = 36;
        o.method = VPL_METHOD_PATH;
        o.path.samples = 256;
        o.output.show = VPL_SHOW_INDIRECT;
        const double truth = meanOfRender(scene, &o, NULL);
        printf("# %s: energy %.3f, documented %.3f\n", scenes[i], found / truth, documented / truth);
        assertNear(found / truth, 1, 0.15, "energy", i);
        assert_true(documented / truth < 0.8);
        vplScene_Destroy(scene);
    }
}

// Where too few clusters are allowed, one sentence says how much is wrong; with the default nothing is said.
TEST(TooFewClustersAreWarnedOf, 2, SLOW)
{
    vplScene* scene;
    vplRenderStats stats;
    assert_int_equal(vplScene_Load(context, "examples/scenes/door-ajar.json", &scene), VPL_SUCCESS);
    vplRenderOptions o = ssvpOptions(32, 18);
    meanOfRender(scene, &o, &stats);
    assert_string_equal(takeMessage(), "");
    assert_in_range(stats.clusters, 9, 64);
    o.ssvp.maxClusters = 9;
    meanOfRender(scene, &o, &stats);
    assert_int_equal(stats.clusters, 9);
    assert_true(stats.clusterDisagreement > 0.15);
    assert_non_null(strstr(takeMessage(), "is tested wrong"));
    vplScene_Destroy(scene);
}
