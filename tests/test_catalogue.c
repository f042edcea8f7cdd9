// SPDX-License-Identifier: MIT
// The catalogue of extremes, tests/data/extremes.csv: extremes_tests.csv names the tests that assert each row, and the table of
// src/base/README.md its promised range.
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Returns whether tests/cli has a check of that name.
static bool isCliCheck(const char* name)
{
    char command[256];
    snprintf(command, sizeof command, "grep -qwF -- '%s' tests/cli/*.sh", name);
    return system(command) == 0;
}

static bool isTest(const char* word)
{
    const char* slash = strchr(word, '/');
    return slash != NULL &&
           (strncmp(word, "cli/", 4) == 0 ? isCliCheck(slash + 1) : findTest(word, slash + 1) != NULL);
}

enum { ROWS = 112 };

TEST_ALONE(EveryRowOfTheCatalogueNamesTestsThatExist)
{
    Table rows = loadTable("extremes.csv"), tests = loadTable("extremes_tests.csv");
    assert_int_equal(rows.rows, ROWS);
    assert_int_equal(tests.rows, ROWS);
    int named = 0;
    for (int row = 0; row < ROWS; row++) {
        char id[8], words[512];
        snprintf(id, sizeof id, "X%03d", row + 1);
        assert_string_equal(cell(&rows, row, "id"), id);
        assert_string_equal(cell(&tests, row, "id"), id);
        snprintf(words, sizeof words, "%s", cell(&tests, row, "tests"));
        const int before = named;
        for (char* word = strtok(words, " "); word != NULL; word = strtok(NULL, " "), named++) {
            if (!isTest(word)) {
                fail_msg("%s: there is no test %s", id, word);
            }
        }
        assert_true(named > before);
    }
    assert_false(isTest("extremes/NobodyWroteThis") ||
                 isTest("lights/EveryRowOfTheCatalogueNamesTestsThatExist"));
    freeTable(&rows);
    freeTable(&tests);
}

// Returns the source of a test with the comment above it: what lies between the ends of two functions. Free it.
static char* sourceOf(const Test* test)
{
    static char text[1 << 17];
    char start[128];
    FILE* file = fopen(test->file, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    assert_true(feof(file));
    fclose(file);
    snprintf(start, sizeof start, "%s(%s%s", test->runAlone != NULL ? "\nTEST_ALONE" : "\nTEST", test->name,
             test->runAlone == NULL || test->slow ? "," : ")");
    char* at = strstr(text, start);
    assert_non_null(at);
    char* end = strstr(at, "\n}\n");
    assert_non_null(end);
    *end = *at = 0; // the comment is a string of its own for a moment
    const char* above = text;
    for (const char* next = text; (next = strstr(next, "\n}\n")) != NULL; next += 3) {
        above = next;
    }
    *at = '\n';
    return strdup(above);
}

// Whether a text has an id such as X054, or a range such as "X053 to X056".
static bool namesRow(const char* text, int row)
{
    for (const char* x = strchr(text, 'X'); x != NULL; x = strchr(x + 1, 'X')) {
        int first, last;
        const int found = sscanf(x, "X%3d to X%3d", &first, &last);
        if (found > 0 && (first == row || (found == 2 && first < row && row <= last))) {
            return true;
        }
    }
    return false;
}

TEST_ALONE(EveryTestOfTheCatalogueHasTheIdOfItsRow)
{
    Table tests = loadTable("extremes_tests.csv");
    for (int row = 0; row < tests.rows; row++) {
        char words[512];
        snprintf(words, sizeof words, "%s", cell(&tests, row, "tests"));
        for (char* word = strtok(words, " "); word != NULL; word = strtok(NULL, " ")) {
            const Test* test = findTest(word, strchr(word, '/') + 1);
            char* source = test != NULL ? sourceOf(test) : NULL; // else a check of tests/cli
            if (source != NULL && !namesRow(source, row + 1)) {
                fail_msg("%s is named for X%03d, which stands neither in it nor above it", word, row + 1);
            }
            free(source);
        }
    }
    assert_true(namesRow("X004, X006 to X009", 8) && !namesRow("X004, X006 to X009", 5));
    freeTable(&tests);
}

// Tests are named as `suite/Test` in the table of promised ranges.
TEST_ALONE(EveryPromisedRangeNamesTestsThatExist)
{
    FILE* file = fopen("src/base/README.md", "r");
    char line[2000];
    int rows = 0, named = 0;
    assert_non_null(file);
    while (fgets(line, sizeof line, file) != NULL) {
        const int before = named;
        for (char* word = strtok(line, "` \n"); word != NULL; word = strtok(NULL, "` \n")) {
            const char* slash = strchr(word, '/');
            if (slash != NULL && slash[1] >= 'A' && slash[1] <= 'Z' &&
                slash[1 + strspn(slash + 1, "TES")] != 0) {
                if (!isTest(word)) {
                    fail_msg("there is no test %s", word);
                }
                named++;
            }
        }
        rows += named > before;
    }
    fclose(file);
    assert_true(rows >= 25);
}

TEST_ALONE(EveryRowOfTheCatalogueHasAPromisedRange)
{
    FILE* file = fopen("src/base/README.md", "r");
    char line[2000];
    bool named[ROWS] = {false}, inTable = false;
    assert_non_null(file);
    while (fgets(line, sizeof line, file) != NULL) {
        inTable = inTable ? line[0] == '|' : strncmp(line, "| quantity | rows |", 19) == 0;
        const char* rows = inTable ? strstr(line + 1, "| ") : NULL; // the second column
        char ids[200] = "";
        if (rows != NULL && sscanf(rows, "| %199[^|]", ids) == 1) {
            for (int row = 0; row < ROWS; row++) {
                named[row] = named[row] || namesRow(ids, row + 1);
            }
        }
    }
    fclose(file);
    for (int row = 0; row < ROWS; row++) {
        if (!named[row]) {
            fail_msg("X%03d has no promised range", row + 1);
        }
    }
}
