// SPDX-License-Identifier: MIT
// tradeoff.csv: one row per setting and seed, with every option and every figure (RFC 4180).
#include "cli/tradeoff/tradeoff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Columns of stages, which differ by method: all that occurred, in the order of their first run.
typedef struct Stages {
    const char* names[MAX_STAGE_NAMES];
    int count;
} Stages;

static void addStages(Stages* stages, const vplRenderStats* stats)
{
    for (int i = 0; i < stats->stageCount; i++) {
        int at = 0;
        while (at < stages->count && strcmp(stages->names[at], stats->stages[i].name) != 0) {
            at++;
        }
        if (at == stages->count && at < MAX_STAGE_NAMES) {
            stages->names[stages->count++] = stats->stages[i].name;
        }
    }
}

// Every option has a column; the seed has its own.
static bool isColumn(const vplOption* o)
{
    return o->kind != VPL_OPTION_PART && o->kind != VPL_OPTION_SEED;
}

// Adds a heading: the name, with underscores instead of dashes and spaces.
static void addHeading(const char* prefix, const char* name, Text* csv)
{
    addText(csv, "%s", prefix);
    for (; *name != 0; name++) {
        addText(csv, "%c", *name == '-' || *name == ' ' ? '_' : *name);
    }
    addText(csv, ",");
}

static void addHeader(const Stages* stages, Text* csv)
{
    addText(csv, "setting,family,sweeps,on_front,seed,");
    int count;
    const vplOption* options = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        if (isColumn(&options[i])) {
            addHeading("", options[i].name, csv);
        }
    }
    addText(
        csv,
        "over_front,virtual_lights,min_distance_used,reflectivity_used,image_hash,error,relative_rmse,rmse,"
        "relmse,trimmed_relmse,ssim,flip,psnr,"
        "energy_ratio,max_difference,draw_calls,rays,peak_bytes,cpu_ms,total_ms,");
    for (int i = 0; i < stages->count; i++) {
        addHeading("ms_", stages->names[i], csv);
    }
    addText(csv, "command\n");
}

static void addSweeps(const Setting* s, Text* csv)
{
    const char* before = "";
    for (int i = 0; i < SWEEP_COUNT; i++) {
        if (s->sweeps[i] && strcmp(before, SWEEPS[i].name) != 0) {
            addText(csv, "%s%s", *before ? " " : "", SWEEPS[i].name);
            before = SWEEPS[i].name;
        }
    }
    addText(csv, ",");
}

// A number that is not known is an empty cell.
static void addKnown(double value, Text* csv)
{
    addText(csv, isnan(value) ? "," : "%.9g,", value);
}

static void addFigures(const Run* run, const Stages* stages, Text* csv)
{
    const vplRenderStats* s = &run->stats;
    const vplComparison* c = &run->comparison;
    addText(csv, "%d,%.9g,%.9g,%016llx,", s->virtualLights, (double)s->minDistance, s->reflectivity,
            (unsigned long long)s->imageHash);
    addText(csv, "%.9g,%.9g,%.9g,%.9g,%.9g,", run->error, c->relativeRmse, c->rmse, c->relmse,
            c->trimmedRelmse);
    addKnown(run->ssim, csv);
    addKnown(run->flip, csv);
    addText(csv, "%.9g,%.9g,%.9g,", c->psnr, c->energyRatio, c->maxDifference);
    addText(csv, "%lld,%lld,%zu,%.3f,%.3f,", (long long)s->drawCalls, (long long)s->rays, s->peakBytes,
            s->cpuMs, s->totalMs);
    for (int i = 0; i < stages->count; i++) {
        double ms = 0;
        for (int j = 0; j < s->stageCount; j++) {
            ms += strcmp(s->stages[j].name, stages->names[i]) == 0 ? s->stages[j].ms : 0;
        }
        addText(csv, "%.3f,", ms);
    }
}

static void addRow(const Tradeoff* t, int index, const Run* run, const Stages* stages, Text* csv)
{
    const Setting* s = &t->settings[index];
    addText(csv, "%d,%s,", index, FAMILY_NAMES[s->family]);
    addSweeps(s, csv);
    addText(csv, "%d,%llu,", s->number > 0, (unsigned long long)run->seed);
    int count;
    const vplOption* options = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        char value[64];
        if (isColumn(&options[i])) {
            vplRenderOptions_Get(&s->options, options[i].name, value, sizeof value);
            addCell(csv, value);
        }
    }
    addKnown(overFront(t, s), csv);
    addFigures(run, stages, csv);
    char command[SENTENCE];
    vplRenderOptions seeded = s->options;
    seeded.seed = run->seed;
    writeCommand(&seeded, command, sizeof command);
    addText(csv, "%s\n", command);
}

void writeTable(const Tradeoff* t, Text* csv)
{
    Stages stages = {0};
    for (int i = 0; i < t->settingCount; i++) {
        for (int k = 0; k < t->settings[i].runCount; k++) {
            addStages(&stages, &t->settings[i].runs[k].stats);
        }
    }
    addHeader(&stages, csv);
    for (int i = 0; i < t->settingCount; i++) {
        for (int k = 0; k < t->settings[i].runCount; k++) {
            addRow(t, i, &t->settings[i].runs[k], &stages, csv);
        }
    }
}
