// SPDX-License-Identifier: MIT
// All ranks as the team of a context (vplContext_SetTeam): they share the rows of form factors, and what is computed with them.
#include "mpi/ranks.h"

#include "cli/bench/measure.h"

#include <mpi.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { TURNS = 200, NAP = 100 }; // tests of MPI before it sleeps; microseconds

// Waits without keeping a core busy: ranks may share one, and blocking calls of MPI spin.
static void await(int count, MPI_Request* requests)
{
    for (int next = 0, turn = 0; next < count; turn++) {
        int done = 0;
        MPI_Test(&requests[next], &done, MPI_STATUS_IGNORE);
        if (done) {
            next++;
        } else if (turn < TURNS) {
            sched_yield();
        } else {
            usleep(NAP);
        }
    }
}

// Messages of a team are smaller than 2^31 bytes: a round of form factors between two ranks has at most 512 per side.
static void exchange(void* user, const void* send, const size_t* sendBytes, void* receive,
                     const size_t* receiveBytes)
{
    Ranks* r = user;
    const char* from = send;
    char* to = receive;
    int count = 0;
    const double start = wallMs();
    for (int m = 0; m < r->count; m++) {
        if (m == r->rank) {
            memcpy(to, from, sendBytes[m]);
        }
        from += sendBytes[m];
        to += receiveBytes[m];
    }
    from = send;
    to = receive;
    for (int m = 0; m < r->count; m++) {
        if (m != r->rank && sendBytes[m] > 0) {
            MPI_Isend(from, (int)sendBytes[m], MPI_BYTE, m, TAG_TEAM, MPI_COMM_WORLD, &r->requests[count++]);
            r->stats.messages += 1;
            r->stats.bytes += (double)sendBytes[m];
        }
        if (m != r->rank && receiveBytes[m] > 0) {
            MPI_Irecv(to, (int)receiveBytes[m], MPI_BYTE, m, TAG_TEAM, MPI_COMM_WORLD, &r->requests[count++]);
        }
        from += sendBytes[m];
        to += receiveBytes[m];
    }
    await(count, r->requests);
    r->stats.waitMs += wallMs() - start;
}

int formTeam(Ranks* r)
{
    const vplTeam team = {r->rank, r->count, exchange, r};
    const vplRenderOptions* o = &r->arguments->render;
    // Without a team each rank has all rows: shooting needs them, and so does a picture of residuals.
    if (r->count == 1 || o->method != VPL_METHOD_RADIOSITY || o->radiosity.solver == VPL_SOLVER_SHOOTING ||
        o->output.show == VPL_SHOW_RESIDUAL) {
        return EXIT_DONE;
    }
    r->requests = realloc(r->requests, 2 * (size_t)r->count * sizeof *r->requests);
    int code = EXIT_COULD_NOT;
    if (r->requests == NULL) {
        complain("out of memory");
    } else {
        code = exitCode(vplContext_SetTeam(r->context, &team), false);
    }
    return largestNumber(r, code);
}

void dissolveTeam(Ranks* r)
{
    vplContext_SetTeam(r->context, NULL);
    free(r->requests);
    r->requests = NULL;
}
