// SPDX-License-Identifier: MIT
#include "pass_cases.h"

vplRenderOptions passCase(vplContext* context, int i, vplScene** sceneOut)
{
    static const char* const CASES[PASS_CASES] = {
        "--method path --spp 103",
        "--method path --spp 103 --aov direct,indirect",
        "--method keller --particles 12 --passes 4",
        "--method keller --particles 9 --passes 4 --aov direct,albedo --antialias 2 --pipeline interleaved",
        "--method ssvp --passes 4 --clusters 2 --first-bounce 8 --second-bounce 8 --paraboloid 8 --rsm-size "
        "16",
        "--method instant-radiosity --particles 7 --placement view --show overlay --passes 4",
    };
    vplRenderOptions o = plainOptions();
    assert_int_equal(vplRenderOptions_SetAll(&o, CASES[i]), VPL_SUCCESS);
    o.output.width = 25;
    o.output.height = 18;
    o.shadow.mapSize = 16;
    *sceneOut =
        openScene(context, i == 1 || i == 3 ? "examples/scenes/room-area.json" : "tests/data/room.json");
    return o;
}

Seen look(vplRenderer* renderer, vplRenderStats* statsOut)
{
    Seen seen = {.count = 0};
    vplLayers* layers = NULL;
    vplImage* image = NULL;
    assert_int_equal(vplRenderer_GetLayers(renderer, &layers, statsOut), VPL_SUCCESS);
    assert_int_equal(vplRenderer_GetImage(renderer, &image, NULL), VPL_SUCCESS);
    for (int i = 0; i < layers->count; i++) {
        seen.images[seen.count++] = vplImage_Hash(layers->layers[i].image);
    }
    assert_true(vplImage_Hash(image) == seen.images[0]);
    vplImage_Destroy(image);
    vplLayers_Destroy(layers);
    return seen;
}

void assertSeenSame(const Seen* a, const Seen* b)
{
    assert_int_equal(a->count, b->count);
    for (int i = 0; i < a->count; i++) {
        assert_true(a->images[i] == b->images[i]);
    }
}

void renderPasses(const vplScene* scene, const vplRenderOptions* options, Seen passes[MOST_PASSES + 1],
                  vplRenderStats* statsOut)
{
    vplRenderer* r;
    int done = 0;
    assert_int_equal(vplRenderer_Create(scene, options, &r), VPL_SUCCESS);
    for (bool ended = false; !ended;) {
        assert_int_equal(vplRenderer_Step(r, &ended), VPL_SUCCESS);
        passes[++done] = look(r, statsOut);
        assert_true(done == 1 || passes[done].images[0] != passes[done - 1].images[0]);
        assert_int_equal(ended, done == MOST_PASSES);
    }
    vplRenderer_Destroy(r);
}
