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

// A test, which registers itself: TEST(SharedEdgeIsCoveredOnce, 2) { ... } has a `context` with two threads,
// of which nothing may be left in the end; TEST_ALONE(...) has none. SLOW, in the end, is for tests that take
// a second or more because they are about statistics, or try many cases of one thing: `vpl-tests --quick`
// leaves them out.
#define TEST(name, ...)                                                                                      \
    static void name(vplContext* context);                                                                   \
    REGISTER_TEST(name, .run = name, .workers = __VA_ARGS__)                                                 \
    static void name(vplContext* context)

#define TEST_ALONE(name, ...)                                                                                \
    static void name(void);                                                                                  \
    REGISTER_TEST(name, .runAlone = name, .workers = 0, ##__VA_ARGS__)                                       \
    static void name(void)

#define REGISTER_TEST(function, ...)                                                                         \
    __attribute__((constructor)) static void function##Register(void)                                        \
    {                                                                                                        \
        static Test test = {.name = #function, .file = __FILE__, __VA_ARGS__};                               \
        registerTest(&test);                                                                                 \
    }

enum { SLOW = 1 };

typedef struct Test {
    const char *name, *file; // the file is its suite
    void (*run)(vplContext* context);
    void (*runAlone)(void);
    int workers;
    bool slow;
    struct Test* next;
} Test;

void registerTest(Test* test);

// A context with `workers` threads whose last message is kept. Never NULL.
vplContext* openTestContext(int workers);

// The same with a chosen instruction set; NULL if this machine lacks it.
vplContext* openIsaContext(int workers, vplIsa isa);

// A vplParallelForFcn made of threads, as a host program might have.
void threadedFor(void* user, int taskCount, int workerCount, vplTaskFcn* task, void* data);

// Fails unless a hash is the same for 1, 2, 3 and 7 workers and every instruction set. hashOf closes the
// context.
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

// A scene from a file, or a failed test with the library's sentence.
vplScene* openScene(vplContext* context, const char* path);

// vplRender, or a failed test with the library's sentence. statsOut may be NULL.
vplImage* renderScene(const vplScene* scene, const vplRenderOptions* options, vplRenderStats* statsOut);

#endif
