// SPDX-License-Identifier: MIT
// Hands out units of work. Rank 0 makes units itself and serves messages from the progress callback of its own render, so
// no core only waits. A rank has its next unit before it ends the one under way, except near the end of the work, where that
// would leave others idle. Waiting sleeps, because blocking calls of MPI spin.
#include "mpi/ranks.h"

#include "cli/bench/measure.h"

#include <mpi.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    AHEAD = 2,
    NAP = 500,
    PATIENCE = 60000
}; // units of a rank at a time; microseconds; ms for a last answer

// A result on its way to rank 0.
typedef struct Incoming {
    MPI_Request request;
    uint64_t* words; // NULL: none
    int64_t header[2];
} Incoming;

typedef struct Desk {
    Ranks* ranks;
    Work* work;
    // Rank 0
    int next, left, taken, todo; // the next unit; units not handed out; finished in this run; of this run
    int* given;                  // units that each rank has
    bool* gone;                  // ranks that ended
    // A result is being taken. Taking it calls the progress function, too, which must not take another one meanwhile.
    bool taking;
    Incoming* incoming;
    // Other ranks
    int queue[AHEAD], queued;
    MPI_Request sending[2];
    int64_t header[2];
    uint64_t* words; // that are sent; NULL: none
    bool told;       // rank 0 knows of our interrupt
    // All
    int code;      // exit code, when the work ends early
    bool stopping; // no more units are begun
    double stopAt; // ms: then the unit under way is cancelled
} Desk;

static void post(Desk* d, int to, int tag, const void* bytes, int size)
{
    MPI_Send(bytes, size, MPI_BYTE, to, tag, MPI_COMM_WORLD);
    d->ranks->stats.messages += 1;
    d->ranks->stats.bytes += size;
}

// ---- rank 0

static int nextUnit(Desk* d)
{
    while (d->next < d->work->count && d->work->done != NULL && d->work->done[d->next]) {
        d->next++;
    }
    d->left--;
    return d->next++;
}

static void feed(Desk* d, int rank)
{
    const int most = d->left > 2 * d->ranks->count ? AHEAD : 1;
    while (!d->stopping && d->left > 0 && d->given[rank] < most) {
        const int unit = nextUnit(d);
        d->given[rank]++;
        post(d, rank, TAG_WORK, &unit, sizeof unit);
    }
}

// Ends the work early: what is under way may take `seconds`.
static void stop(Desk* d, int code, double seconds)
{
    if (d->stopping) {
        return;
    }
    d->stopping = true;
    d->code = code;
    d->stopAt = wallMs() + 1000 * seconds;
    for (int i = 1; i < d->ranks->count; i++) {
        post(d, i, TAG_STOP, &seconds, sizeof seconds);
    }
}

static void take(Desk* d, int unit, const uint8_t* bytes, size_t size)
{
    d->taking = true;
    const int code = d->work->take(d->work->user, unit, bytes, size);
    d->taking = false;
    if (code != EXIT_DONE) {
        stop(d, code, 0);
        return;
    }
    d->taken++;
    if (d->work->progress != NULL && !d->stopping) {
        showProgress(d->work->progress, (double)d->taken / d->todo);
    }
}

// Takes results that have arrived.
static void finishIncoming(Desk* d)
{
    for (int i = 1; i < d->ranks->count; i++) {
        Incoming* in = &d->incoming[i];
        int arrived = 0;
        if (in->words != NULL) {
            MPI_Test(&in->request, &arrived, MPI_STATUS_IGNORE);
        }
        if (arrived) {
            uint64_t* words = in->words;
            in->words = NULL;
            d->given[i]--;
            feed(d, i);
            take(d, (int)in->header[0], (uint8_t*)words, (size_t)in->header[1]);
            free(words);
        }
    }
}

