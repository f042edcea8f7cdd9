// SPDX-License-Identifier: MIT
// Measures cost and error of lightcuts: lights evaluated per pixel, processor time of whole renders including
// the light tree, and the error of each pixel against the sum over all lights.
// `bench/lightcuts SCENE [instant-radiosity|keller [WIDTH HEIGHT [MOST [MOST_JUDGED [ERROR]]]]]`: runs with
// 1,000 particles and ten times as many each, up to MOST; up to MOST_JUDGED the program also shades all
// lights, deferred, for comparison.
#include "bench.h"

#include <string.h>

typedef struct Bench {
    const vplScene* scene;
    vplRenderOptions options;
    int judged; // largest number of particles for which deferred shading runs, too
} Bench;

typedef struct Run {
    vplImage* image;
    vplRenderStats stats;
} Run;

static Run runOnce(const Bench* b, vplAccumulation accumulation, vplLightShadows shadows, vplShow show)
{
    Run run = {0};
    vplRenderOptions o = b->options;
    o.pipeline.kind = accumulation;
    o.lights.shadows = shadows;
    o.output.show = show;
    check(vplRender(b->scene, &o, &run.image, &run.stats));
    return run;
}

static double sumOf(const vplImage* image, int i)
{
    return (double)image->pixels[3 * i] + (double)image->pixels[3 * i + 1] + (double)image->pixels[3 * i + 2];
}

static int compareDoubles(const void* a, const void* b)
{
    const double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

// Prints errors relative to a pixel's light, or to a sixteenth of its unshadowed light (`open`) if shadows
// leave less. `own`: relative to the pixel's light in any case.
static void printErrors(const vplImage* image, const vplImage* truth, const vplImage* open)
{
    const int pixels = image->width * image->height;
    double *errors = malloc((size_t)pixels * sizeof *errors), squares = 0, sum = 0, own = 0;
    int count = 0;
    for (int i = 0; i < pixels; i++) {
        const double light = sumOf(truth, i), dark = sumOf(open, i) / 16,
                     error = fabs(sumOf(image, i) - light);
        squares += error * error;
        sum += light;
        if (dark > 0) {
            errors[count++] = error / (light > dark ? light : dark);
            own = light > 0 && error / light > own ? error / light : own;
        }
    }
    qsort(errors, (size_t)count, sizeof *errors, compareDoubles);
    printf(" %6.3f %6.3f %6.3f %6.3f %6.3f", 100 * sqrt(squares / pixels) * pixels / sum,
           100 * errors[(int)(0.95 * count)], 100 * errors[(int)(0.99 * count)], 100 * errors[count - 1],
           100 * own);
    free(errors);
}

// Measures indirect light alone, so that emitted light hides no error.
static void measure(const Bench* b, vplLightShadows shadows)
{
    Run cut = runOnce(b, VPL_ACCUMULATE_LIGHTCUTS, shadows, VPL_SHOW_INDIRECT);
    Run picture = runOnce(b, VPL_ACCUMULATE_LIGHTCUTS, shadows, VPL_SHOW_PICTURE);
    const vplRenderStats* s = &cut.stats;
    printf("%8d %-5s %8.0f %8.0f %7d %9.0f %9.0f", s->virtualLights,
           shadows == VPL_LIGHT_SHADOWS_RAY ? "ray" : "none",
           (double)picture.stats.lightEvaluations / (double)picture.stats.cutPixels,
           (double)s->lightEvaluations / (double)s->cutPixels, s->largestCut, picture.stats.cpuMs, s->cpuMs);
    if (b->options.particles.count <= b->judged) {
        Run all = runOnce(b, VPL_ACCUMULATE_DEFERRED, shadows, VPL_SHOW_INDIRECT);
        Run open = runOnce(b, VPL_ACCUMULATE_DEFERRED, VPL_LIGHT_SHADOWS_NONE, VPL_SHOW_INDIRECT);
        printf(" %9.0f %6.2fx", all.stats.cpuMs, all.stats.cpuMs / s->cpuMs);
        printErrors(cut.image, all.image, open.image);
        vplImage_Destroy(open.image);
        vplImage_Destroy(all.image);
    }
    printf("\n");
    fflush(stdout);
    vplImage_Destroy(picture.image);
    vplImage_Destroy(cut.image);
}

int main(int count, char** words)
{
    const char* path = count > 1 ? words[1] : "examples/scenes/room.json";
    vplContext* context;
    vplScene* scene;
    openScene(path, 0, VPL_ISA_AUTO, &context, &scene);
    Bench b = {.scene = scene, .options = plainOptions()};
    b.options.method =
        count > 2 && strcmp(words[2], "keller") == 0 ? VPL_METHOD_KELLER : VPL_METHOD_INSTANT_RADIOSITY;
    b.options.particles.sampler = VPL_SAMPLER_HALTON;
    b.options.lights.compensation = VPL_COMPENSATION_NONE;
    b.options.output.width = count > 4 ? atoi(words[3]) : 160;
    b.options.output.height = count > 4 ? atoi(words[4]) : 120;
    b.options.pipeline.cutError = count > 7 ? (float)atof(words[7]) : b.options.pipeline.cutError;
    const int most = count > 5 ? atoi(words[5]) : 100000;
    b.judged = count > 6 ? atoi(words[6]) : 10000;
    printf("%s, %dx%d, asked for %g %%; processor ms of whole renders; errors in %% of a pixel's light\n",
           path, b.options.output.width, b.options.output.height, 100 * (double)b.options.pipeline.cutError);
    printf("%8s %-5s %8s %8s %7s %9s %9s %9s %7s %6s %6s %6s %6s %6s\n", "lights", "shad.", "picture",
           "indirect", "largest", "picture", "indirect", "deferred", "ratio", "rmse", "p95", "p99", "max",
           "own");
    for (int particles = 1000; particles <= most; particles *= 10) {
        b.options.particles.count = particles;
        measure(&b, VPL_LIGHT_SHADOWS_NONE);
        measure(&b, VPL_LIGHT_SHADOWS_RAY);
    }
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
