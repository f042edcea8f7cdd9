// SPDX-License-Identifier: MIT
// The reference: read from files, or path traced as two independent halves a and b. The squared error of a
// picture x is the mean of (x - a)(x - b), in which the reference's noise cancels; (x - a)^2 would include
// it. The two buffers are those of: Fabrice Rousselle, Claude Knaus and Matthias Zwicker, Adaptive Rendering
// with Non-Local Means Filtering, SIGGRAPH Asia 2012, section 4.
#include "cli/tradeoff/tradeoff.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static size_t countOf(const vplImage* image)
{
    return 3 * (size_t)image->width * (size_t)image->height;
}

double errorOf(const Reference* r, const vplImage* image, const vplComparison* comparison)
{
    double error = comparison->relativeRmse;
    if (r->halves[0] != NULL) {
        double square =
            jointSquare(image->pixels, r->halves[0]->pixels, r->halves[1]->pixels, countOf(image));
        error = square > 0 ? sqrt(square) / r->mean : 0;
    }
    return fmax(error, r->resolution);
}

static int readPicture(Tradeoff* t, const char* path, vplImage** imageOut)
{
    const vplRenderOptions* o = &t->arguments->render;
    vplContext_SetProgress(t->context, askInterrupts, NULL); // a pipe may be silent
    int code = exitCode(vplImage_Read(t->context, path, imageOut), true);
    vplContext_SetProgress(t->context, NULL, NULL);
    if (code == EXIT_DONE &&
        ((*imageOut)->width != o->output.width || (*imageOut)->height != o->output.height)) {
        complain("%s: the reference has %dx%d pixels, must have %dx%d as the pictures (--size)", path,
                 (*imageOut)->width, (*imageOut)->height, o->output.width, o->output.height);
        return EXIT_USAGE;
    }
    return code;
}

// Reads one file, or two with a comma between.
static int readReference(Tradeoff* t)
{
    Reference* r = &t->reference;
    const char* list = t->arguments->reference;
    const char* comma = strchr(list, ',');
    char first[PATH_MAX];
    snprintf(first, sizeof first, "%.*s", comma ? (int)(comma - list) : (int)strlen(list), list);
    if (comma == NULL) {
        return readPicture(t, first, &r->image);
    }
    int code = readPicture(t, first, &r->halves[0]);
    return code == EXIT_DONE ? readPicture(t, comma + 1, &r->halves[1]) : code;
}

// Returns the paths per pixel for one half: as many as fit into a sixth of the time, rounded down to 2^k or 3
// * 2^k so that similar machines choose equal numbers.
static int chooseSamples(const Tradeoff* t, double msPerSample)
{
    double fitting = 1e3 * (t->deadline - t->start) / 6 / msPerSample;
    int samples = 1;
    while (samples < 1 << 20 && 2 * samples <= fitting) {
        samples *= 2;
    }
    return samples > 1 && 1.5 * samples <= fitting ? samples / 2 * 3 : samples;
}

static vplResult traceHalf(Tradeoff* t, int samples, int half, vplImage** imageOut, vplRenderStats* stats)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    const vplRenderOptions* base = &t->arguments->render;
    o.method = VPL_METHOD_PATH;
    // Pictures without antialiasing sample there, too: jagged edges are no error of theirs.
    o.path.pixel = base->output.antialias > 1 ? VPL_PIXEL_AREA : VPL_PIXEL_CENTRE;
    o.output.width = base->output.width;
    o.output.height = base->output.height;
    o.output.camera = base->output.camera;
    o.path.samples = samples;
    // Far from the seeds of the settings: a path-traced setting must not share paths with the reference.
    o.seed = base->seed ^ (UINT64_C(0x7472757468000000) + (uint64_t)half);
    return renderQuietly(t, t->traced, &o, imageOut, stats);
}

static int explain(Tradeoff* t, vplResult result)
{
    if (t->interrupted) {
        complain("interrupted while the reference was made, nothing was written");
    } else if (result == VPL_CANCELLED) {
        complain("the time is too short for a reference; give more with --time, or one with --reference");
    } else {
        complain("no reference could be made (--reference gives one): %s", t->message);
    }
    return result == VPL_CANCELLED || result == VPL_OUT_OF_MEMORY ? EXIT_COULD_NOT : EXIT_USAGE;
}

static int traceReference(Tradeoff* t)
{
    enum { TRIAL = 4 };
    Reference* r = &t->reference;
    vplRenderStats stats;
    int samples = t->arguments->referenceSpp / 2;
    vplResult result = VPL_SUCCESS;
    if (samples == 0) {
        vplImage* trial = NULL;
        result = traceHalf(t, TRIAL, 2, &trial, &stats);
        samples = result == VPL_SUCCESS ? chooseSamples(t, stats.totalMs / TRIAL) : 0;
        vplImage_Destroy(trial);
    }
    for (int i = 0; i < 2 && result == VPL_SUCCESS; i++) {
        result = traceHalf(t, samples, i, &r->halves[i], &stats);
        r->ms += result == VPL_SUCCESS ? stats.cpuMs : 0;
    }
    r->spp = 2 * samples;
    return result == VPL_SUCCESS ? EXIT_DONE : explain(t, result);
}

// Computes the mean of the halves, its own error, and the smallest error that it can resolve.
static int joinHalves(Tradeoff* t)
{
    Reference* r = &t->reference;
    const vplImage *a = r->halves[0], *b = r->halves[1];
    int code = exitCode(vplImage_Create(t->context, a->width, a->height, &r->image), false);
    double square = 0;
    for (size_t i = 0; code == EXIT_DONE && i < countOf(a); i++) {
        double difference = (double)a->pixels[i] - (double)b->pixels[i];
        square += difference * difference;
        r->image->pixels[i] = 0.5f * (a->pixels[i] + b->pixels[i]);
    }
    // Halves of variance 2v have a difference of variance 4v and a mean of variance v: half the deviation.
    r->error = 0.5 * sqrt(square / (double)countOf(a));
    // Two standard errors.
    r->resolution = sqrt(2 * jointUncertainty(a->pixels, b->pixels, countOf(a)));
    return code;
}

int makeReference(Tradeoff* t)
{
    Reference* r = &t->reference;
    if (r->image != NULL) {
        return EXIT_DONE; // read before the folder was made
    }
    r->error = -1;
    int code = t->arguments->reference ? readReference(t) : traceReference(t);
    if (code == EXIT_DONE && r->halves[0] != NULL) {
        code = joinHalves(t);
    }
    if (code != EXIT_DONE) {
        return code;
    }
    for (size_t i = 0; i < countOf(r->image); i++) {
        r->mean += (double)r->image->pixels[i] / (double)countOf(r->image);
    }
    if (!(r->mean > 0 && isfinite(r->mean))) {
        complain("the reference is black: there is nothing to be wrong about");
        return EXIT_USAGE;
    }
    r->error /= r->error >= 0 ? r->mean : 1;
    r->resolution /= r->mean;
    return EXIT_DONE;
}
