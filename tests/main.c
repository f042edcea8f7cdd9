// SPDX-License-Identifier: MIT
// Runs all tests; `vpl-tests NAME` runs the suite NAME (the tests of test_NAME.c) and the tests whose names
// contain NAME, `vpl-tests -memory -Host` all but the suite memory and the tests whose names contain Host.
// --quick leaves out slow tests, --odd and --even take every second test, so that two processes share them, --times prints the
// processor time of each. Ends with "N passed, N failed".
#include "test.h"

#include <stdlib.h>
#include <time.h>

static Test *first, *last;
static int testCount;

// Appends a test to the list. Each test file calls it before main, through its constructors.
void registerTest(Test* test)
{
    *(last != NULL ? &last->next : &first) = test;
    last = test;
    testCount++;
}

// Returns the suite of a test: "memory" for "tests/test_memory.c".
static const char* suiteOf(const Test* test)
{
    static char suite[64];
    snprintf(suite, sizeof suite, "%s", strstr(test->file, "test_") + strlen("test_"));
    suite[strlen(suite) - strlen(".c")] = 0;
    return suite;
}

const Test* findTest(const char* suite, const char* name)
{
    const size_t length = strcspn(suite, "/");
    for (const Test* test = first; test != NULL; test = test->next) {
        const char* own = suiteOf(test);
        if (strcmp(test->name, name) == 0 && strncmp(own, suite, length) == 0 && own[length] == 0) {
            return test;
        }
    }
    return NULL;
}

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

// Returns whether the command line selects a test. Words name suites or parts of test names; "-word"
// excludes, other words, if any, include.
static bool isWanted(int count, char** words, const Test* test)
{
    bool any = false, included = false;
    for (int i = 1; i < count; i++) {
        const bool minus = words[i][0] == '-';
        const char* word = words[i] + minus;
        const bool hit = strcmp(word, suiteOf(test)) == 0 || strstr(test->name, word) != NULL;
        if (minus && hit) {
            return false;
        }
        any = any || !minus;
        included = included || (!minus && hit);
    }
    return included || !any;
}

static void runTest(void** state)
{
    const Test* test = *state;
    if (test->runAlone != NULL) {
        test->runAlone();
        return;
    }
    vplContext* context = openTestContext(test->workers);
    test->run(context);
    closeTestContext(context);
}

// Runs `count` tests of one suite. Returns how many failed.
static size_t run(const char* suite, const struct CMUnitTest* tests, size_t count)
{
    const int bad = count > 0 ? _cmocka_run_group_tests(suite, tests, count, NULL, NULL) : 0;
    return bad < 0 ? count : (size_t)bad;
}

// Runs tests one by one, because cmocka reports times only for whole groups.
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
    const bool timed = takeOption(&count, words, "--times"), quick = takeOption(&count, words, "--quick");
    const bool odd = takeOption(&count, words, "--odd"), even = takeOption(&count, words, "--even");
    int chosen = 0;
    struct CMUnitTest* wanted = malloc((size_t)testCount * sizeof *wanted);
    size_t passed = 0, failed = 0;
    for (Test* test = first; test != NULL;) {
        const Test* head = test;
        size_t n = 0;
        for (; test != NULL && strcmp(test->file, head->file) == 0; test = test->next) {
            const bool isChosen = isWanted(count, words, test) && !(quick && test->slow);
            chosen += isChosen;
            const bool isOthers = chosen % 2 == 1 ? even : odd; // the other process takes it
            if (isChosen && !isOthers) {
                wanted[n++] = (struct CMUnitTest){test->name, runTest, NULL, NULL, test};
            }
        }
        const size_t wrong = (timed ? runTimed : run)(suiteOf(head), wanted, n);
        failed += wrong;
        passed += n - wrong;
    }
    free(wanted);
    printf("%zu passed, %zu failed\n", passed, failed);
    return failed > 0;
}
