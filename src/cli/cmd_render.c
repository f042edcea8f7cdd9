// SPDX-License-Identifier: MIT
#include "cli/steps.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static bool isEmpty(const float* pixel)
{
    return pixel[0] == 0 && pixel[1] == 0 && pixel[2] == 0;
}

// Makes metres and normals visible in a PNG: the nearest is white, the farthest is dark; normals are (n + 1)
// / 2.
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

static bool endsWith(const char* path, const char* extension)
{
    const size_t n = strlen(path), m = strlen(extension);
    return n >= m && strcasecmp(path + n - m, extension) == 0;
}

// ---- exposure and tone map

static bool isMetres(vplShow show)
{
    return show == VPL_SHOW_DEPTH || show == VPL_SHOW_SHADOW_MAP;
}

// Exposure and tone map are not for these.
static bool isNoLight(vplShow show)
{
    return isMetres(show) || show == VPL_SHOW_NORMALS || show == VPL_SHOW_SHADOW_FACTOR;
}

// Pictures of light alone, without marks or outlines. They are exposed and tone mapped by default.
static bool isLight(vplShow show)
{
    return show == VPL_SHOW_PICTURE || show == VPL_SHOW_DIRECT || show == VPL_SHOW_INDIRECT ||
           show == VPL_SHOW_LIGHT || show == VPL_SHOW_BOUNCE || show == VPL_SHOW_GATHER ||
           show == VPL_SHOW_DENOISED || show == VPL_SHOW_PATCH_RADIOSITY;
}

vplWriteOptions chooseDisplay(const Arguments* a)
{
    const vplShow show = a->render.output.show;
    vplWriteOptions display = vplDefaultWriteOptions();
    if (isNoLight(show)) {
        return display;
    }
    if (a->tonemap > 0) {
        display.tonemap = (vplToneMap)(a->tonemap - 1);
    } else if (isLight(show)) {
        const bool reinhard = a->render.preset == VPL_PRESET_SSVP_2020; // as its document has it
        display.tonemap = reinhard ? VPL_TONEMAP_REINHARD : VPL_TONEMAP_AGX;
    }
    if (isLight(show) || isGiven(a, "exposure")) {
        display.exposure = (float)a->exposure;
    }
    if (display.exposure == VPL_EXPOSURE_AUTO && display.tonemap == VPL_TONEMAP_REINHARD) {
        display.exposure = 0;
    }
    return display;
}

void warnOfDisplay(const Arguments* a)
{
    static const char* const NAMES[] = {"exposure", "tonemap"};
    for (int i = 0; i < 2 && !a->quiet; i++) {
        if (!isGiven(a, NAMES[i])) {
            continue;
        }
        if (!endsWith(a->output, ".png")) {
            complain("warning: --%s has no effect on %s, which holds linear values", NAMES[i], a->output);
        } else if (isNoLight(a->render.output.show)) {
            complain("warning: --%s has no effect with a --show that is not light", NAMES[i]);
        } else if (i == 0 && a->tonemap == 1 + VPL_TONEMAP_REINHARD) {
            complain("warning: --exposure has no effect with --tonemap reinhard, which has its own key");
        }
    }
}

static int writeToStdout(const vplImage* image, const char* path, const vplWriteOptions* display)
{
    uint8_t* bytes;
    size_t size;
    const int code = exitCode(vplImage_Encode(image, path, display, &bytes, &size), false);
    if (code == EXIT_DONE) {
        fwrite(bytes, 1, size, stdout); // finishOutput reports what fails
        vplBytes_Free(image->context, bytes);
    }
    return code;
}

int preparePicture(const Arguments* a, vplImage* image, const char* path, vplWriteOptions* display)
{
    const vplShow show = a->render.output.show;
    const bool png = endsWith(path, ".png");
    if (png && (isMetres(show) || show == VPL_SHOW_NORMALS)) {
        prepareForEyes(image, show);
    }
    if (png && display->exposure == VPL_EXPOSURE_AUTO) {
        const int code = exitCode(vplImage_AutoExposure(image, &display->exposure), false);
        if (code != EXIT_DONE) {
            return code;
        }
    }
    if (png && a->verbose && !isNoLight(show)) {
        const bool automatic = chooseDisplay(a).exposure == VPL_EXPOSURE_AUTO;
        complain("exposure %+.2f stops%s", (double)display->exposure, automatic ? " (auto)" : "");
    }
    return EXIT_DONE;
}

