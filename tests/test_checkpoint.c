// SPDX-License-Identifier: MIT
// Tests of saved renders: the same bits as one that was never stopped, and files that are wrong in every way.
#include "pass_cases.h"

#include "base/bytes.h"
#include "base/file.h"
#include "render/renderer.h"
#include "render/state_file.h"

#include <stdlib.h>
#include <unistd.h>

static const char* stateFile(void)
{
    return temporaryName(".state");
}

// Renders `passes` passes and saves them.
static void savePasses(const vplScene* scene, const vplRenderOptions* o, int passes)
{
    vplRenderer* r;
    bool done;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    for (int i = 0; i < passes; i++) {
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    }
    assert_int_equal(vplRenderer_Save(r, stateFile()), VPL_SUCCESS);
    vplRenderer_Destroy(r);
}

// Goes on with another renderer, and looks at what it has at first and at the end.
static void goOn(const vplScene* scene, const vplRenderOptions* o, Seen* first, Seen* last,
                 vplRenderStats* stats)
{
    vplRenderer* r;
    bool done;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Load(r, stateFile(), &done), VPL_SUCCESS);
    *first = look(r, NULL);
    while (!done) {
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    }
    *last = look(r, stats);
    vplRenderer_Destroy(r);
}

TEST_ALONE(ALoadedRenderGoesOnToTheSameBits)
{
    for (int i = 0; i < PASS_CASES; i++) {
        Seen passes[MOST_PASSES + 1], first, last;
        vplRenderStats whole, stats;
        vplScene* scene;
        vplContext* context = openTestContext(2);
        const vplRenderOptions o = passCase(context, i, &scene);
        renderPasses(scene, &o, passes, &whole);
        for (int saved = 1; saved <= MOST_PASSES; saved++) {
            vplScene* other;
            vplContext* elsewhere = openIsaContext(3, VPL_ISA_SCALAR); // as on another machine
            savePasses(scene, &o, saved);
            passCase(elsewhere, i, &other);
            goOn(other, &o, &first, &last, &stats);
            assertSeenSame(&first, &passes[saved]);
            assertSeenSame(&last, &passes[MOST_PASSES]);
            assert_int_equal(stats.passes, MOST_PASSES);
            assert_true(stats.errorEstimate == whole.errorEstimate);
            assert_true(o.method != VPL_METHOD_PATH || stats.rays == whole.rays);
            vplScene_Destroy(other);
            closeTestContext(elsewhere);
        }
        unlink(stateFile());
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

// Counts that end a render may change: a finished render goes on to more, also where its last pass was short.
TEST(AFinishedRenderGoesOnToMore, 1, SLOW)
{
    static const char* const MORE[PASS_CASES] = {"--spp 150",  "--spp 150",  "--passes 5",
                                                 "--passes 5", "--passes 5", "--passes 5"};
    for (int i = 0; i < PASS_CASES; i++) {
        Seen first, last, ended;
        vplRenderer* r;
        vplRenderStats stats;
        vplScene* scene;
        vplRenderOptions o = passCase(context, i, &scene);
        savePasses(scene, &o, MOST_PASSES);
        assert_int_equal(vplRenderOptions_SetAll(&o, MORE[i]), VPL_SUCCESS);
        goOn(scene, &o, &first, &last, &stats);
        assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
        stepToEnd(r);
        ended = look(r, NULL);
        assertSeenSame(&last, &ended);
        vplRenderer_Destroy(r);
        vplScene_Destroy(scene);
    }
    unlink(stateFile());
}

// Loading fails with a sentence, and the renderer then renders as if nothing had been loaded.
static void assertNotLoaded(const vplScene* scene, const vplRenderOptions* o, vplResult wanted,
                            const char* sentence)
{
    vplRenderer* r;
    bool done = false;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    takeMessage();
    assert_int_equal(vplRenderer_Load(r, stateFile(), &done), wanted);
    const char* message = takeMessage();
    if (strstr(message, sentence) == NULL) {
        fail_msg("\"%s\" lacks \"%s\"", message, sentence);
    }
    vplRenderer_Destroy(r);
}

TEST(AStateOfAnotherRenderIsRefused, 1)
{
    vplScene *scene, *other;
    vplRenderOptions o = passCase(context, 2, &scene), path = passCase(context, 0, &other), changed = o;
    vplRenderer* r;
    bool done;
    assertNotLoaded(scene, &o, VPL_FILE_ERROR, "cannot open");
    savePasses(scene, &o, 1);
    changed.seed = 7;
    assertNotLoaded(scene, &changed, VPL_INVALID_ARGUMENT,
                    "saved with --seed 0, but this render has 7; only passes");
    changed = o;
    changed.lights.minDistance = 0.25f; // and not auto
    assertNotLoaded(scene, &changed, VPL_INVALID_ARGUMENT,
                    "saved with --min-distance auto, but this render has 0.25");
    assertNotLoaded(scene, &path, VPL_INVALID_ARGUMENT,
                    "saved with --method keller, but this render has path");
    changed = o;
    changed.stop.passes = 0;
    assertNotLoaded(scene, &changed, VPL_INVALID_ARGUMENT, "say when it ends");
    assert_int_equal(vplRenderer_Create(scene, &changed, &r), VPL_SUCCESS);
    assert_false(vplRenderer_HasState(r));
    assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Save(r, stateFile()), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "has no state to save"));
    vplRenderer_Destroy(r);
    addMaterial(scene, (vplRgb){0.25f, 0.5f, 0.75f}, 0);
    assertNotLoaded(scene, &o, VPL_INVALID_ARGUMENT, "saved with another scene");
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    assert_true(vplRenderer_HasState(r));
    assert_int_equal(vplRenderer_Save(r, stateFile()), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "before its first step"));
    assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Load(r, stateFile(), &done), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "before its first step only"));
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
    vplScene_Destroy(other);
    unlink(stateFile());
}

