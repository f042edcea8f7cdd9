// SPDX-License-Identifier: MIT
// Tests of second-bounce lights: their flux and their positions.
#include "shapes.h"

#include "base/hash.h"
#include "math/vec.h"
#include "render/stages/show.h"

// There are five clusters on the floor of the cube [-1, 1]^3, of flux (4, 2, 1) W each.
enum { CLUSTERS = 5 };

typedef struct Stand {
    vplContext* context;
    vplGeometry* geometry;
    vplLightCluster list[CLUSTERS];
    vplLightClusters clusters;
    vplParaboloidMaps* maps;
} Stand;

static void openStand(Stand* s, vplContext* context, float rho, int size)
{
    vplParaboloidPlace places[CLUSTERS];
    s->context = context;
    s->geometry = closedCube(context, rho);
    for (int i = 0; i < CLUSTERS; i++) {
        const vplVec3 at = vplVec(0.35f * (float)i - 0.7f, -1, 0.1f * (float)i), up = vplVec(0, 1, 0);
        s->list[i] = (vplLightCluster){at, up, {4, 2, 1}, 3, 0, true};
        places[i] = (vplParaboloidPlace){at, up, 1, true};
    }
    s->clusters = (vplLightClusters){.clusters = s->list, .count = CLUSTERS, .context = context};
    assert_int_equal(vplParaboloidMaps_Create(context, size, CLUSTERS, true, &s->maps), VPL_SUCCESS);
    assert_int_equal(vplParaboloidMaps_Draw(s->maps, s->geometry, places, CLUSTERS, NULL, NULL), VPL_SUCCESS);
}

static void closeStand(Stand* s)
{
    vplParaboloidMaps_Destroy(s->maps);
    vplGeometry_Destroy(s->geometry);
    closeTestContext(s->context);
}

static vplLightSet* sampleStand(const Stand* s, const vplSecondBounceDef* def)
{
    vplLightSet* set;
    assert_int_equal(vplSampleParaboloidMaps(s->geometry, &s->clusters, s->maps, def, &set), VPL_SUCCESS);
    return set;
}

// Returns the flux of all lights as the picture gets it, in W.
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

// In a closed box of reflectance a, the second bounce carries a times the first.
TEST_ALONE(SecondBounceOfAClosedBoxIsAlbedoTimesTheFirst)
{
    Stand s;
    openStand(&s, openTestContext(2), 0.6f, 128);
    const double wanted = 0.6 * 4 * CLUSTERS;
    static const struct {
        int count;
        double error; // relative
    } runs[] = {{32 * CLUSTERS, 0.004},
                {256 * CLUSTERS, 0.003},
                {16384 * CLUSTERS, 0.0002},
                {32 * CLUSTERS + 3, 0.005}};
    for (int i = 0; i < 4; i++) {
        vplSecondBounceDef def = vplDefaultSecondBounceDef();
        def.count = runs[i].count;
        vplLightSet* set = sampleStand(&s, &def);
        const vplRgb flux = fluxOf(set);
        printf("# %d samples: %+.3f %%\n", def.count, 100 * ((double)flux.r / wanted - 1));
        assertNear((double)flux.r / wanted, 1, runs[i].error, "flux", i);
        assertNear((double)(flux.g / flux.r), 0.5, 1e-5, "green", i);
        assert_int_equal(set->escaped, 0);
        vplLightSet_Destroy(set);
    }
    closeStand(&s);
}

// X104: without the weight, the sum is the same if all walls are alike, but too much of it comes from near
// the horizon: a diffuse light sends sin^2 10 = 3.0 % of its flux below 10 degrees, but 1 - tan^2 40 = 29.6 %
// of the disk lies there.
TEST_ALONE(PrintedWeightsBrightenTheHorizon)
{
    Stand s;
    openStand(&s, openTestContext(1), 0.6f, 256);
    double low[2];
    for (int printed = 0; printed < 2; printed++) {
        vplSecondBounceDef def = vplDefaultSecondBounceDef();
        def.count = 4096 * CLUSTERS;
        def.weight = printed ? VPL_SECOND_WEIGHT_PRINTED : VPL_SECOND_WEIGHT_COSINE;
        vplLightSet* set = sampleStand(&s, &def);
        double sum = 0, all = 0;
        for (int i = 0; i < set->lightCount; i++) {
            const vplVirtualLight* v = &set->lights[i];
            const vplVec3 way = vplSub(v->position, s.maps->maps[v->particle / 4096].position);
            const double share = (double)(v->weight * v->light.r);
            all += share;
            sum += way.y < 0.1736482f * vplLength(way) ? share : 0;
        }
        low[printed] = sum / all;
        vplLightSet_Destroy(set);
    }
    printf("# flux below 10 degrees: %.4f, as printed %.4f\n", low[0], low[1]);
    assertNear(low[0], 0.0302, 0.001, "weighted", 0);
    assertNear(low[1], 0.2959, 0.004, "printed", 1);
    closeStand(&s);
}

