// SPDX-License-Identifier: MIT
// vpl bake by many ranks: they share form factors and sweeps, and each then knows the light of all patches. Rank 0 writes them.
#include "mpi/ranks.h"

#include "cli/bench/measure.h"

int bakePatches(Ranks* r, vplScene* scene)
{
    const double start = wallMs();
    Arguments own = *r->arguments;
    own.stats = NULL; // --stats is about ranks
    if (r->rank > 0) {
        own.output = "/dev/null";
    }
    int code = formTeam(r);
    if (code == EXIT_DONE) {
        code = bakeScene(&own, scene);
        r->stats.units = 1;
        r->stats.busyMs = wallMs() - start - r->stats.waitMs;
        dissolveTeam(r);
    }
    code = largestNumber(r, code);
    code = code == EXIT_DONE ? collectStats(r) : code;
    return shareNumber(r, code == EXIT_DONE && r->rank == 0 ? reportRanks(r, wallMs() - start, 0) : code);
}
