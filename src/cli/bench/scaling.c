// SPDX-License-Identifier: MIT
// vpl bench --scaling: the growth of time with the amount of work. Constant costs flatten the exponent that
// least squares find over all points. Two more figures are therefore printed: the exponent of the upper half
// of the points, where constant costs weigh least, and the constant a of the fit a + b n^p with the expected
// p and the fit's largest error.
#include "cli/bench/bench.h"
#include "cli/bench/fit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// Exponents of the upper half that exceed the expected one by more than this are marked.
#define TOLERANCE          0.15
#define SECONDS_PER_SERIES 15.0

enum { MAX_POINTS = 16 };

typedef struct Series Series;

// One series: what it varies and measures, and the results.
typedef struct Sweep {
    const Arguments* arguments;
    const Series* series;
    Bench bench;
    Bench benches[MAX_POINTS]; // what a series makes for each of its points: an image, a field or all
    double n[MAX_POINTS], ms[MAX_POINTS], cpuMs[MAX_POINTS];
    int points, runs;
    bool oneThread;
    double exponent, upper; // of all points, and of the upper half
    FixedFit fit;
} Sweep;

struct Series {
    const char* name;
    const char* unit; // what n counts
    double expected;  // exponent of n in the time
    const char* why;
    double least, most;                        // n goes from one to the other...
    double factor;                             // ...in such steps
    vplResult (*prepare)(Sweep* s, int point); // NULL: nothing to do; may replace n by the exact value
    vplResult (*run)(Sweep* s, int point);
};

// ---- the series

static const Stage SHADED = {.accumulation = VPL_ACCUMULATE_DEFERRED, .lights = 64, .batch = 1};

static vplResult shadeLights(Sweep* s, int point)
{
    Stage stage = SHADED;
    stage.lights = (int)s->n[point];
    Outcome outcome = {0};
    return shadeInto(&s->bench, s->bench.geometry, &stage, s->bench.image, &outcome);
}

// n is the number of pixels of a picture of 16:9.
static vplResult makeImage(Sweep* s, int point)
{
    const int height = (int)(sqrt(s->n[point] * 9 / 16) + 0.5), width = (int)(height * 16.0 / 9 + 0.5);
    s->n[point] = (double)width * height;
    return vplImage_Create(s->bench.context, width, height, &s->benches[point].image);
}

static vplResult shadePixels(Sweep* s, int point)
{
    Outcome outcome = {0};
    return shadeInto(&s->bench, s->bench.geometry, &SHADED, s->benches[point].image, &outcome);
}

static vplResult makeField(Sweep* s, int point)
{
    Bench* b = &s->benches[point];
    TRY(buildField(s->bench.context, (int)s->n[point], &b->field));
    TRY(vplGeometry_Create(b->field, &b->fieldGeometry));
    s->n[point] = b->fieldGeometry->triangleCount;
    return VPL_SUCCESS;
}

static vplResult buildTree(Sweep* s, int point)
{
    vplGeometry* geometry;
    TRY(vplGeometry_Create(s->benches[point].field, &geometry));
    vplGeometry_Destroy(geometry);
    return VPL_SUCCESS;
}

static vplResult drawTriangles(Sweep* s, int point)
{
    const Stage stage = {.accumulation = VPL_ACCUMULATE_DEFERRED, .batch = 1, .flags = NORMALS};
    Outcome outcome = {0};
    return shadeInto(&s->bench, s->benches[point].fieldGeometry, &stage, s->bench.image, &outcome);
}

static vplResult traceTriangles(Sweep* s, int point)
{
    Outcome outcome = {0};
    hitPixels(s->benches[point].fieldGeometry, vplScene_GetCamera(s->benches[point].field, 0), 256, 144,
              &outcome);
    return VPL_SUCCESS;
}

static vplResult openThreads(Sweep* s, int point)
{
    const vplImage* image = s->bench.image;
    return openBench(s->arguments, (int)s->n[point], image->width, image->height, &s->benches[point]);
}

