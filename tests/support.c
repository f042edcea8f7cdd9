// SPDX-License-Identifier: MIT
#include "test.h"

#include "base/rng.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

static char lastMessage[1200];

static void keepMessage(void* user, vplLogLevel level, const char* message)
{
    (void)user;
    (void)level;
    snprintf(lastMessage, sizeof lastMessage, "%s", message);
}

const char* takeMessage(void)
{
    static char taken[1200];
    memcpy(taken, lastMessage, sizeof taken);
    lastMessage[0] = 0;
    return taken;
}

const char* temporaryName(const char* ending)
{
    static char name[64];
    snprintf(name, sizeof name, "/tmp/vpl-test-%ld%s", (long)getpid(), ending);
    return name;
}

// A thread pool like that of a host program: threads take tasks from a counter.
typedef struct Crew {
    vplTaskFcn* task;
    void* data;
    int count;
    atomic_int next;
} Crew;

typedef struct Member {
    Crew* crew;
    int worker;
} Member;

static void* work(void* data)
{
    Member* member = data;
    Crew* crew = member->crew;
    for (int i = atomic_fetch_add(&crew->next, 1); i < crew->count; i = atomic_fetch_add(&crew->next, 1)) {
        crew->task(crew->data, i, member->worker);
    }
    return NULL;
}

void threadedFor(void* user, int taskCount, int workerCount, vplTaskFcn* task, void* data)
{
    enum { MOST = 16 };
    Crew crew = {task, data, taskCount, 0};
    Member members[MOST];
    pthread_t threads[MOST];
    (void)user;
    workerCount = workerCount < MOST ? workerCount : MOST;
    for (int i = 0; i < workerCount; i++) {
        members[i] = (Member){&crew, i};
        if (i > 0) {
            assert_int_equal(pthread_create(&threads[i], NULL, work, &members[i]), 0);
        }
    }
    work(&members[0]);
    for (int i = 1; i < workerCount; i++) {
        pthread_join(threads[i], NULL);
    }
}

vplContext* openIsaContext(int workers, vplIsa isa)
{
    vplContextDef def = vplDefaultContextDef();
    def.workerCount = workers;
    def.isa = isa;
    def.log = keepMessage;
#ifdef VPL_TEST_PTHREADS // for the thread sanitizer, which cannot see OpenMP's synchronisation
    def.parallelFor = threadedFor;
#endif
    vplContext* context = NULL;
    return vplContext_Create(&def, &context) == VPL_SUCCESS ? context : NULL;
}

vplSpeeds slowerSpeeds(double factor)
{
    vplSpeeds speeds = vplUsualSpeeds();
    double* values = (double*)&speeds; // all fields are doubles
    for (size_t i = 0; i < sizeof speeds / sizeof *values; i++) {
        values[i] *= factor;
    }
    speeds.threads = vplUsualSpeeds().threads;
    return speeds;
}

vplRenderOptions plannedOptions(const vplScene* scene, const vplRenderOptions* o)
{
    vplPlan* plan;
    assert_int_equal(vplPlan_Create(scene, o, NULL, &plan), VPL_SUCCESS);
    const vplRenderOptions options = plan->options;
    vplPlan_Destroy(plan);
    return options;
}

vplContext* openTestContext(int workers)
{
    vplContext* context = openIsaContext(workers, VPL_ISA_AUTO);
    assert_non_null(context);
    takeMessage();
    return context;
}

void closeTestContext(vplContext* context)
{
    assert_int_equal(vplContext_GetBytes(context), 0);
    vplContext_Destroy(context);
}

static char* readText(const char* name)
{
    char path[256];
    snprintf(path, sizeof path, "tests/data/%s", name);
    FILE* file = fopen(path, "rb");
    if (file == NULL) {
        fail_msg("%s: cannot open (tests run from the top of the checkout)", path);
        return NULL;
    }
    fseek(file, 0, SEEK_END);
    size_t size = (size_t)ftell(file);
    rewind(file);
    char* text = malloc(size + 1);
    assert_int_equal(fread(text, 1, size, file), size);
    text[size] = 0;
    fclose(file);
    return text;
}

