// SPDX-License-Identifier: MIT
// Tests of processes that share form factors (vplContext_SetTeam): here threads, each with a context of its own.
#include "test.h"

#include <pthread.h>
#include <stdlib.h>
#include <time.h>

enum { MOST = 5, PATIENCE = 60 }; // members; seconds after which a member waits in vain

// The place where members meet. Each shows what it sends, and all copy.
typedef struct Crew {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    int count, here, turn;
    const void* sent[MOST];
    const size_t* sentBytes[MOST];
} Crew;

typedef struct Member {
    Crew* crew;
    int index, calls;
    const char* words; // options
    int failAt;        // the allocation that fails; -1: none
    int cancelAt;      // the progress call that cancels; -1: none
    int allocations, reports;
    vplResult result;
    uint64_t hash;
} Member;

static void meet(Crew* crew)
{
    struct timespec end;
    clock_gettime(CLOCK_REALTIME, &end);
    end.tv_sec += PATIENCE;
    pthread_mutex_lock(&crew->mutex);
    const int turn = crew->turn;
    if (++crew->here == crew->count) {
        crew->here = 0;
        crew->turn++;
        pthread_cond_broadcast(&crew->changed);
    }
    while (crew->turn == turn) {
        if (pthread_cond_timedwait(&crew->changed, &crew->mutex, &end) != 0) {
            fprintf(stderr, "a member of a team waits in vain\n");
            abort();
        }
    }
    pthread_mutex_unlock(&crew->mutex);
}

static void exchange(void* user, const void* send, const size_t* sendBytes, void* receive,
                     const size_t* receiveBytes)
{
    Member* m = user;
    Crew* crew = m->crew;
    m->calls++;
    crew->sent[m->index] = send;
    crew->sentBytes[m->index] = sendBytes;
    meet(crew);
    char* to = receive;
    for (int i = 0; i < crew->count; i++) {
        const char* from = crew->sent[i];
        for (int k = 0; k < m->index; k++) {
            from += crew->sentBytes[i][k];
        }
        if (crew->sentBytes[i][m->index] != receiveBytes[i]) {
            fprintf(stderr, "a member sends %zu bytes where %zu are expected\n", crew->sentBytes[i][m->index],
                    receiveBytes[i]);
            abort();
        }
        memcpy(to, from, receiveBytes[i]);
        to += receiveBytes[i];
    }
    meet(crew);
}

static void* allocate(void* user, void* memory, size_t oldSize, size_t newSize)
{
    Member* m = user;
    (void)oldSize;
    if (newSize == 0) {
        free(memory);
        return NULL;
    }
    return m->failAt >= 0 && m->allocations++ == m->failAt ? NULL : realloc(memory, newSize);
}

static bool report(void* user, double fraction)
{
    Member* m = user;
    (void)fraction;
    return m->cancelAt < 0 || m->reports++ < m->cancelAt;
}

// Prepares the renderer together with the others, and renders alone.
static vplResult renderTogether(Member* m, vplContext* context, const vplScene* scene)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    vplRenderer* r = NULL;
    vplImage* image = NULL;
    bool done;
    vplRenderOptions_SetAll(&o, m->words);
    o.output.width = 32;
    o.output.height = 18;
    o.progress = report;
    o.progressUser = m;
    vplResult result = vplRenderer_Create(scene, &o, &r);
    result = result == VPL_SUCCESS ? vplRenderer_Prepare(r) : result;
    vplContext_SetTeam(context, NULL);
    if (result == VPL_SUCCESS) {
        m->failAt = m->cancelAt = -1;
        result = vplRenderer_Step(r, &done);
        result = result == VPL_SUCCESS ? vplRenderer_GetImage(r, &image, NULL) : result;
        m->hash = vplImage_Hash(image);
        vplImage_Destroy(image);
    }
    vplRenderer_Destroy(r);
    return result;
}

