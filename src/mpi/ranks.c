// SPDX-License-Identifier: MIT
// Messages to all ranks. Sizes are sent first; bytes travel as words of 8, so that counts fit into int up to 16 GiB.
#include "mpi/ranks.h"

#include "cli/bench/measure.h"

#include <stdlib.h>
#include <string.h>

// A broadcast is counted as the messages that its sender would need to reach all others one by one.
static void countBroadcast(Ranks* r, size_t bytes)
{
    if (r->rank == 0) {
        r->stats.messages += r->count - 1;
        r->stats.bytes += (double)bytes * (r->count - 1);
    }
}

int shareNumber(Ranks* r, int number)
{
    MPI_Bcast(&number, 1, MPI_INT, 0, MPI_COMM_WORLD);
    countBroadcast(r, sizeof number);
    return number;
}

int largestNumber(Ranks* r, int number)
{
    int largest;
    MPI_Allreduce(&number, &largest, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    r->stats.messages += 1;
    r->stats.bytes += sizeof number;
    return largest;
}

int collectStats(Ranks* r)
{
    r->stats.cpuMs = cpuMs();
    r->stats.peakBytes = (double)vplContext_GetPeakBytes(r->context);
    r->all = r->all != NULL ? r->all : calloc((size_t)r->count, sizeof *r->all);
    if (largestNumber(r, r->all == NULL) != 0) {
        complain("out of memory");
        return EXIT_COULD_NOT;
    }
    MPI_Gather(&r->stats, sizeof r->stats, MPI_BYTE, r->all, sizeof r->stats, MPI_BYTE, 0, MPI_COMM_WORLD);
    return EXIT_DONE;
}

bool shareBytes(Ranks* r, uint8_t** bytes, size_t* size)
{
    uint64_t length = *size;
    MPI_Bcast(&length, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    const size_t words = (size_t)(length / 8 + 1);
    uint8_t* room = calloc(words, 8);
    if (largestNumber(r, room == NULL) != 0 || room == NULL) {
        complain("out of memory for %llu bytes of the scene", (unsigned long long)length);
        free(room);
        return false;
    }
    if (r->rank == 0 && length > 0) {
        memcpy(room, *bytes, (size_t)length);
    }
    MPI_Bcast(room, (int)words, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    countBroadcast(r, 8 * words + sizeof length);
    if (r->rank == 0) {
        free(room);
    } else {
        *bytes = room;
        *size = (size_t)length;
    }
    return true;
}