// Splits a line at commas outside quotes; the cells point into the line.
static int splitLine(char* line, char** cells, int most)
{
    int count = 0;
    char* at = line;
    for (;;) {
        assert_true(count < most);
        char* end = at;
        if (*at == '"') {
            cells[count++] = ++at;
            end = strchr(at, '"');
            *end++ = 0;
        } else {
            cells[count++] = at;
            end = at + strcspn(at, ",");
        }
        if (*end != ',') {
            *end = 0;
            return count;
        }
        *end = 0;
        at = end + 1;
    }
}

Table loadTable(const char* name)
{
    Table t = {readText(name), NULL, NULL, 0, 0};
    enum { MOST = 64 };
    int capacity = 0;
    for (char* line = t.text; line != NULL && *line;) {
        char* next = strchr(line, '\n');
        if (next != NULL) {
            *next++ = 0;
        }
        if (*line != '#' && *line != 0) {
            char* cells[MOST];
            int count = splitLine(line, cells, MOST);
            if (t.names == NULL) {
                t.columns = count;
                t.names = malloc((size_t)count * sizeof(char*));
                memcpy(t.names, cells, (size_t)count * sizeof(char*));
            } else {
                assert_int_equal(count, t.columns);
                if (t.rows == capacity) {
                    capacity = capacity ? 2 * capacity : 64;
                    t.cells = realloc(t.cells, (size_t)capacity * (size_t)t.columns * sizeof(char*));
                }
                memcpy(t.cells + (size_t)t.rows++ * (size_t)t.columns, cells, (size_t)count * sizeof(char*));
            }
        }
        line = next;
    }
    assert_true(t.rows > 0);
    return t;
}

void freeTable(Table* table)
{
    free(table->text);
    free(table->cells);
    free(table->names);
}

int columnOf(const Table* table, const char* name)
{
    for (int i = 0; i < table->columns; i++) {
        if (strcmp(table->names[i], name) == 0) {
            return i;
        }
    }
    fail_msg("no column %s", name);
    return 0;
}

const char* cell(const Table* table, int row, const char* name)
{
    return table->cells[row * table->columns + columnOf(table, name)];
}

bool isEmpty(const Table* table, int row, const char* name)
{
    return cell(table, row, name)[0] == 0;
}

double number(const Table* table, int row, const char* name)
{
    const char* text = cell(table, row, name);
    char* end;
    double value = strtod(text, &end);
    const char* slash = strchr(text, '/');
    if (slash != NULL) {
        value /= strtod(slash + 1, &end); // a fraction such as "1/512"
    }
    if (end == text || *end != 0) {
        fail_msg("row %d, %s: \"%s\" is no number", row, name, text);
    }
    return value;
}

vplVec3 vectorOf(const Table* table, int row, const char* prefix)
{
    float v[3];
    for (int i = 0; i < 3; i++) {
        char name[32];
        snprintf(name, sizeof name, "%s%c", prefix, 'x' + i);
        v[i] = (float)number(table, row, name);
    }
    return (vplVec3){v[0], v[1], v[2]};
}

void assertRefused(vplResult result, vplResult wanted, const char* said)
{
    const char* message = takeMessage();
    if (result != wanted || strstr(message, said) == NULL) {
        fail_msg("%s, \"%s\" instead of %s, \"%s\"", vplResult_GetName(result), message,
                 vplResult_GetName(wanted), said);
    }
}

void assertNear(double value, double wanted, double tolerance, const char* what, int row)
{
    if (!(fabs(value - wanted) <= tolerance)) {
        fail_msg("row %d, %s: %.9g, wanted %.9g within %.3g (off by %.3g)", row, what, value, wanted,
                 tolerance, value - wanted);
    }
}

double uniformAt(uint64_t seed, uint64_t index)
{
    return (double)vplRandomAt(seed, 77, index).v[0] * 0x1p-32;
}

