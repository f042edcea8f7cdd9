// SPDX-License-Identifier: MIT
// Tests of plan files: replayed elsewhere they give the same bits, and a file that is wrong gets a sentence.
#include "scenes.h"

#include <unistd.h>

static const char* planFile(void)
{
    return temporaryName(".plan");
}

// Every method, and what ends a render by time or error.
static const char* const CASES[] = {
    "--method keller --particles auto --interleave auto",
    "--method keller --particles 1200",
    "--method keller --particles 30 --budget 0.001",
    "--method keller --particles 30 --budget 150",
    "--method keller --particles 30 --max-error 0.2",
    "--method keller --particles 30 --light-shadows ray --passes 2",
    "--method keller --particles 30 --passes 3 --edge-pixels 60 --edge-paths 6",
    "--method auto --max-error 0.1",
    "--method keller --particles 30 --light-shadows map --compensation none",
    "--method keller --particles 3 --light-shadows auto --passes 3 --min-distance 0.1",
    "--method keller --pipeline lightcuts --particles 40 --antialias 8 --show indirect",
    "--method keller --show direct --particles 20",
    "--preset keller-1997 --seed 18446744073709551615",
    "--method path --spp 40",
    "--method path --max-error 0.3",
    "--method path --budget 0.001",
    "--method path --pixel centre --max-bounces 1 --spp 3",
    "--method ssvp --clusters 3 --first-bounce 20 --second-bounce 20 --rsm-size 32",
    "--method ssvp --clusters 3 --first-bounce 20 --second-bounce 20 --rsm-size 32 --budget 100",
    "--preset ssvp-2020 --first-bounce 20 --second-bounce 20",
    "--method radiosity --patches 60",
    "--method radiosity --patches 60 --patch-placement adaptive",
    "--method radiosity --patches 60 --hierarchy on --budget 1",
    "--preset hemgren",
    "--method instant-radiosity --particles auto --reflectivity usual",
    "--method instant-radiosity --particles 8 --placement view --passes 2",
    "--method instant-radiosity --particles 8 --placement rsm --light-shadows auto",
    "--preset franchi-ferrante",
    "--method direct --light-shadows ray",
    "--method direct --antialias 8",
    "--method auto --spp 3",
    "--method auto --particles 50 --budget 100",
};

enum { CASE_COUNT = sizeof CASES / sizeof *CASES };

static vplRenderOptions caseOptions(int i)
{
    vplRenderOptions o = plainOptions();
    o.particles.reflectivity = -2;
    o.pipeline.interleave = -1;
    assert_int_equal(vplRenderOptions_SetAll(&o, CASES[i]), VPL_SUCCESS);
    o.output.width = 24;
    o.output.height = 18;
    o.shadow.mapSize = 32;
    return o;
}

// Renders and writes the plan, before or after.
static uint64_t renderAndWrite(const vplScene* scene, const vplRenderOptions* o)
{
    vplRenderer* r;
    vplImage* image;
    vplRenderStats stats;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    stepToEnd(r);
    assert_int_equal(vplRenderer_WritePlan(r, planFile()), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Finish(r, &image, NULL, &stats), VPL_SUCCESS);
    vplImage_Destroy(image);
    vplRenderer_Destroy(r);
    return stats.imageHash;
}

static uint64_t replay(vplContext* context, const char* path, vplRenderStats* stats)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    vplScene* scene = openScene(context, path);
    uint64_t hash;
    assert_int_equal(vplRenderOptions_Load(context, planFile(), &o, &hash), VPL_SUCCESS);
    assert_true(hash == vplScene_GetHash(scene));
    assert_true(o.method != VPL_METHOD_AUTO && o.stop.budgetMs == 0 && o.stop.maxError == 0);
    vplImage_Destroy(renderScene(scene, &o, stats));
    vplScene_Destroy(scene);
    return stats->imageHash;
}

TEST_ALONE(AReplayedPlanGivesTheSameBits, SLOW)
{
    static const char* const SCENES[] = {"tests/data/room.json", "examples/scenes/room-area.json"};
    for (int i = 0; i < 2 * CASE_COUNT; i++) {
        const vplRenderOptions o = caseOptions(i / 2);
        if (i % 2 == 1 && o.lighting == VPL_LIGHTING_DOCUMENTED) {
            continue; // it has no area lights
        }
        vplContext *context = openTestContext(2), *elsewhere = openIsaContext(1, VPL_ISA_SCALAR);
        vplScene* scene = openScene(context, SCENES[i % 2]);
        vplRenderStats stats;
        const uint64_t hash = renderAndWrite(scene, &o);
        if (hash != replay(elsewhere, SCENES[i % 2], &stats)) {
            fail_msg("%s, %s: other bits after %d passes", CASES[i / 2], SCENES[i % 2], stats.passes);
        }
        vplScene_Destroy(scene);
        closeTestContext(context);
        closeTestContext(elsewhere);
    }
    unlink(planFile());
}

