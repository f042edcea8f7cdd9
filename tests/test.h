// SPDX-License-Identifier: MIT
// Declarations that all test files share: suites, contexts that record messages, tables of exact answers.
#ifndef VPL_TESTS_TEST_H
#define VPL_TESTS_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <vpl/plantools.h>
#include <vpl/stages.h>

#include "plain_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Defines and registers a test. TEST(SharedEdgeIsCoveredOnce, 2) { ... } gets a `context` with two threads,
// which must hold no memory at the end of the test; TEST_ALONE(...) gets none. SLOW as last argument marks
// tests that take half a second or more, because they measure statistics or try many cases: `vpl-tests --quick`
// leaves them out. Most tests of allocations that fail are not marked, because sanitizers need them.
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
    const char *name, *file; // the file gives the suite
    void (*run)(vplContext* context);
    void (*runAlone)(void);
    int workers;
    bool slow;
    struct Test* next;
} Test;

void registerTest(Test* test);

// Finds a test by the name of its suite, which the first characters of `suite` up to a slash are, and its own
// name; NULL if there is none.
const Test* findTest(const char* suite, const char* name);

// Opens a context with `workers` threads that records its last message. Never NULL.
vplContext* openTestContext(int workers);

// The usual speeds of a machine whose parts of the work take `factor` times as long.
vplSpeeds slowerSpeeds(double factor);

// The options of the plan for a scene.
vplRenderOptions plannedOptions(const vplScene* scene, const vplRenderOptions* o);

// Does the same with a chosen instruction set; NULL if this machine lacks it.
vplContext* openIsaContext(int workers, vplIsa isa);

// A vplParallelForFcn that runs on threads, as a host program's might.
void threadedFor(void* user, int taskCount, int workerCount, vplTaskFcn* task, void* data);

// Fails unless a hash is the same for 1, 2, 3 and 7 workers and every instruction set. hashOf closes the
// context.
void assertSameEverywhere(uint64_t (*hashOf)(vplContext* context));

// A vplProgressFcn that cancels on its third call; `user` is an int that counts the calls.
bool refuseThird(void* user, double fraction);

// Destroys the context and fails the test if any memory is still held.
void closeTestContext(vplContext* context);

// Returns the last message logged through any test context; empty if there was none since the last call.
const char* takeMessage(void);

// Fails unless a call gave this result and its message contains `said`.
void assertRefused(vplResult result, vplResult wanted, const char* said);

// A table from tests/data without its comments. Cells are read by column name.
typedef struct Table {
    char* text;
    char** cells; // rows * columns
    char** names; // columns
    int rows, columns;
} Table;

Table loadTable(const char* name);
void freeTable(Table* table);
int columnOf(const Table* table, const char* name); // fails the test if there is no such column
const char* cell(const Table* table, int row, const char* name);
bool isEmpty(const Table* table, int row, const char* name);
double number(const Table* table, int row, const char* name);

// Returns the vector of three columns such as px, py, pz, which a prefix such as "p" names.
vplVec3 vectorOf(const Table* table, int row, const char* prefix);

// Fails with row and values unless |value - wanted| <= tolerance. NaN fails.
void assertNear(double value, double wanted, double tolerance, const char* what, int row);

// Returns a counter-based uniform random number in [0, 1) for seeded cases, the same on every machine.
double uniformAt(uint64_t seed, uint64_t index);

// What a vplProgressFcn has seen.
typedef struct Progressed {
    int calls;
    double last;
} Progressed;

// A vplProgressFcn with a Progressed as its user: never cancels, and requires fractions of at most 1 that never shrink.
bool noteProgress(void* user, double fraction);

// Loads the benchmark room (tests/data/room.json), or the same with a front wall and the camera inside.
vplScene* loadScene(vplContext* context, const char* name);

// Loads a scene from a file; a failure fails the test with the library's message.
vplScene* openScene(vplContext* context, const char* path);

// Calls vplRender; a failure fails the test with the library's message. statsOut may be NULL.
vplImage* renderScene(const vplScene* scene, const vplRenderOptions* options, vplRenderStats* statsOut);

// Steps until the render is done; returns the number of steps.
int stepToEnd(vplRenderer* renderer);

// Saves a render after so many steps, or as many as it has.
void saveAfter(const vplScene* scene, const vplRenderOptions* options, int steps, const char* path,
               bool* endedOut);

// Loads a saved render and steps until it is done.
void finishSaved(const vplScene* scene, const vplRenderOptions* options, const char* path,
                 vplRenderStats* statsOut);

// Names a file with this ending in /tmp that no other process uses: several builds are tested side by side. The
// next call overwrites it.
const char* temporaryName(const char* ending);

// Computes the root-mean-square error of a picture over its mean, against two path-traced pictures of 128 paths per pixel. Their
// noise is independent, so that it cancels.
double errorAgainstPaths(const vplScene* scene, const vplImage* image);

// Tests of times wait longer where a sanitizer watches each access to memory.
#ifdef __SANITIZE_ADDRESS__
#define TEST_SLOWDOWN 10
#else
#define TEST_SLOWDOWN 1
#endif

#endif
