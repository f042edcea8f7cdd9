// SPDX-License-Identifier: MIT
#include "cli/options.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

// ---- readers

// Whole numbers without a sign, with `separator` between, into `out`. Returns how many; 0 if it is anything else.
static int parseNumbers(const char* text, char separator, double low, double high, int* out, int most)
{
    for (int count = 0; count < most;) {
        char* end;
        errno = 0;
        const long number = *text >= '0' && *text <= '9' ? strtol(text, &end, 10) : -1;
        if (number < 0 || errno != 0 || (double)number < low || (double)number > high) {
            return 0;
        }
        out[count++] = (int)number;
        if (*end == 0) {
            return count;
        }
        if (*end != separator) {
            return 0;
        }
        text = end + 1;
    }
    return 0;
}

static bool readInt(const Option* o, const char* value, Arguments* a)
{
    int number;
    if (parseNumbers(value, 0, o->low, o->high, &number, 1) != 1) {
        complain("%s is \"%s\", must be a whole number in [%.0f, %.0f]", o->name, value, o->low, o->high);
        return false;
    }
    memcpy((char*)a + o->offset, &number, sizeof number);
    return true;
}

static bool readNumber(const Option* o, const char* value, Arguments* a)
{
    char* end;
    const double number = strtod(value, &end);
    if (*value == ' ' || end == value || *end != 0 || !(number >= o->low && number <= o->high)) {
        complain("%s is \"%s\", must be a number in [%g, %g]", o->name, value, o->low, o->high);
        return false;
    }
    memcpy((char*)a + o->offset, &number, sizeof number);
    return true;
}

static bool readFlag(const Option* o, const char* value, Arguments* a)
{
    (void)value;
    const bool on = true;
    memcpy((char*)a + o->offset, &on, sizeof on);
    return true;
}

static bool readText(const Option* o, const char* value, Arguments* a)
{
    if (*value == 0) {
        complain("%s is empty, must be %s", o->name, o->value);
        return false;
    }
    memcpy((char*)a + o->offset, &value, sizeof value);
    return true;
}

static bool readChoice(const Option* o, const char* value, Arguments* a)
{
    const size_t length = strlen(value);
    const char* at = o->value;
    for (int choice = 0; at != NULL; choice++) {
        if (length > 0 && strcspn(at, "|") == length && strncmp(at, value, length) == 0) {
            memcpy((char*)a + o->offset, &choice, sizeof choice); // enums are ints
            return true;
        }
        at = strchr(at, '|');
        at = at != NULL ? at + 1 : NULL;
    }
    complain("%s is \"%s\", must be one of %s", o->name, value, o->value);
    return false;
}

static bool readGrid(const Option* o, const char* value, Arguments* a)
{
    if (parseNumbers(value, 'x', 1, VPL_MAX_IMAGE_SIZE, a->regions, 2) != 2) {
        complain("%s is \"%s\", must be COLUMNSxROWS, each in [1, %d]", o->name, value, VPL_MAX_IMAGE_SIZE);
        return false;
    }
    return true;
}

// Whether it lies inside the pictures is asked when they are there.
static bool readRegion(const Option* o, const char* value, Arguments* a)
{
    int* r = a->region;
    if (parseNumbers(value, ',', 0, VPL_MAX_IMAGE_SIZE, r, 4) != 4 || r[2] == 0 || r[3] == 0) {
        complain("%s is \"%s\", must be X,Y,WIDTH,HEIGHT in pixels, X and Y from 0", o->name, value);
        return false;
    }
    return true;
}

static bool readFrames(const Option* o, const char* value, Arguments* a)
{
    int* f = a->frames;
    if (parseNumbers(value, ':', 0, VPL_MAX_FRAME, f, 2) != 2) {
        complain("%s is \"%s\", must be FIRST:LAST, two numbers in [0, %d]", o->name, value, VPL_MAX_FRAME);
        return false;
    }
    if (f[0] > f[1] || f[1] - f[0] >= MAX_FRAMES) {
        complain("%s is \"%s\", must be 1 to %d frames", o->name, value, MAX_FRAMES);
        return false;
    }
    a->render.sequence.frame = f[0]; // that of the plan
    return true;
}

// One thread count, or for bench several: 1,2,4.
static bool readThreads(const Option* o, const char* value, Arguments* a)
{
    const bool several = a->command->bit == BENCH;
    a->threadsCount =
        parseNumbers(value, ',', 0, VPL_MAX_WORKERS, a->threads, several ? MAX_THREAD_COUNTS : 1);
    if (a->threadsCount == 0) {
        complain("%s is \"%s\", must be %s in [0, %d]", o->name, value,
                 several ? "whole numbers with commas between," : "a whole number", VPL_MAX_WORKERS);
        return false;
    }
    a->context.workerCount = a->threads[a->threadsCount - 1];
    return true;
}

// ---- the table

#define AT(field) offsetof(Arguments, field)

