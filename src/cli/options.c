// SPDX-License-Identifier: MIT
#include "cli/options.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

// ---- readers

// Reads whole numbers without a sign, separated by `separator`. Returns their number; 0 if the text is
// anything else.
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

// Reads a number without blanks before or behind it.
static bool parseReal(const char* text, double* out)
{
    char* end;
    *out = strtod(text, &end);
    return *text > ' ' && *end == 0;
}

__attribute__((format(printf, 3, 4))) static bool refuse(const Option* o, const char* value,
                                                         const char* format, ...)
{
    char wanted[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(wanted, sizeof wanted, format, arguments);
    va_end(arguments);
    complain("%s%s is \"%s\", must be %s", dashesOf(o), o->name, value, wanted);
    return false;
}

static bool store(const Option* o, Arguments* a, const void* value, size_t size)
{
    memcpy((char*)a + o->offset, value, size);
    return true;
}

static bool readInt(const Option* o, const char* value, Arguments* a)
{
    int number;
    return parseNumbers(value, 0, o->low, o->high, &number, 1) == 1
               ? store(o, a, &number, sizeof number)
               : refuse(o, value, "a whole number in [%.0f, %.0f]", o->low, o->high);
}

static bool readNumber(const Option* o, const char* value, Arguments* a)
{
    double number;
    const bool good = parseReal(value, &number) && number >= o->low && number <= o->high;
    return good ? store(o, a, &number, sizeof number)
                : refuse(o, value, "a number in [%g, %g]", o->low, o->high);
}

static bool readExposure(const Option* o, const char* value, Arguments* a)
{
    if (strcmp(value, "auto") == 0) {
        a->exposure = (double)VPL_EXPOSURE_AUTO;
        return true;
    }
    const bool good = parseReal(value, &a->exposure) && fabs(a->exposure) <= o->high;
    return good || refuse(o, value, "a number in [%g, %g] or auto", o->low, o->high);
}

static bool readFlag(const Option* o, const char* value, Arguments* a)
{
    (void)value;
    return store(o, a, &(bool){true}, sizeof(bool));
}

static bool readText(const Option* o, const char* value, Arguments* a)
{
    if (*value == 0) {
        complain("%s%s is empty, must be %s", dashesOf(o), o->name, o->value);
        return false;
    }
    return store(o, a, &value, sizeof value);
}

static bool readSky(const Option* o, const char* value, Arguments* a)
{
    vplEnvironmentDef sky = vplDefaultEnvironmentDef();
    return parseSky(value, &sky)
               ? store(o, a, &value, sizeof value)
               : refuse(o, value,
                        "ELEVATION in [0, 90] degrees, and behind commas TURBIDITY in [2, 10] and TURN in "
                        "degrees");
}

static bool readChoice(const Option* o, const char* value, Arguments* a)
{
    const size_t length = strlen(value);
    const char* at = o->value;
    for (int choice = 0; at != NULL && length > 0; choice++) {
        if (strcspn(at, "|") == length && strncmp(at, value, length) == 0) {
            return store(o, a, &choice, sizeof choice); // enums are ints
        }
        at = strchr(at, '|');
        at = at != NULL ? at + 1 : NULL;
    }
    return refuse(o, value, "one of %s", o->value);
}

static bool readGrid(const Option* o, const char* value, Arguments* a)
{
    return parseNumbers(value, 'x', 1, VPL_MAX_IMAGE_SIZE, a->regions, 2) == 2 ||
           refuse(o, value, "COLUMNSxROWS, each in [1, %d]", VPL_MAX_IMAGE_SIZE);
}

// The rectangle is checked against the pictures when they are read.
static bool readRegion(const Option* o, const char* value, Arguments* a)
{
    const int* r = a->region;
    return (parseNumbers(value, ',', 0, VPL_MAX_IMAGE_SIZE, a->region, 4) == 4 && r[2] > 0 && r[3] > 0) ||
           refuse(o, value, "X,Y,WIDTH,HEIGHT in pixels, X and Y from 0");
}

static bool readFrames(const Option* o, const char* value, Arguments* a)
{
    int* f = a->frames;
    if (parseNumbers(value, ':', 0, VPL_MAX_FRAME, f, 2) != 2) {
        return refuse(o, value, "FIRST:LAST, two numbers in [0, %d]", VPL_MAX_FRAME);
    }
    a->render.sequence.frame = f[0]; // the plan describes the first frame
    return (f[0] <= f[1] && f[1] - f[0] < MAX_FRAMES) || refuse(o, value, "1 to %d frames", MAX_FRAMES);
}

static bool readTile(const Option* o, const char* value, Arguments* a)
{
    enum { MOST = 4096 };
    return (parseNumbers(value, '/', 1, MOST, a->tile, 2) == 2 && a->tile[0] <= a->tile[1]) ||
           refuse(o, value, "I/N, two numbers in [1, %d], I at most N", MOST);
}

// One thread count, or for bench several: 1,2,4.
static bool readThreads(const Option* o, const char* value, Arguments* a)
{
    const bool several = a->command->bit == BENCH;
    const int most = several ? MAX_THREAD_COUNTS : 1;
    a->threadsCount = parseNumbers(value, ',', 0, VPL_MAX_WORKERS, a->threads, most);
    if (a->threadsCount == 0) {
        return refuse(o, value, "%s in [0, %d]",
                      several ? "whole numbers with commas between," : "a whole number", VPL_MAX_WORKERS);
    }
    a->context.workerCount = a->threads[a->threadsCount - 1];
    return true;
}

// The context serves this file alone.
static bool readPlan(const Option* o, const char* value, Arguments* a)
{
    vplContext* context;
    if (!readText(o, value, a)) {
        return false;
    }
    vplResult result = openContext(a, &context);
    if (result == VPL_SUCCESS) {
        result = vplRenderOptions_Load(context, value, &a->render, &a->planScene);
    }
    vplContext_Destroy(context);
    a->failure = result == VPL_OUT_OF_MEMORY ? EXIT_COULD_NOT : a->failure;
    return result == VPL_SUCCESS;
}

static bool readRender(const Option* o, const char* value, Arguments* a)
{
    if (vplRenderOptions_Set(&a->render, o->name, value) != VPL_SUCCESS) {
        complain("--%s", a->render.problem);
        return false;
    }
    return true;
}

// ---- the table

#define AT(field) offsetof(Arguments, field)

static const Option OWN[] = {
    {"o", "FILE", NULL, RENDER, readText, AT(output), 0, 0,
     "picture to write: .png (8-bit sRGB), .hdr, .pfm or, where built in, .exr (linear radiance); required",
     NULL},
    {"o", "FILE", NULL, MERGE, readText, AT(output), 0, 0, "picture to write, as of vpl render; required",
     NULL},
    {"o", "FILE", NULL, BAKE, readText, AT(output), 0, 0, "mesh to write: .ply; required", NULL},
    {"o", "DIR", NULL, TRADEOFF, readText, AT(output), 0, 0,
     "folder for report.html, tradeoff.svg, tradeoff.csv and the reference, made if missing; required", NULL},
    {"exposure", "EV|auto", "auto", RENDER | MERGE, readExposure, 0, -64, 64,
     "stops, PNG only: pixels times 2^EV. auto: the geometric mean of the luminance becomes middle grey, "
     "without dark surroundings, the darkest 10 % and the brightest 5 %, up to two stops less where "
     "highlights "
     "are large; with --frames that of the first picture for all; 0 for --tonemap reinhard, which has its "
     "own key, and for stages that are not light",
     NULL},
    {"exposure", "EV", NULL, TRADEOFF | BAKE, readNumber, AT(exposure), -64, 64,
     "stops, 8-bit colours only: radiance times 2^EV; default 0, tradeoff: by the reference", NULL},
    {"tonemap", "usual|none|reinhard|aces|agx", "usual", RENDER | MERGE, readChoice, AT(tonemap), 0, 0,
     "PNG only: how bright light fits into the screen's range. none: clipped; aces: strong contrast; agx: "
     "bright colours turn pale, shadows keep their value; usual: agx, reinhard for --preset ssvp-2020, and "
     "none for stages that are not light",
     NULL},
    {"no-ground", NULL, NULL, ON_SCENES, readFlag, AT(noGround), 0, 0,
     "no ground under a SCENE that is a model (.obj, .ply, .stl, .gltf, .glb)", NULL},
    {"environment", "FILE|R,G,B", NULL, ON_SCENES, readText, AT(environment), 0, 0,
     "light from all around instead of the scene's own: a picture of all directions (.hdr, .pfm, .exr; the "
     "middle is -z, "
     "y is up), or one radiance in W/(m^2 sr)",
     NULL},
    {"sky", "E[,T[,TURN]]", NULL, ON_SCENES, readSky, AT(sky), 0, 0,
     "a clear sky and its sun instead: elevation of the sun in degrees, turbidity from 2 (very clear) to 10 "
     "(hazy), default "
     "3, and degrees by which the sun is turned from +x, counter-clockwise seen from above",
     NULL},
    {"frames", "A:B", NULL, RENDER, readFrames, 0, 0, 0,
     "frames A to B of the scene's paths, one picture each: out.png becomes out-0000.png and so on, and "
     "statistics are numbered in the same way",
     NULL},
    {"tile", "I/N", NULL, RENDER, readTile, 0, 0, 0,
     "write part I of N parts of the picture as FILE, for vpl merge: some of its passes, or else bands of 64 "
     "rows (16 of "
     "path tracing)",
     NULL},
    {"plan", "FILE", NULL, ON_SCENES & ~TRADEOFF, readPlan, AT(planIn), 0, 0,
     "a plan file (see --plan-out), which sets all options of rendering; options beside it change them",
     NULL},
    {"plan-out", "FILE", NULL, RENDER | INFO, readText, AT(planOut), 0, 0,
     "write the plan as JSON: all options as they were chosen, with the reasons, and with counts of passes "
     "or spp "
     "instead of a time or error that ended the render, so that --plan gives the same bits on every machine; "
     "with "
     "--dry-run, and by vpl info, as planned",
     NULL},
    {"checkpoint", "FILE", NULL, RENDER, readText, AT(checkpoint), 0, 0,
     "save the state of a render of several passes, or of path tracing, now and then, at the end, and when "
     "it is "
     "interrupted",
     NULL},
    {"checkpoint-every", "S", "60", RENDER, readNumber, AT(checkpointEvery), 0, 1e9,
     "seconds between two states of --checkpoint, and the pass under way", NULL},
    {"resume", "FILE", NULL, RENDER, readText, AT(resume), 0, 0,
     "go on with a state of --checkpoint, to the bits of a render that was never stopped; scene and options "
     "must be "
     "the same, but for those that say when it ends: passes, spp, budget, max-error, quality",
     NULL},
    {"no-partial", NULL, NULL, RENDER, readFlag, AT(noPartial), 0, 0,
     "write no picture if the render is interrupted (Ctrl-C, SIGTERM); by default the picture of the passes "
     "that were "
     "done is written, and the exit code is 1",
     NULL},
    {"error-map", "FILE", NULL, RENDER, readText, AT(errorMap), 0, 0,
     "write where the error of the picture lies, as a picture with one pixel for each block of 8x8: its rmse "
     "is red, its "
     "noise green, its bias blue, W/(m^2 sr); for renders of several passes and path tracing",
     NULL},
    {"stats", "FILE", NULL, RENDER | BAKE, readText, AT(stats), 0, 0, "write statistics as JSON", NULL},
    {"explain", NULL, NULL, RENDER | BAKE | LIGHTS, readFlag, AT(explain), 0, 0,
     "print the plan on standard error first: what will be done, and why", NULL},
    {"dry-run", NULL, NULL, RENDER | BAKE | LIGHTS, readFlag, AT(dryRun), 0, 0,
     "print the plan and do nothing", NULL},
    {"reference", "FILES", NULL, TRADEOFF, readText, AT(reference), 0, 0,
     "the true picture, linear and of the same size, or two independent ones, A,B, whose noise cancels; "
     "default: path traced",
     NULL},
    {"reference-spp", "N", NULL, TRADEOFF, readInt, AT(referenceSpp), 2, VPL_MAX_SAMPLES,
     "paths per pixel of the reference; default: as many as a third of the time allows", NULL},
    {"seeds", "K", "3", TRADEOFF, readInt, AT(seeds), 1, 64, "seeds per setting", NULL},
    {"time", "S", "300", TRADEOFF, readNumber, AT(seconds), 0, 1e9,
     "seconds of measuring, the most promising settings first", NULL},
    {"sweeps", "LIST", NULL, TRADEOFF, readText, AT(sweeps), 0, 0,
     "only these sweeps, as in frontier,sampler; default: all", NULL},
    {"heatmap", "FILE", NULL, COMPARE, readText, AT(heatmap), 0, 0, "write a picture of the differences",
     NULL},
    {"heatmap-of", "difference|relative|ssim|flip", "difference", COMPARE, readChoice, AT(heatmapOf), 0, 0,
     "what it shows; ssim: 1 - SSIM; flip: in magma colours", NULL},
    {"heat-scale", "X", NULL, COMPARE, readNumber, AT(heatScale), 0, 1e30,
     "value at the bright end; default: the largest, and 1 for ssim and flip", NULL},
    {"ppd", "P", NULL, COMPARE, readNumber, AT(ppd), VPL_MIN_PPD, VPL_MAX_PPD,
     "pixels per degree of vision, for FLIP; default 67.02: 3840 pixels on 0.7 m seen from 0.7 m", NULL},
    {"region", "X,Y,W,H", NULL, COMPARE, readRegion, 0, 0, 0,
     "compare this rectangle only, as if it were cut out of both pictures", NULL},
    {"regions", "CxR", NULL, COMPARE, readGrid, 0, 0, 0,
     "also print means, ratio and rmse of each of C times R blocks", NULL},
    {"json", NULL, NULL, COMPARE | BENCH | INFO, readFlag, AT(json), 0, 0, "print JSON", NULL},
    {"runs", "N", "5", BENCH, readInt, AT(runs), 1, 1000,
     "runs of which the median is printed, three at least of stages that take seconds", NULL},
    {"stage", "WORD", NULL, BENCH, readText, AT(stage), 0, 0,
     "only the stages (with --scaling: the series, with --extremes: the sweeps) whose name contains this, "
     "slow ones too",
     NULL},
    {"all", NULL, NULL, BENCH, readFlag, AT(all), 0, 0, "slow stages, too", NULL},
    {"scaling", NULL, NULL, BENCH, readFlag, AT(scaling), 0, 0,
     "instead: time against lights, pixels, triangles, threads and shadow map size, with fitted exponents",
     NULL},
    {"extremes", NULL, NULL, BENCH, readFlag, AT(extremes), 0, 0,
     "instead: errors at the ends of what scenes and options may be, for every method; exit code 1 if one is "
     "larger "
     "than promised",
     NULL},
    {"calibrate", NULL, NULL, BENCH, readFlag, AT(calibrate), 0, 0,
     "instead: measure this machine for a second and keep its speeds in the cache folder; predicted times "
     "follow them",
     NULL},
    {"threads", "T", NULL, ~INFO, readThreads, 0, 0, 0,
     "worker threads, 0 (default, tradeoff: 1): one per processor; bench takes several: 1,2", NULL},
    {"memory", "MIB", NULL, RENDER | LIGHTS, readInt, AT(memoryMib), 1, INT_MAX,
     "refuse pictures that need more memory than this, MiB; usual: than nine tenths of what the machine has",
     NULL},
    {"isa", "auto|scalar|sse2|avx2|avx512", "auto", ~(INFO | COMPARE | MERGE), readChoice, AT(context.isa), 0,
     0, "instruction set: the same bits", NULL},
    {"quiet", NULL, NULL, ~0, readFlag, AT(quiet), 0, 0, "no progress bar, no warnings", NULL},
    {"v", NULL, NULL, ~0, readFlag, AT(verbose), 0, 0, "say what was decided, and how long each stage took",
     NULL},
    {"help", NULL, NULL, ~0, readFlag, AT(help), 0, 0, "print the help of a command", NULL},
};

const Option* getOptions(void)
{
    enum { OWN_COUNT = sizeof OWN / sizeof *OWN, MOST = 200 };
    static Option all[MOST];
    static int count = 0;
    if (count == 0) {
        int renderCount;
        const vplOption* render = vplGetOptions(&renderCount);
        memcpy(all, OWN, sizeof OWN);
        count = OWN_COUNT;
        for (const vplOption* r = render; r < render + renderCount && count < MOST - 1; r++) {
            const int method = strcmp(r->name, "method") == 0 ? TRADEOFF : 0;
            const int size = strcmp(r->name, "size") == 0 ? BENCH : 0;
            if (r->kind != VPL_OPTION_PART) {
                all[count++] = (Option){.name = r->name,
                                        .value = r->value,
                                        .commands = (ON_SCENES & ~method) | size,
                                        .read = readRender,
                                        .help = r->help,
                                        .render = r};
            }
        }
    }
    return all;
}

const char* dashesOf(const Option* option)
{
    return option->name[1] == 0 ? "-" : "--";
}
