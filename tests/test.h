// SPDX-License-Identifier: MIT
// What all test files share: suites, contexts whose messages can be read, tables of exact answers.
#ifndef VPL_TESTS_TEST_H
#define VPL_TESTS_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <vpl/vpl.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct Suite {
    const char* name;
    const struct CMUnitTest* tests;
    size_t count;
} Suite;

// Last lines of a test file: TEST_SUITE(raster, cmocka_unit_test(SharedEdgeIsCoveredOnce), ...)
#define TEST_SUITE(name, ...)                                                                                \
    static const struct CMUnitTest name##Tests[] = {__VA_ARGS__};                                            \
    const Suite name##Suite = {#name, name##Tests, sizeof name##Tests / sizeof *name##Tests}

// For TEST_SUITE, a test that takes a second or more because it is about statistics, or tries many cases of one thing:
// it has nothing new to say where the bits are the same, and `vpl-tests --quick` leaves it out.
// clang-format off
#define slow_unit_test(f) {#f, f, NULL, NULL, (void*)&testIsSlow}
// clang-format on

extern char testIsSlow;

// A context with `workers` threads whose last message is kept. Never NULL.
vplContext* openTestContext(int workers);

// The same with a chosen instruction set; NULL if this machine lacks it.
vplContext* openIsaContext(int workers, vplIsa isa);

// A vplParallelForFcn made of threads, as a host program might have.
void threadedFor(void* user, int taskCount, int workerCount, vplTaskFcn* task, void* data);

// Fails unless a hash is the same for 1, 2, 3 and 7 workers and every instruction set. hashOf closes the context.
void assertSameEverywhere(uint64_t (*hashOf)(vplContext* context));

// A vplProgressFcn that refuses when it is asked for the third time; `user` is an int that counts.
bool refuseThird(void* user, double fraction);

// Destroys it and fails the test if any memory is still held.
void closeTestContext(vplContext* context);

// The last message logged through any test context; empty if none since the last call.
const char* takeMessage(void);

// A table from tests/data, comments skipped. Cells are read by column name.
typedef struct Table {
    char* text;
    char** cells; // rows * columns
    char** names; // columns
    int rows, columns;
} Table;

Table loadTable(const char* name);
void freeTable(Table* table);
int columnOf(const Table* table, const char* name); // fails the test if there is none
const char* cell(const Table* table, int row, const char* name);
bool isEmpty(const Table* table, int row, const char* name);
double number(const Table* table, int row, const char* name);

// Three columns such as px, py, pz from a prefix "p" (suffixes x, y, z).
vplVec3 vectorOf(const Table* table, int row, const char* prefix);

// Fails, naming row and values, unless |value - wanted| <= tolerance. NaN fails.
void assertNear(double value, double wanted, double tolerance, const char* what, int row);

// Counter-based uniform random number in [0, 1) for seeded cases: the same on every machine.
double uniformAt(uint64_t seed, uint64_t index);

// The benchmark room (tests/data/room.json), or the same with a front wall and the camera inside.
vplScene* loadScene(vplContext* context, const char* name);

// vplRender, or a failed test with the library's sentence. statsOut may be NULL.
vplImage* renderScene(const vplScene* scene, const vplRenderOptions* options, vplRenderStats* statsOut);

#endif
