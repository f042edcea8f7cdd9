// SPDX-License-Identifier: MIT
// End-to-end tests of SSVP: its limits, its toggles, and extremes. The stages have suites of their own: rsm,
// clusters, paraboloid, secondBounce, interleaved.
#include "scenes.h"
#include "shapes.h"

#include "math/vec.h"

// ---- scenes

static void addBox(vplScene* scene)
{
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0.25f, -0.7f, -0.2f), 0, 0.5, vplVec(0.5f, 0.6f, 0.5f));
}

// Makes the closed cube [-1, 1]^3 with a box in it and a spot that shines at a wall.
static vplScene* spotRoom(vplContext* context, float rho)
{
    vplScene* scene = closedCubeScene(context, rho, 0);
    addBox(scene);
    aim(scene, vplVec(0.1f, -0.2f, 0.9f), vplVec(0, -0.3f, -1));
    addEmitter(scene, VPL_EMITTER_SPOT, vplVec(0.5f, 0.4f, 0.3f), vplVec(-1, -0.3f, -0.6f), 10);
    return scene;
}

// Makes a box on a floor between a red and a white wall, open so that directional light reaches it, too.
static vplScene* corner(vplContext* context, vplEmitterType type)
{
    vplScene* scene = sceneOf(context, 0.7f);
    const int red = addMaterial(scene, (vplRgb){0.8f, 0.1f, 0.1f}, 0);
    const vplVec3 size = {2, 2, 1};
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, -1, 0), -VPL_PI / 2, 0, size);
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, -1), 0, 0, size);
    addThing(scene, VPL_OBJECT_QUAD, red, vplVec(-1, 0, 0), 0, VPL_PI / 2, size);
    addBox(scene);
    aim(scene, vplVec(1.5f, 0.8f, 2), vplVec(0, -0.4f, 0));
    addEmitter(scene, type, vplVec(0.5f, 0.7f, 0.6f), vplVec(-1, -0.9f, -0.8f), 10);
    return scene;
}

static vplRenderOptions ssvpOptions(int size)
{
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_SSVP;
    o.output.width = o.output.height = size;
    o.shadow.rsmSize = 256;
    return o;
}

static double meanOf(const vplImage* image)
{
    const size_t values = 3 * (size_t)image->width * (size_t)image->height;
    double sum = 0;
    for (size_t i = 0; i < values; i++) {
        assert_true(isfinite(image->pixels[i]));
        sum += (double)image->pixels[i];
    }
    return sum / (double)values;
}

// Returns the root mean square of the difference, relative to the second picture's mean.
static double differenceOf(const vplImage* a, const vplImage* b)
{
    const size_t values = 3 * (size_t)a->width * (size_t)a->height;
    double squares = 0;
    for (size_t i = 0; i < values; i++) {
        const double d = (double)a->pixels[i] - (double)b->pixels[i];
        squares += d * d;
    }
    const double mean = meanOf(b);
    return sqrt(squares / (double)values) / mean;
}

static double meanOfRender(const vplScene* scene, const vplRenderOptions* o)
{
    vplImage* image = renderScene(scene, o, NULL);
    const double mean = meanOf(image);
    vplImage_Destroy(image);
    return mean;
}

// ---- limits

// Renders with the given kind of shadows for virtual lights.
static vplImage* renderWith(const vplScene* scene, vplRenderOptions o, vplLightShadows shadows)
{
    o.lights.shadows = shadows;
    return renderScene(scene, &o, NULL);
}

