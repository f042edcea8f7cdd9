// SPDX-License-Identifier: MIT
// Measures what patches gain that guide paths: variance times time with the guide over that without, for pixels all over a picture.
// `bench/guide SCENE PATCHES PATHS [FORM_SAMPLES]`: paths per pixel.
#include "base/arena.h"
#include "cli/bench/measure.h"
#include "render/renderer.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 96, HEIGHT = 54, STEP = 3 };

typedef struct Measured {
    double variance, ms, mean;
} Measured;

static vplResult trace(const vplRun* run, const vplPathGuide* guide, int paths, Measured* out)
{
    static vplSparsePixel pixels[WIDTH * HEIGHT / STEP / STEP];
    int count = 0;
    for (int i = 0; i < WIDTH / STEP * (HEIGHT / STEP); i++) {
        pixels[count++] = (vplSparsePixel){.x = i % (WIDTH / STEP) * STEP + STEP / 2,
                                           .y = i / (WIDTH / STEP) * STEP + STEP / 2};
    }
    vplPathDef def = vplDescribePaths(run, VPL_SHOW_PICTURE);
    def.lastBounce = def.mostBounces = VPL_MAX_BOUNCES;
    def.guide = guide;
    vplSparsePaths sparse;
    TRY(vplSparsePaths_Init(&sparse, run->results[VPL_STAGE_GEOMETRY], &def, pixels, count));
    const double start = cpuMs();
    const vplResult result = vplSparsePaths_Trace(&sparse, paths / 2, (vplProgressRange){NULL, NULL, 0, 1});
    *out = (Measured){.ms = cpuMs() - start};
    for (int i = 0; i < count; i++) {
        const vplSparsePixel* p = &pixels[i];
        out->variance += vplSparsePixel_Variance(p, paths / 2) / count;
        out->mean +=
            (p->sums[0].r + p->sums[0].g + p->sums[0].b + p->sums[1].r + p->sums[1].g + p->sums[1].b) /
            (3.0 * paths * count);
    }
    vplSparsePaths_Free(&sparse);
    return result;
}

static vplResult measure(vplRenderer* r, int paths)
{
    bool done;
    Measured plain, guided;
    TRY(vplRenderer_Step(r, &done));
    vplRun* run = &r->runner.run;
    vplArena* arena = vplArena_Create(run->context);
    const vplPathGuide* guide;
    TRY(vplMakePathGuide(run, arena, &guide));
    if (guide == NULL) {
        printf("links give no guide\n");
        vplArena_Destroy(arena);
        return VPL_SUCCESS;
    }
    TRY(vplFindLightVertices(run));
    TRY(trace(run, NULL, paths, &plain));
    TRY(trace(run, guide, paths, &guided));

    printf(
        "without: mean %.5g, variance %.3g, %.0f ms; with: %.5g, %.3g, %.0f ms; variance times time %.3g\n",
        plain.mean, plain.variance, plain.ms, guided.mean, guided.variance, guided.ms,
        guided.variance * guided.ms / (plain.variance * plain.ms));
    vplArena_Destroy(arena);
    return VPL_SUCCESS;
}

int main(int argc, char** argv)
{
    vplContext* context = NULL;
    vplScene* scene = NULL;
    vplRenderer* renderer = NULL;
    if (argc < 4) {
        fprintf(stderr, "usage: bench/guide SCENE PATCHES PATHS [FORM_SAMPLES]\n");
        return 2;
    }
    vplRenderOptions o = vplDefaultRenderOptions();
    o.method = VPL_METHOD_RADIOSITY;
    o.radiosity.patches = atoi(argv[2]);
    o.radiosity.formSamples = argc > 4 ? atoi(argv[4]) : o.radiosity.formSamples;
    o.radiosity.gather = 0;
    o.output.width = WIDTH;
    o.output.height = HEIGHT;
    vplResult result = vplContext_Create(NULL, &context);
    result = result == VPL_SUCCESS ? vplScene_Load(context, argv[1], &scene) : result;
    result = result == VPL_SUCCESS ? vplRenderer_Create(scene, &o, &renderer) : result;
    result = result == VPL_SUCCESS ? measure(renderer, atoi(argv[3])) : result;
    if (result != VPL_SUCCESS) {
        fprintf(stderr, "%s\n", vplContext_GetLastMessage(context));
    }
    vplRenderer_Destroy(renderer);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return result == VPL_SUCCESS ? 0 : 1;
}
