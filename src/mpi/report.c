// SPDX-License-Identifier: MIT
// What the ranks did: a table for -v, JSON for --stats, and the imbalance where it costs something.
#include "mpi/ranks.h"

#include <math.h>

// The time of the busiest rank over the mean of those that worked: what an even division would gain.
static double imbalanceOf(const Ranks* r)
{
    double sum = 0, most = 0;
    int workers = 0;
    for (int i = 0; i < r->count; i++) {
        const bool works = i > 0 || !r->options.rankZeroWaits;
        sum += r->all[i].busyMs;
        workers += works;
        most = fmax(most, r->all[i].busyMs);
    }
    return sum > 0 ? most * workers / sum : 1;
}

static json_t* countJson(double count)
{
    return json_integer((json_int_t)count);
}

static json_t* rankJson(const RankStats* s)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "units", countJson(s->units), "busy_ms",
                     numberJson(s->busyMs), "cpu_ms", numberJson(s->cpuMs), "wait_ms", numberJson(s->waitMs),
                     "messages", countJson(s->messages), "bytes", countJson(s->bytes), "peak_bytes",
                     countJson(s->peakBytes), "planned_bytes", countJson(s->plannedBytes));
}

int reportRanks(const Ranks* r, double totalMs, uint64_t hash)
{
    double messages = 0, bytes = 0;
    const double imbalance = imbalanceOf(r);
    json_t* list = json_array();
    char text[20];
    for (int i = 0; i < r->count; i++) {
        const RankStats* s = &r->all[i];
        messages += s->messages;
        bytes += s->bytes;
        json_array_append_new(list, rankJson(s));
        if (r->arguments->verbose) {
            complain(
                "rank %d: %.0f units in %.0f ms, %.0f ms of processors, %.0f messages and %.0f bytes sent", i,
                s->units, s->busyMs, s->cpuMs, s->messages, s->bytes);
        }
    }
    if (r->count > 1 && (r->arguments->verbose || (imbalance > 1.25 && !r->arguments->quiet))) {
        complain("the busiest rank worked %.0f %% longer than the mean of all", 100 * (imbalance - 1));
    }
    snprintf(text, sizeof text, "%016llx", (unsigned long long)hash);
    json_t* root =
        json_pack("{s:i, s:o, s:o, s:o, s:o, s:s, s:o}", "ranks", r->count, "total_ms", numberJson(totalMs),
                  "imbalance", numberJson(imbalance), "messages", countJson(messages), "bytes",
                  countJson(bytes), "image_hash", text, "each", list);
    if (r->arguments->stats == NULL) {
        json_decref(root);
        return EXIT_DONE;
    }
    return writeJson(root, 12, r->arguments->stats);
}
