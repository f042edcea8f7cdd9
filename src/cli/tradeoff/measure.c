// SPDX-License-Identifier: MIT
// Renders the settings, cheapest first, until all are done or the time is up.
#include "cli/tradeoff/tradeoff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The bar shows the share of the time that is used up; the fraction of one picture would jump back and forth.
static bool watch(void* user, double fraction)
{
    Tradeoff* t = user;
    double now = 1e-3 * wallMs(), used = (now - t->start) / (t->deadline - t->start);
    (void)fraction;
    if (!showProgress(&t->progress, used < 0.999 ? used : 0.999)) {
        t->interrupted = true;
    }
    return !t->interrupted && now < t->deadline;
}

vplResult renderQuietly(Tradeoff* t, const vplScene* scene, const vplRenderOptions* options,
                        vplImage** imageOut, vplRenderStats* stats)
{
    vplRenderOptions watched = *options;
    watched.progress = watch;
    watched.progressUser = t;
    t->message[0] = 0;
    t->silent = true;
    vplResult result = vplRender(scene, &watched, imageOut, stats);
    t->silent = false;
    if (result != VPL_SUCCESS && t->message[0] == 0) {
        snprintf(t->message, sizeof t->message, "%s", vplResult_GetName(result));
    }
    return result;
}

// Milliseconds of the wall clock that one picture will take. The nearest measured setting of the same kind is
// scaled by the work; where there is none yet, a guess per pixel that only has to put the kinds in order.
static double foresee(const Tradeoff* t, const Setting* s)
{
    static const double guess[FAMILY_COUNT] = {1e-4, 1e-7, 1e-5, 1e-5, 1e-5, 1e-6, 1e-7, 1e-3};
    const vplRenderOptions* o = &s->options;
    const Setting* nearest = NULL;
    double least = INFINITY;
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* other = &t->settings[i];
        double far = fabs(log(other->work / s->work));
        if (isMeasured(other) && other->family == s->family &&
            other->options.pipeline.kind == o->pipeline.kind && far < least) {
            nearest = other;
            least = far;
        }
    }
    double pixels = (double)o->output.width * o->output.height;
    double pipeline = o->pipeline.kind >= VPL_ACCUMULATE_DEFERRED ? 1 : 10;
    return nearest ? nearest->wallMs * s->work / nearest->work
                   : guess[s->family] * pixels * s->work * pipeline;
}

// Short renders are repeated and the least time counts: what disturbs a machine only ever adds.
enum { REPEATS = 3, SHORT_MS = 100 };

static vplResult timeAgain(Tradeoff* t, const vplRenderOptions* options, vplRenderStats* stats)
{
    vplResult result = VPL_SUCCESS;
    for (int i = 1; i < REPEATS && stats->totalMs < SHORT_MS && result == VPL_SUCCESS; i++) {
        vplImage* image = NULL;
        vplRenderStats again;
        result = renderQuietly(t, t->scene, options, &image, &again);
        if (result == VPL_SUCCESS && again.cpuMs < stats->cpuMs) {
            *stats = again;
        }
        vplImage_Destroy(image);
    }
    return result;
}

static vplResult compare(const Tradeoff* t, const vplImage* image, Run* run)
{
    const vplImage* truth = t->reference.image;
    TRY(vplImage_Compare(image, truth, &run->comparison));
    run->error = errorOf(&t->reference, image, &run->comparison);
    TRY(vplImage_Ssim(image, truth, &run->ssim, NULL));
    return vplImage_Flip(image, truth, VPL_DEFAULT_PPD, &run->flip, NULL);
}

// One more seed of a setting.
static void measureSeed(Tradeoff* t, Setting* s)
{
    Run* run = &s->runs[s->runCount];
    vplRenderOptions options = s->options;
    run->seed = options.seed += (uint64_t)s->runCount;
    vplImage* image = NULL;
    vplResult result = renderQuietly(t, t->scene, &options, &image, &run->stats);
    if (result == VPL_SUCCESS) {
        result = compare(t, image, run);
    }
    if (result == VPL_SUCCESS) {
        result = timeAgain(t, &options, &run->stats);
    }
    if (result != VPL_SUCCESS) {
        s->exhausted = result == VPL_CANCELLED;
        snprintf(s->problem, sizeof s->problem, "%s", s->exhausted ? "" : t->message);
    } else if (s->runCount++ == 0) {
        s->wallMs = run->stats.totalMs; // for foresee, until the median is known
        s->image = image;
        image = NULL;
    }
    vplImage_Destroy(image);
}