// The document: "for the hypothetical scenario where we have as many clusters as VPLs ... the technique is
// indistinguishable from the original Instant Radiosity". Each light then has a map of its own; the remaining
// error is the difference between maps and rays at shadow edges, as with Keller's map per light.
TEST(AsManyClustersAsLightsAreInstantRadiosity, 2, SLOW)
{
    vplScene* scene = spotRoom(context, 0.6f);
    vplRenderOptions o = ssvpOptions(64);
    o.output.show = VPL_SHOW_INDIRECT;
    o.pipeline.kind = VPL_ACCUMULATE_DEFERRED;
    o.ssvp.firstBounce = o.ssvp.secondBounce = o.ssvp.clusters = 128;
    o.ssvp.paraboloidSize = o.lights.mapSize = 512;
    vplImage* rays = renderWith(scene, o, VPL_LIGHT_SHADOWS_RAY);
    vplImage* clusters = renderWith(scene, o, VPL_LIGHT_SHADOWS_CLUSTER);
    vplImage* maps = renderWith(scene, o, VPL_LIGHT_SHADOWS_MAP);
    vplImage* none = renderWith(scene, o, VPL_LIGHT_SHADOWS_NONE);
    assertNear(meanOf(clusters) / meanOf(rays), 1, 0.01, "energy", 0);
    assertNear(differenceOf(clusters, rays), 0, 0.01, "clusters and rays", 0);
    assertNear(differenceOf(clusters, maps), 0, 0.02, "clusters and maps", 0);
    assert_true(differenceOf(none, rays) > 5 * differenceOf(clusters, rays)); // shadows matter in this scene
    o.ssvp.clusters = 8;
    vplImage* few = renderWith(scene, o, VPL_LIGHT_SHADOWS_CLUSTER);
    assert_true(differenceOf(few, rays) > 2 * differenceOf(clusters, rays)); // so does the number of clusters
    vplImage* all[5] = {rays, clusters, maps, none, few};
    for (int i = 0; i < 5; i++) {
        vplImage_Destroy(all[i]);
    }
    vplScene_Destroy(scene);
}

// Light of one and of two bounces must equal that of the path tracer, which uses no maps, clusters or virtual
// lights.
TEST(EachBounceHasTheLightOfPaths, 2, SLOW)
{
    const vplEmitterType types[3] = {VPL_EMITTER_SPOT, VPL_EMITTER_POINT, VPL_EMITTER_DIRECTIONAL};
    for (int k = 0; k < 3; k++) {
        vplScene* scene = corner(context, types[k]);
        for (int bounces = 1; bounces <= 2; bounces++) {
            vplRenderOptions o = ssvpOptions(32);
            o.ssvp.firstBounce = o.ssvp.secondBounce = 8192;
            o.ssvp.clusters = 64;
            o.lights.minDistance = 0.01f;
            o.pipeline.kind = VPL_ACCUMULATE_DEFERRED; // interleaved sharing would move light across edges
            o.maxBounces = bounces;
            o.output.show = VPL_SHOW_INDIRECT;
            o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
            const double found = meanOfRender(scene, &o);
            o = plainOptions();
            o.output.width = o.output.height = 32;
            o.method = VPL_METHOD_PATH;
            o.path.pixel = VPL_PIXEL_CENTRE;
            o.path.samples = 512;
            o.maxBounces = bounces;
            o.output.show = VPL_SHOW_INDIRECT;
            assertNear(found / meanOfRender(scene, &o), 1, 0.02, "energy", 10 * k + bounces);
        }
        vplScene_Destroy(scene);
    }
}

// The document omits the weight: without it, light near the rim of each map counts as much as light along the
// axis, where it is eight times as bright.
TEST(PrintedWeightsMoveTheSecondBounce, 1)
{
    vplScene* scene = spotRoom(context, 0.6f);
    vplRenderOptions o = ssvpOptions(32);
    o.output.show = VPL_SHOW_INDIRECT;
    o.ssvp.nextBounce = VPL_NEXT_BOUNCE_MAPS;
    vplImage* right = renderScene(scene, &o, NULL);
    o.ssvp.secondWeight = VPL_SECOND_WEIGHT_PRINTED;
    vplImage* printed = renderScene(scene, &o, NULL);
    assert_true(differenceOf(printed, right) > 0.01);
    vplImage_Destroy(right);
    vplImage_Destroy(printed);
    vplScene_Destroy(scene);
}

// ---- toggles

TEST(BouncesAreToggled, 2, SLOW)
{
    vplScene* scene = spotRoom(context, 0.6f);
    vplRenderOptions o = ssvpOptions(48);
    vplRenderStats stats[4];
    vplImage* pictures[4];
    for (int bounces = 0; bounces <= 3; bounces++) {
        o.maxBounces = bounces;
        pictures[bounces] = renderScene(scene, &o, &stats[bounces]);
    }
    assert_int_equal(stats[0].virtualLights, 0);
    assert_true(stats[1].virtualLights > 150);
    assert_true(stats[2].virtualLights > stats[1].virtualLights + 150);
    assert_true(stats[3].virtualLights > stats[2].virtualLights + 100);
    assert_true(meanOf(pictures[0]) < meanOf(pictures[1]));
    assert_true(meanOf(pictures[1]) < meanOf(pictures[2]));
    assert_true(meanOf(pictures[2]) < meanOf(pictures[3]));
    vplRenderStats other;
    o.maxBounces = 2;
    o.ssvp.secondBounce = 0;
    vplImage_Destroy(renderScene(scene, &o, &other));
    assert_true(other.imageHash == stats[1].imageHash);
    o.maxBounces = -1;
    o.output.show = VPL_SHOW_DIRECT;
    vplImage_Destroy(renderScene(scene, &o, &other));
    assert_true(other.imageHash == stats[0].imageHash);
    for (int i = 0; i < 4; i++) {
        vplImage_Destroy(pictures[i]);
    }
    vplScene_Destroy(scene);
}

