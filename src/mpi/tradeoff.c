// SPDX-License-Identifier: MIT
// vpl tradeoff by many ranks: each measures every N-th setting against the reference of rank 0, which writes the report. Times
// are those of the machine that measured, so machines should be alike.
#include "cli/tradeoff/tradeoff.h"
#include "mpi/ranks.h"

#include <mpi.h>
#include <stdlib.h>
#include <string.h>

static int agree(void* user, int code)
{
    return largestNumber(user, code);
}

// ---- the reference

// Gives all ranks an image of rank 0.
static bool shareImage(Ranks* r, vplContext* context, int width, int height, vplImage** image)
{
    uint8_t* bytes = r->rank == 0 ? (uint8_t*)(*image)->pixels : NULL;
    size_t size = r->rank == 0 ? 3 * (size_t)width * (size_t)height * sizeof(float) : 0;
    bool good = shareBytes(r, &bytes, &size);
    if (r->rank > 0 && good) {
        good = vplImage_Create(context, width, height, image) == VPL_SUCCESS;
        if (good) {
            memcpy((*image)->pixels, bytes, size);
        }
        free(bytes);
    }
    return largestNumber(r, !good) == 0;
}

static int shareReference(void* user, Tradeoff* t)
{
    Ranks* r = user;
    Reference* reference = &t->reference;
    const bool zero = r->rank == 0;
    vplImage* own[] = {reference->image, reference->halves[0], reference->halves[1]};
    uint8_t* bytes = (uint8_t*)reference;
    size_t size = sizeof *reference;
    const int width = shareNumber(r, zero ? own[0]->width : 0),
              height = shareNumber(r, zero ? own[0]->height : 0);
    bool good = shareBytes(r, &bytes, &size);
    if (!zero && good) {
        memcpy(reference, bytes, sizeof *reference);
        free(bytes);
    }
    reference->image = own[0];
    reference->halves[0] = own[1];
    reference->halves[1] = own[2];
    good = good && shareImage(r, t->context, width, height, &reference->image) &&
           shareImage(r, t->context, width, height, &reference->halves[0]) &&
           shareImage(r, t->context, width, height, &reference->halves[1]);
    return good ? EXIT_DONE : EXIT_COULD_NOT;
}

// ---- what was measured

enum { NAME = 32 };

// A setting of one rank; its runs follow.
typedef struct Record {
    int setting, runCount;
    LeftOut leftOut;
    double cancelledMs;
    char problem[SENTENCE];
} Record;

// Names of stages are at other addresses at other ranks.
typedef struct RunRecord {
    Run run;
    char names[VPL_MAX_STAGES][NAME];
} RunRecord;

static size_t writeRuns(const Tradeoff* t, const Ranks* r, uint8_t* to)
{
    uint8_t* const start = to;
    for (int i = r->rank; i < t->settingCount; i += r->count) {
        const Setting* s = &t->settings[i];
        Record record = {i, s->runCount, s->leftOut, s->cancelledMs, ""};
        memcpy(record.problem, s->problem, sizeof record.problem);
        memcpy(to, &record, sizeof record);
        to += sizeof record;
        for (int k = 0; k < s->runCount; k++) {
            RunRecord run = {.run = s->runs[k]};
            for (int n = 0; n < run.run.stats.stageCount; n++) {
                snprintf(run.names[n], NAME, "%s", run.run.stats.stages[n].name);
            }
            memcpy(to, &run, sizeof run);
            to += sizeof run;
        }
    }
    return (size_t)(to - start);
}

// A name that stays.
static const char* keepName(const char* name)
{
    static char names[MAX_STAGE_NAMES][NAME];
    int i = 0;
    while (i < MAX_STAGE_NAMES - 1 && names[i][0] != 0 && strcmp(names[i], name) != 0) {
        i++;
    }
    memcpy(names[i], name, NAME);
    return names[i];
}

static void readRuns(Tradeoff* t, const uint8_t* from, size_t size)
{
    for (const uint8_t* end = from + size; from < end;) {
        Record record;
        memcpy(&record, from, sizeof record);
        from += sizeof record;
        Setting* s = &t->settings[record.setting];
        s->runCount = record.runCount;
        s->leftOut = record.leftOut;
        s->cancelledMs = record.cancelledMs;
        memcpy(s->problem, record.problem, sizeof s->problem);
        for (int k = 0; k < record.runCount; k++) {
            RunRecord run;
            memcpy(&run, from, sizeof run);
            from += sizeof run;
            s->runs[k] = run.run;
            for (int n = 0; n < run.run.stats.stageCount; n++) {
                s->runs[k].stats.stages[n].name = keepName(run.names[n]);
            }
        }
    }
}

static int collectRuns(void* user, Tradeoff* t)
{
    Ranks* r = user;
    const size_t seeds = (size_t)t->arguments->seeds, settings = (size_t)(t->settingCount / r->count) + 1;
    const size_t most = settings * (sizeof(Record) + seeds * sizeof(RunRecord));
    uint8_t* bytes = malloc(most);
    if (largestNumber(r, bytes == NULL) != 0 || bytes == NULL) {
        complain("out of memory");
        free(bytes);
        return EXIT_COULD_NOT;
    }
    if (r->rank > 0) {
        MPI_Send(bytes, (int)writeRuns(t, r, bytes), MPI_BYTE, 0, TAG_RESULT, MPI_COMM_WORLD);
    }
    for (int i = 1; i < r->count && r->rank == 0; i++) {
        MPI_Status status;
        int size;
        MPI_Recv(bytes, (int)most, MPI_BYTE, i, TAG_RESULT, MPI_COMM_WORLD, &status);
        MPI_Get_count(&status, MPI_BYTE, &size);
        readRuns(t, bytes, (size_t)size);
    }
    free(bytes);
    t->interrupted = largestNumber(r, t->interrupted) != 0;
    return EXIT_DONE;
}

int measureTradeoff(Ranks* r)
{
    const Crew crew = {r->rank, r->count, agree, shareReference, collectRuns, r};
    return shareNumber(r, runTradeoffWith(r->arguments, &crew));
}
