// SPDX-License-Identifier: MIT
// The picture that counts as true: read from a file, or path traced in two independent halves whose difference
// says how far their mean is from the truth.
#include "cli/tradeoff.h"

#include <math.h>
#include <stdio.h>

static double meanOf(const vplImage* image)
{
    double sum = 0;
    size_t count = 3 * (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < count; i++) {
        sum += (double)image->pixels[i];
    }
    return sum / (double)count;
}

static int readReference(Tradeoff* t)
{
    Reference* r = &t->reference;
    const vplRenderOptions* o = &t->arguments->render;
    const char* path = t->arguments->reference;
    int code = exitCode(vplImage_Read(t->context, path, &r->image), true);
    if (code == EXIT_DONE && (r->image->width != o->width || r->image->height != o->height)) {
        complain("%s: the reference has %dx%d pixels, must have %dx%d as the pictures (--size)", path,
                 r->image->width, r->image->height, o->width, o->height);
        return EXIT_USAGE;
    }
    return code;
}

// Paths per pixel for one half: those that fit into a sixth of the time, as a power of two so that most machines
// come to the same number.
static int chooseSamples(const Tradeoff* t, double msPerSample)
{
    double fitting = 1e3 * (t->deadline - t->start) / 6 / msPerSample;
    int samples = 1;
    while (samples < 1 << 20 && 2 * samples <= fitting) {
        samples *= 2;
    }
    return samples;
}

static vplResult traceHalf(Tradeoff* t, int samples, int half, vplImage** imageOut, vplRenderStats* stats)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    const vplRenderOptions* base = &t->arguments->render;
    o.method = VPL_METHOD_PATH;
    o.width = base->width;
    o.height = base->height;
    o.camera = base->camera;
    o.samplesPerPixel = samples;
    // Far from the seeds of the settings: a path-traced setting must not share paths with its own judge.
    o.seed = base->seed ^ (UINT64_C(0x7472757468000000) + (uint64_t)half);
    return renderQuietly(t, &o, imageOut, stats);
}

static int traceReference(Tradeoff* t)
{
    enum { TRIAL = 4 };
    Reference* r = &t->reference;
    vplRenderStats stats;
    vplImage *halves[2] = {NULL, NULL}, *trial = NULL;
    int samples = t->arguments->referenceSpp / 2;
    vplResult result = VPL_SUCCESS;
    if (samples == 0) {
        result = traceHalf(t, TRIAL, 2, &trial, &stats);
        samples = result == VPL_SUCCESS ? chooseSamples(t, stats.totalMs / TRIAL) : 0;
        vplImage_Destroy(trial);
    }
    for (int i = 0; i < 2 && result == VPL_SUCCESS; i++) {
        result = traceHalf(t, samples, i, &halves[i], &stats);
        r->ms += result == VPL_SUCCESS ? stats.cpuMs : 0;
    }
    vplComparison comparison;
    if (result == VPL_SUCCESS) {
        result = vplImage_Compare(halves[0], halves[1], &comparison);
    }
    if (result == VPL_SUCCESS) {
        size_t count = 3 * (size_t)halves[0]->width * (size_t)halves[0]->height;
        for (size_t i = 0; i < count; i++) {
            halves[0]->pixels[i] = 0.5f * (halves[0]->pixels[i] + halves[1]->pixels[i]);
        }
        r->image = halves[0];
        r->spp = 2 * samples;
        // Halves of variance 2 v differ by 4 v, their mean has v: half the difference.
        r->error = 0.5 * comparison.relativeRmse;
        halves[0] = NULL;
    } else if (t->interrupted) {
        complain("interrupted while the reference was made, nothing was written");
    } else if (result == VPL_CANCELLED) {
        complain("the time is too short for a reference; give more with --time, or one with --reference");
    } else {
        complain("no reference (--reference gives one): %s", t->message);
    }
    vplImage_Destroy(halves[0]);
    vplImage_Destroy(halves[1]);
    return result == VPL_SUCCESS                                    ? EXIT_DONE
           : result == VPL_CANCELLED || result == VPL_OUT_OF_MEMORY ? EXIT_COULD_NOT
                                                                    : EXIT_USAGE;
}

int makeReference(Tradeoff* t)
{
    Reference* r = &t->reference;
    if (r->image != NULL) {
        return EXIT_DONE; // read before the folder was made
    }
    r->error = -1;
    int code = t->arguments->reference ? readReference(t) : traceReference(t);
    if (code == EXIT_DONE) {
        r->mean = meanOf(r->image);
        if (!(r->mean > 0 && isfinite(r->mean))) {
            complain("the reference is black: there is nothing to be wrong about");
            return EXIT_USAGE;
        }
    }
    return code;
}
