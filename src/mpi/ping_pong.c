// SPDX-License-Identifier: MIT
// Measures what a message costs: seconds = alpha + beta bytes, by messages of many sizes that ranks 0 and 1 send back and
// forth. Based on: Roger Hockney, The Communication Challenge for MPP, Parallel Computing 1994.
#include "mpi/ranks.h"

#include "cli/bench/measure.h"

#include <math.h>
#include <mpi.h>
#include <stdlib.h>

enum { LARGEST = 1 << 24, TURNS = 200 };

static double turnMs(const Ranks* r, char* buffer, int size, int turns)
{
    const double start = wallMs();
    for (int i = 0; i < turns; i++) {
        if (r->rank == 0) {
            MPI_Send(buffer, size, MPI_BYTE, 1, 0, MPI_COMM_WORLD);
            MPI_Recv(buffer, size, MPI_BYTE, 1, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        } else if (r->rank == 1) {
            MPI_Recv(buffer, size, MPI_BYTE, 0, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
            MPI_Send(buffer, size, MPI_BYTE, 0, 0, MPI_COMM_WORLD);
        }
    }
    return (wallMs() - start) / (2.0 * turns);
}

int measureMessages(Ranks* r)
{
    char* buffer = calloc(LARGEST, 1);
    double alpha = 0, last = 0;
    if (r->count < 2 || buffer == NULL) {
        complain(buffer == NULL ? "out of memory" : "--ping-pong needs two ranks");
        free(buffer);
        return buffer == NULL ? EXIT_COULD_NOT : EXIT_USAGE;
    }
    for (int size = 1; size <= LARGEST; size *= 8) {
        const int turns = size < 1 << 18 ? TURNS : TURNS / 20;
        turnMs(r, buffer, size, turns / 10 + 1);
        last = INFINITY;
        for (int run = 0; run < 5; run++) {
            last = fmin(last, turnMs(r, buffer, size, turns));
        }
        alpha = size == 1 ? last : alpha;
        if (r->rank == 0) {
            printf("%9d bytes %10.4f ms\n", size, last);
        }
    }
    if (r->rank == 0) {
        printf("alpha %.2f us, 1/beta %.2f GB/s\n", 1e3 * alpha, LARGEST / (1e6 * (last - alpha)));
    }
    free(buffer);
    return EXIT_DONE;
}
