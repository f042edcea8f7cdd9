// SPDX-License-Identifier: MIT
// vpl bench --extremes: runs the sweeps and prints the stability table. An error above what is promised ends in
// an exclamation mark; a refusal, or what is left out, is a letter, and its sentence stands below the sweep.
#include "cli/bench/bench.h"
#include "cli/bench/extremes.h"

#include <math.h>
#include <stdlib.h>

enum { MOST_SENTENCES = 26, SENTENCE = 400 };

// The state of the table.
typedef struct Report {
    char said[SENTENCE];                      // by the library, in the last trial
    char sentences[MOST_SENTENCES][SENTENCE]; // of one sweep
    int sentenceCount;
    int broken; // promises
    json_t* json;
} Report;

static void hear(void* user, vplLogLevel level, const char* message)
{
    if (level == VPL_LOG_ERROR) { // without the name of a temporary file
        const char* colon =
            strncmp(message, EXTREME_FILE, strlen(EXTREME_FILE)) == 0 ? strchr(message, ':') : NULL;
        snprintf(((Report*)user)->said, SENTENCE, "%s", colon != NULL ? colon + 1 : message);
    }
}

// Returns the letter that stands for the refusal of the last trial.
static char letterOf(Report* r)
{
    for (int i = 0; i < r->sentenceCount; i++) {
        if (strcmp(r->sentences[i], r->said) == 0) {
            return (char)('a' + i);
        }
    }
    if (r->sentenceCount == MOST_SENTENCES) {
        return '?';
    }
    memcpy(r->sentences[r->sentenceCount], r->said, SENTENCE);
    return (char)('a' + r->sentenceCount++);
}

static double boundOf(const ExtremeSweep* s, int method)
{
    return s->bounds[method] > 0 ? s->bounds[method] : s->bounds[0];
}

static void addCell(const Arguments* a, Report* r, const Trial* t, vplResult result)
{
    const ExtremeSweep* s = t->sweep;
    const bool promised = t->value >= s->low && t->value <= s->high, left = t->leftOut != NULL;
    const bool done = result == VPL_SUCCESS && !left;
    const bool broken = promised && !left && !(done && t->error <= boundOf(s, t->method)); // NaN is broken
    if (left) {
        snprintf(r->said, SENTENCE, "%s", t->leftOut);
    }
    r->broken += broken;
    if (a->json) {
        json_array_append_new(r->json,
                              json_pack("{s:s, s:f, s:s, s:o, s:s, s:s, s:b, s:f}", "sweep", s->name, "value",
                                        t->value, "method", EXTREME_METHODS[t->method].name, "error",
                                        numberJson(done ? t->error : (double)NAN), "refused",
                                        done || left ? "" : r->said, "left_out", left ? r->said : "",
                                        "promised", promised, "bound", boundOf(s, t->method)));
    } else if (done) {
        printf(" %11.1e%c", t->error, broken ? '!' : ' ');
    } else {
        printf(" %11c%c", letterOf(r), broken ? '!' : ' ');
    }
}

static void printHead(const ExtremeSweep* s)
{
    printf("\n%s; against %s; promised: %g to %g\n%14s", s->name, s->truth, s->low, s->high, "");
    for (int m = 0; m < METHODS; m++) {
        printf(" %11s ", s->methods >> m & 1 ? EXTREME_METHODS[m].name : "");
    }
    printf("\n");
}

static void printFoot(const Report* r, const ExtremeSweep* s)
{
    printf("%14s", "at most");
    for (int m = 0; m < METHODS; m++) {
        if (s->methods >> m & 1) {
            printf(" %11.1e ", boundOf(s, m));
        } else {
            printf("%13s", "");
        }
    }
    printf("\n");
    for (int i = 0; i < r->sentenceCount; i++) {
        printf("  %c: %s\n", 'a' + i, r->sentences[i]);
    }
    if (s->others != NULL) {
        printf("  blank: %s\n", s->others);
    }
    fflush(stdout);
}

static void runSweep(const Arguments* a, const Trial* first, const ExtremeSweep* sweep, Report* r)
{
    vplImage* home[METHODS] = {NULL};
    r->sentenceCount = 0;
    for (int v = 0; v < sweep->valueCount; v++) {
        if (!a->json) {
            printf("%14.8g", sweep->values[v]);
        }
        for (int m = 0; m < METHODS; m++) {
            Trial trial = *first;
            trial.sweep = sweep;
            trial.value = sweep->values[v];
            trial.method = m;
            trial.home = home;
            r->said[0] = 0;
            if (sweep->methods >> m & 1) {
                addCell(a, r, &trial, sweep->measure(&trial));
            } else if (!a->json) {
                printf("%13s", "");
            }
        }
        if (!a->json) {
            printf("\n");
            fflush(stdout);
        }
    }
    for (int m = 0; m < METHODS; m++) {
        vplImage_Destroy(home[m]);
    }
}

// Prints what stands above the table: how it is read, and the options of each method.
static void printMethods(void)
{
    printf(
        "vpl bench --extremes: errors of pictures, root mean square over that of the truth. A letter is a "
        "refusal or what is left out; its sentence\n"
        "stands below its sweep. An error above the last line of its sweep, which is what is promised, has "
        "a mark. A floor alone has no indirect\n"
        "light: all methods show its direct light.\n\n");
    for (int m = 0; m < METHODS; m++) {
        printf("%14s  %s\n", EXTREME_METHODS[m].name, EXTREME_METHODS[m].words);
    }
}

static int runSweeps(const Arguments* a, const Trial* first, Report* r)
{
    int ran = 0;
    if (!a->json && a->stage == NULL) {
        printMethods();
    }
    for (int i = 0; i < EXTREME_SWEEP_COUNT; i++) {
        const ExtremeSweep* sweep = &EXTREME_SWEEPS[i];
        if (!isAskedFor(a, sweep->name)) {
            continue;
        }
        if (!a->json) {
            printHead(sweep);
        }
        runSweep(a, first, sweep, r);
        if (!a->json) {
            printFoot(r, sweep);
        }
        ran++;
    }
    if (ran == 0) {
        complain("no sweep of bench --extremes has \"%s\" in its name", a->stage);
        return EXIT_USAGE;
    }
    if (r->broken > 0) {
        complain("%d errors are larger than promised", r->broken);
        return EXIT_COULD_NOT;
    }
    return EXIT_DONE;
}

int runExtremes(const Arguments* a)
{
    static Report report;
    Trial first = {.contextDef = a->context};
    first.contextDef.log = hear;
    first.contextDef.logUser = &report;
    if (vplContext_Create(&first.contextDef, &first.context) != VPL_SUCCESS) {
        complain("%s", report.said);
        return EXIT_COULD_NOT;
    }
    report.json = json_array();
    const int code = runSweeps(a, &first, &report);
    vplContext_Destroy(first.context);
    if (a->json && code != EXIT_USAGE) {
        const int written = writeJson(report.json, 6, NULL);
        return code != EXIT_DONE ? code : written;
    }
    json_decref(report.json);
    return code;
}
