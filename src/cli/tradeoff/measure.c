// SPDX-License-Identifier: MIT
// Renders the settings, the most promising first, until all are done or the time is up.
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
    return !t->interrupted && now < t->deadline && now < t->limit;
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

static vplResult comparePerceptually(Tradeoff* t, const vplImage* image, Run* run)
{
    const double begin = wallMs();
    TRY(vplImage_Ssim(image, t->reference.image, &run->ssim, NULL));
    TRY(vplImage_Flip(image, t->reference.image, VPL_DEFAULT_PPD, &run->flip, NULL));
    t->perceptual += 1e-3 * (wallMs() - begin);
    return VPL_SUCCESS;
}

// SSIM and FLIP can take longer than a fast picture. They get a tenth of the time: pictures of the front,
// which are completed at the end, and any others while it lasts.
static vplResult compare(Tradeoff* t, const vplImage* image, Run* run)
{
    TRY(vplImage_Compare(image, t->reference.image, &run->comparison));
    run->error = errorOf(&t->reference, image, &run->comparison);
    run->ssim = run->flip = NAN;
    const bool time = t->perceptual <= 0.1 * (1e-3 * wallMs() - t->start);
    return time ? comparePerceptually(t, image, run) : VPL_SUCCESS;
}

// Cancels a render that takes far longer than foreseen, which would cost others their time. A budget is
// foreseen even where the planner cannot keep it.
static void limitTime(Tradeoff* t, const Setting* s)
{
    const double now = 1e-3 * wallMs(), foreseen = s->forecast.known ? 1e-3 * s->forecast.wallMs : 0;
    const double factor = s->options.stop.budgetMs > 0 ? 8 : 4;
    const double trial = TRIAL_SHARE * 0.5 * (t->deadline - now + t->deadline - t->start);
    t->limit = now + fmax(factor * foreseen, factor / 4 * trial);
}

// Measures one more seed of a setting.
static void measureSeed(Tradeoff* t, Setting* s)
{
    const double begin = wallMs();
    limitTime(t, s);
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
        const bool cancelled = result == VPL_CANCELLED;
        s->leftOut = cancelled && !t->interrupted && 1e-3 * wallMs() < t->deadline ? LEFT_LONG : LEFT_LATE;
        s->cancelledMs = wallMs() - begin;
        snprintf(s->problem, sizeof s->problem, "%s", cancelled ? "" : t->message);
    } else if (s->runCount++ == 0) {
        s->image = image;
        image = NULL;
    }
    vplImage_Destroy(image);
    t->limit = INFINITY;
    t->spent += t->coarse ? 0 : 1e-3 * (wallMs() - begin);
    t->knobs += isKnob(s) ? 1e-3 * (wallMs() - begin) : 0;
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

static void say(const Setting* s)
{
    const char* change = s->change[0] ? s->change : "(base)";
    if (!isMeasured(s)) {
        char reason[SENTENCE];
        complain("%s: %s", change, whyLeftOut(s, reason, sizeof reason));
    } else {
        complain("%-10s %-10s %s", formatTime(s->cpuMs).text, formatPercent(s->error).text, change);
    }
}

// Measures one seed of the settings, the most promising first, until `end`. Each seed is a round over all
// settings, so a disturbance of the machine hits one seed of many settings instead of all seeds of a few.
static void measureRound(Tradeoff* t, int round, double end)
{
    Setting* s;
    while (!t->interrupted && (s = chooseNext(t, round, end)) != NULL) {
        measureSeed(t, s);
        summarise(t);
        dropPictures(t);
        if (t->arguments->verbose && round == 0) {
            say(s);
        }
    }
}

// Renders again the pictures of settings that came to the front after their picture was dropped, and compares
// those of the front in every way.
static void restorePictures(Tradeoff* t)
{
    t->deadline = t->limit = INFINITY;
    for (int i = 0; i < t->settingCount; i++) {
        Setting* s = &t->settings[i];
        if (s->number > 0 && s->image == NULL) {
            vplRenderStats stats;
            renderQuietly(t, t->scene, &s->options, &s->image, &stats);
        }
        if (s->number > 0 && s->image != NULL && isnan(s->runs[0].flip)) {
            comparePerceptually(t, s->image, &s->runs[0]);
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
        t->settings[i].elsewhere = t->crew != NULL && i % t->crew->count != t->crew->index;
    }
    t->limit = INFINITY;
    warmUp(t);
    for (int round = 0; round < seeds; round++) {
        // The first seed gets more than its share of the time: one seed of an expensive setting is better
        // than none, and the seeds of expensive settings differ least.
        double now = 1e-3 * wallMs(), left = t->deadline - now;
        int rounds = seeds - round;
        measureRound(t, round, now + left * (rounds == 1 ? 1 : round == 0 ? 0.8 : 1.0 / rounds));
    }
    measureRound(t, 0, t->deadline); // expensive ones, in the time that other seeds left
    if (t->crew != NULL) {
        const int code = t->crew->collectRuns(t->crew->user, t);
        if (code != EXIT_DONE || t->crew->index > 0) {
            return code;
        }
        summarise(t);
    }
    explainLeftOut(t);
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
