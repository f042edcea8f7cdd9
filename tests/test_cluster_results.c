// SPDX-License-Identifier: MIT
// Tests of clusters: their flux and nearest light, extremes, initialization, and invalid input.
#include "cluster_lights.h"

// ---- flux, nearest light, bounds

TEST(FluxIsThatOfTheLightsAndTheNearestIsOneOfThem, 1)
{
    Lights l;
    beginLights(&l, context, 120);
    fillRoom(&l, 77);
    double wanted = 0, sum = 0;
    for (int i = 0; i < 120; i++) {
        l.lights[i].weight = 1 + (float)(i % 5);
        wanted += (double)l.lights[i].light.r * (1 + i % 5) / 120;
    }
    vplClusterDef def = vplDefaultClusterDef();
    vplLightClusters* clusters = find(&l.set, &def);
    assert_int_equal(clusters->end, VPL_CLUSTERS_CONVERGED);
    const vplClusterDistance distance = {def.metric, def.w1, def.w2};
    int lights = 0;
    for (int j = 0; j < clusters->count; j++) {
        const vplLightCluster* c = &clusters->clusters[j];
        const vplClusterPoint centre = {{(double)c->position.x, (double)c->position.y, (double)c->position.z},
                                        {(double)c->normal.x, (double)c->normal.y, (double)c->normal.z}};
        double mean[3] = {0, 0, 0}, best = INFINITY, nearest = 0;
        for (int i = 0; i < 120; i++) {
            const vplVec3 p = l.lights[i].position, n = l.lights[i].normal;
            const vplClusterPoint point = {{(double)p.x, (double)p.y, (double)p.z},
                                           {(double)n.x, (double)n.y, (double)n.z}};
            const double d = vplClusterDistance_Below(&distance, &point, &centre, INFINITY);
            if (clusters->of[i] == j) {
                best = fmin(best, d);
                nearest = i == c->nearest ? d : nearest;
                for (int k = 0; k < 3; k++) {
                    mean[k] += point.p[k] / c->lightCount;
                }
            }
        }
        assert_int_equal(clusters->of[c->nearest], j);
        assertNear(nearest, best, 1e-6, "distance of the nearest", j);
        assertNear((double)c->position.x, mean[0], 1e-6, "x", j);
        assertNear((double)c->position.y, mean[1], 1e-6, "y", j);
        assertNear((double)c->position.z, mean[2], 1e-6, "z", j);
        sum += (double)c->flux.r;
        lights += c->lightCount;
    }
    assertNear(sum, wanted, 1e-6 * wanted, "flux", 0);
    assert_int_equal(lights, 120);
    vplLightClusters_Destroy(clusters);
}

static bool isFlat(Lights* l)
{
    vplClusterDef def = vplDefaultClusterDef();
    def.count = 1;
    vplLightClusters* clusters = find(&l->set, &def);
    const bool flat = clusters->clusters[0].flat;
    vplLightClusters_Destroy(clusters);
    return flat;
}

TEST(FlatClustersLieOnOnePlaneWithOneNormal, 1)
{
    Lights l;
    beginLights(&l, context, 50);
    const float tilt = 0.6f; // a tilted plane far from the origin, so that its points are rounded
    for (int i = 0; i < 50; i++) {
        const float u = (float)(i % 7), v = (float)(i / 7);
        l.lights[i].normal = (vplVec3){-tilt, 0.8f, 0};
        l.lights[i].position = (vplVec3){100 + 0.8f * u, 50 + tilt * u, v};
    }
    assert_true(isFlat(&l));
    l.lights[3].position.y += 0.002f; // the box is 10 m across
    assert_false(isFlat(&l));
    l.lights[3].position.y -= 0.002f;
    l.lights[3].normal = (vplVec3){-0.6012f, 0.7991f, 0};
    assert_false(isFlat(&l));
}

// ---- extremes

