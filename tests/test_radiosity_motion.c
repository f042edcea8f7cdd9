// SPDX-License-Identifier: MIT
// Tests of radiosity in frames with a moving light.
#include "radiosity_pictures.h"

// ---- a light that moves

static void movePath(vplScene* scene)
{
    const vplEmitterDef* def = vplScene_GetEmitter(scene, 0);
    vplEmitterKey keys[2] = {vplMakeEmitterKey(def, 0), vplMakeEmitterKey(def, 1)};
    keys[1].position = vplVec(0.5f, 0.3f, 0.4f);
    assert_int_equal(vplScene_SetEmitterPath(scene, 0, keys, 2), VPL_SUCCESS);
}

// Renders frame 0, then frame 1 repeatedly: each time does one sweep.
TEST(LightThatJumpedArrivesSweepBySweep, 2)
{
    vplScene* scene = boxRoom(context, 0.7f, false);
    movePath(scene);
    vplRenderOptions o = radiosityOptions(300);
    o.sequence.frame = 1;
    o.radiosity.residual = 1e-7;
    vplImage* truth = showOf(scene, o, VPL_SHOW_INDIRECT);
    assert_int_equal(vplHistory_Create(context, &o.sequence.history), VPL_SUCCESS);
    o.sequence.frame = 0;
    vplImage* image = showOf(scene, o, VPL_SHOW_INDIRECT);
    double last = compare(image, truth).rmse;
    assert_true(last > 0);
    vplImage_Destroy(image);
    o.sequence.frame = 1;
    o.radiosity.iterations = 1;
    for (int i = 0; i < 12; i++) {
        image = showOf(scene, o, VPL_SHOW_INDIRECT);
        const double error = compare(image, truth).rmse;
        assert_true(error < 0.6 * last || error < 1e-6);
        last = error;
        vplImage_Destroy(image);
    }
    vplHistory_Destroy(o.sequence.history);
    vplImage_Destroy(truth);
    vplScene_Destroy(scene);
}

TEST(FormFactorsAreKeptAndNothingElseChanges, 2)
{
    vplScene* scene = boxRoom(context, 0.7f, false);
    movePath(scene);
    vplRenderOptions o = radiosityOptions(300);
    vplRenderStats alone, kept;
    o.sequence.coherence = VPL_COHERENCE_OFF;
    o.sequence.frame = 1;
    vplImage_Destroy(renderScene(scene, &o, &alone));
    assert_int_equal(vplHistory_Create(context, &o.sequence.history), VPL_SUCCESS);
    o.sequence.frame = 0;
    vplImage_Destroy(renderScene(scene, &o, NULL));
    o.sequence.frame = 1;
    vplImage_Destroy(renderScene(scene, &o, &kept));
    assert_true(kept.imageHash == alone.imageHash);
    assert_true(kept.rays < alone.rays / 4);
    o.radiosity.patches = 200;
    vplImage_Destroy(renderScene(scene, &o, &kept)); // a different number of patches makes them anew
    assert_true(kept.patches < alone.patches);
    vplHistory_Destroy(o.sequence.history);
    vplScene_Destroy(scene);
}

// A vplProgressFcn that cancels from the n-th call on; `user` is an int that counts down.
static bool refuseLater(void* user, double fraction)
{
    (void)fraction;
    return --*(int*)user > 0;
}

// Wherever the first frame was cancelled, the next frame of the same history is the same as without it.
TEST(CancelledFramesLeaveNothingBehind, 1, SLOW)
{
    vplScene* scene = boxRoom(context, 0.7f, false);
    vplRenderOptions o = radiosityOptions(40);
    vplRenderStats alone, after;
    o.shadow.mapSize = 32; // the same number of steps, all of them short
    o.sequence.coherence =
        VPL_COHERENCE_OFF; // a coherent solver could start from light of the cancelled frame
    vplImage_Destroy(renderScene(scene, &o, &alone));
    int cancelled = 0;
    for (int last = 1, done = 0; !done; last += 1 + last / 16) {
        int left = last;
        vplImage* image = NULL;
        assert_int_equal(vplHistory_Create(context, &o.sequence.history), VPL_SUCCESS);
        o.progress = refuseLater;
        o.progressUser = &left;
        const vplResult result = vplRender(scene, &o, &image, NULL);
        vplImage_Destroy(image);
        o.progress = NULL;
        if (result == VPL_CANCELLED) {
            vplImage_Destroy(renderScene(scene, &o, &after));
            assert_true(after.imageHash == alone.imageHash);
            assert_true(after.solve.spectralRadius == alone.solve.spectralRadius);
            cancelled++;
        }
        done = result == VPL_SUCCESS;
        vplHistory_Destroy(o.sequence.history);
        o.sequence.history = NULL;
    }
    assert_true(cancelled > 10);
    vplScene_Destroy(scene);
}
