// SPDX-License-Identifier: MIT
// Runs all suites; `vpl-tests NAME` runs the suite NAME and the tests whose names contain NAME, `vpl-tests -memory
// -Host` all but the suite memory and the tests whose names contain Host. --quick leaves out slow tests, --times says what
// processor time each takes. Ends with "N passed, N failed".
#include "test.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

// One line per test file.
// clang-format off
#define ALL_SUITES(X) \
    X(arena) \
    X(bench) \
    X(bounds) \
    X(chooseShadows) \
    X(clusterShadows) \
    X(clusters) \
    X(compensation) \
    X(drawPatches) \
    X(emission) \
    X(emitters) \
    X(exr) \
    X(formFactors) \
    X(frames) \
    X(gather) \
    X(geometry) \
    X(hemiMaps) \
    X(hits) \
    X(image) \
    X(interleaved) \
    X(keller) \
    X(lightcuts) \
    X(lights) \
    X(links) \
    X(math) \
    X(memory) \
    X(metrics) \
    X(obj) \
    X(objParts) \
    X(objScene) \
    X(packets) \
    X(paraboloids) \
    X(passes) \
    X(patchMesh) \
    X(patchSides) \
    X(patchPriority) \
    X(patches) \
    X(path) \
    X(placement) \
    X(ply) \
    X(radiosity) \
    X(radiositySolve) \
    X(raster) \
    X(rasterTruth) \
    X(rays) \
    X(render) \
    X(renderer) \
    X(rsm) \
    X(rsmLights) \
    X(rsmShadow) \
    X(scene) \
    X(sceneChecks) \
    X(secondBounce) \
    X(shadeOutputs) \
    X(shading) \
    X(ssvp) \
    X(tradeoff) \
    X(triangleFactors) \
    X(visibility)
// clang-format on

#define DECLARE(name) extern const Suite name##Suite;
#define LIST(name)    &name##Suite,
ALL_SUITES(DECLARE)

char testIsSlow;

// Takes an option out of the words.
static bool takeOption(int* count, char** words, const char* option)
{
    for (int i = 1; i < *count; i++) {
        if (strcmp(words[i], option) == 0) {
            --*count;
            memmove(&words[i], &words[i + 1], (size_t)(*count - i) * sizeof *words);
            return true;
        }
    }
    return false;
}

// Words name suites, or parts of the names of tests. "-word" excludes; other words, if any, include.
static bool isWanted(int count, char** words, const char* suite, const char* test)
{
    bool any = false, included = false;
    for (int i = 1; i < count; i++) {
        const bool minus = words[i][0] == '-';
        const char* word = words[i] + minus;
        const bool hit = strcmp(word, suite) == 0 || strstr(test, word) != NULL;
        if (minus && hit) {
            return false;
        }
        any = any || !minus;
        included = included || (!minus && hit);
    }
    return included || !any;
}

static size_t run(const char* suite, const struct CMUnitTest* tests, size_t count)
{
    const int bad = count > 0 ? _cmocka_run_group_tests(suite, tests, count, NULL, NULL) : 0;
    return bad < 0 ? count : (size_t)bad;
}

// One by one: cmocka knows how long a group takes at most.
static size_t runTimed(const char* suite, const struct CMUnitTest* tests, size_t count)
{
    size_t bad = 0;
    for (size_t i = 0; i < count; i++) {
        const clock_t start = clock();
        bad += run(suite, &tests[i], 1);
        printf("%9.2f s  %s  %s\n", (double)(clock() - start) / CLOCKS_PER_SEC, suite, tests[i].name);
    }
    return bad;
}

int main(int count, char** words)
{
    static const Suite* const suites[] = {ALL_SUITES(LIST)};
    const bool timed = takeOption(&count, words, "--times"), quick = takeOption(&count, words, "--quick");
    size_t passed = 0, failed = 0;
    for (size_t i = 0; i < sizeof suites / sizeof *suites; i++) {
        const Suite* suite = suites[i];
        struct CMUnitTest wanted[128];
        size_t n = 0;
        assert(suite->count <= sizeof wanted / sizeof *wanted);
        for (size_t k = 0; k < suite->count; k++) {
            const struct CMUnitTest* test = &suite->tests[k];
            if (isWanted(count, words, suite->name, test->name) &&
                !(quick && test->initial_state == &testIsSlow)) {
                wanted[n++] = *test;
            }
        }
        const size_t wrong = (timed ? runTimed : run)(suite->name, wanted, n);
        failed += wrong;
        passed += n - wrong;
    }
    printf("%zu passed, %zu failed\n", passed, failed);
    return failed > 0;
}
