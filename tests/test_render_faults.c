// SPDX-License-Identifier: MIT
// Every method, pipeline and --show without memory, and cancelled at each question (tests/render_cases.h).
#include "failing.h"
#include "render_cases.h"

#include <limits.h>
#include <unistd.h>

// ---- memory

static int cases[MOST_RENDER_CASES];

static vplResult renderCase(Attempt* a)
{
    const char* words;
    const vplRenderOptions options = renderCaseOptions(cases[a->variant], &words);
    TRY(vplScene_Load(a->context, renderCaseScene(cases[a->variant]), &a->scene));
    return vplRenderLayers(a->scene, &options, &a->layers, NULL);
}

TEST(FailedAllocationsOfEveryMethodAndShowAreReported, 1, SLOW)
{
    const int count = listRenderCases(context, cases);
    assert_true(count > 80);
    failSomeAllocations("EveryMethodAndShow", renderCase, count);
}

// ---- cancellation

// Cancels at call `at`; requires fractions that never shrink.
typedef struct Stop {
    int calls, at;
    double last;
    const char* words;
} Stop;

static bool stopAt(void* user, double fraction)
{
    Stop* stop = user;
    if (!(fraction >= stop->last && fraction <= 1)) {
        fail_msg("%s, call %d: progress goes from %g to %g", stop->words, stop->calls, stop->last, fraction);
    }
    stop->last = fraction;
    return ++stop->calls != stop->at;
}

// Renders with a stop at call `at`. Returns false if there were fewer calls: then the picture is there.
static bool cancelAt(const vplScene* scene, vplRenderOptions options, Stop* stop, uint64_t hash)
{
    const Failing* failing = vplScene_GetContext(scene)->def.allocUser;
    vplContext* context = vplScene_GetContext(scene);
    const size_t bytes = vplContext_GetBytes(context);
    vplLayers* layers = NULL;
    options.progress = stopAt;
    options.progressUser = stop;
    const vplResult result = vplRenderLayers(scene, &options, &layers, NULL);
    const bool cancelled = stop->at > 0 && stop->calls >= stop->at;
    const bool same = layers == NULL || vplImage_Hash(layers->layers[0].image) == hash;
    if (result != (cancelled ? VPL_CANCELLED : VPL_SUCCESS) || cancelled != (layers == NULL) || !same ||
        (cancelled && vplContext_GetBytes(context) != bytes) || failing->errors != 0 ||
        (!cancelled && stop->last != 1)) {
        fail_msg("%s, cancelled at call %d of %d: %s, at %g, %zu bytes held%s", stop->words, stop->at,
                 stop->calls, vplResult_GetName(result), stop->last, vplContext_GetBytes(context) - bytes,
                 same ? "" : ", another picture");
    }
    vplLayers_Destroy(layers);
    return cancelled;
}

static int cancelEverywhere(int i, int workers)
{
    Failing failing = {.failAt = -1}; // counts blocks and errors
    vplContext* context = openFailing(&failing);
    vplScene* scene = openScene(context, renderCaseScene(i));
    context->workerCount = workers;
    Stop stop = {0, 0, 0, NULL};
    vplLayers* layers;
    const vplRenderOptions options = renderCaseOptions(i, &stop.words);
    const int thin = workers > 1 ? 1 : everyFault() ? INT_MAX : 8;
    int count = 0;
    assert_int_equal(vplRenderLayers(scene, &options, &layers, NULL), VPL_SUCCESS);
    const uint64_t hash = vplImage_Hash(layers->layers[0].image);
    vplLayers_Destroy(layers);
    cancelAt(scene, options, &stop, hash);
    for (int at = 1; at <= stop.calls || workers > 1; at += 1 + at / thin, count++) {
        if (!cancelAt(scene, options, &(Stop){0, at, 0, stop.words}, hash)) {
            assert_true(workers > 1); // where threads share the tasks, the calls are not the same each time
            break;
        }
    }
    vplScene_Destroy(scene);
    closeTestContext(context);
    return count;
}

// At every call if everyFault, else at the first eight and at growing distances after them.
TEST(EveryMethodAndShowIsCancelledAtEveryCall, 1, SLOW)
{
    const int count = listRenderCases(context, cases);
    int calls = 0;
    for (int i = 0; i < count; i++) {
        calls += cancelEverywhere(cases[i], 1);
        cancelEverywhere(cases[i], 3);
    }
    printf("# cancelled at %d calls\n", calls);
    assert_true(calls > 10 * count);
}

// Bakes with a stop at call `at`. Returns false if there were fewer calls: then the file is there.
static bool cancelBakeAt(const vplScene* scene, vplRenderOptions options, const char* words, int at)
{
    vplContext* context = vplScene_GetContext(scene);
    const size_t bytes = vplContext_GetBytes(context);
    const char* path = temporaryName(".ply");
    Stop stop = {0, at, 0, words};
    options.progress = stopAt;
    options.progressUser = &stop;
    const vplResult result = vplBake(scene, &options, 0, path, NULL);
    assert_int_equal(result, stop.calls >= at ? VPL_CANCELLED : VPL_SUCCESS);
    assert_true(vplContext_GetBytes(context) == bytes);
    assert_int_equal(access(path, F_OK), result == VPL_SUCCESS ? 0 : -1);
    unlink(path);
    return result == VPL_CANCELLED;
}

TEST(ABakeIsCancelledAtEveryCall, 1, SLOW)
{
    static const char* const CASES[] = {
        "--method radiosity --patches 16", "--method radiosity --patches 16 --hierarchy on",
        "--method radiosity --patches 30 --patch-placement adaptive",
        "--method radiosity --patches 30 --patch-placement adaptive --hierarchy on --solver jacobi"};
    const int thin = everyFault() ? INT_MAX : 32;
    vplScene* scene = openScene(context, "tests/data/corner-path.json");
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        vplRenderOptions options = vplDefaultRenderOptions();
        assert_int_equal(vplRenderOptions_SetAll(&options, CASES[i]), VPL_SUCCESS);
        int at = 1;
        while (cancelBakeAt(scene, options, CASES[i], at)) {
            at += 1 + at / thin;
        }
        printf("# %s: fewer than %d calls\n", CASES[i], at + 1);
        assert_true(at > 10);
    }
    vplScene_Destroy(scene);
}
