// SPDX-License-Identifier: MIT
// Runs all suites; `vpl-tests NAME` runs the tests whose names contain NAME. Ends with "N passed, N failed".
#include "test.h"

#include <stdlib.h>

// One line per test file.
#define ALL_SUITES(X)                                                                                        \
    X(geometry)                                                                                              \
    X(image)                                                                                                 \
    X(lights)                                                                                                \
    X(math)                                                                                                  \
    X(memory)                                                                                                \
    X(raster)                                                                                                \
    X(rasterTruth)                                                                                           \
    X(render)                                                                                                \
    X(scene)                                                                                                 \
    X(sceneChecks)                                                                                           \
    X(shading)                                                                                               \
    X(visibility)

#define DECLARE(name) extern const Suite name##Suite;
#define LIST(name)    &name##Suite,
ALL_SUITES(DECLARE)

int main(int count, char** words)
{
    static const Suite* const suites[] = {ALL_SUITES(LIST)};
    size_t passed = 0, failed = 0;
    char filter[128];
    if (count > 1) {
        snprintf(filter, sizeof filter, "*%s*", words[1]);
        cmocka_set_test_filter(filter);
    }
    for (size_t i = 0; i < sizeof suites / sizeof *suites; i++) {
        int bad = _cmocka_run_group_tests(suites[i]->name, suites[i]->tests, suites[i]->count, NULL, NULL);
        size_t wrong = bad < 0 ? suites[i]->count : (size_t)bad;
        failed += wrong;
        passed += suites[i]->count - wrong;
    }
    printf("%zu passed, %zu failed\n", passed, failed);
    return failed > 0;
}
