// SPDX-License-Identifier: MIT
// Measures the time that a picture takes to reach an error, with many virtual lights and with the path
// tracer, alternated in one run on two threads.
// `bench/deadline SCENE FOLDER [SIZE [PATHS]]`: the reference is traced as two independent halves a and b of
// PATHS paths per pixel (default 512) and kept in FOLDER. error: the root of the mean of (x - a)(x - b), in
// which the halves' noise cancels, relative to the mean of the reference. region: the same error of the means
// over 8 x 8 regions, each relative to its own mean: the root mean square, and the largest.
#include "bench.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

enum { RUNS = 3, GRID = 8 };

typedef struct Truth {
    vplImage* halves[2];
    vplImage* mean;
} Truth;

typedef struct Line {
    vplMethod method;
    int amount; // particles, or paths per pixel
    int interleave, passes;
    vplCompensation compensation;
} Line;

static const Line LINES[] = {
    {VPL_METHOD_KELLER, 1000, 16, 0, VPL_COMPENSATION_NONE},
    {VPL_METHOD_KELLER, 4000, 16, 0, VPL_COMPENSATION_NONE},
    {VPL_METHOD_KELLER, 1000, 16, 0, VPL_COMPENSATION_RAYS},
    {VPL_METHOD_KELLER, 4000, 16, 0, VPL_COMPENSATION_RAYS},
    {VPL_METHOD_KELLER, 16000, 16, 0, VPL_COMPENSATION_RAYS},
    {VPL_METHOD_KELLER, 64000, 16, 0, VPL_COMPENSATION_RAYS},
    {VPL_METHOD_KELLER, 64000, 16, 2, VPL_COMPENSATION_RAYS},
    {VPL_METHOD_KELLER, 16000, 8, 0, VPL_COMPENSATION_RAYS},
    {VPL_METHOD_KELLER, 300, 4, 0, VPL_COMPENSATION_RAYS},
    {VPL_METHOD_KELLER, 300, 1, 0, VPL_COMPENSATION_RAYS},
    {VPL_METHOD_PATH, 1, 0, 0, VPL_COMPENSATION_NONE},
    {VPL_METHOD_PATH, 4, 0, 0, VPL_COMPENSATION_NONE},
    {VPL_METHOD_PATH, 16, 0, 0, VPL_COMPENSATION_NONE},
    {VPL_METHOD_PATH, 64, 0, 0, VPL_COMPENSATION_NONE},
    {VPL_METHOD_PATH, 256, 0, 0, VPL_COMPENSATION_NONE},
};

static Truth findTruth(const vplScene* scene, const char* path, const char* folder, int size, int spp)
{
    Truth truth = {{NULL, NULL}, NULL};
    const char* name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    for (int i = 0; i < 2; i++) {
        char file[1024];
        snprintf(file, sizeof file, "%s/%s-%d-%d-%c.pfm", folder, name, size, spp, 'a' + i);
        struct stat there;
        if (stat(file, &there) == 0) {
            check(vplImage_Read(vplScene_GetContext(scene), file, &truth.halves[i]));
        } else {
            vplRenderOptions o = plainOptions();
            o.method = VPL_METHOD_PATH;
            o.path.pixel = VPL_PIXEL_CENTRE;
            o.output.width = o.output.height = size;
            o.path.samples = spp;
            o.seed = 1000001 + (uint64_t)i;
            check(vplRender(scene, &o, &truth.halves[i], NULL));
            check(vplImage_Write(truth.halves[i], file, NULL));
        }
    }
    check(vplImage_Create(vplScene_GetContext(scene), size, size, &truth.mean));
    for (size_t k = 0; k < 3 * (size_t)size * (size_t)size; k++) {
        truth.mean->pixels[k] = 0.5f * (truth.halves[0]->pixels[k] + truth.halves[1]->pixels[k]);
    }
    return truth;
}

// Returns the root of a mean of products, 0 where it is negative because the error is below the reference's
// own.
static double rootOf(double mean)
{
    return mean > 0 ? sqrt(mean) : 0;
}

