// SPDX-License-Identifier: MIT
// vpl bench --scaling: how time grows with the amount of work. An exponent by least squares over all points is
// flattened by the part of the time that does not grow. So two figures stand beside it: the exponent of the upper
// half of the points, where that part weighs least, and the part itself, by fitting a + b n^p where p is what is
// expected; how far that fit is off says whether to believe it.
#include "cli/bench/fit.h"
#include "cli/bench/series.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// An exponent this much above the expected one is marked.
#define TOLERANCE          0.15
#define SECONDS_PER_SERIES 15.0

typedef struct Measured {
    const Series* series;
    double n[MAX_POINTS], ms[MAX_POINTS], cpuMs[MAX_POINTS];
    int points, runs;
    bool oneThread;
    double exponent, upper; // of all points, and of the upper half
    FixedFit fit;
} Measured;

// Threads go up to the number of processors, by doubling, and to that number itself.
static void choosePoints(const Series* series, Sweep* s)
{
    const bool threads = series->most == 0;
    const double most = threads ? (double)sysconf(_SC_NPROCESSORS_ONLN) : series->most;
    for (double n = series->least; n < most * 1.01 && s->points < MAX_POINTS; n *= series->factor) {
        s->n[s->points++] = n;
    }
    if (threads && s->points < MAX_POINTS && s->n[s->points - 1] < most) {
        s->n[s->points++] = most;
    }
}

static vplResult openSweep(const Arguments* a, const Series* series, Sweep* s)
{
    memset(s, 0, sizeof *s);
    s->arguments = a;
    s->series = series;
    const bool sized = isGiven(a, "size");
    TRY(openBench(a, a->threadsCount > 0 ? a->threads[0] : 1, sized ? a->render.output.width : 640,
                  sized ? a->render.output.height : 360, &s->bench));
    choosePoints(series, s);
    for (int i = 0; i < s->points && series->prepare != NULL; i++) {
        TRY(series->prepare(s, i));
    }
    return VPL_SUCCESS;
}

static void closeSweep(Sweep* s)
{
    for (int i = 0; i < s->points; i++) {
        vplGeometry_Destroy(s->geometries[i]);
        vplScene_Destroy(s->scenes[i]);
        vplImage_Destroy(s->images[i]);
        closeBench(&s->benches[i]);
    }
    closeBench(&s->bench);
}

static vplResult runPoint(void* user, int point)
{
    Sweep* s = user;
    return s->series->run(s, point);
}

// On one thread processor time is what the wall clock would show if nothing else ran.
static void fitSeries(Measured* m)
{
    const double* times = m->oneThread ? m->cpuMs : m->ms;
    const int half = m->points > 3 ? m->points / 2 : 0;
    m->exponent = fitExponent(m->n, times, m->points);
    m->upper = fitExponent(m->n + half, times + half, m->points - half);
    m->fit = fitFixed(m->n, times, m->points, m->series->expected);
}

static vplResult measureSweep(const Arguments* a, Sweep* s, Measured* m)
{
    Times times[MAX_POINTS];
    TRY(openSweep(a, m->series, s));
    const Contest contest = {runPoint, s, s->points, a->runs, SECONDS_PER_SERIES, INFINITY};
    TRY(measureInTurn(&contest, times, &m->runs));
    m->points = s->points;
    m->oneThread = vplContext_GetWorkerCount(s->bench.context) == 1 && m->series->most > 0;
    for (int i = 0; i < s->points; i++) {
        m->n[i] = s->n[i];
        m->ms[i] = times[i].wall;
        m->cpuMs[i] = times[i].cpu;
    }
    fitSeries(m);
    return VPL_SUCCESS;
}

static vplResult measureSeries(const Arguments* a, Measured* m)
{
    static Sweep sweep;
    const vplResult result = measureSweep(a, &sweep, m);
    closeSweep(&sweep);
    return result;
}

static void printSeries(const Measured* m)
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

static json_t* seriesJson(const Measured* m)
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
    static Measured measured;
    json_t* root = json_array();
    int ran = 0, code = EXIT_DONE;
    for (int i = 0; i < SERIES_COUNT && code == EXIT_DONE; i++) {
        if (!isAskedFor(a, SERIES[i].name)) {
            continue;
        }
        measured.series = &SERIES[i];
        code = exitCode(measureSeries(a, &measured), true);
        if (code == EXIT_DONE && a->json) {
            json_array_append_new(root, seriesJson(&measured));
        } else if (code == EXIT_DONE) {
            printSeries(&measured);
            fflush(stdout);
        }
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
