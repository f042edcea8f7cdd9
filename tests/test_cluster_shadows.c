// SPDX-License-Identifier: MIT
// Tests of lights that share their cluster's visibility, with maps that the tests fill texel by texel.
#include "stage.h"

#include "math/vec.h"

#include <stdlib.h>
#include <string.h>

enum { WIDTH = 131, HEIGHT = 75, COUNT = 300, SIZE = 8, TEXELS = 2 * (SIZE + 2) * (SIZE + 2) };

static const float nothing[TEXELS]; // an empty map: light reaches all points of the drawn hemispheres

static vplParaboloidMap farMapOf(vplContext* context, const float* texels, vplVec3 position, int hemispheres)
{
    return (vplParaboloidMap){.position = position,
                              .right = {1, 0, 0},
                              .up = {0, 0, -1},
                              .forward = {0, 1, 0},
                              .size = SIZE,
                              .hemispheres = hemispheres,
                              .texels = texels,
                              .context = context};
}

// Returns an empty map that sees everything (`all`), or one high above that has only its upper hemisphere and
// sees nothing of the stage.
static vplParaboloidMap seeing(vplContext* context, bool all)
{
    return farMapOf(context, nothing, vplVec(0, all ? 3 : 100, 0), all ? 2 : 1);
}

typedef struct Setting {
    vplContext* context;
    vplGeometry* geometry;
    vplView view;
    vplShadeLight* lights;
    int clusters[COUNT];
    vplParaboloidMap maps[COUNT];
} Setting;

// Opens a setting with clusters of 40 lights, every other one of which sees nothing.
static Setting openSetting(vplContext* context, vplGeometry* geometry)
{
    Setting s = {.context = context, .geometry = geometry};
    s.view = stageView(vplVec(1, 2, 5), WIDTH, HEIGHT);
    s.lights = rollLights(COUNT, 7);
    for (int i = 0; i < COUNT; i++) {
        s.clusters[i] = i / 40;
        s.maps[i] = seeing(context, i % 2 == 0);
    }
    return s;
}

static Setting openStage(void)
{
    vplContext* context = openTestContext(2);
    return openSetting(context, stage(context));
}

static void closeSetting(Setting* s)
{
    free(s->lights);
    vplGeometry_Destroy(s->geometry);
    closeTestContext(s->context);
}

static vplShadeDef clusteredDef(const Setting* s, int count, int side)
{
    vplShadeDef def = stageDef(s->lights, count, side);
    def.lightClusters = s->clusters;
    def.clusterShadows = s->maps;
    def.clusterCount = COUNT;
    return def;
}

static uint64_t shadeHash(const Setting* s, const vplShadeDef* def)
{
    vplImage* image = shadeStage(s->geometry, &s->view, def);
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    return hash;
}

TEST_ALONE(OneClusterThatSeesAllHasTheBitsOfNoShadows)
{
    Setting s = openStage();
    memset(s.clusters, 0, sizeof s.clusters);
    for (int side = 0; side <= 4; side++) {
        const vplShadeDef plain = stageDef(s.lights, COUNT, side), shared = clusteredDef(&s, COUNT, side);
        assert_true(shadeHash(&s, &plain) == shadeHash(&s, &shared));
    }
    closeSetting(&s);
}

// The bits also agree if there is no map at all.
TEST_ALONE(LightsWithoutAClusterHaveTheBitsOfNoShadows)
{
    Setting s = openStage();
    memset(s.clusters, 0xff, sizeof s.clusters);
    for (int side = 0; side <= 4; side++) {
        const vplShadeDef plain = stageDef(s.lights, COUNT, side);
        vplShadeDef shared = clusteredDef(&s, COUNT, side);
        shared.clusterCount = 0;
        shared.clusterShadows = NULL;
        assert_true(shadeHash(&s, &plain) == shadeHash(&s, &shared));
    }
    closeSetting(&s);
}

TEST_ALONE(InterleavedByOneIsDeferredBitForBit)
{
    Setting s = openStage();
    const vplShadeDef deferred = clusteredDef(&s, COUNT, 0), one = clusteredDef(&s, COUNT, 1);
    const vplShadeDef plain = stageDef(s.lights, COUNT, 0);
    assert_true(shadeHash(&s, &deferred) == shadeHash(&s, &one));
    assert_true(shadeHash(&s, &deferred) != shadeHash(&s, &plain));
    closeSetting(&s);
}

