// SPDX-License-Identifier: MIT
// Renders the settings, cheapest first, until all are done or the time is up.
#include "cli/tradeoff/tradeoff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The bar shows the share of the time that is used up.
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

// Estimates the wall-clock time of a picture, ms: that of the nearest measured setting of the same kind,
// scaled by the work; or, where there is none yet, a guess per pixel, which only orders the kinds.
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

// Short renders are repeated and the least time counts, because disturbances only add time.
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

// Measures one more seed of a setting.
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

// The report shows pictures of the front only.
static void dropPictures(Tradeoff* t)
{
    for (int i = 0; i < t->settingCount; i++) {
        if (t->settings[i].number == 0) {
            vplImage_Destroy(t->settings[i].image);
            t->settings[i].image = NULL;
        }
    }
}

// Returns the setting with `done` seeds whose next picture should take the least time; NULL if none is left.
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
    const char* change = s->change[0] ? s->change : "(base)";
    if (s->problem[0] != 0 || s->exhausted) {
        complain("%s: %s", change, s->exhausted ? "no time left" : s->problem);
    } else {
        complain("%-10s %-10s %s", formatTime(s->cpuMs).text, formatPercent(s->error).text, change);
    }
}

// Measures one seed of every setting, the cheapest first, until `end`. Each seed is a round over all
// settings, so a disturbance of the machine hits one seed of many settings instead of all seeds of a few.
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

// Renders again the pictures of settings that came to the front after their picture was dropped.
static void restorePictures(Tradeoff* t)
{
    t->deadline = INFINITY;
    for (int i = 0; i < t->settingCount; i++) {
        Setting* s = &t->settings[i];
        if (s->number > 0 && s->image == NULL) {
            vplRenderStats stats;
            renderQuietly(t, t->scene, &s->options, &s->image, &stats);
        }
    }
}

// Renders once without measuring: an idle processor is slow at first.
static void warmUp(Tradeoff* t)
{
    vplImage* image = NULL;
    renderQuietly(t, t->scene, &t->settings[0].options, &image, NULL);
    vplImage_Destroy(image);
}

int measureSettings(Tradeoff* t)
{
    const int seeds = t->arguments->seeds;
    t->runs = calloc((size_t)t->settingCount * (size_t)seeds, sizeof *t->runs);
    if (t->runs == NULL) {
        complain("out of memory");
        return EXIT_COULD_NOT;
    }
    for (int i = 0; i < t->settingCount; i++) {
        t->settings[i].runs = t->runs + (size_t)i * (size_t)seeds;
    }
    warmUp(t);
    for (int round = 0; round < seeds; round++) {
        // The first seed gets more than its share of the time: one seed of an expensive setting is better
        // than none, and the seeds of expensive settings differ least.
        double now = 1e-3 * wallMs(), left = t->deadline - now;
        int rounds = seeds - round;
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
