// SPDX-License-Identifier: MIT
// Times every stage on the benchmark room. Each figure is a median of runs that alternate between the thread
// counts; speed-ups compare medians of one call. Hashes show that all thread counts gave the same bits.
#include "cli/bench.h"
#include "cli/tradeoff_math.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

// A stage is not run again after this time in all its runs, but three times at least. A first run shorter than
// WARM_UP warms up and does not count.
#define SECONDS_PER_STAGE 4.0
#define WARM_UP           0.5
enum { LEAST_RUNS = 3 };

bool isAskedFor(const Arguments* a, const char* name)
{
    return a->stage == NULL || strstr(name, a->stage) != NULL;
}

double processorSeconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// libgomp's threads spin for some milliseconds after a parallel section.
void settle(void)
{
    nanosleep(&(struct timespec){0, 10000000}, NULL);
}

static vplResult runOnce(const Stage* stage, Bench* b, double* seconds, double* processor, Outcome* outcome)
{
    memset(outcome, 0, sizeof *outcome);
    settle();
    *processor = processorSeconds();
    *seconds = secondsNow();
    vplResult result = stage->run(b, stage, outcome);
    *seconds = secondsNow() - *seconds;
    *processor = processorSeconds() - *processor;
    if (result == VPL_SUCCESS && outcome->image != NULL) {
        outcome->hash = vplImage_Hash(outcome->image);
    }
    return result;
}

// One stage under all thread counts, in turn, so that a machine that slows down slows all of them.
static vplResult measureStage(const Arguments* a, Bench* benches, int columns, Row* row)
{
    static double wall[MAX_THREAD_COUNTS][MAX_RUNS], processor[MAX_THREAD_COUNTS][MAX_RUNS];
    double spent = 0;
    int runs = 0;
    for (bool first = true; runs < a->runs && (spent < SECONDS_PER_STAGE || runs < LEAST_RUNS);
         first = false) {
        double longest = 0;
        for (int c = 0; c < columns; c++) {
            double seconds, used;
            vplResult result = runOnce(row->stage, &benches[c], &seconds, &used, &row->figure[c].outcome);
            if (result != VPL_SUCCESS) {
                return result;
            }
            wall[c][runs] = 1e3 * seconds;
            processor[c][runs] = 1e3 * used;
            spent += seconds;
            longest = seconds > longest ? seconds : longest;
        }
        runs += !first || longest > WARM_UP;
    }
    for (int c = 0; c < columns; c++) {
        row->figure[c].ms = medianOf(wall[c], runs);
        row->figure[c].cpuMs = medianOf(processor[c], runs);
        row->figure[c].runs = runs;
    }
    return VPL_SUCCESS;
}

static vplResult measureAll(const Arguments* a, int width, int height, int* threads, int columns, Row* rows,
                            int rowCount)
{
    static Bench benches[MAX_THREAD_COUNTS];
    vplResult result = VPL_SUCCESS;
    int opened = 0;
    for (; opened < columns && result == VPL_SUCCESS; opened++) {
        result = openBench(a, threads[opened], width, height, &benches[opened]);
        if (result == VPL_SUCCESS) {
            threads[opened] = vplContext_GetWorkerCount(benches[opened].context);
        }
    }
    for (int i = 0; i < rowCount && result == VPL_SUCCESS; i++) {
        result = measureStage(a, benches, columns, &rows[i]);
    }
    for (int c = 0; c < opened; c++) {
        closeBench(&benches[c]);
    }
    return result;
}

static int chooseStages(const Arguments* a, Row* rows)
{
    int count = 0;
    for (int i = 0; i < STAGE_COUNT; i++) {
        const Stage* s = &STAGES[i];
        bool slow = (s->flags & STAGE_SLOW) != 0;
        if (isAskedFor(a, s->name) && (!slow || a->all || a->stage != NULL)) {
            rows[count++].stage = s;
        }
    }
    return count;
}

static int runStages(const Arguments* a, Row* rows)
{
    int threads[MAX_THREAD_COUNTS] = {1, 2}, columns = 2;
    if (a->threadsCount > 0) {
        columns = a->threadsCount;
        memcpy(threads, a->threads, sizeof threads);
    }
    const int width = isGiven(a, "size") ? a->render.output.width : 1920,
              height = isGiven(a, "size") ? a->render.output.height : 1080;
    const int count = chooseStages(a, rows);
    if (count == 0) {
        complain("no stage of bench has \"%s\" in its name", a->stage);
        return EXIT_USAGE;
    }
    double load = 0;
    load = getloadavg(&load, 1) == 1 ? load : 0;
    int code = exitCode(measureAll(a, width, height, threads, columns, rows, count), true);
    if (code == EXIT_DONE && a->json) {
        printStagesJson(rows, count, threads, columns);
    } else if (code == EXIT_DONE) {
        printStages(a, width, height, load, rows, count, threads, columns);
    }
    return code;
}

int runBench(const Arguments* a)
{
    if (a->scaling) {
        return runScaling(a);
    }
    Row* rows = calloc((size_t)STAGE_COUNT, sizeof *rows);
    if (rows == NULL) {
        complain("out of memory");
        return EXIT_COULD_NOT;
    }
    int code = runStages(a, rows);
    free(rows);
    return code;
}
