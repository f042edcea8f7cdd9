// SPDX-License-Identifier: MIT
#include "cli/bench/bench.h"

#include <stdio.h>

// A lower parallel efficiency is marked.
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

// Formats a rate, such as "2.35 Gpixel-lights/s".
static void printRate(const Outcome* o, double ms)
{
    if (o->unit == NULL || !(ms > 0)) {
        return;
    }
    double rate = o->work / ms * 1e3;
    const char* unit = rate >= 1e9 ? "G" : rate >= 1e6 ? "M" : "k";
    printf("  %7.2f %s%s/s", rate / (rate >= 1e9 ? 1e9 : rate >= 1e6 ? 1e6 : 1e3), unit, o->unit);
}

static double speedUp(const Row* row, int column)
{
    return row->times[0].wall / row->times[column].wall;
}

static double efficiency(const Table* t, const Row* row, int column)
{
    return speedUp(row, column) * t->threads[0] / t->threads[column];
}

static void printRow(const Table* t, const Row* row)
{
    char text[4][16];
    bool same = true;
    printf("%-35s %4d", row->stage->name, row->runs);
    for (int c = 0; c < t->columns; c++) {
        printf(" %9.2f %9.2f", row->times[c].wall, row->times[c].cpu);
        if (c > 0 && (row->stage->flags & SERIAL) != 0) {
            printf("      -     - ");
        } else if (c > 0) {
            double e = efficiency(t, row, c);
            printf("  %4.2fx %3.0f %%%s", speedUp(row, c), 100 * e, e < LEAST_EFFICIENCY ? "*" : " ");
        }
        same = same && row->outcomes[c].hash == row->outcomes[0].hash;
    }
    const Outcome* o = &row->outcomes[0];
    printf(" %6s %6s %6s %6s  %016llx", shorten((double)o->raster.drawCalls, text[0]),
           shorten((double)o->raster.fragments, text[1]), shorten((double)o->raster.trianglesIn, text[2]),
           shorten((double)o->rays, text[3]), (unsigned long long)o->hash);
    printRate(&row->outcomes[t->columns - 1], row->times[t->columns - 1].wall);
    printf("%s\n", same ? "" : "  DIFFERS BETWEEN THREAD COUNTS");
}

void printTable(const Arguments* a, const Table* t)
{
    printf("room at %dx%d (1/16: at a quarter of width and height); medians of up to %d runs, ms: of the "
           "wall clock, of the processors\n",
           t->width, t->height, a->runs);
    if (t->load >= 0.5) {
        printf("a load average of %.2f before this: what else runs takes processors away from speed-ups\n",
               t->load);
    }
    printf("%-35s %4s", "stage", "runs");
    for (int c = 0; c < t->columns; c++) {
        printf(" %5d thr  processor%s", t->threads[c], c > 0 ? "  speed-up    " : "");
    }
    printf("  draws  frags  trigs   rays  %-16s  rate of the last\n", "hash");
    for (int i = 0; i < t->rowCount; i++) {
        printRow(t, &t->rows[i]);
    }
    if (t->columns > 1) {
        printf(
            "speed-up against the first column, and that per thread; * under %.0f %% (two threads: %.1fx)\n",
            100 * LEAST_EFFICIENCY, 2 * LEAST_EFFICIENCY);
    }
}

static json_t* columnJson(const Table* t, const Row* row, int column)
{
    const Outcome* o = &row->outcomes[column];
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)o->hash);
    return json_pack("{s:s, s:i, s:f, s:f, s:i, s:f, s:f, s:I, s:I, s:I, s:I, s:f, s:f, s:s, s:s}", "stage",
                     row->stage->name, "threads", t->threads[column], "ms", row->times[column].wall, "cpu_ms",
                     row->times[column].cpu, "runs", row->runs, "speed_up", speedUp(row, column),
                     "efficiency", efficiency(t, row, column), "draw_calls", (json_int_t)o->raster.drawCalls,
                     "fragments", (json_int_t)o->raster.fragments, "triangles",
                     (json_int_t)o->raster.trianglesIn, "rays", (json_int_t)o->rays, "pixel_lights",
                     o->pixelLights, "work", o->work, "unit", o->unit ? o->unit : "", "hash", hash);
}

int printTableJson(const Table* t)
{
    json_t* root = json_array();
    for (int i = 0; i < t->rowCount; i++) {
        for (int c = 0; c < t->columns; c++) {
            json_array_append_new(root, columnJson(t, &t->rows[i], c));
        }
    }
    return writeJson(root, 6, NULL);
}
