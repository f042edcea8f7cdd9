// SPDX-License-Identifier: MIT
// vpl render: one picture or frames, and the files beside them.
#include "cli/steps.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

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