static void assertSound(const vplLightClusters* clusters)
{
    for (int j = 0; j < clusters->count; j++) {
        const vplLightCluster* c = &clusters->clusters[j];
        const double length = (double)c->normal.x * (double)c->normal.x +
                              (double)c->normal.y * (double)c->normal.y +
                              (double)c->normal.z * (double)c->normal.z;
        assert_true(isfinite(c->position.x) && isfinite(c->position.y) && isfinite(c->position.z));
        assert_true(isfinite(c->flux.r) && isfinite(c->flux.g) && isfinite(c->flux.b));
        assertNear(length, 1, 1e-6, "length of a normal", j);
        assert_true((c->nearest >= 0) == (c->lightCount > 0) && c->nearest < clusters->lightCount);
    }
}

// X092
TEST(NoLightsMakeNoClusters, 2)
{
    Lights l;
    beginLights(&l, context, 0);
    vplClusterDef def = vplDefaultClusterDef();
    vplLightClusters* clusters = find(&l.set, &def);
    assert_true(clusters->count == 0 && clusters->emptyCount == 0 && clusters->lightCount == 0);
    assert_int_equal(clusters->end, VPL_CLUSTERS_CONVERGED);
    vplLightClusters_Destroy(clusters);
}

// X105
TEST(FewerLightsThanClustersAreEachTheirOwn, 1)
{
    Lights l;
    for (int count = 1; count <= 20; count++) {
        beginLights(&l, context, count);
        fillRoom(&l, 9);
        vplClusterDef def = vplDefaultClusterDef();
        def.count = 20;
        vplLightClusters* clusters = find(&l.set, &def);
        assert_int_equal(clusters->count, count);
        for (int i = 0; i < count; i++) {
            assert_int_equal(clusters->of[i], i);
            assert_int_equal(clusters->clusters[i].nearest, i);
            assert_memory_equal(&clusters->clusters[i].position, &l.lights[i].position, sizeof(vplVec3));
            assert_true(clusters->clusters[i].flat);
        }
        vplLightClusters_Destroy(clusters);
    }
}

// X105
TEST(LightsAtOnePlaceLeaveClustersEmptyWhereTheyWere, 1)
{
    Lights l;
    beginLights(&l, context, 30);
    for (int i = 0; i < 30; i++) {
        l.lights[i].position = (vplVec3){1, 2, 3};
    }
    for (int metric = 0; metric < 4; metric++) {
        vplClusterDef def = vplDefaultClusterDef();
        def.metric = (vplClusterMetric)metric;
        vplLightClusters* clusters = find(&l.set, &def);
        assertSound(clusters);
        assert_true(clusters->count == 8 && clusters->emptyCount == 7);
        assert_int_equal(clusters->clusters[0].lightCount, 30);
        for (int j = 0; j < 8; j++) {
            assert_true(clusters->clusters[j].position.z == 3 && clusters->clusters[j].flat);
        }
        vplLightClusters_Destroy(clusters);
    }
}

// X106
TEST(NormalsThatCancelLeaveTheOldOne, 1)
{
    Lights l;
    beginLights(&l, context, 10);
    for (int i = 0; i < 10; i++) { // 0.6f and 0.8f are rounded: their sum is not 0 to the last bit in general
        const float sign = i % 2 ? -1 : 1;
        l.lights[i].normal = (vplVec3){0, sign * 0.6f, sign * 0.8f};
        l.lights[i].normal.y += i == 3 ? 1e-7f : 0;
    }
    vplClusterDef def = vplDefaultClusterDef();
    def.count = 1;
    def.seeds = (const int[]){1};
    vplLightClusters* clusters = find(&l.set, &def);
    assert_memory_equal(&clusters->clusters[0].normal, &l.lights[1].normal, sizeof(vplVec3));
    assert_false(clusters->clusters[0].flat);
    assertSound(clusters);
    vplLightClusters_Destroy(clusters);
}