static vplResult shadeThreads(Sweep* s, int point)
{
    Bench* b = &s->benches[point];
    Stage stage = SHADED;
    stage.lights = 512;
    Outcome outcome = {0};
    return shadeInto(b, b->geometry, &stage, b->image, &outcome);
}

static vplResult drawCubeMap(Sweep* s, int point)
{
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.position = vplScene_GetEmitter(s->bench.scene, 0)->position;
    def.size = (int)s->n[point];
    vplCubeMap* map;
    TRY(vplCubeMap_Create(s->bench.geometry, &def, NULL, NULL, &map));
    vplCubeMap_Destroy(map);
    return VPL_SUCCESS;
}

static const Series SERIES[] = {
    {"deferred against lights", "lights", 1, "each light costs each pixel the same", 16, 2048, 2, NULL,
     shadeLights},
    {"deferred, 64 lights, against pixels", "pixels", 1, "each pixel costs the same; 240p to 2160p",
     426 * 240, 3840 * 2160, 2.0837, makeImage, shadePixels},
    {"geometry and tree against triangles", "triangles", 1, "n log n: a little above 1", 1024, 1 << 20, 4,
     makeField, buildTree},
    {"G-buffer against triangles", "triangles", 1, "at most: triangles smaller than a pixel mostly end early",
     1024, 1 << 20, 4, makeField, drawTriangles},
    {"closest hits against triangles", "triangles", 0, "log n, and what no longer fits the caches", 1024,
     1 << 20, 4, makeField, traceTriangles},
    {"deferred, 512 lights, against threads", "threads", -1, "tiles are independent", 1, 0, 2, openThreads,
     shadeThreads},
    {"cube shadow map against size", "texels along a face", 2,
     "each texel costs the same, until maps outgrow the caches", 256, 4096, 2, NULL, drawCubeMap},
};

enum { SERIES_COUNT = sizeof SERIES / sizeof *SERIES };

// ---- measuring

// Threads go up to the number of processors, by doubling, and to that number itself.
static void choosePoints(Sweep* s)
{
    const Series* series = s->series;
    const bool threads = series->most == 0;
    const double most = threads ? (double)sysconf(_SC_NPROCESSORS_ONLN) : series->most;
    for (double n = series->least; n < most * 1.01 && s->points < MAX_POINTS; n *= series->factor) {
        s->n[s->points++] = n;
    }
    if (threads && s->points < MAX_POINTS && s->n[s->points - 1] < most) {
        s->n[s->points++] = most;
    }
}

static vplResult openSweep(Sweep* s)
{
    const Arguments* a = s->arguments;
    const bool sized = isGiven(a, "size");
    TRY(openBench(a, a->threadsCount > 0 ? a->threads[0] : 1, sized ? a->render.output.width : 640,
                  sized ? a->render.output.height : 360, &s->bench));
    choosePoints(s);
    for (int i = 0; i < s->points && s->series->prepare != NULL; i++) {
        TRY(s->series->prepare(s, i));
    }
    return VPL_SUCCESS;
}

static void closeSweep(Sweep* s)
{
    for (int i = 0; i < s->points; i++) {
        closeBench(&s->benches[i]);
    }
    closeBench(&s->bench);
}

static vplResult runPoint(void* user, int point)
{
    Sweep* s = user;
    return s->series->run(s, point);
}

// On one thread, processor time is used: other programs do not disturb it.
static void fitSweep(Sweep* s)
{
    const double* times = s->oneThread ? s->cpuMs : s->ms;
    const int half = s->points > 3 ? s->points / 2 : 0;
    s->exponent = fitExponent(s->n, times, s->points);
    s->upper = fitExponent(s->n + half, times + half, s->points - half);
    s->fit = fitFixed(s->n, times, s->points, s->series->expected);
}