// Each light has a cluster of its own, and every third cluster sees the stage: the picture has the bits of
// these lights alone, as long as they form one group.
TEST_ALONE(ClustersOfOneLightAreMapsOfTheirOwn)
{
    enum { FEW = VPL_LIGHT_GROUP };
    Setting s = openStage();
    vplShadeLight seen[FEW];
    int seenCount = 0;
    for (int i = 0; i < FEW; i++) {
        s.clusters[i] = i;
        s.maps[i] = seeing(s.context, i % 3 == 0);
        seen[seenCount] = s.lights[i];
        seenCount += i % 3 == 0;
    }
    const vplShadeDef shared = clusteredDef(&s, FEW, 0), alone = stageDef(seen, seenCount, 0);
    assert_true(shadeHash(&s, &shared) == shadeHash(&s, &alone));
    closeSetting(&s);
}

// Clusters change at every light of the list, with unclustered lights between: the picture is the sum of the
// lights that are visible.
TEST_ALONE(AnyOrderOfClustersGivesTheSameSum)
{
    Setting s = openStage();
    vplShadeLight seen[COUNT];
    int seenCount = 0;
    for (int i = 0; i < COUNT; i++) {
        s.clusters[i] = i * i % 13 - 1; // -1 has no map
        seen[seenCount] = s.lights[i];
        seenCount += s.clusters[i] < 0 || s.clusters[i] % 2 == 0;
    }
    const vplShadeDef shared = clusteredDef(&s, COUNT, 0), alone = stageDef(seen, seenCount, 0);
    vplImage *a = shadeStage(s.geometry, &s.view, &shared), *b = shadeStage(s.geometry, &s.view, &alone);
    assert_true(seenCount > 50 && seenCount < 250);
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        assertNear((double)a->pixels[i], (double)b->pixels[i], 1e-6 * (double)b->pixels[i], "radiance", i);
    }
    vplImage_Destroy(a);
    vplImage_Destroy(b);
    closeSetting(&s);
}

// The map holds the hemisphere above a height of one metre over the floor: points below get no light, points
// above all of it. Interleaved pixels look up the map each for themselves; those whose window lies on one
// side of the boundary are compared.
TEST_ALONE(VisibilityIsThatOfEachPoint)
{
    Setting s = openStage();
    memset(s.clusters, 0, sizeof s.clusters);
    s.maps[0] = farMapOf(s.context, nothing, vplVec(0, 1, 0), 1);
    PixelSample* samples = samplePixels(s.geometry, &s.view);
    for (int side = 0; side <= 4; side += 2) {
        const vplShadeDef plain = stageDef(s.lights, COUNT, side), shared = clusteredDef(&s, COUNT, side);
        vplImage *a = shadeStage(s.geometry, &s.view, &shared), *b = shadeStage(s.geometry, &s.view, &plain);
        int dark = 0, bright = 0;
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            const double up = 2 + samples[i].p[1], margin = 0.25; // 4 pixels are 0.2 m
            const float *own = a->pixels + 3 * i, *all = b->pixels + 3 * i;
            if (samples[i].w > 0 && up < 1 - margin) {
                assert_true(own[0] == 0 && own[1] == 0 && own[2] == 0);
                dark += all[0] > 0;
            } else if (samples[i].w > 0 && up > 1 + margin) {
                assert_true(memcmp(own, all, 3 * sizeof *own) == 0);
                bright += all[0] > 0;
            }
        }
        assert_true(dark > 1000 && bright > 300);
        vplImage_Destroy(a);
        vplImage_Destroy(b);
    }
    free(samples);
    closeSetting(&s);
}

// Light from far above a floor does not depend on which clusters a class has lights of: the sum is that of
// deferred shading, for clusters of many and of few lights, and for few and many clusters.
TEST_ALONE(EachLightIsInOneClass)
{
    vplContext* context = openTestContext(2);
    Setting s = openSetting(context, floorQuad(context, vplVec(0, 0, 0), 100, 0.5f));
    s.view = stageView(vplVec(0, 3, 0.5f), WIDTH, HEIGHT);
    for (int i = 0; i < COUNT; i++) {
        s.lights[i].py = 2000 + 100 * s.lights[i].py;
        s.lights[i].r = s.lights[i].g = s.lights[i].b = 1e6f;
    }
    static const int counts[] = {1, 7, 8, 9, 30, COUNT};
    for (int k = 0; k < 6; k++) {
        for (int i = 0; i < COUNT; i++) {
            s.clusters[i] = (int)((int64_t)i * i * counts[k] / (COUNT * COUNT)) - (k == 3);
        }
        const vplShadeDef all = clusteredDef(&s, COUNT, 0);
        vplImage* deferred = shadeStage(s.geometry, &s.view, &all);
        for (int side = 2; side <= 6; side++) {
            const vplShadeDef def = clusteredDef(&s, COUNT, side);
            vplImage* image = shadeStage(s.geometry, &s.view, &def);
            for (int i = 0; i < WIDTH * HEIGHT; i++) {
                const int x = i % WIDTH, y = i / WIDTH, border = side - 1;
                if (x >= border && y >= border && x < WIDTH - border && y < HEIGHT - border) {
                    const double wanted = (double)deferred->pixels[3 * i];
                    assert_true(wanted > 0);
                    assertNear((double)image->pixels[3 * i], wanted, 1e-6 * wanted, "radiance", counts[k]);
                }
            }
            vplImage_Destroy(image);
        }
        vplImage_Destroy(deferred);
    }
    closeSetting(&s);
}

