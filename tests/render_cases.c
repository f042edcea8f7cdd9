// SPDX-License-Identifier: MIT
#include "render_cases.h"

#define TINY                                                                                                 \
    "--size 6x5 --shadow-map 8 --particles 4 --spp 2 --light-map 4 --rsm-size 8 --clusters 2 "               \
    "--first-bounce 6 --second-bounce 6 --paraboloid 4 --patches 16 --iterations 2 --form-samples 1 "        \
    "--patch-light 1 --batch 3 --area-light-samples 3 --interleave 2 "
#define AREA   "examples/scenes/room-area.json"
#define POINT  "tests/data/room.json"
#define CORNER "tests/data/corner-path.json"

static const struct {
    const char *scene, *words;
} CASES[] = {
    {POINT, "--method direct"},
    {AREA, "--method direct --antialias 2"},
    {POINT, "--method instant-radiosity --pipeline multipass"},
    {POINT, "--method instant-radiosity --pipeline batched --lighting documented"},
    {AREA, "--method instant-radiosity --pipeline deferred --placement rsm"},
    {AREA, "--method instant-radiosity --pipeline interleaved --placement view"},
    {POINT, "--method keller --pipeline multipass --light-shadows map"},
    {POINT, "--method keller --pipeline batched --light-shadows map"},
    {AREA, "--method keller --pipeline deferred --light-shadows ray --compensation rays"},
    {AREA, "--method keller --pipeline interleaved --light-shadows map"},
    {POINT, "--method keller --pipeline lightcuts --light-shadows ray"},
    {POINT, "--method keller --lighting documented --particle-geometry obb"},
    {AREA, "--method keller --passes 2 --aov direct,normal --supersample 2"},
    {POINT, "--method ssvp"},
    {POINT, "--method ssvp --hemispheres 2 --pipeline deferred --passes 2"},
    {AREA, "--method path"},
    {POINT, "--method path --spp 40 --aov direct,depth"},
    {CORNER, "--method radiosity --hierarchy off"},
    {CORNER, "--method radiosity --hierarchy on"},
    {CORNER, "--method radiosity --patch-placement adaptive --patches 20"},
    {CORNER, "--method radiosity --form-factors incentre --solver shooting --interpolation none"},
    {CORNER, "--method radiosity --gather 3"},
    {POINT, "--method radiosity --gather 2 --interleave 1 --interpolation none --supersample 2 --aov "
            "direct,indirect"},
    {POINT, "--method auto"},
    {AREA, "--method auto --passes 1"},
};
enum {
    CASE_COUNT = sizeof CASES / sizeof *CASES,
    METHOD_COUNT = VPL_METHOD_RADIOSITY + 1,
    SHOW_COUNT = METHOD_COUNT * VPL_SHOW_RESIDUAL // but the picture itself
};

const char* renderCaseScene(int i)
{
    return i < CASE_COUNT                                            ? CASES[i].scene
           : (i - CASE_COUNT) % METHOD_COUNT == VPL_METHOD_RADIOSITY ? CORNER
                                                                     : POINT;
}

vplRenderOptions renderCaseOptions(int i, const char** wordsOut)
{
    static char words[256];
    vplRenderOptions options = vplDefaultRenderOptions();
    assert_int_equal(vplRenderOptions_SetAll(&options, TINY), VPL_SUCCESS);
    if (i < CASE_COUNT) {
        snprintf(words, sizeof words, "%s", CASES[i].words);
        assert_int_equal(vplRenderOptions_SetAll(&options, words), VPL_SUCCESS);
    } else {
        char method[32], show[32];
        options.output.antialias = 1;
        options.method = (vplMethod)((i - CASE_COUNT) % METHOD_COUNT);
        options.output.show = (vplShow)(VPL_SHOW_DEPTH + (i - CASE_COUNT) / METHOD_COUNT);
        assert_int_equal(vplRenderOptions_Get(&options, "method", method, sizeof method), VPL_SUCCESS);
        assert_int_equal(vplRenderOptions_Get(&options, "show", show, sizeof show), VPL_SUCCESS);
        snprintf(words, sizeof words, "--method %s --show %s", method, show);
    }
    *wordsOut = words;
    return options;
}

int listRenderCases(vplContext* context, int cases[MOST_RENDER_CASES])
{
    int count = 0;
    _Static_assert(CASE_COUNT + SHOW_COUNT <= MOST_RENDER_CASES, "room for all");
    for (int i = 0; i < CASE_COUNT + SHOW_COUNT; i++) {
        const char* words;
        const vplRenderOptions options = renderCaseOptions(i, &words);
        vplScene* scene = openScene(context, renderCaseScene(i));
        vplPlan* plan;
        assert_int_equal(vplPlan_Create(scene, &options, NULL, &plan), VPL_SUCCESS);
        if (plan->problem[0] == 0) {
            cases[count++] = i;
        }
        assert_true(i >= CASE_COUNT || plan->problem[0] == 0);
        vplPlan_Destroy(plan);
        vplScene_Destroy(scene);
    }
    return count;
}