static void* work(void* data)
{
    Member* m = data;
    vplContextDef def = vplDefaultContextDef();
    const vplTeam team = {m->index, m->crew->count, exchange, m};
    vplContext* context = NULL;
    vplScene* scene = NULL;
    const int failAt = m->failAt;
    def.alloc = allocate;
    def.allocUser = m;
    def.workerCount = 1 + m->index % 2;
    m->failAt = -1;
    vplContext_Create(&def, &context);
    vplScene_Load(context, "tests/data/room.json", &scene);
    vplContext_SetTeam(context, &team);
    m->failAt = failAt;
    m->result = renderTogether(m, context, scene);
    vplScene_Destroy(scene);
    if (vplContext_GetBytes(context) != 0) {
        fprintf(stderr, "member %d holds %zu bytes\n", m->index, vplContext_GetBytes(context));
        abort();
    }
    vplContext_Destroy(context);
    return NULL;
}

// Runs a team in which member 1 fails or cancels as `second` says.
static void runTeam(int count, const char* words, Member second, Member members[MOST])
{
    Crew crew = {PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, .count = count};
    pthread_t threads[MOST];
    for (int i = 0; i < count; i++) {
        members[i] = i == 1 ? second : (Member){.failAt = -1, .cancelAt = -1};
        members[i].crew = &crew;
        members[i].index = i;
        members[i].words = words;
        assert_int_equal(pthread_create(&threads[i], NULL, work, &members[i]), 0);
    }
    for (int i = 0; i < count; i++) {
        pthread_join(threads[i], NULL);
    }
}

static const Member WELL = {.failAt = -1, .cancelAt = -1};

TEST_ALONE(TeamsHaveTheBitsOfOneProcess)
{
    static const char* const words[] = {
        "--method radiosity --patches 150",
        "--method radiosity --patches 150 --solver jacobi --row-sums normalise --form-samples 20",
        "--method radiosity --patches 150 --gather 4 --iterations 3",
        "--method radiosity --patch-size 1 --form-factors incentre",
        "--method radiosity --patches 60 --patch-placement adaptive",
        "--method radiosity --patches 8 --patch-groups on",
        "--method radiosity --patches 60 --hierarchy on",
        "--method keller --particles 20",
    };
    for (size_t w = 0; w < sizeof words / sizeof *words; w++) {
        Member members[MOST];
        runTeam(1, words[w], WELL, members);
        assert_int_equal(members[0].result, VPL_SUCCESS);
        const uint64_t whole = members[0].hash;
        for (int count = 2; count <= MOST; count++) {
            runTeam(count, words[w], WELL, members);
            for (int i = 0; i < count; i++) {
                assert_int_equal(members[i].result, VPL_SUCCESS);
                assert_int_equal(members[i].hash, whole);
                assert_true(members[i].calls > 0);
            }
        }
    }
}

TEST_ALONE(AMemberWithoutMemoryEndsTheTeam, SLOW)
{
    Member members[MOST];
    int failures = 0;
    for (int n = 0, done = 0; !done; n += n < 40 ? 1 : 5) {
        runTeam(3, "--method radiosity --patches 40", (Member){.failAt = n, .cancelAt = -1}, members);
        done = members[1].result == VPL_SUCCESS;
        for (int i = 0; i < 3; i++) {
            assert_int_equal(members[i].result, done ? VPL_SUCCESS : VPL_OUT_OF_MEMORY);
        }
        failures += !done;
    }
    assert_true(failures > 60);
}

TEST_ALONE(AMemberThatIsCancelledEndsTheTeam, SLOW)
{
    Member members[MOST];
    int cancelled = 0;
    for (int n = 0, done = 0; !done; n += 3) {
        runTeam(3, "--method radiosity --patches 40", (Member){.failAt = -1, .cancelAt = n}, members);
        done = members[1].result == VPL_SUCCESS;
        for (int i = 0; i < 3; i++) {
            assert_int_equal(members[i].result, done ? VPL_SUCCESS : VPL_CANCELLED);
        }
        cancelled += !done;
    }
    assert_true(cancelled > 10);
}

TEST(TeamsThatCannotBeAreRefused, 1)
{
    Member member = WELL;
    const vplTeam teams[] = {
        {0, 0, exchange, &member}, {2, 2, exchange, &member}, {-1, 2, exchange, &member}};
    for (size_t i = 0; i < sizeof teams / sizeof *teams; i++) {
        assert_int_equal(vplContext_SetTeam(context, &teams[i]), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), "vplTeam has member"));
    }
    const vplTeam silent = {0, 2, NULL, NULL};
    assert_int_equal(vplContext_SetTeam(context, &silent), VPL_INVALID_ARGUMENT);
}