// Every stage can be shown; stages that do not exist are refused with a message.
TEST(EveryStageIsShown, 2, SLOW)
{
    vplScene* scene = spotRoom(context, 0.6f);
    vplRenderOptions o = ssvpOptions(48);
    vplRenderStats plain, stats;
    vplImage_Destroy(renderScene(scene, &o, &plain));
    for (int show = VPL_SHOW_RSM; show <= VPL_SHOW_DENOISED; show++) {
        o.output.show = (vplShow)show;
        vplImage* image = renderScene(scene, &o, &stats);
        assert_true(meanOf(image) > 0);
        vplImage_Destroy(image);
        assert_true(stats.imageHash != plain.imageHash);
    }
    o.output.show = VPL_SHOW_PARABOLOID;
    o.output.showIndex = 8;
    vplImage* nothing = NULL;
    assert_int_equal(vplRender(scene, &o, &nothing, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "cluster 8 does not exist, there are 8"));
    vplScene_Destroy(scene);
}

// Colours are those of the paper's figure 1. Marks are where the picture without them differs.
TEST(FirstBounceLightsAreRedAndSecondBounceLightsBlue, 2)
{
    static const vplShow shows[2] = {VPL_SHOW_RSM_SAMPLES, VPL_SHOW_SECOND_BOUNCE};
    vplScene* scene = spotRoom(context, 0.6f);
    vplRenderOptions o = ssvpOptions(32);
    o.maxBounces = 2;
    o.shadow.rsmSize = 64;
    o.ssvp.firstBounce = o.ssvp.secondBounce = 32;
    vplImage* plain = renderScene(scene, &o, NULL);
    for (int k = 0; k < 2; k++) {
        o.output.show = shows[k];
        vplImage* image = renderScene(scene, &o, NULL);
        int marked = 0;
        for (int i = 0; i < 3 * 32 * 32; i += 3) {
            const float *p = &image->pixels[i], *q = &plain->pixels[i], own = p[k == 0 ? 0 : 2];
            if (p[0] != q[0] || p[1] != q[1] || p[2] != q[2]) {
                marked++;
                assert_true(own > 3 * p[1] && own > 3 * p[k == 0 ? 2 : 0]);
            }
        }
        assert_true(marked > 50);
        vplImage_Destroy(image);
    }
    vplImage_Destroy(plain);
    vplScene_Destroy(scene);
}