static void beginIncoming(Desk* d, int from)
{
    Incoming* in = &d->incoming[from];
    MPI_Recv(in->header, sizeof in->header, MPI_BYTE, from, TAG_RESULT, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    const size_t words = (size_t)in->header[1] / 8 + 1;
    in->words = malloc(8 * words);
    if (in->words == NULL) {
        complain("out of memory for a result of %lld bytes", (long long)in->header[1]);
        MPI_Abort(MPI_COMM_WORLD, EXIT_COULD_NOT);
    }
    MPI_Irecv(in->words, (int)words, MPI_UINT64_T, from, TAG_BYTES, MPI_COMM_WORLD, &in->request);
}

static void serve(Desk* d)
{
    finishIncoming(d);
    for (int i = 1; i < d->ranks->count; i++) {
        int there = 0;
        MPI_Status status;
        if (d->incoming[i].words == NULL && !d->gone[i]) {
            MPI_Iprobe(i, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
        }
        if (!there) {
            continue;
        }
        if (status.MPI_TAG == TAG_RESULT) {
            beginIncoming(d, i);
        } else if (status.MPI_TAG == TAG_FAIL) {
            int code;
            MPI_Recv(&code, 1, MPI_INT, i, TAG_FAIL, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
            stop(d, code, code == EXIT_COULD_NOT ? d->ranks->options.grace : 0);
        } else {
            MPI_Recv(&d->ranks->all[i], sizeof(RankStats), MPI_BYTE, i, TAG_BYE, MPI_COMM_WORLD,
                     MPI_STATUS_IGNORE);
            d->gone[i] = true;
        }
    }
    if (!askInterrupts(NULL, 0) && !d->stopping) {
        if (d->work->checkpoint != NULL) {
            complain("interrupted after %d of %d %s; they are kept in %s, go on with --resume %s", d->taken,
                     d->todo, d->work->name, d->work->checkpoint, d->work->checkpoint);
        } else {
            complain("interrupted after %d of %d %s; without --checkpoint they are lost", d->taken, d->todo,
                     d->work->name);
        }
        stop(d, EXIT_COULD_NOT, d->ranks->options.grace);
    }
}

// ---- other ranks

static void listen(Desk* d)
{
    int there = 0, sent = 0;
    MPI_Status status;
    if (d->words != NULL) {
        MPI_Status both[2];
        MPI_Testall(2, d->sending, &sent, both);
        if (sent) {
            free(d->words);
            d->words = NULL;
        }
    }
    MPI_Iprobe(0, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (there && status.MPI_TAG == TAG_WORK) {
        MPI_Recv(&d->queue[d->queued++], 1, MPI_INT, 0, TAG_WORK, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    } else if (there) {
        double seconds;
        MPI_Recv(&seconds, 1, MPI_DOUBLE, 0, TAG_STOP, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        d->stopping = true;
        d->stopAt = wallMs() + 1000 * seconds;
    }
    if (!askInterrupts(NULL, 0) && !d->told) {
        const int code = EXIT_COULD_NOT;
        post(d, 0, TAG_FAIL, &code, sizeof code);
        d->told = true;
    }
}

static void awaitSent(Desk* d)
{
    while (d->words != NULL) {
        listen(d);
        usleep(NAP);
    }
}

static void sendResult(Desk* d, int unit, uint8_t* bytes, size_t size)
{
    awaitSent(d);
    const size_t words = size / 8 + 1;
    d->words = realloc(bytes, 8 * words);
    if (d->words == NULL) {
        complain("out of memory");
        MPI_Abort(MPI_COMM_WORLD, EXIT_COULD_NOT);
    }
    d->header[0] = unit;
    d->header[1] = (int64_t)size;
    MPI_Isend(d->header, sizeof d->header, MPI_BYTE, 0, TAG_RESULT, MPI_COMM_WORLD, &d->sending[0]);
    MPI_Isend(d->words, (int)words, MPI_UINT64_T, 0, TAG_BYTES, MPI_COMM_WORLD, &d->sending[1]);
    d->ranks->stats.messages += 2;
    d->ranks->stats.bytes += (double)(sizeof d->header + 8 * words);
}

// ---- all

bool attendWork(void* user, double fraction)
{
    Desk* d = ((Work*)user)->desk;
    if (d == NULL) { // plans ask, too
        return askInterrupts(NULL, fraction);
    }
    if (d->taking) {
        return true;
    }
    if (d->ranks->rank == 0) {
        serve(d);
    } else {
        listen(d);
    }
    return !d->stopping || wallMs() < d->stopAt;
}

// Makes a unit, and takes or sends it.
static void makeUnit(Desk* d, int unit)
{
    uint8_t* bytes = NULL;
    size_t size = 0;
    const double start = wallMs();
    const vplResult result = d->work->make(d->work->user, unit, &bytes, &size);
    d->ranks->stats.busyMs += wallMs() - start;
    const int code = result == VPL_CANCELLED ? EXIT_DONE : exitCode(result, false);
    d->ranks->stats.units += result == VPL_SUCCESS;
    if (d->ranks->rank == 0) {
        if (result == VPL_SUCCESS) {
            take(d, unit, bytes, size);
        } else if (code != EXIT_DONE) {
            stop(d, code, 0);
        }
        free(bytes);
    } else if (result == VPL_SUCCESS) {
        sendResult(d, unit, bytes, size);
    } else if (code != EXIT_DONE) {
        post(d, 0, TAG_FAIL, &code, sizeof code);
        d->stopping = true;
    }
}

static void finishStats(Ranks* r)
{
    r->stats.cpuMs = cpuMs();
    r->stats.peakBytes = (double)vplContext_GetPeakBytes(r->context);
}

static void workAtOthers(Desk* d)
{
    while (!d->stopping) {
        listen(d);
        if (d->queued > 0 && !d->stopping) {
            const int unit = d->queue[0];
            d->queue[0] = d->queue[1];
            d->queued--;
            makeUnit(d, unit);
        } else {
            usleep(NAP);
        }
    }
    awaitSent(d);
    finishStats(d->ranks);
    d->ranks->stats.messages += 1; // the statistics count their own message
    d->ranks->stats.bytes += sizeof(RankStats);
    MPI_Send(&d->ranks->stats, sizeof(RankStats), MPI_BYTE, 0, TAG_BYE, MPI_COMM_WORLD);
}

static bool allGone(const Desk* d)
{
    bool all = true;
    for (int i = 1; i < d->ranks->count; i++) {
        all = all && d->gone[i];
    }
    return all;
}

static void workAtZero(Desk* d)
{
    for (int i = 1; i < d->ranks->count; i++) {
        feed(d, i);
    }
    while (d->taken < d->todo && !d->stopping) {
        serve(d);
        if (!d->stopping && d->left > 0 && (d->ranks->count == 1 || !d->ranks->options.rankZeroWaits)) {
            makeUnit(d, nextUnit(d));
        } else {
            usleep(NAP);
        }
    }
    stop(d, EXIT_DONE, 0);
    while (!allGone(d)) {
        serve(d);
        if (d->code != EXIT_DONE && wallMs() > d->stopAt + PATIENCE) {
            complain("a rank does not answer");
            MPI_Abort(MPI_COMM_WORLD, EXIT_COULD_NOT);
        }
        usleep(NAP);
    }
    for (int i = 1; i < d->ranks->count; i++) { // what ranks sent before they left
        while (d->incoming[i].words != NULL) {
            finishIncoming(d);
        }
    }
    finishStats(d->ranks);
    d->ranks->all[0] = d->ranks->stats;
}

int runWork(Ranks* r, Work* work)
{
    const size_t count = (size_t)r->count;
    Desk d = {.ranks = r,
              .work = work,
              .given = calloc(count, sizeof *d.given),
              .gone = calloc(count, sizeof *d.gone),
              .incoming = calloc(count, sizeof *d.incoming)};
    r->all = r->all != NULL ? r->all : calloc(count, sizeof *r->all);
    for (int i = 0; i < work->count; i++) {
        d.todo += work->done == NULL || !work->done[i];
    }
    d.left = d.todo;
    work->desk = &d;
    setSpeaker(r->speaker); // from here on ranks fail for reasons of their own
    const bool good = d.given != NULL && d.gone != NULL && d.incoming != NULL && r->all != NULL;
    if (largestNumber(r, !good) != 0) {
        complain("out of memory");
        d.code = EXIT_COULD_NOT;
    } else if (r->rank == 0) {
        workAtZero(&d);
    } else {
        workAtOthers(&d);
    }
    work->desk = NULL;
    free(d.given);
    free(d.gone);
    free(d.incoming);
    return shareNumber(r, d.code);
}