// X108
TEST(InASphereTheNearestLightIsOnItsWall, 1)
{
    Lights l;
    beginLights(&l, context, 200);
    for (int i = 0; i < 200; i++) {
        const double z = 1 - (2 * i + 1) / 200.0, r = sqrt(1 - z * z), turn = 2.399963 * i;
        const float x = (float)(r * cos(turn)), y = (float)(r * sin(turn));
        l.lights[i].position = (vplVec3){5 * x, 5 * y, 5 * (float)z};
        l.lights[i].normal = (vplVec3){-x, -y, -(float)z};
    }
    vplClusterDef def = vplDefaultClusterDef();
    vplLightClusters* clusters = find(&l.set, &def);
    assertSound(clusters);
    for (int j = 0; j < clusters->count; j++) {
        const vplLightCluster* c = &clusters->clusters[j];
        const vplVec3 p = c->position, on = l.lights[c->nearest].position;
        const double out = sqrt((double)(p.x * p.x + p.y * p.y + p.z * p.z));
        const double away = sqrt((double)((p.x - on.x) * (p.x - on.x) + (p.y - on.y) * (p.y - on.y) +
                                          (p.z - on.z) * (p.z - on.z)));
        assert_true(out < 4.9);          // the mean is off the wall
        assert_true(away < 5 - out + 1); // as near as 200 lights, 1.25 m apart, allow
        assert_false(c->flat);
    }
    vplLightClusters_Destroy(clusters);
}

TEST(HugeNumbersStayFinite, 1)
{
    Lights l;
    beginLights(&l, context, 64);
    fillRoom(&l, 3);
    for (int i = 0; i < 64; i++) {
        l.lights[i].position.x *= 1e15f;
        l.lights[i].position.y *= 1e-15f;
        l.lights[i].light = (vplRgb){1e30f, 0, 1e-30f};
        l.lights[i].weight = 1e30f;
    }
    const double weights[] = {0, 1e-300, 1, 1e300};
    for (int i = 0; i < 64; i++) {
        vplClusterDef def = vplDefaultClusterDef();
        def.metric = (vplClusterMetric)(i % 4);
        def.w1 = weights[i / 4 % 4];
        def.w2 = weights[i / 16];
        vplLightClusters* clusters = find(&l.set, &def);
        assertSound(clusters);
        vplLightClusters_Destroy(clusters);
    }
}

// ---- initialization

TEST(ClustersFarFromEachOtherStartBetterThanEveryNthLight, 1)
{
    const vplClusterDistance distance = {VPL_CLUSTER_ONE_MINUS, 0.6, 0.4};
    double sums[2] = {0, 0};
    Lights l;
    for (uint64_t room = 0; room < 40; room++) {
        beginLights(&l, context, 256);
        fillRoom(&l, 500 + room);
        for (int k = 0; k < 2; k++) {
            int seeds[32];
            for (int j = 0; j < 32; j++) {
                seeds[j] = 8 * j;
            }
            vplClusterDef def = vplDefaultClusterDef();
            def.count = 32;
            def.seeds = k ? seeds : NULL;
            vplLightClusters* clusters = find(&l.set, &def);
            for (int i = 0; i < 256; i++) {
                const vplLightCluster* c = &clusters->clusters[clusters->of[i]];
                const vplVec3 p = l.lights[i].position, n = l.lights[i].normal;
                const vplClusterPoint a = {{(double)p.x, (double)p.y, (double)p.z},
                                           {(double)n.x, (double)n.y, (double)n.z}};
                const vplClusterPoint b = {
                    {(double)c->position.x, (double)c->position.y, (double)c->position.z},
                    {(double)c->normal.x, (double)c->normal.y, (double)c->normal.z}};
                sums[k] += vplClusterDistance_Below(&distance, &a, &b, INFINITY);
            }
            vplLightClusters_Destroy(clusters);
        }
    }
    assert_true(sums[0] < 0.98 * sums[1]); // 0.96 when the test was written
}

TEST(ClustersOfTheLastFrameAreFoundAgainAtOnce, 1)
{
    Lights l;
    beginLights(&l, context, 256);
    fillRoom(&l, 21);
    vplClusterDef def = vplDefaultClusterDef();
    vplLightClusters* first = find(&l.set, &def);
    assert_true(first->end == VPL_CLUSTERS_CONVERGED && first->iterations > 1);
    def.last = first;
    vplLightClusters* again = find(&l.set, &def);
    assert_int_equal(again->iterations, 1);
    assertSame(again, first);
    vplLightClusters_Destroy(again);

    for (int i = 0; i < 256; i++) { // the light moves by a small step
        l.lights[i].position.x += 0.01f;
    }
    again = find(&l.set, &def);
    int moved = 0;
    for (int i = 0; i < 256; i++) {
        moved += again->of[i] != first->of[i];
    }
    assert_int_equal(moved, 0);
    vplLightClusters_Destroy(again);

    const int counts[] = {3, 12}; // fewer: the last frame's first ones; more: also lights far from them
    for (int k = 0; k < 2; k++) {
        def.count = counts[k];
        def.maxIterations = 0;
        again = find(&l.set, &def);
        assert_int_equal(again->count, counts[k]);
        assert_int_equal(again->emptyCount, 0);
        vplLightClusters_Destroy(again);
    }
    vplLightClusters_Destroy(first);
}

