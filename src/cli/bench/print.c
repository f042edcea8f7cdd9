// SPDX-License-Identifier: MIT
#include "cli/bench/bench.h"

#include <jansson.h>
#include <stdio.h>

// Less than this on two threads, and as much less of what more could give, is marked.
#define LEAST_EFFICIENCY 0.85

// "2.07M", "41k", "7"; "-" for nothing.
static const char* shorten(double count, char text[16])
{
    static const char units[] = " kMGT";
    int unit = 0;
    for (; count >= 9999.5 && unit < 4; unit++) {
        count /= 1000;
    }
    if (count <= 0) {
        snprintf(text, 16, "-");
    } else {
        snprintf(text, 16, "%.*f%.*s",
                 unit == 0 || count >= 99.95 ? 0
                 : count >= 9.995            ? 1
                                             : 2,
                 count, unit > 0, units + unit);
    }
    return text;
}

// "2.35 Gpixel-lights/s".
static void printRate(const Figure* f)
{
    if (f->outcome.unit == NULL || !(f->ms > 0)) {
        return;
    }
    double rate = f->outcome.work / f->ms * 1e3;
    const char* unit = rate >= 1e9 ? "G" : rate >= 1e6 ? "M" : "k";
    printf("  %7.2f %s%s/s", rate / (rate >= 1e9 ? 1e9 : rate >= 1e6 ? 1e6 : 1e3), unit, f->outcome.unit);
}

static double speedUp(const Row* row, int column)
{
    return row->figure[0].ms / row->figure[column].ms;
}

static double efficiency(const Row* row, const int* threads, int column)
{
    return speedUp(row, column) * threads[0] / threads[column];
}

static void printRow(const Row* row, const int* threads, int columns)
{
    char text[4][16];
    const Figure* figure = row->figure;
    bool same = true;
    printf("%-35s %4d", row->stage->name, figure[0].runs);
    for (int c = 0; c < columns; c++) {
        printf(" %9.2f %9.2f", figure[c].ms, figure[c].cpuMs);
        if (c > 0 && (row->stage->flags & STAGE_SERIAL) != 0) {
            printf("      -     - ");
        } else if (c > 0) {
            double e = efficiency(row, threads, c);
            printf("  %4.2fx %3.0f %%%s", speedUp(row, c), 100 * e, e < LEAST_EFFICIENCY ? "*" : " ");
        }
        same = same && figure[c].outcome.hash == figure[0].outcome.hash;
    }
    const Outcome* o = &figure[0].outcome;
    printf(" %6s %6s %6s %6s  %016llx", shorten((double)o->drawCalls, text[0]),
           shorten((double)o->fragments, text[1]), shorten((double)o->triangles, text[2]),
           shorten((double)o->rays, text[3]), (unsigned long long)o->hash);
    printRate(&figure[columns - 1]);
    printf("%s\n", same ? "" : "  DIFFERS BETWEEN THREAD COUNTS");
}

void printStages(const Arguments* a, int width, int height, double load, const Row* rows, int rowCount,
                 const int* threads, int columns)
{
    printf("room at %dx%d (1/16: at a quarter of width and height); medians of up to %d runs, ms: of the "
           "wall clock, of the processors\n",
           width, height, a->runs);
    if (load >= 0.5) {
        printf("a load average of %.2f before this: what else runs takes processors away from speed-ups\n",
               load);
    }
    printf("%-35s %4s", "stage", "runs");
    for (int c = 0; c < columns; c++) {
        printf(" %5d thr  processor", threads[c]);
        printf("%s", c > 0 ? "  speed-up    " : "");
    }
    printf("  draws  frags  trigs   rays  %-16s  rate of the last\n", "hash");
    for (int i = 0; i < rowCount; i++) {
        printRow(&rows[i], threads, columns);
    }
    if (columns > 1) {
        printf(
            "speed-up against the first column, and that per thread; * under %.0f %% (two threads: %.1fx)\n",
            100 * LEAST_EFFICIENCY, 2 * LEAST_EFFICIENCY);
    }
}

static json_t* figureJson(const Row* row, const int* threads, int column)
{
    const Figure* f = &row->figure[column];
    const Outcome* o = &f->outcome;
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)o->hash);
    return json_pack("{s:s, s:i, s:f, s:f, s:i, s:f, s:f, s:I, s:I, s:I, s:I, s:f, s:f, s:s, s:s}", "stage",
                     row->stage->name, "threads", threads[column], "ms", f->ms, "cpu_ms", f->cpuMs, "runs",
                     f->runs, "speed_up", speedUp(row, column), "efficiency",
                     efficiency(row, threads, column), "draw_calls", (json_int_t)o->drawCalls, "fragments",
                     (json_int_t)o->fragments, "triangles", (json_int_t)o->triangles, "rays",
                     (json_int_t)o->rays, "pixel_lights", o->pixelLights, "work", o->work, "unit",
                     o->unit ? o->unit : "", "hash", hash);
}

void printStagesJson(const Row* rows, int rowCount, const int* threads, int columns)
{
    json_t* root = json_array();
    for (int i = 0; i < rowCount; i++) {
        for (int c = 0; c < columns; c++) {
            json_array_append_new(root, figureJson(&rows[i], threads, c));
        }
    }
    json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(6));
    putchar('\n');
    json_decref(root);
}