// ---- damaged files

static void writeState(const uint8_t* bytes, size_t size)
{
    FILE* file = fopen(stateFile(), "wb");
    assert_non_null(file);
    assert_true(fwrite(bytes, 1, size, file) == size);
    fclose(file);
}

// Replaces bytes of the saved state and makes its checksum right.
static void forge(vplContext* context, size_t at, const void* with, size_t count)
{
    char* bytes;
    size_t size;
    assert_int_equal(vplReadFile(context, stateFile(), &bytes, &size), VPL_SUCCESS);
    memcpy(bytes + at, with, count);
    vplStream s = {.bytes = (uint8_t*)bytes, .at = size - 8, .writes = true};
    uint64_t sum = vplState_Checksum(s.bytes, size - 8);
    vplStream_Long(&s, &sum);
    writeState(s.bytes, size);
    vplFree(context, bytes);
}

// Else the picture would have an infinity, and the pixels at edges are chosen by their differences. Cases: the first sum of
// paths, which is not negative, and direct light of passes, to which their mean is added.
TEST_ALONE(SumsThatNoPictureHasAreRefused)
{
    static const double negative = -1;
    static const float huge = 3e38f;
    for (int i = 0; i < 4; i += 2) {
        vplContext* context = openTestContext(1);
        vplScene* scene;
        const vplRenderOptions o = passCase(context, i, &scene);
        uint32_t textBytes;
        char* bytes;
        size_t size;
        savePasses(scene, &o, 1);
        assert_int_equal(vplReadFile(context, stateFile(), &bytes, &size), VPL_SUCCESS);
        textBytes = vplTakeWord((uint8_t*)bytes + 12);
        vplFree(context, bytes);
        const void* with = i == 0 ? (const void*)&negative : &huge;
        forge(context, VPL_STATE_HEADER_BYTES + textBytes, with, i == 0 ? sizeof negative : sizeof huge);
        assertNotLoaded(scene, &o, VPL_PARSE_ERROR, "has sums that no picture has");
        unlink(stateFile());
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

// Every length from 0, and a bit flipped in every byte; with a right checksum, too, so that checks behind it
// are seen.
TEST_ALONE(DamagedStatesAreRefused, SLOW)
{
    for (int i = 0; i < 4; i += 2) {
        vplContext* context = openTestContext(1);
        vplScene* scene;
        vplRenderOptions o = passCase(context, i, &scene);
        char* bytes;
        size_t size;
        vplRenderer* r;
        bool done;
        o.output.width = 3;
        o.output.height = 2;
        savePasses(scene, &o, 1);
        assert_int_equal(vplReadFile(context, stateFile(), &bytes, &size), VPL_SUCCESS);
        assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
        for (size_t k = 0; k < 2 * size + 32; k++) {
            const bool cut = k < size;
            const size_t at = cut ? k : k - size < 8 ? k - size : (k - size) % size;
            uint8_t* copy = malloc(size + 1);
            memcpy(copy, bytes, size);
            copy[at] ^= cut ? 0 : (uint8_t)(1 << k % 8);
            writeState(copy, cut ? at : size);
            takeMessage();
            assert_int_equal(vplRenderer_Load(r, stateFile(), &done), VPL_PARSE_ERROR);
            assert_true(takeMessage()[0] != 0);
            free(copy);
        }
        // With its checksum made right, a file may be right; never more than a sentence may come of it.
        for (size_t at = 8; at < size - 8; at++) {
            vplRenderer* fresh;
            uint8_t* copy = malloc(size);
            memcpy(copy, bytes, size);
            copy[at] ^= (uint8_t)(0x80 >> at % 8);
            const uint64_t sum = vplState_Checksum(copy, size - 8);
            for (int b = 0; b < 8; b++) {
                copy[size - 8 + (size_t)b] = (uint8_t)(sum >> 8 * b);
            }
            writeState(copy, size);
            takeMessage();
            assert_int_equal(vplRenderer_Create(scene, &o, &fresh), VPL_SUCCESS);
            const vplResult result = vplRenderer_Load(fresh, stateFile(), &done);
            assert_true((result == VPL_SUCCESS) == (takeMessage()[0] == 0));
            if (result == VPL_SUCCESS) {
                look(fresh, NULL);
            }
            vplRenderer_Destroy(fresh);
            free(copy);
        }
        vplRenderer_Destroy(r);
        vplFree(context, bytes);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
    unlink(stateFile());
}

// ---- the hash of a scene

TEST(AScenesHashIsOfItsContent, 1)
{
    vplScene *a = loadScene(context, "room.json"), *b = loadScene(context, "room.json");
    assert_true(vplScene_GetHash(a) == vplScene_GetHash(b));
    print_message("%llx\n", (unsigned long long)vplScene_GetHash(a));
    addEmitter(b, VPL_EMITTER_POINT, (vplVec3){0, 1, 0}, (vplVec3){0, -1, 0}, 3);
    assert_true(vplScene_GetHash(a) != vplScene_GetHash(b));
    const vplCameraKey key = vplMakeCameraKey(vplScene_GetCamera(a, 0), 3);
    const uint64_t still = vplScene_GetHash(a);
    assert_int_equal(vplScene_SetCameraPath(a, 0, &key, 1), VPL_SUCCESS);
    assert_true(vplScene_GetHash(a) != still);
    vplScene_Destroy(a);
    vplScene_Destroy(b);
}

// One number that is not finite is enough, whatever follows.
TEST_ALONE(StreamsNoteWhatIsNotFinite)
{
    for (int at = 0; at < 4; at++) {
        float values[3] = {1, 2, 3};
        double wide[3] = {1, 2, 3};
        uint8_t bytes[sizeof values + sizeof wide];
        values[at % 3] = at < 3 ? INFINITY : 1;
        vplStream s = {.bytes = bytes, .writes = true, .finite = true};
        vplStream_Floats(&s, values, 3);
        assert_int_equal(s.finite, at == 3);
        wide[at % 3] = at < 3 ? NAN : 1;
        s.finite = true;
        vplStream_Doubles(&s, wide, 3);
        assert_int_equal(s.finite, at == 3);
        assert_int_equal(s.at, sizeof bytes);
    }
}

// What a coarse picture replaces begins anew, with whatever options.
TEST(AStateOfACoarsePictureBeginsAnew, 2)
{
    const vplSpeeds slow = slowerSpeeds(1e10);
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    vplRenderOptions o = vplDefaultRenderOptions();
    o.method = VPL_METHOD_KELLER;
    o.output.width = o.output.height = 24;
    o.particles.count = 100;
    for (int during = 0; during < 2; during++) { // its picture, or the plan that follows
        vplRenderer* r;
        vplRenderStats stats;
        Seen first, last, ended;
        bool done;
        o.stop.budgetMs = 1e7;
        o.stop.passes = 0;
        assert_int_equal(vplContext_SetSpeeds(context, &slow), VPL_SUCCESS);
        assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
        assert_true(vplRenderer_HasState(r) && r->coarse);
        if (during == 0) {
            assert_int_equal(vplRenderer_RunPass(r), VPL_SUCCESS);
            r->done = 1;
        } else {
            assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
            assert_true(!done && r->done == 0);
        }
        assert_int_equal(vplRenderer_Save(r, stateFile()), VPL_SUCCESS);
        vplRenderer_Destroy(r);
        assert_int_equal(vplContext_SetSpeeds(context, NULL), VPL_SUCCESS);
        o.stop.budgetMs = 0;
        o.stop.passes = 2;
        goOn(scene, &o, &first, &last, &stats);
        assert_int_equal(stats.passes, 2);
        assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
        stepToEnd(r);
        ended = look(r, NULL);
        assertSeenSame(&last, &ended);
        vplRenderer_Destroy(r);
    }
    unlink(stateFile());
    vplScene_Destroy(scene);
}

// A plan that was made smaller for want of time is followed, but for what the caller asks otherwise.
TEST(AStateOfASmallerPlanIsFollowed, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    vplRenderOptions o = vplDefaultRenderOptions(), smaller;
    vplRenderer* r;
    bool done;
    o.method = VPL_METHOD_KELLER;
    o.output.width = o.output.height = 24;
    o.stop.passes = 3;
    smaller = o;
    smaller.output.antialias = 4;
    smaller.particles.count = 100;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Plan(r, &smaller, false), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Save(r, stateFile()), VPL_SUCCESS);
    stepToEnd(r);
    const Seen whole = look(r, NULL);
    vplRenderer_Destroy(r);
    Seen first, last;
    vplRenderStats stats;
    goOn(scene, &o, &first, &last, &stats);
    assertSeenSame(&last, &whole);
    o.maxBounces = 1;
    assertNotLoaded(scene, &o, VPL_INVALID_ARGUMENT, "--max-bounces");
    o.maxBounces = vplDefaultRenderOptions().maxBounces;
    o.method = VPL_METHOD_INSTANT_RADIOSITY;
    assertNotLoaded(scene, &o, VPL_INVALID_ARGUMENT, "--method keller");
    unlink(stateFile());
    vplScene_Destroy(scene);
}