TEST_ALONE(LightsLieOnWhatTheirClusterSeesAndFaceIt)
{
    Stand s;
    openStand(&s, openTestContext(1), 0.6f, 64);
    vplSecondBounceDef def = vplDefaultSecondBounceDef();
    vplLightSet* set = sampleStand(&s, &def);
    assert_int_equal(set->particleCount, 256);
    assert_int_equal(set->stepCount, 2);
    assert_int_equal(set->stepCounts[1], 256);
    assert_int_equal(set->lightsInStep[0], 0);
    assert_int_equal(set->lightsInStep[1], set->lightCount);
    assert_true(set->lightCount >= 254); // lights on the rim carry nothing
    for (int i = 0; i < set->lightCount; i++) {
        const vplVirtualLight* v = &set->lights[i];
        const vplVec3 p = v->position;
        const int cluster = v->particle < 52 ? 0 : 1 + (v->particle - 52) / 51; // 256 = 52 + 4 * 51
        assert_true(v->step == 1 && (i == 0 || v->particle > set->lights[i - 1].particle));
        assert_true(fmaxf(fabsf(p.x), fmaxf(fabsf(p.y), fabsf(p.z))) <= 1.00001f);
        assert_true(vplDot(vplSub(s.list[cluster].position, p), v->normal) > 0);
        assertNear((double)v->weight, 256.0 / (cluster ? 51 : 52), 1e-5, "weight", i);
    }
    vplLightSet_Destroy(set);
    closeStand(&s);
}

// Samples are the same in all frames; another shift gives other points, and clusters have different samples.
TEST_ALONE(PointsAreTheSameFromFrameToFrame)
{
    Stand s;
    openStand(&s, openTestContext(1), 0.6f, 256);
    for (int i = 0; i < CLUSTERS; i++) {
        s.list[i].position = s.list[0].position;
    }
    vplSecondBounceDef def = vplDefaultSecondBounceDef();
    vplLightSet *one = sampleStand(&s, &def), *two = sampleStand(&s, &def);
    def.shift = 1;
    vplLightSet* other = sampleStand(&s, &def);
    assert_int_equal(one->lightCount, two->lightCount);
    int same = 0;
    for (int i = 0; i < one->lightCount; i++) {
        assert_memory_equal(&one->lights[i].position, &two->lights[i].position, sizeof(vplVec3));
        same += i < other->lightCount &&
                memcmp(&one->lights[i].position, &other->lights[i].position, sizeof(vplVec3)) == 0;
    }
    assert_true(same < 8);
    vplLightSet_Destroy(one);
    vplLightSet_Destroy(two);
    vplLightSet_Destroy(other);
    closeStand(&s);
}

TEST_ALONE(ClustersWithoutLightSampleNothing)
{
    Stand s;
    openStand(&s, openTestContext(1), 0.6f, 32);
    s.list[0].lightCount = 0;
    s.list[2].flux = (vplRgb){0, 0, 0};
    vplSecondBounceDef def = vplDefaultSecondBounceDef();
    vplLightSet* set = sampleStand(&s, &def);
    assertNear((double)fluxOf(set).r / (0.6 * 4 * (CLUSTERS - 2)), 1, 0.02, "flux", 0);
    vplLightSet_Destroy(set);
    def.count = 0;
    set = sampleStand(&s, &def);
    assert_int_equal(set->lightCount, 0);
    vplLightSet_Destroy(set);
    def.count = 64;
    for (int i = 0; i < CLUSTERS; i++) {
        s.list[i].lightCount = 0;
    }
    set = sampleStand(&s, &def);
    assert_int_equal(set->lightCount, 0);
    vplLightSet_Destroy(set);
    def.count = VPL_MAX_LIGHTS + 1;
    assert_int_equal(vplSampleParaboloidMaps(s.geometry, &s.clusters, s.maps, &def, &set),
                     VPL_INVALID_ARGUMENT);
    def = (vplSecondBounceDef){.count = 1};
    assert_int_equal(vplSampleParaboloidMaps(s.geometry, &s.clusters, s.maps, &def, &set),
                     VPL_INVALID_ARGUMENT);
    def = vplDefaultSecondBounceDef();
    s.clusters.count = 2;
    assert_int_equal(vplSampleParaboloidMaps(s.geometry, &s.clusters, s.maps, &def, &set),
                     VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "not 5"));
    closeStand(&s);
}

TEST_ALONE(APictureOfAMapShowsPositionsNormalsAlbedoAndDistance)
{
    Stand s;
    openStand(&s, openTestContext(1), 0.6f, 33);
    vplImage* image;
    assert_int_equal(vplShowParaboloidMap(&s.maps->maps[2], s.geometry, &image), VPL_SUCCESS);
    assert_true(image->width == 4 * 33 && image->height == 33);
    const float* row = image->pixels + 3 * 16 * (size_t)image->width; // straight up, from (0, -1, 0.2)
    float far = 0;                                                    // the longest distance is drawn white
    for (int i = 0; i < 33 * 33; i++) {
        const float texel = s.maps->maps[2].texels[i];
        far = texel > 0 ? fmaxf(far, 1 / texel) : far;
    }
    const float wanted[4][3] = {
        {0.5f, 1, 0.6f}, {0.5f, 0, 0.5f}, {0.6f, 0.6f, 0.6f}, {2 / far, 2 / far, 2 / far}};
    for (int k = 0; k < 4; k++) {
        for (int c = 0; c < 3; c++) {
            assertNear((double)row[3 * (k * 33 + 16) + c], (double)wanted[k][c], 1e-4, "pixel", 3 * k + c);
        }
        assert_true(image->pixels[3 * k * 33] == 0); // the corner lies outside the disk
    }
    vplImage_Destroy(image);
    closeStand(&s);
}