TEST(EmptyClustersOfTheLastFrameStartAnew, 1)
{
    Lights l;
    beginLights(&l, context, 100);
    vplClusterDef def = vplDefaultClusterDef();
    vplLightClusters* together = find(&l.set, &def);
    assert_int_equal(together->emptyCount, 7);
    fillRoom(&l, 4);
    def.last = together;
    vplLightClusters* apart = find(&l.set, &def);
    assert_int_equal(apart->emptyCount, 0);
    vplLightClusters_Destroy(apart);
    vplLightClusters_Destroy(together);
}

// ---- invalid input

static void refuse(const vplLightSet* set, const vplClusterDef* def, const char* sentence)
{
    vplLightClusters* clusters = NULL;
    assert_int_equal(vplFindClusters(set, def, &clusters), VPL_INVALID_ARGUMENT);
    assert_null(clusters);
    assert_string_equal(takeMessage(), sentence);
}

// A light of weight 3 counts three times, one of weight 0 does not count; equal weights change nothing.
TEST(WeightsMoveMeans, 1)
{
    Lights l;
    beginLights(&l, context, 4);
    for (int i = 0; i < 4; i++) {
        l.lights[i].position = (vplVec3){(float)i, 0, 0};
    }
    float weights[4] = {3, 1, 0, 1};
    vplClusterDef def = vplDefaultClusterDef();
    def.count = 1;
    def.weights = weights;
    vplLightClusters* clusters = find(&l.set, &def);
    assertNear((double)clusters->clusters[0].position.x, 4.0 / 5, 1e-7, "mean", 0);
    assert_int_equal(clusters->clusters[0].lightCount, 4);
    vplLightClusters_Destroy(clusters);
    def.count = 2; // a light of weight 0 is never chosen as the farthest
    weights[3] = 0;
    clusters = find(&l.set, &def);
    assert_int_equal(clusters->of[0], 0);
    assert_int_equal(clusters->of[1], 1);
    vplLightClusters_Destroy(clusters);
    weights[1] = NAN;
    clusters = NULL;
    assert_int_equal(vplFindClusters(&l.set, &def, &clusters), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "weights[1]"));
}

TEST(MistakesAreNamed, 1)
{
    Lights l;
    beginLights(&l, context, 10);
    vplClusterDef def = {0};
    refuse(&l.set, &def, "vplClusterDef was not made by vplDefaultClusterDef");
    def = vplDefaultClusterDef();
    def.count = 0;
    refuse(&l.set, &def, "vplClusterDef.count is 0, must be in [1, 16777216]");
    def = vplDefaultClusterDef();
    def.metric = (vplClusterMetric)4;
    refuse(&l.set, &def, "vplClusterDef.metric is 4, must be a vplClusterMetric");
    def = vplDefaultClusterDef();
    def.w1 = NAN;
    refuse(&l.set, &def, "vplClusterDef.w1 and w2 are nan and 0.4, must be finite and at least 0");
    def = vplDefaultClusterDef();
    def.w2 = -1;
    refuse(&l.set, &def, "vplClusterDef.w1 and w2 are 0.6 and -1, must be finite and at least 0");
    def = vplDefaultClusterDef();
    def.maxIterations = 10001;
    refuse(&l.set, &def, "vplClusterDef.maxIterations is 10001, must be in [0, 10000]");
    def = vplDefaultClusterDef();
    def.count = 2;
    def.seeds = (const int[]){0, 10};
    refuse(&l.set, &def, "vplClusterDef.seeds[1] is 10, must be in [0, 10)");
    def = vplDefaultClusterDef();
    l.lights[7].object = -1;
    refuse(&l.set, &def, "light 7 is an emitter itself, clusters are of lights on surfaces");
    vplLightClusters_Destroy(NULL);
}