TEST_ALONE(BitsDependOnNeitherThreadsNorInstructions)
{
    static const int workers[4] = {1, 2, 3, 7};
    uint64_t first = 0;
    for (int i = 0; i < 4 + VPL_ISA_COUNT; i++) {
        vplContext* context = i < 4 ? openTestContext(workers[i]) : openIsaContext(2, (vplIsa)(i - 4));
        if (context == NULL) {
            continue;
        }
        vplScene* scene = spotRoom(context, 0.6f);
        const vplRenderOptions o = ssvpOptions(80);
        vplRenderStats stats;
        vplImage_Destroy(renderScene(scene, &o, &stats));
        first = i == 0 ? stats.imageHash : first;
        assert_true(stats.imageHash == first);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

// ---- frames

static uint64_t hashOfFrame(vplScene* scene, vplRenderOptions o, vplHistory* history, double frame)
{
    vplRenderStats stats;
    o.sequence.history = history;
    o.sequence.frame = frame;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    return stats.imageHash;
}

// Lights and clusters are the same in all frames while the light does not move; if patterns change per frame,
// they are not.
TEST(StillLightsKeepTheirBits, 2)
{
    vplScene* scene = spotRoom(context, 0.6f);
    vplRenderOptions o = ssvpOptions(32);
    vplHistory* history;
    assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
    const uint64_t alone = hashOfFrame(scene, o, NULL, 0);
    assert_true(hashOfFrame(scene, o, history, 0) == alone);
    assert_true(hashOfFrame(scene, o, history, 1) == alone);
    o.sequence.coherence = VPL_COHERENCE_OFF;
    assert_true(hashOfFrame(scene, o, history, 2) != alone);
    assert_true(hashOfFrame(scene, o, history, 2) == hashOfFrame(scene, o, NULL, 2));
    o.sequence.coherence = VPL_COHERENCE_ON;
    o.ssvp.clusters = 5; // changes the kept data
    const uint64_t five = hashOfFrame(scene, o, NULL, 0);
    vplHistory_Destroy(history);
    assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
    assert_true(hashOfFrame(scene, o, history, 0) == five);
    vplHistory_Destroy(history);
    vplScene_Destroy(scene);
}

// A frame that needed no maps draws none; the next frame draws the maps that it needs.
TEST(MapsThatWereNotNeededAreDrawnWhenTheyAre, 2)
{
    vplScene* scene = spotRoom(context, 0.6f);
    vplRenderOptions o = ssvpOptions(32);
    vplHistory* history;
    assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o.maxBounces = 0;
    hashOfFrame(scene, o, history, 0);
    o.maxBounces = 2;
    assert_true(hashOfFrame(scene, o, history, 1) == hashOfFrame(scene, o, NULL, 1));
    vplHistory_Destroy(history);
    vplScene_Destroy(scene);
}

// Passes are not frames: each has samples of its own, and does not start from the pass before.
TEST(PassesHaveNothingToDoWithEachOther, 2)
{
    vplScene* scene = corner(context, VPL_EMITTER_SPOT);
    vplRenderOptions o = ssvpOptions(32);
    o.stop.passes = 3;
    const uint64_t on = hashOfFrame(scene, o, NULL, 0);
    o.sequence.coherence = VPL_COHERENCE_OFF;
    assert_true(hashOfFrame(scene, o, NULL, 0) == on);
    vplScene_Destroy(scene);
}

// ---- extremes

static void assertFinite(const vplScene* scene, vplRenderOptions o)
{
    vplImage* image = renderScene(scene, &o, NULL);
    assert_true(meanOf(image) >= 0);
    vplImage_Destroy(image);
}

// X092, X105: fewer lights than clusters, a single light, and a map of one texel.
TEST(FewerLightsThanClustersAndMapsOfOneTexel, 2)
{
    vplScene* scene = spotRoom(context, 0.6f);
    vplRenderOptions o = ssvpOptions(32);
    const int counts[4] = {0, 1, 2, 7};
    for (int i = 0; i < 4; i++) {
        o.ssvp.firstBounce = o.ssvp.secondBounce = counts[i];
        o.ssvp.clusters = 32;
        assertFinite(scene, o);
    }
    o = ssvpOptions(32);
    o.shadow.rsmSize = 1;
    assertFinite(scene, o);
    o.ssvp.paraboloidSize = 1;
    assertFinite(scene, o);
    o.pipeline.interleave = 16;
    assertFinite(scene, o);
    vplScene_Destroy(scene);
}

// X108: the facing walls of a cube, and a sphere seen from inside: centroids lie in mid-air, and normals
// cancel.
TEST(CentroidsInMidAirLightTheBallTheyAreIn, 2)
{
    vplScene* scene = sceneOf(context, 0.5f);
    Shape ball = icosphere(3);
    const vplMat4 identity = vplMat4_Identity();
    addShape(scene, &ball, false, &identity);
    freeShape(&ball);
    aim(scene, vplVec(0.2f, 0.1f, 0.3f), vplVec(0, 0, -1));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(0.1f, 0.2f, 0), vplVec(0, -1, 0), 1);
    for (int place = 0; place <= 1; place++) {
        vplRenderOptions o = ssvpOptions(32);
        o.output.show = VPL_SHOW_INDIRECT;
        o.ssvp.clusters = 2;
        o.ssvp.hemispheres = 2;
        o.ssvp.place = (vplClusterPlace)place;
        vplImage* clusters = renderScene(scene, &o, NULL);
        o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
        vplImage* rays = renderScene(scene, &o, NULL);
        assert_true(meanOf(clusters) > 0.9 * meanOf(rays)); // nothing occludes inside a sphere
        vplImage_Destroy(clusters);
        vplImage_Destroy(rays);
    }
    vplScene_Destroy(scene);
}

// X092
TEST(BlackScenesAndLightsThatSeeNothingStayBlack, 2)
{
    vplScene* black = spotRoom(context, 0);
    vplRenderOptions o = ssvpOptions(32);
    o.output.show = VPL_SHOW_INDIRECT;
    assertNear(meanOfRender(black, &o), 0, 0, "black walls", 0);
    vplScene_Destroy(black);
    vplScene* dark = closedCubeScene(context, 0.5f, 0);
    aim(dark, vplVec(0, 0, 0.9f), vplVec(0, 0, -1));
    assertNear(meanOfRender(dark, &o), 0, 0, "no light", 0);
    addEmitter(dark, VPL_EMITTER_SPOT, vplVec(0, 0, 0), vplVec(0, 1, 0), 0);
    assertNear(meanOfRender(dark, &o), 0, 0, "light of no power", 0);
    addEmitter(dark, VPL_EMITTER_SPOT, vplVec(9, 0, 0), vplVec(1, 0, 0), 5);
    assertNear(meanOfRender(dark, &o), 0, 0, "light that sees nothing", 0);
    vplScene_Destroy(dark);
}

// Reflective shadow maps do not support emitting surfaces: particles make their part of the first bounce.
TEST(SsvpReflectsAreaLights, 2, SLOW)
{
    vplScene* scene = closedCubeScene(context, 0.6f, 0);
    addBox(scene);
    const int areaLight = addMaterial(scene, (vplRgb){0.5f, 0.5f, 0.5f}, 3);
    addThing(scene, VPL_OBJECT_QUAD, areaLight, vplVec(0, 0.99f, 0), VPL_PI / 2, 0, vplVec(1, 1, 1));
    aim(scene, vplVec(0.1f, -0.2f, 0.9f), vplVec(0, -0.3f, -1));
    vplRenderOptions o = ssvpOptions(32);
    o.ssvp.firstBounce = 4096;
    o.maxBounces = 1;
    o.output.show = VPL_SHOW_INDIRECT;
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o.lights.minDistance = 0.05f;
    const double found = meanOfRender(scene, &o);
    o = plainOptions();
    o.output.width = o.output.height = 32;
    o.method = VPL_METHOD_PATH;
    o.path.pixel = VPL_PIXEL_CENTRE;
    o.path.samples = 1024;
    o.maxBounces = 1;
    o.output.show = VPL_SHOW_INDIRECT;
    assertNear(found / meanOfRender(scene, &o), 1, 0.03, "energy", 0);
    vplScene_Destroy(scene);
}

// SSVP refuses options that it does not support, with a sentence.
TEST(WhatIsNotPossibleIsASentence, 1)
{
    vplScene* scene = spotRoom(context, 0.5f);
    vplImage* image = NULL;
    vplRenderOptions o = ssvpOptions(16);
    o.lighting = VPL_LIGHTING_DOCUMENTED;
    assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "physical"));
    o = ssvpOptions(16);
    o.pipeline.kind = VPL_ACCUMULATE_MULTIPASS;
    assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT);
    assert_true(strlen(takeMessage()) > 0);
    o = plainOptions();
    o.output.width = o.output.height = 16;
    o.lights.shadows = VPL_LIGHT_SHADOWS_CLUSTER;
    assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "clusters"));
    const vplMethod others[3] = {VPL_METHOD_INSTANT_RADIOSITY, VPL_METHOD_DIRECT, VPL_METHOD_PATH};
    for (int i = 0; i < 3; i++) {
        o = plainOptions();
        o.method = others[i];
        o.output.width = o.output.height = 16;
        for (int show = VPL_SHOW_RSM; show <= VPL_SHOW_SECOND_BOUNCE; show++) {
            o.output.show = (vplShow)show;
            assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT);
            assert_non_null(strstr(takeMessage(), "only SSVP"));
        }
    }
    assert_null(image);
    vplScene_Destroy(scene);
}

// Clusters of all bounces are those of the first and those of the others.
TEST(ClustersOfAllBouncesAreCounted, 1, SLOW)
{
    vplScene* scene = openScene(context, "examples/scenes/room.json");
    int all[2];
    for (int k = 0; k < 2; k++) {
        vplRenderOptions o = plainOptions();
        vplRenderStats stats;
        o.method = VPL_METHOD_SSVP;
        o.output.width = o.output.height = 16;
        assert_int_equal(vplRenderOptions_Set(&o, "max-bounces", k ? "3" : "1"), VPL_SUCCESS);
        vplImage_Destroy(renderScene(scene, &o, &stats));
        all[k] = stats.allClusters;
        assert_true(stats.clusters > 0 && (k ? all[k] > stats.clusters : all[k] == stats.clusters));
    }
    vplScene_Destroy(scene);
}