// Pixels at edges that the planner had traced are traced again.
TEST_ALONE(AReplayedPlanTracesTheSameEdges)
{
    static const char PATH[] = "examples/scenes/room-area.json";
    vplContext *context = openTestContext(2), *elsewhere = openTestContext(1);
    vplScene* scene = openScene(context, PATH);
    vplRenderOptions o = vplDefaultRenderOptions(), again = o;
    vplRenderStats stats;
    o.output.width = 64;
    o.output.height = 36;
    o.stop.maxError = 0.1;
    const uint64_t hash = renderAndWrite(scene, &o);
    assert_true(replay(elsewhere, PATH, &stats) == hash);
    assert_int_equal(vplRenderOptions_Load(context, planFile(), &again, NULL), VPL_SUCCESS);
    assert_true(again.path.edgePixels > 0 && again.path.edgePaths > 1);
    vplScene_Destroy(scene);
    closeTestContext(context);
    closeTestContext(elsewhere);
    unlink(planFile());
}

// A plan that was not rendered has what ends it; its options make an equal plan.
TEST(APlanThatWasNotRenderedIsReplayedToo, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    for (int i = 0; i < CASE_COUNT; i++) {
        vplRenderOptions o = caseOptions(i), again = vplDefaultRenderOptions();
        vplPlan *plan, *same;
        int count;
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assert_int_equal(vplPlan_Write(plan, scene, planFile()), VPL_SUCCESS);
        assert_int_equal(vplRenderOptions_Load(context, planFile(), &again, NULL), VPL_SUCCESS);
        assert_int_equal(vplPlan_Create(scene, &again, NULL, &same), VPL_SUCCESS);
        const vplOption* options = vplGetOptions(&count);
        for (int k = 0; k < count; k++) {
            char a[64] = "", b[64] = "";
            vplRenderOptions_Get(&plan->options, options[k].name, a, sizeof a);
            vplRenderOptions_Get(&same->options, options[k].name, b, sizeof b);
            assert_string_equal(a, b);
        }
        assert_int_equal(plan->progressive, same->progressive);
        assert_true(plan->clampArea == same->clampArea && plan->emitterRays == same->emitterRays);
        vplPlan_Destroy(plan);
        vplPlan_Destroy(same);
    }
    vplScene_Destroy(scene);
    unlink(planFile());
}

// ---- files that are wrong

static void writePlanFile(const char* text)
{
    FILE* file = fopen(planFile(), "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

TEST(AWrongPlanFileGetsASentence, 1)
{
    static const char* const WRONG[][2] = {
        {"", ":1:1: "},
        {"[1]", ":1:1: the plan is an array, must be an object"},
        {"{}", ":1:1: the plan lacks the key \"vpl_plan\""},
        {"{\"vpl_plan\": 2, \"new\": 3}",
         ":1:14: vpl_plan is 2, must be 1, the version that this library reads"},
        {"{\"vpl_plan\": \"1\"}", ":1:14: vpl_plan is a string, must be a number"},
        {"{\"vpl_plan\": 1, \"scene\": \"0123456789abcdef\"}", "lacks the key \"options\""},
        {"{\"vpl_plan\": 1, \"scene\": \"xyz\", \"options\": {}}", ":1:26: scene must be 16 of the digits"},
        {"{\"vpl_plan\": 1, \"scene\": 7, \"options\": {}}", ":1:26: scene is a number, must be a string"},
        {"{\"vpl_plan\": 1, \"scene\": \"0123456789abcdef\", \"options\": {}, \"more\": 1}",
         ":1:61: more is not a known key"},
        {"{\"vpl_plan\": 1, \"scene\": \"0123456789abcdef\", \"options\": []}",
         "options is an array, must be an object"},
        {"{\"vpl_plan\": 1, \"scene\": \"0123456789abcdef\", \"options\": {\"colour\": \"red\"}}",
         "options.colour is no option of this version"},
        {"{\"vpl_plan\": 1, \"scene\": \"0123456789abcdef\", \"options\": {\"seed\": \"red\"}}",
         ":1:66: options.seed is \"red\", must be a whole number"},
        {"{\"vpl_plan\": 1, \"scene\": \"0123456789abcdef\", \"options\": {\"seed\": 7}}",
         "options.seed is a number, must be a string"},
        {"{\"vpl_plan\": 1, \"scene\": \"0123456789abcdef\", \"options\": {\"height\": \"7\"}}",
         "options.height is no option"},
    };
    vplRenderOptions o = vplDefaultRenderOptions();
    o.seed = 5;
    for (size_t i = 0; i < sizeof WRONG / sizeof *WRONG; i++) {
        uint64_t hash = 9;
        writePlanFile(WRONG[i][0]);
        takeMessage();
        assert_int_equal(vplRenderOptions_Load(context, planFile(), &o, &hash), VPL_PARSE_ERROR);
        const char* message = takeMessage();
        if (strstr(message, WRONG[i][1]) == NULL || strstr(message, planFile()) != message) {
            fail_msg("%s: \"%s\" lacks \"%s\"", WRONG[i][0], message, WRONG[i][1]);
        }
        assert_true(hash == 9 && o.seed == 5); // nothing is changed
    }
    unlink(planFile());
    assert_int_equal(vplRenderOptions_Load(context, planFile(), &o, NULL), VPL_FILE_ERROR);
    writePlanFile(
        "{\"vpl_plan\": 1, \"scene\": \"0123456789abcdef\", \"options\": {\"particles\": \"44\", \"preset\": "
        "\"franchi-ferrante\"}}");
    assert_int_equal(vplRenderOptions_Load(context, planFile(), &o, NULL), VPL_SUCCESS);
    assert_true(o.seed == 5 && o.particles.count == 44 &&
                o.lighting == VPL_LIGHTING_DOCUMENTED); // others stay
    unlink(planFile());
}