static int writePicture(const Arguments* a, vplImage* image, const char* path, vplWriteOptions* display)
{
    const int code = preparePicture(a, image, path, display);
    if (code != EXIT_DONE) {
        return code;
    }
    return isStdout(path) ? writeToStdout(image, path, display)
                          : exitCode(vplImage_Write(image, path, display), false);
}

int writeWholePicture(const Arguments* a, vplImage* image)
{
    vplWriteOptions display = chooseDisplay(a);
    warnOfDisplay(a);
    return writePicture(a, image, a->output, &display);
}

int writeLayers(const vplLayers* layers, const char* path)
{
    return exitCode(vplImage_WriteLayers(layers->layers, layers->count, path), false);
}

// ---- frames

static void sayMore(const vplRenderStats* stats)
{
    for (int i = 0; i < stats->stageCount; i++) {
        complain("%-12s %9.2f ms", stats->stages[i].name, stats->stages[i].ms);
    }
    complain("%d virtual lights, %lld draw calls, hash %016llx", stats->virtualLights,
             (long long)stats->drawCalls, (unsigned long long)stats->imageHash);
    if (stats->relativeErrorEstimate >= 0 && stats->relativeBias >= 0) {
        char bound[64] = "";
        if (stats->relativeErrorBound >= 0) {
            snprintf(bound, sizeof bound, ", in nineteen of twenty pictures below %.3g %%",
                     100 * stats->relativeErrorBound);
        }
        complain("error about %.3g %%%s: noise %.3g %%, and edges, blur and light left out %.3g %%",
                 100 * stats->relativeErrorEstimate, bound, 100 * fmax(0, stats->relativeNoise),
                 100 * stats->relativeBias);
    }
    if (stats->clampLoss >= 0) {
        complain("the clamp at %g m takes about %.3g %% of the virtual lights' light away",
                 (double)stats->minDistance, 100 * stats->clampLoss);
    }
}

// The files of one frame.
typedef struct Files {
    char output[PATH_MAX], stats[PATH_MAX]; // stats is empty without --stats
} Files;

// Returns false if a name is too long.
static bool nameFiles(const Arguments* a, int frame, Files* files)
{
    const int last = a->frames[1];
    files->stats[0] = 0;
    return numberName(a->output, frame, last, files->output, PATH_MAX) &&
           (a->stats == NULL || numberName(a->stats, frame, last, files->stats, PATH_MAX));
}

// The progress bar and the exposure are those of all frames.
typedef struct Sequence {
    Progress progress;
    int done, count;
    vplWriteOptions display;
} Sequence;

static bool showSequence(void* user, double fraction)
{
    Sequence* s = user;
    return showProgress(&s->progress, (s->done + fraction) / s->count);
}

static int writeFrame(const Arguments* a, const vplScene* scene, const Picture* picture, const Files* files,
                      vplWriteOptions* display)
{
    int code = picture->layers != NULL ? writeLayers(picture->layers, files->output)
                                       : writePicture(a, picture->image, files->output, display);
    if (code == EXIT_DONE && picture->errorMap != NULL) {
        code = exitCode(vplImage_Write(picture->errorMap, a->errorMap, NULL), false);
    }
    if (code == EXIT_DONE && a->stats != NULL) {
        code = writeStats(vplScene_GetContext(scene), files->stats, &picture->stats);
    }
    return code;
}

static int renderFrame(const Arguments* a, const vplScene* scene, const vplRenderOptions* options)
{
    Picture picture = {.image = NULL};
    Files files;
    char before[64] = "";
    nameFiles(a, (int)options->sequence.frame, &files); // runRender has checked their lengths
    Sequence* sequence = options->progressUser;
    vplResult result;
    int code = renderPicture(a, scene, options, &picture, &result);
    endProgress(&sequence->progress);
    if (code != EXIT_DONE) {
        return code;
    }
    if (result == VPL_CANCELLED && sequence->done > 0) {
        complain("cancelled, %d of %d frames were written", sequence->done, sequence->count);
        return EXIT_COULD_NOT;
    }
    if (result == VPL_CANCELLED && picture.saved) {
        complain("interrupted, no picture was written; go on with --resume %s", a->checkpoint);
        return EXIT_COULD_NOT;
    }
    code = exitCode(result, false);
    if (code != EXIT_DONE) {
        return code;
    }
    if (a->verbose) {
        sayMore(&picture.stats);
    }
    code = writeFrame(a, scene, &picture, &files, &sequence->display);
    if (code == EXIT_DONE && isPartial(&picture)) {
        if (sequence->count > 1) {
            snprintf(before, sizeof before, "%d of %d frames and ", sequence->done, sequence->count);
        }
        sayPartial(&picture, before, files.output, picture.saved ? a->checkpoint : NULL);
        code = EXIT_COULD_NOT;
    }
    freePicture(&picture);
    return picture.unsaved ? EXIT_COULD_NOT : code;
}