bool noteProgress(void* user, double fraction)
{
    Progressed* p = user;
    assert_true(fraction >= p->last && fraction <= 1);
    p->calls++;
    p->last = fraction;
    return true;
}

vplScene* openScene(vplContext* context, const char* path)
{
    vplScene* scene = NULL;
    if (vplScene_Load(context, path, &scene) != VPL_SUCCESS) {
        fail_msg("%s: %s", path, takeMessage());
    }
    return scene;
}

vplScene* loadScene(vplContext* context, const char* name)
{
    char path[256];
    snprintf(path, sizeof path, "tests/data/%s", name);
    return openScene(context, path);
}

vplImage* renderScene(const vplScene* scene, const vplRenderOptions* options, vplRenderStats* statsOut)
{
    vplImage* image = NULL;
    if (vplRender(scene, options, &image, statsOut) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return image;
}

int stepToEnd(vplRenderer* r)
{
    int steps = 0;
    for (bool done = false; !done; steps++) {
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    }
    return steps;
}

void saveAfter(const vplScene* scene, const vplRenderOptions* o, int steps, const char* path, bool* endedOut)
{
    vplRenderer* r;
    *endedOut = false;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    for (int i = 0; i < steps && !*endedOut; i++) {
        assert_int_equal(vplRenderer_Step(r, endedOut), VPL_SUCCESS);
    }
    assert_int_equal(vplRenderer_Save(r, path), VPL_SUCCESS);
    vplRenderer_Destroy(r);
}

void finishSaved(const vplScene* scene, const vplRenderOptions* o, const char* path, vplRenderStats* stats)
{
    vplRenderer* r;
    vplImage* image;
    bool done;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Load(r, path, &done), VPL_SUCCESS);
    while (!done) {
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    }
    assert_int_equal(vplRenderer_GetImage(r, &image, stats), VPL_SUCCESS);
    vplImage_Destroy(image);
    vplRenderer_Destroy(r);
}

double errorAgainstPaths(const vplScene* scene, const vplImage* image)
{
    vplImage* halves[2];
    double square = 0, sum = 0;
    const size_t values = 3 * (size_t)image->width * (size_t)image->height;
    for (int i = 0; i < 2; i++) {
        vplRenderOptions o = vplDefaultRenderOptions();
        o.output.width = image->width;
        o.output.height = image->height;
        o.method = VPL_METHOD_PATH;
        o.path.samples = 128;
        o.seed = 77 + (uint64_t)i;
        halves[i] = renderScene(scene, &o, NULL);
    }
    for (size_t k = 0; k < values; k++) {
        const double x = (double)image->pixels[k], a = (double)halves[0]->pixels[k],
                     b = (double)halves[1]->pixels[k];
        square += (x - a) * (x - b);
        sum += 0.5 * (a + b);
    }
    vplImage_Destroy(halves[0]);
    vplImage_Destroy(halves[1]);
    return sqrt(fmax(0, square) * (double)values) / sum;
}

// The thread sanitizer looks for races, which do not depend on the instruction set.
#ifdef VPL_TEST_PTHREADS
enum { MOST_WORKERS = 3, ISAS = VPL_ISA_SCALAR };
#else
enum { MOST_WORKERS = 7, ISAS = VPL_ISA_COUNT };
#endif

void assertSameEverywhere(uint64_t (*hashOf)(vplContext* context))
{
    const uint64_t wanted = hashOf(openTestContext(1));
    for (int workers = 2; workers <= MOST_WORKERS; workers += workers == 3 ? 4 : 1) {
        assert_true(hashOf(openTestContext(workers)) == wanted);
    }
    for (int isa = VPL_ISA_SCALAR; isa < ISAS; isa++) {
        vplContext* context = openIsaContext(2, (vplIsa)isa);
        assert_true(context == NULL || hashOf(context) == wanted);
    }
}

bool refuseThird(void* user, double fraction)
{
    (void)fraction;
    return ++*(int*)user < 3;
}
