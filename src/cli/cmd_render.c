// SPDX-License-Identifier: MIT
#include "cli/cli.h"

#include <math.h>
#include <string.h>

static bool isEmpty(const float* pixel)
{
    return pixel[0] == 0 && pixel[1] == 0 && pixel[2] == 0;
}

// PNG shows what is not light: metres from nearest (white) to farthest (dark), normals packed as (n + 1) / 2.
static void prepareForEyes(vplImage* image, vplShow show)
{
    size_t count = 3 * (size_t)image->width * (size_t)image->height;
    float smallest = INFINITY, largest = 0;
    for (size_t i = 0; i < count; i += 3) {
        if (!isEmpty(image->pixels + i)) {
            largest = fmaxf(largest, image->pixels[i]);
            smallest = fminf(smallest, image->pixels[i]);
        }
    }
    float scale = largest > smallest ? 0.9f / (largest - smallest) : 0;
    for (size_t i = 0; i < count; i += 3) {
        float* p = image->pixels + i;
        bool empty = isEmpty(p);
        for (int c = 0; c < 3 && !empty; c++) {
            float code = show == VPL_SHOW_NORMALS ? 0.5f * p[c] + 0.5f : 1 - scale * (p[c] - smallest);
            p[c] = vplSrgb_Decode(code);
        }
    }
}

static bool endsWithPng(const char* path)
{
    size_t n = strlen(path);
    return n >= 4 && (strcmp(path + n - 4, ".png") == 0 || strcmp(path + n - 4, ".PNG") == 0);
}

static int writePicture(const Arguments* a, vplImage* image)
{
    vplShow show = a->render.show;
    bool metres = show == VPL_SHOW_DEPTH || show == VPL_SHOW_SHADOW_MAP;
    vplWriteOptions options = a->write;
    if (!a->tonemapGiven && a->render.method == VPL_METHOD_SSVP) {
        options.tonemap = VPL_TONEMAP_REINHARD;
    }
    if (endsWithPng(a->output) && (metres || show == VPL_SHOW_NORMALS)) {
        prepareForEyes(image, show);
    }
    if (metres || show == VPL_SHOW_NORMALS || show == VPL_SHOW_SHADOW_FACTOR) {
        options = vplDefaultWriteOptions(); // exposure and tone map are for light
    }
    return exitCode(vplImage_Write(image, a->output, &options), false);
}

static int renderScene(const Arguments* a, vplContext* context, const vplScene* scene)
{
    Progress progress = beginProgress(a->quiet);
    vplRenderOptions options = a->render;
    options.progress = showProgress;
    options.progressUser = &progress;
    vplImage* image = NULL;
    vplRenderStats stats;
    vplResult result = vplRender(scene, &options, &image, &stats);
    endProgress(&progress);
    int code = exitCode(result, false);
    if (code != EXIT_DONE) {
        return code;
    }
    if (a->verbose) {
        for (int i = 0; i < stats.stageCount; i++) {
            complain("%-12s %9.2f ms", stats.stages[i].name, stats.stages[i].ms);
        }
        complain("%d virtual lights, %lld draw calls, hash %016llx", stats.virtualLights,
                 (long long)stats.drawCalls, (unsigned long long)stats.imageHash);
        if (stats.clampLoss >= 0) {
            complain("the bound at %g m takes about %.3g %% of the virtual lights' light away",
                     (double)stats.minDistance, 100 * stats.clampLoss);
        }
    }
    code = writePicture(a, image);
    if (code == EXIT_DONE && a->stats != NULL) {
        code = exitCode(writeStats(context, a->stats, &stats), false);
    }
    vplImage_Destroy(image);
    return code;
}

int runRender(const Arguments* a)
{
    if (a->output == NULL) {
        complain("render needs -o FILE, the picture to write");
        return EXIT_USAGE;
    }
    if (!vplImage_CanWrite(a->output)) {
        complain("%s: unknown picture format; the name must end in %s", a->output, vplImage_GetExtensions());
        return EXIT_USAGE;
    }
    if (a->stats != NULL && strcmp(a->output, a->stats) == 0) {
        complain("%s: both the picture and the statistics would be written there", a->output);
        return EXIT_USAGE;
    }
    if (!checkOutput(a->output) || (a->stats != NULL && !checkOutput(a->stats))) {
        return EXIT_COULD_NOT;
    }
    catchInterrupts();
    vplContext* context = openContext(a);
    if (context == NULL) {
        return EXIT_USAGE;
    }
    vplScene* scene = NULL;
    int code = exitCode(vplScene_Load(context, a->positionals[0], &scene), true);
    if (code == EXIT_DONE) {
        code = renderScene(a, context, scene);
    }
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return code;
}
