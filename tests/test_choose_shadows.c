// SPDX-License-Identifier: MIT
// Tests of the choice between maps and rays for shadows of virtual lights: the rule, its input, and that
// pictures equal those of the chosen way. Also lights whose maps do not fit into memory at once.
#include "scenes.h"

#include "render/stages/shadow_choice.h"

static const vplShadowLoad plain = {64, 1e5, 0.4, 1e4, 2e4, 128};

TEST_ALONE(CostsGrowWithWhatTheyDependOn)
{
    const size_t fields[] = {offsetof(vplShadowLoad, lights),         offsetof(vplShadowLoad, pixels),
                             offsetof(vplShadowLoad, facing),         offsetof(vplShadowLoad, triangles),
                             offsetof(vplShadowLoad, trianglesAbove), offsetof(vplShadowLoad, mapSize)};
    for (int field = 0; field < 6; field++) {
        vplShadowLoad load = plain;
        vplShadowCosts before = vplEstimateShadows(&load);
        for (int step = 0; step < 20; step++) {
            double value;
            memcpy(&value, (char*)&load + fields[field], sizeof value);
            value *= 1.1;
            memcpy((char*)&load + fields[field], &value, sizeof value);
            const vplShadowCosts after = vplEstimateShadows(&load);
            const bool forMaps = field != 3, forRays = field < 4;
            assert_true(forMaps ? after.mapMs > before.mapMs : after.mapMs == before.mapMs);
            assert_true(forRays ? after.rayMs > before.rayMs : after.rayMs == before.rayMs);
            before = after;
        }
    }
}

// As pixels increase, the rule switches to maps once; as triangles above the lights increase, it switches
// back to rays once.
TEST_ALONE(TheRuleTurnsOnce)
{
    for (int lights = 1; lights < 5000; lights *= 7) {
        vplShadowLoad load = plain;
        load.lights = lights;
        int turns = 0;
        bool map = false;
        for (load.pixels = 1; load.pixels < 1e8; load.pixels *= 1.5) {
            const vplShadowCosts costs = vplEstimateShadows(&load);
            turns += map != (costs.mapMs < costs.rayMs);
            map = costs.mapMs < costs.rayMs;
        }
        assert_true(turns == 1 && map);
        for (load.pixels = 3e5, turns = 0; load.trianglesAbove < 1e7; load.trianglesAbove *= 1.5) {
            const vplShadowCosts costs = vplEstimateShadows(&load);
            turns += map != (costs.mapMs < costs.rayMs);
            map = costs.mapMs < costs.rayMs;
        }
        assert_true(turns == 1 && !map);
    }
}

// tests/data/crossover.csv has the times that bench/crossover measured. Among the cells in which one way
// takes at least a quarter longer, the rule finds the faster in 95 %, and its choice never takes more than
// 1.4 times as long.
TEST_ALONE(TheRuleAgreesWithTheMeasuredTable)
{
    Table t = loadTable("crossover.csv");
    int clear = 0, right = 0;
    for (int i = 0; i < t.rows; i++) {
        const vplShadowLoad load = {number(&t, i, "lights"),    number(&t, i, "pixels"),
                                    number(&t, i, "facing"),    number(&t, i, "above"),
                                    number(&t, i, "triangles"), number(&t, i, "size")};
        const double map = number(&t, i, "map_ms"), ray = number(&t, i, "ray_ms");
        const vplShadowCosts costs = vplEstimateShadows(&load);
        const bool agrees = (costs.mapMs < costs.rayMs) == (map < ray);
        if (map > 1.25 * ray || ray > 1.25 * map) {
            clear++;
            right += agrees;
        }
        const double ratio = map > ray ? map / ray : ray / map;
        if (!agrees && ratio > 1.4) {
            fail_msg("row %d: maps %g ms, rays %g ms, expected %g and %g", i, map, ray, costs.mapMs,
                     costs.rayMs);
        }
    }
    printf("# %d of %d cells\n", right, clear);
    assert_true(clear > 150 && right >= 0.95 * clear);
    freeTable(&t);
}