static int renderScene(const Arguments* a, vplScene* scene)
{
    catchInterrupts();
    Sequence sequence = {beginProgress(a->quiet), 0, 1, chooseDisplay(a)};
    vplRenderOptions options = a->render;
    options.progress = showSequence;
    options.progressUser = &sequence;
    if (a->frames[1] < 0) {
        return renderFrame(a, scene, &options);
    }
    int code = exitCode(vplHistory_Create(vplScene_GetContext(scene), &options.sequence.history), false);
    sequence.count = a->frames[1] - a->frames[0] + 1;
    for (; code == EXIT_DONE && sequence.done < sequence.count; sequence.done++) {
        options.sequence.frame = a->frames[0] + sequence.done;
        if (a->verbose) {
            complain("frame %d", a->frames[0] + sequence.done);
        }
        code = exitCode(vplScene_SetFrame(scene, options.sequence.frame), false);
        code = code == EXIT_DONE ? renderFrame(a, scene, &options) : code;
    }
    vplHistory_Destroy(options.sequence.history);
    return code;
}

bool checkPictureName(const Arguments* a)
{
    const bool layers = a->render.output.aovs != 0;
    if (!vplImage_CanWrite(a->output)) {
        complain("%s: unknown picture format; the name must end in %s", a->output, vplImage_GetExtensions());
        return false;
    }
    if (layers && !endsWith(a->output, ".exr")) {
        complain("%s: --aov writes layers into .exr files only", a->output);
        return false;
    }
    if (isStdout(a->output) && (a->frames[1] >= 0 || layers)) {
        complain("-o %s: standard output takes one picture without layers", a->output);
        return false;
    }
    return true;
}

// Checks that every file has a name of its own, and that files of one picture are not asked for of several.
static bool checkFiles(const Arguments* a)
{
    const struct {
        const char *path, *option, *what;
    } files[] = {{a->output, "-o", "the picture"},
                 {a->stats, "--stats", "the statistics"},
                 {a->errorMap, "--error-map", "the map of errors"},
                 {a->planOut, "--plan-out", "the plan"},
                 {a->checkpoint, "--checkpoint", "the state"},
                 {a->resume, "--resume", "the state"}};
    const int count = sizeof files / sizeof *files;
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < i && files[i].path != NULL && i < count - 1;
             k++) { // a state may replace the one before
            if (files[k].path != NULL && strcmp(files[k].path, files[i].path) == 0) {
                complain("%s: both %s and %s would be written there", files[k].path, files[k].what,
                         files[i].what);
                return false;
            }
        }
        if (i > 0 && files[i].path != NULL && isStdout(files[i].path)) {
            complain("%s %s: only -o writes to standard output", files[i].option, files[i].path);
            return false;
        }
        if (i >= 2 && files[i].path != NULL && a->frames[1] >= 0) {
            complain("%s is for one picture, not for --frames", files[i].option);
            return false;
        }
    }
    return true;
}

int runRender(const Arguments* a)
{
    if (a->dryRun) {
        return runOnScene(a, renderScene);
    }
    if (a->output == NULL) {
        complain("render needs -o FILE, the picture to write");
        return EXIT_USAGE;
    }
    if (a->tile[1] > 0) {
        return !checkTile(a)             ? EXIT_USAGE
               : !checkOutput(a->output) ? EXIT_COULD_NOT
                                         : runOnScene(a, renderTile);
    }
    if (!checkPictureName(a)) {
        return EXIT_USAGE;
    }
    if (a->errorMap != NULL && !vplImage_CanWrite(a->errorMap)) {
        complain("%s: unknown picture format; the name must end in %s", a->errorMap,
                 vplImage_GetExtensions());
        return EXIT_USAGE;
    }
    if (!checkFiles(a)) {
        return EXIT_USAGE;
    }
    Files files; // of the first frame; the names of the others differ in digits only
    const bool named = nameFiles(a, a->frames[0], &files);
    if (!named) {
        complain("%s: the name is too long", a->output);
    }
    if (!named || !checkOutput(files.output) || (a->stats != NULL && !checkOutput(files.stats)) ||
        (a->planOut != NULL && !checkOutput(a->planOut)) ||
        (a->errorMap != NULL && !checkOutput(a->errorMap)) ||
        (a->checkpoint != NULL && !checkOutput(a->checkpoint))) {
        return EXIT_COULD_NOT;
    }
    warnOfDisplay(a);
    return runOnScene(a, renderScene);
}