// Pictures are kept for the report; those of settings that another one beats are not needed any more.
static void dropPictures(Tradeoff* t)
{
    for (int i = 0; i < t->settingCount; i++) {
        if (!t->settings[i].onFront) {
            vplImage_Destroy(t->settings[i].image);
            t->settings[i].image = NULL;
        }
    }
}

// The setting that will be the cheapest of those with `done` seeds; NULL if there is none left.
static Setting* findNext(Tradeoff* t, int done, double* ms)
{
    Setting* next = NULL;
    for (int i = 0; i < t->settingCount; i++) {
        Setting* s = &t->settings[i];
        bool open = s->runCount == done && s->problem[0] == 0 && !s->exhausted;
        double cost = open ? foresee(t, s) : INFINITY;
        if (open && (next == NULL || cost < *ms)) {
            next = s;
            *ms = cost;
        }
    }
    return next;
}

static void say(const Setting* s)
{
    char time[32], error[32];
    const char* change = s->change[0] ? s->change : "(base)";
    formatTime(s->cpuMs, time, sizeof time);
    formatPercent(s->error, error, sizeof error);
    if (s->problem[0] != 0 || s->exhausted) {
        complain("%s: %s", change, s->exhausted ? "no time left" : s->problem);
    } else {
        complain("%-10s %-10s %s", time, error, change);
    }
}

// One seed of every setting, the cheapest first, as long as it is before `end`. Seeds are rounds, not rows: what
// disturbs the machine for a while then hits all settings, and the medians of none.
static void measureRound(Tradeoff* t, int round, double end)
{
    double ms = 0;
    for (Setting* s = findNext(t, round, &ms); s != NULL && !t->interrupted; s = findNext(t, round, &ms)) {
        if (1e-3 * wallMs() + 1e-3 * ms < end) {
            measureSeed(t, s);
        } else {
            s->exhausted = true; // and so will be the rest, which is dearer
        }
        summarise(t);
        dropPictures(t);
        if (t->arguments->verbose && round == 0) {
            say(s);
        }
    }
}

static bool makeRoom(Tradeoff* t)
{
    bool good = true;
    for (int i = 0; i < t->settingCount && good; i++) {
        t->settings[i].runs = calloc((size_t)t->arguments->seeds, sizeof(Run));
        good = t->settings[i].runs != NULL;
    }
    return good;
}

// A setting may come to the front only when later seeds are known, its picture gone: the same bits are made again.
static void restorePictures(Tradeoff* t)
{
    t->deadline = INFINITY;
    for (int i = 0; i < t->settingCount; i++) {
        Setting* s = &t->settings[i];
        if (s->onFront && s->image == NULL) {
            vplRenderStats stats;
            renderQuietly(t, t->scene, &s->options, &s->image, &stats);
        }
    }
}

// A processor that was idle is slow at first; that must not be the cheapest setting's fault.
static void warmUp(Tradeoff* t)
{
    vplImage* image = NULL;
    renderQuietly(t, t->scene, &t->settings[0].options, &image, NULL);
    vplImage_Destroy(image);
}

int measureSettings(Tradeoff* t)
{
    if (!makeRoom(t)) {
        complain("out of memory");
        return EXIT_COULD_NOT;
    }
    warmUp(t);
    for (int round = 0; round < t->arguments->seeds; round++) {
        // The first seed gets more than its share: it is better to know a dear setting by one seed than not at
        // all, and the dearer a setting, the less its seeds differ.
        double now = 1e-3 * wallMs(), left = t->deadline - now;
        int rounds = t->arguments->seeds - round;
        measureRound(t, round, now + left * (rounds == 1 ? 1 : round == 0 ? 0.6 : 1.0 / rounds));
    }
    restorePictures(t);
    int measured = 0;
    for (int i = 0; i < t->settingCount; i++) {
        measured += isMeasured(&t->settings[i]);
    }
    if (measured > 0) {
        return EXIT_DONE;
    }
    const char* problem = t->settings[0].problem;
    complain("no setting could be measured: %s", t->interrupted    ? "interrupted"
                                                 : problem[0] != 0 ? problem
                                                                   : "the time is too short");
    return t->interrupted || problem[0] == 0 ? EXIT_COULD_NOT : EXIT_USAGE;
}