static vplRenderOptions autoOptions(void)
{
    vplRenderOptions o = plainOptions();
    o.particles.count = 20;
    o.lights.mapSize = 64;
    o.lights.shadows = VPL_LIGHT_SHADOWS_AUTO;
    return o;
}

TEST_ALONE(AutoRendersWhatItSaysItChose)
{
    static const struct {
        int width, interleave;
        vplAccumulation accumulation;
        vplLightShadows wanted;
    } cases[] = {{128, 4, VPL_ACCUMULATE_DEFERRED, VPL_LIGHT_SHADOWS_MAP},
                 {4, 4, VPL_ACCUMULATE_DEFERRED, VPL_LIGHT_SHADOWS_RAY},
                 {128, 16, VPL_ACCUMULATE_INTERLEAVED, VPL_LIGHT_SHADOWS_RAY}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplContext* context = openTestContext(2);
        vplScene* scene = loadScene(context, "room.json");
        vplRenderOptions o = autoOptions();
        vplRenderStats chosen, named;
        o.output.width = o.output.height = cases[i].width;
        o.pipeline.kind = cases[i].accumulation;
        o.pipeline.interleave = cases[i].interleave;
        vplImage_Destroy(renderScene(scene, &o, &chosen));
        assert_int_equal(chosen.lightShadows, cases[i].wanted);
        assert_true((chosen.shadowMapEstimateMs < chosen.shadowRayEstimateMs) ==
                    (cases[i].wanted == VPL_LIGHT_SHADOWS_MAP));
        o.lights.shadows = cases[i].wanted;
        if (o.lights.shadows == VPL_LIGHT_SHADOWS_MAP) {
            vplImage_Destroy(renderScene(scene, &o, &named));
            assert_true(named.imageHash == chosen.imageHash);
            assert_true(named.lightShadows == cases[i].wanted && named.shadowRayEstimateMs == 0);
        } else { // RAY also replaces the emitter's map; indirect light must be the same
            o.output.show = VPL_SHOW_INDIRECT;
            vplImage_Destroy(renderScene(scene, &o, &named));
            o.lights.shadows = VPL_LIGHT_SHADOWS_AUTO;
            vplImage_Destroy(renderScene(scene, &o, &chosen));
            assert_true(named.imageHash == chosen.imageHash);
        }
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

// Maps have 2048 x 2048 texels, of which three fit into the memory limit.
TEST(LightsWhoseMapsDoNotFitAreAddedInBatches, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = autoOptions();
    vplRenderStats stats;
    o.output.width = 24;
    o.output.height = 16;
    o.particles.count = 8;
    o.lights.mapSize = 2048;
    o.lights.shadows = VPL_LIGHT_SHADOWS_MAP;
    vplImage* all = renderScene(scene, &o, &stats);
    assert_true(stats.virtualLights > 2 * 3 &&
                stats.peakBytes <= ((size_t)o.lights.mapMemory << 20) + ((size_t)64 << 20));
    o.output.show = VPL_SHOW_DIRECT;
    vplImage* direct = renderScene(scene, &o, NULL);
    vplImage* sum = direct;
    o.output.show = VPL_SHOW_LIGHT;
    o.lights.minDistance = stats.minDistance;
    for (o.output.showIndex = 0; o.output.showIndex < stats.virtualLights; o.output.showIndex++) {
        vplImage* one = renderScene(scene, &o, NULL);
        for (int k = 0; k < 3 * o.output.width * o.output.height; k++) {
            sum->pixels[k] += one->pixels[k];
        }
        vplImage_Destroy(one);
    }
    for (int k = 0; k < 3 * o.output.width * o.output.height; k++) {
        assert_true(fabsf(sum->pixels[k] - all->pixels[k]) <= 1e-5f * all->pixels[k]);
    }
    vplImage_Destroy(all);
    vplImage_Destroy(sum);
    vplScene_Destroy(scene);
}
