// SPDX-License-Identifier: MIT
// Runs all suites; `vpl-tests NAME` runs the tests whose names contain NAME, `vpl-tests -memory -Host` all
// but the suite memory and the tests whose names contain Host. Ends with "N passed, N failed".
#include "test.h"

#include <stdlib.h>

// One line per test file.
#define ALL_SUITES(X)                                                                                        \
    X(emitters)                                                                                              \
    X(emission)                                                                                              \
    X(exr)                                                                                                   \
    X(geometry)                                                                                              \
    X(hits)                                                                                                  \
    X(image)                                                                                                 \
    X(lights)                                                                                                \
    X(math)                                                                                                  \
    X(memory)                                                                                                \
    X(metrics)                                                                                               \
    X(obj)                                                                                                   \
    X(objParts)                                                                                              \
    X(objScene)                                                                                              \
    X(rays)                                                                                                  \
    X(path)                                                                                                  \
    X(raster)                                                                                                \
    X(rasterTruth)                                                                                           \
    X(render)                                                                                                \
    X(scene)                                                                                                 \
    X(sceneChecks)                                                                                           \
    X(shading)                                                                                               \
    X(tradeoff)                                                                                              \
    X(visibility)

#define DECLARE(name) extern const Suite name##Suite;
#define LIST(name)    &name##Suite,
ALL_SUITES(DECLARE)

// True if `name` is among the words that exclude suites ("-memory").
static bool isExcluded(int count, char** words, const char* name)
{
    for (int i = 1; i < count; i++) {
        if (words[i][0] == '-' && strcmp(words[i] + 1, name) == 0) {
            return true;
        }
    }
    return false;
}

int main(int count, char** words)
{
    static const Suite* const suites[] = {ALL_SUITES(LIST)};
    size_t passed = 0, failed = 0;
    static char filter[128], skip[128];
    for (int i = 1; i < count; i++) {
        if (words[i][0] == '-') {
            snprintf(skip, sizeof skip, "*%s*", words[i] + 1);
            cmocka_set_skip_filter(skip); // harmless where it is a suite's name
        } else {
            snprintf(filter, sizeof filter, "*%s*", words[i]);
            cmocka_set_test_filter(filter);
        }
    }
    for (size_t i = 0; i < sizeof suites / sizeof *suites; i++) {
        if (isExcluded(count, words, suites[i]->name)) {
            continue;
        }
        int bad = _cmocka_run_group_tests(suites[i]->name, suites[i]->tests, suites[i]->count, NULL, NULL);
        size_t wrong = bad < 0 ? suites[i]->count : (size_t)bad;
        failed += wrong;
        passed += suites[i]->count - wrong;
    }
    printf("%zu passed, %zu failed\n", passed, failed);
    return failed > 0;
}