const Option OPTIONS[] = {
    {"-o", "FILE", NULL, RENDER, readText, AT(output), 0, 0,
     "picture to write: .png (8-bit sRGB), .hdr, .pfm or, where built in, .exr (linear radiance); required"},
    {"-o", "FILE", NULL, BAKE, readText, AT(output), 0, 0, "mesh to write: .ply; required"},
    {"-o", "DIR", NULL, TRADEOFF, readText, AT(output), 0, 0,
     "folder for report.html, tradeoff.svg, tradeoff.csv and the reference, made if missing; required"},
    {"--exposure", "EV", NULL, RENDER | TRADEOFF | BAKE, readNumber, AT(exposure), -64, 64,
     "stops, PNG and the colours of PLY only: pixels times 2^EV; default 0"},
    {"--tonemap", "usual|none|reinhard", "usual", RENDER, readChoice, AT(tonemap), 0, 0,
     "PNG only; usual: reinhard for ssvp, else none"},
    {"--frames", "A:B", NULL, RENDER, readFrames, 0, 0, 0,
     "frames A to B of the scene's paths, one picture each: out.png becomes out-0000.png and so on, and "
     "statistics "
     "are numbered in the same way"},
    {"--stats", "FILE", NULL, RENDER | BAKE, readText, AT(stats), 0, 0, "write statistics as JSON"},
    {"--explain", NULL, NULL, RENDER | BAKE | LIGHTS, readFlag, AT(explain), 0, 0,
     "print the plan on standard error first: what will be done, and why"},
    {"--dry-run", NULL, NULL, RENDER | BAKE | LIGHTS, readFlag, AT(dryRun), 0, 0,
     "print the plan and do nothing"},
    {"--reference", "FILES", NULL, TRADEOFF, readText, AT(reference), 0, 0,
     "the true picture, linear and of the same size, or two independent ones, A,B, whose noise cancels; "
     "default: "
     "path traced"},
    {"--reference-spp", "N", NULL, TRADEOFF, readInt, AT(referenceSpp), 2, VPL_MAX_SAMPLES,
     "paths per pixel of the reference; default: as many as a third of the time allows"},
    {"--seeds", "K", "3", TRADEOFF, readInt, AT(seeds), 1, 64, "seeds per setting"},
    {"--time", "S", "300", TRADEOFF, readNumber, AT(seconds), 0, 1e9,
     "seconds of measuring, the cheapest settings first"},
    {"--sweeps", "LIST", NULL, TRADEOFF, readText, AT(sweeps), 0, 0,
     "only these sweeps, as in frontier,sampler; default: all"},
    {"--heatmap", "FILE", NULL, COMPARE, readText, AT(heatmap), 0, 0, "write a picture of the differences"},
    {"--heatmap-of", "difference|relative|ssim|flip", "difference", COMPARE, readChoice, AT(heatmapOf), 0, 0,
     "what it shows; ssim: 1 - SSIM; flip: in magma colours"},
    {"--heat-scale", "X", NULL, COMPARE, readNumber, AT(heatScale), 0, 1e30,
     "value at the bright end; default: the largest, and 1 for ssim and flip"},
    {"--ppd", "P", NULL, COMPARE, readNumber, AT(ppd), VPL_MIN_PPD, VPL_MAX_PPD,
     "pixels per degree of vision, for FLIP; default 67.02: 3840 pixels on 0.7 m seen from 0.7 m"},
    {"--region", "X,Y,W,H", NULL, COMPARE, readRegion, 0, 0, 0,
     "compare this rectangle only, as if it were cut out of both pictures"},
    {"--regions", "CxR", NULL, COMPARE, readGrid, 0, 0, 0,
     "also print means, ratio and rmse of each of C times R blocks"},
    {"--json", NULL, NULL, COMPARE | BENCH | INFO, readFlag, AT(json), 0, 0, "print JSON"},
    {"--runs", "N", "5", BENCH, readInt, AT(runs), 1, 1000,
     "runs of which the median is printed, three at least of stages that take seconds"},
    {"--stage", "WORD", NULL, BENCH, readText, AT(stage), 0, 0,
     "only the stages (with --scaling: the series) whose name contains this, slow ones too"},
    {"--all", NULL, NULL, BENCH, readFlag, AT(all), 0, 0, "slow stages, too"},
    {"--scaling", NULL, NULL, BENCH, readFlag, AT(scaling), 0, 0,
     "instead: time against lights, pixels, triangles, threads and shadow map size, with fitted exponents"},
    {"--threads", "T", NULL, ~INFO, readThreads, 0, 0, 0,
     "worker threads, 0 (default, tradeoff: 1): one per processor; bench takes several: 1,2"},
    {"--isa", "auto|scalar|sse2|avx2|avx512", "auto", ~(INFO | COMPARE), readChoice, AT(context.isa), 0, 0,
     "instruction set: the same bits"},
    {"--quiet", NULL, NULL, ~0, readFlag, AT(quiet), 0, 0, "no progress bar, no warnings"},
    {"-v", NULL, NULL, ~0, readFlag, AT(verbose), 0, 0, "say more"},
    {"--help", NULL, NULL, ~0, readFlag, AT(help), 0, 0, "print the help of a command"},
};

const int OPTION_COUNT = sizeof OPTIONS / sizeof *OPTIONS;

bool takesOption(const Command* command, const vplOption* option)
{
    if (option->kind == VPL_OPTION_PART) {
        return false;
    }
    return command->bit == BENCH      ? strcmp(option->name, "size") == 0
           : command->bit == TRADEOFF ? strcmp(option->name, "method") != 0
                                      : (command->bit & ON_SCENES) != 0;
}
