// SPDX-License-Identifier: MIT
// vpl bench: every stage on the benchmark room. Speed-ups compare medians of one call; hashes show that all
// thread counts gave the same bits.
#include "cli/bench/bench.h"
#include "cli/calibration.h"

#include <stdlib.h>
#include <string.h>

// A stage is not run again after this time in all its runs. A first run shorter than WARM_UP does not count.
// Seconds.
#define SECONDS_PER_STAGE 4.0
#define WARM_UP           0.5

bool isAskedFor(const Arguments* a, const char* name)
{
    return a->stage == NULL || strstr(name, a->stage) != NULL;
}

typedef struct Work {
    Bench* benches;
    Row* row;
} Work;

static vplResult runStage(void* user, int column)
{
    const Work* w = user;
    Outcome* outcome = &w->row->outcomes[column];
    memset(outcome, 0, sizeof *outcome);
    return w->row->stage->run(&w->benches[column], w->row->stage, outcome);
}

static vplResult measureRow(const Arguments* a, Bench* benches, int columns, Row* row)
{
    Work work = {benches, row};
    const Measurement measurement = {runStage, &work, columns, a->runs, SECONDS_PER_STAGE, WARM_UP};
    TRY(measureInTurn(&measurement, row->times, &row->runs));
    for (int c = 0; c < columns; c++) {
        Outcome* outcome = &row->outcomes[c];
        outcome->hash = outcome->image != NULL ? vplImage_Hash(outcome->image) : outcome->hash;
    }
    return VPL_SUCCESS;
}

static vplResult measureAll(const Arguments* a, Table* t)
{
    static Bench benches[MAX_THREAD_COUNTS];
    vplResult result = VPL_SUCCESS;
    int opened = 0;
    for (; opened < t->columns && result == VPL_SUCCESS; opened++) {
        result = openBench(a, t->threads[opened], t->width, t->height, &benches[opened]);
        if (result == VPL_SUCCESS) {
            t->threads[opened] = vplContext_GetWorkerCount(benches[opened].context);
        }
    }
    for (int i = 0; i < t->rowCount && result == VPL_SUCCESS; i++) {
        result = measureRow(a, benches, t->columns, &t->rows[i]);
    }
    for (int c = 0; c < opened; c++) {
        closeBench(&benches[c]);
    }
    return result;
}

static int runStages(const Arguments* a, Table* t)
{
    for (int i = 0; i < STAGE_COUNT; i++) {
        const bool slow = (STAGES[i].flags & SLOW) != 0;
        if (isAskedFor(a, STAGES[i].name) && (!slow || a->all || a->stage != NULL)) {
            t->rows[t->rowCount++].stage = &STAGES[i];
        }
    }
    if (t->rowCount == 0) {
        complain("no stage of bench has \"%s\" in its name", a->stage);
        return EXIT_USAGE;
    }
    t->load = getloadavg(&t->load, 1) == 1 ? t->load : 0;
    const int code = exitCode(measureAll(a, t), true);
    if (code == EXIT_DONE && a->json) {
        return printTableJson(t);
    }
    if (code == EXIT_DONE) {
        printTable(a, t);
    }
    return code;
}

int runBench(const Arguments* a)
{
    if (a->calibrate) {
        return runCalibration(a);
    }
    if (a->scaling) {
        return runScaling(a);
    }
    if (a->extremes) {
        return runExtremes(a);
    }
    const bool sized = isGiven(a, "size");
    Table table = {.width = sized ? a->render.output.width : 1920,
                   .height = sized ? a->render.output.height : 1080,
                   .threads = {1, 2},
                   .columns = 2,
                   .rows = calloc((size_t)STAGE_COUNT, sizeof *table.rows)};
    if (a->threadsCount > 0) {
        table.columns = a->threadsCount;
        memcpy(table.threads, a->threads, sizeof table.threads);
    }
    if (table.rows == NULL) {
        complain("out of memory");
        return EXIT_COULD_NOT;
    }
    const int code = runStages(a, &table);
    free(table.rows);
    return code;
}