static double errorOf(const vplImage* x, const Truth* t)
{
    const size_t count = 3 * (size_t)x->width * (size_t)x->height;
    double products = 0, sum = 0;
    for (size_t k = 0; k < count; k++) {
        const double here = (double)x->pixels[k];
        products += (here - (double)t->halves[0]->pixels[k]) * (here - (double)t->halves[1]->pixels[k]);
        sum += (double)t->mean->pixels[k];
    }
    return rootOf(products / (double)count) / (sum / (double)count);
}

static void regionErrors(const vplImage* x, const Truth* t, double* rms, double* largest)
{
    vplRegion regions[GRID * GRID];
    check(vplImage_CompareRegions(x, t->mean, GRID, GRID, regions));
    double squares = 0;
    int count = 0;
    *largest = 0;
    for (int i = 0; i < GRID * GRID; i++) {
        if (regions[i].meanB > 0) {
            const double off = fabs(regions[i].ratio - 1);
            squares += off * off;
            *largest = off > *largest ? off : *largest;
            count++;
        }
    }
    *rms = count ? sqrt(squares / count) : 0;
}

static void measure(const vplScene* scene, const Truth* truth, const Line* line, int size)
{
    vplRenderOptions o = plainOptions();
    o.method = line->method;
    o.output.width = o.output.height = size;
    o.path.pixel = VPL_PIXEL_CENTRE;
    o.particles.count = o.path.samples = line->amount;
    o.particles.reflectivity = -1;
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o.pipeline.kind = VPL_ACCUMULATE_INTERLEAVED;
    o.pipeline.interleave = line->interleave > 0 ? line->interleave : 1;
    o.stop.passes = line->passes;
    o.lights.compensation = line->compensation;
    double wall[RUNS], cpu[RUNS], errors[RUNS], rms[RUNS], largest[RUNS];
    vplRenderStats stats;
    for (int i = 0; i < RUNS; i++) {
        o.seed = 7 + (uint64_t)i; // unlike the seeds of the reference
        vplImage* image;
        check(vplRender(scene, &o, &image, &stats));
        wall[i] = stats.totalMs;
        cpu[i] = stats.cpuMs;
        errors[i] = errorOf(image, truth);
        regionErrors(image, truth, &rms[i], &largest[i]);
        vplImage_Destroy(image);
    }
    if (line->method == VPL_METHOD_PATH) {
        printf("path tracing, %4d per pixel                      ", line->amount);
    } else {
        printf("keller %6d, interleaved %2d, %d passes, %s", line->amount, line->interleave, stats.passes,
               line->compensation == VPL_COMPENSATION_RAYS ? "short rays" : "clamped   ");
    }
    printf(" %8.3f %8.3f %8.2f %8.2f %8.2f\n", 1e-3 * medianOf(wall, RUNS), 1e-3 * medianOf(cpu, RUNS),
           100 * medianOf(errors, RUNS), 100 * medianOf(rms, RUNS), 100 * medianOf(largest, RUNS));
    fflush(stdout);
}

int main(int count, char** words)
{
    if (count < 3) {
        fprintf(stderr, "deadline SCENE FOLDER [SIZE [PATHS]]\n");
        return 2;
    }
    const int size = count > 3 ? atoi(words[3]) : 512, spp = count > 4 ? atoi(words[4]) : 512;
    vplContext* context;
    vplScene* scene;
    openScene(words[1], 2, VPL_ISA_AUTO, &context, &scene);
    Truth truth = findTruth(scene, words[1], words[2], size, spp);
    printf("%s, %dx%d, medians of %d seeds                     s    cpu s  error %% region %% largest %%\n",
           words[1], size, size, RUNS);
    for (size_t i = 0; i < sizeof LINES / sizeof *LINES; i++) {
        measure(scene, &truth, &LINES[i], size);
    }
    vplImage_Destroy(truth.halves[0]);
    vplImage_Destroy(truth.halves[1]);
    vplImage_Destroy(truth.mean);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