// ---- the same bits

// Makes the stage below a smooth sphere, whose points have geometric and shading normals.
static vplGeometry* smoothStage(vplContext* context)
{
    vplScene* scene = sceneOf(context, 0.5f);
    vplObjectDef object = vplDefaultObjectDef();
    const double rotate[3] = {-VPL_PI / 2, 0, 0};
    object.transform = vplMat4_FromParts(vplVec(0, 0, 0), rotate, vplVec(4, 4, 1));
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    Shape ball = icosphere(2);
    const double still[3] = {0, 0, 0};
    const vplMat4 place = vplMat4_FromParts(vplVec(0, 0.8f, 0), still, vplVec(0.7f, 0.7f, 0.7f));
    addShape(scene, &ball, true, &place);
    freeShape(&ball);
    return buildGeometry(scene);
}

TEST_ALONE(ThreadsAndInstructionSetsChangeNoBit)
{
    static float spots[TEXELS]; // some distances are long, some short
    Dice dice = {5, 0};
    for (int i = 0; i < TEXELS; i++) {
        spots[i] = roll(&dice, 0, 0.8f);
    }
    static const int threads[] = {1, 2, 3, 7};
    uint64_t expected[2] = {0, 0};
    for (int k = 0; k < 4 + VPL_ISA_COUNT; k++) {
        vplContext* context = k < 4 ? openTestContext(threads[k]) : openIsaContext(2, (vplIsa)(k - 4));
        if (context == NULL) {
            continue;
        }
        Setting s = openSetting(context, smoothStage(context));
        for (int i = 0; i < COUNT; i++) {
            s.maps[i] = farMapOf(context, spots, vplVec(0, 3, 0), 2);
        }
        for (int way = 0; way < 2; way++) {
            const vplShadeDef def = clusteredDef(&s, COUNT, 4 * way);
            const uint64_t hash = shadeHash(&s, &def);
            assert_true(k == 0 || hash == expected[way]);
            expected[way] = hash;
        }
        closeSetting(&s);
    }
}

// ---- refusals

TEST_ALONE(WhatClustersCannotDoIsRefused)
{
    Setting s = openStage();
    vplImage* image;
    assert_int_equal(vplImage_Create(s.context, WIDTH, HEIGHT, &image), VPL_SUCCESS);
    const vplAccumulation ways[] = {VPL_ACCUMULATE_MULTIPASS, VPL_ACCUMULATE_BATCHED,
                                    VPL_ACCUMULATE_LIGHTCUTS};
    for (int i = 0; i < 7; i++) {
        vplShadeDef def = clusteredDef(&s, COUNT, 0);
        def.batch = 1;
        def.cutError = 0.1f;
        def.accumulation = i < 3 ? ways[i] : VPL_ACCUMULATE_DEFERRED;
        def.lightRays = i == 3;
        s.clusters[5] = i == 4 ? -2 : i == 5 ? COUNT : 0;
        s.clusters[0] = i == 6 ? -2 : 0;
        assert_int_equal(vplShadeView(s.geometry, &s.view, &def, image, NULL), VPL_INVALID_ARGUMENT);
        const char* message = takeMessage();
        assert_true(strstr(message, i < 3    ? "deferred and interleaved shading only"
                                    : i == 3 ? "no maps or rays of their own"
                                    : i == 4 ? "lightClusters[5] is -2, must be in [-1, 300)"
                                    : i == 5 ? "lightClusters[5] is 300, must be in [-1, 300)"
                                             : "lightClusters[0] is -2, must be in [-1, 300)") != NULL);
    }
    vplImage_Destroy(image);
    closeSetting(&s);
}