static vplResult measureSweep(Sweep* s)
{
    Times times[MAX_POINTS];
    TRY(openSweep(s));
    const Measurement measurement = {runPoint,           s,       s->points, s->arguments->runs,
                                     SECONDS_PER_SERIES, INFINITY};
    TRY(measureInTurn(&measurement, times, &s->runs));
    s->oneThread = vplContext_GetWorkerCount(s->bench.context) == 1 && s->series->most > 0;
    for (int i = 0; i < s->points; i++) {
        s->ms[i] = times[i].wall;
        s->cpuMs[i] = times[i].cpu;
    }
    fitSweep(s);
    return VPL_SUCCESS;
}

static void printSweep(const Sweep* m)
{
    const Series* s = m->series;
    const double* times = m->oneThread ? m->cpuMs : m->ms;
    printf("\n%s; fitted: %s time\n%20s %12s %12s %16s\n", s->name, m->oneThread ? "processor" : "wall-clock",
           s->unit, "ms", "processor", "ns / n^expected");
    for (int i = 0; i < m->points; i++) {
        printf("%20.0f %12.3f %12.3f %16.4g\n", m->n[i], m->ms[i], m->cpuMs[i],
               1e6 * times[i] / pow(m->n[i], s->expected));
    }
    if (isnan(m->exponent)) {
        printf("  one point only: no exponent\n");
        return;
    }
    const double off = m->upper - s->expected;
    printf("  exponent %.3f, of the upper half %.3f; expected %g (%s)%s\n", m->exponent, m->upper,
           s->expected, s->why, off > TOLERANCE ? "  STEEPER" : "");
    if (!isnan(m->fit.fixed)) {
        printf("  with that exponent: %.3f ms fixed + %.4g ns n^%g, off by at most %.1f %%\n", m->fit.fixed,
               1e6 * m->fit.scale, s->expected, 100 * m->fit.worst);
    }
}

static json_t* sweepJson(const Sweep* m)
{
    json_t* points = json_array();
    for (int i = 0; i < m->points; i++) {
        json_array_append_new(
            points, json_pack("{s:f, s:f, s:f}", "n", m->n[i], "ms", m->ms[i], "cpu_ms", m->cpuMs[i]));
    }
    return json_pack("{s:s, s:s, s:s, s:i, s:f, s:o, s:o, s:o, s:o, s:o, s:o}", "series", m->series->name,
                     "unit", m->series->unit, "fitted", m->oneThread ? "cpu_ms" : "ms", "runs", m->runs,
                     "expected", m->series->expected, "exponent", numberJson(m->exponent),
                     "exponent_upper_half", numberJson(m->upper), "fixed_ms", numberJson(m->fit.fixed),
                     "ms_per_unit", numberJson(m->fit.scale), "fit_off_by", numberJson(m->fit.worst),
                     "points", points);
}

int runScaling(const Arguments* a)
{
    static Sweep sweep;
    json_t* root = json_array();
    int ran = 0, code = EXIT_DONE;
    for (int i = 0; i < SERIES_COUNT && code == EXIT_DONE; i++) {
        if (!isAskedFor(a, SERIES[i].name)) {
            continue;
        }
        memset(&sweep, 0, sizeof sweep);
        sweep.arguments = a;
        sweep.series = &SERIES[i];
        code = exitCode(measureSweep(&sweep), true);
        if (code == EXIT_DONE && a->json) {
            json_array_append_new(root, sweepJson(&sweep));
        } else if (code == EXIT_DONE) {
            printSweep(&sweep);
            fflush(stdout);
        }
        closeSweep(&sweep);
        ran++;
    }
    if (a->json && code == EXIT_DONE && ran > 0) {
        return writeJson(root, 6, NULL);
    }
    json_decref(root);
    if (ran == 0) {
        complain("no series of bench --scaling has \"%s\" in its name", a->stage);
        return EXIT_USAGE;
    }
    return code;
}
