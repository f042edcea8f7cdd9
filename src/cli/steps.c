// SPDX-License-Identifier: MIT
// One picture, step by step, so that an interrupted render still has the picture of the passes that were
// done.
#include "cli/steps.h"

#include "cli/bench/measure.h"

#include <stdio.h>

static vplResult getPicture(vplRenderer* r, bool layers, Picture* picture)
{
    if (picture->passesAsked < 0) {
        return vplRenderer_Finish(r, &picture->image, layers ? &picture->layers : NULL, &picture->stats);
    }
    return layers ? vplRenderer_GetLayers(r, &picture->layers, &picture->stats)
                  : vplRenderer_GetImage(r, &picture->image, &picture->stats);
}

// ---- the state

// Returns false and complains, before anything is rendered, if a state is to be saved or loaded and the render has none.
static bool hasState(const Arguments* a, const vplRenderer* r)
{
    if (!vplRenderer_HasState(r) && (a->checkpoint != NULL || a->resume != NULL)) {
        complain("--%s: this picture is drawn at once and has no state between passes; it has with --passes, "
                 "--budget or --max-error and virtual lights or --method auto, and by --method path",
                 a->checkpoint != NULL ? "checkpoint" : "resume");
        return false;
    }
    return true;
}

// Saves the state. A failure, which the library tells, does not end the render.
static void saveState(const Arguments* a, vplRenderer* r, Picture* picture)
{
    picture->saved = vplRenderer_Save(r, a->checkpoint) == VPL_SUCCESS;
    picture->unsaved = picture->unsaved || !picture->saved;
}

// ---- steps

// Steps to the end, or until it is interrupted. `done` says whether there is nothing left to do.
static vplResult stepAll(const Arguments* a, vplRenderer* r, bool done, Picture* picture)
{
    const bool layers = vplRenderer_GetPlan(r)->options.output.aovs != 0;
    double lastSaved = wallMs();
    bool saved = false; // the state after the last step that was done
    int savedPasses = 0;
    vplResult result = VPL_SUCCESS;
    while (!done && result == VPL_SUCCESS) {
        result = vplRenderer_Step(r, &done);
        saved = saved && result != VPL_SUCCESS;
        if (a->checkpoint != NULL && !done && result == VPL_SUCCESS &&
            wallMs() - lastSaved >= 1000 * a->checkpointEvery) {
            saveState(a, r, picture);
            lastSaved = wallMs();
            saved = picture->saved;
            savedPasses = vplRenderer_GetPassCount(r);
        }
    }
    const int passes = vplRenderer_GetPassCount(r);
    const bool partial = result == VPL_CANCELLED && passes > 0;
    const bool same = saved && savedPasses == passes; // a step that is cancelled may have added its pass
    if (a->checkpoint != NULL && !same && (result == VPL_SUCCESS || partial)) {
        saveState(a, r, picture);
    }
    if (partial && !a->noPartial) {
        picture->passesAsked = vplRenderer_GetPlan(r)->passes;
        result = VPL_SUCCESS;
    }
    if (result == VPL_SUCCESS && a->errorMap != NULL) {
        result = vplRenderer_GetErrorMap(r, &picture->errorMap);
    }
    result = result == VPL_SUCCESS ? getPicture(r, layers, picture) : result;
    return result == VPL_SUCCESS && a->planOut != NULL ? vplRenderer_WritePlan(r, a->planOut) : result;
}

// -v: each decision that was left to the library, once for all frames.
static void sayDecisions(const Arguments* a, const vplPlan* plan)
{
    const bool first = a->frames[1] < 0 || plan->options.sequence.frame == a->frames[0];
    for (int i = 0; i < plan->decisionCount && a->verbose && first; i++) {
        const vplDecision* d = &plan->decisions[i];
        complain("--%s %s: %s", d->name, d->value, d->why);
    }
}

int renderPicture(const Arguments* a, const vplScene* scene, const vplRenderOptions* options,
                  Picture* pictureOut, vplResult* resultOut)
{
    vplRenderer* r;
    Picture picture = {.passesAsked = -1};
    bool done = false;
    int code = EXIT_DONE;
    *resultOut = vplRenderer_Create(scene, options, &r);
    if (*resultOut != VPL_SUCCESS) {
        return EXIT_DONE;
    }
    sayDecisions(a, vplRenderer_GetPlan(r));
    if (!hasState(a, r)) {
        code = EXIT_USAGE;
    } else if (a->resume != NULL) {
        code = exitCode(vplRenderer_Load(r, a->resume, &done), true);
    }
    *resultOut = code == EXIT_DONE ? stepAll(a, r, done, &picture) : VPL_SUCCESS;
    vplRenderer_Destroy(r);
    *pictureOut = picture;
    return code;
}

void freePicture(Picture* picture)
{
    vplImage_Destroy(picture->image);
    vplLayers_Destroy(picture->layers);
    vplImage_Destroy(picture->errorMap);
}

bool isPartial(const Picture* picture)
{
    return picture->passesAsked >= 0;
}

void sayPartial(const Picture* picture, const char* before, const char* path, const char* checkpoint)
{
    char passes[64], error[64] = "";
    const int done = picture->stats.passes, asked = picture->passesAsked;
    const double relative = picture->stats.relativeErrorEstimate;
    snprintf(passes, sizeof passes,
             asked > 0   ? "%d of %d passes"
             : done == 1 ? "%d pass"
                         : "%d passes",
             done, asked);
    if (relative >= 0) {
        snprintf(error, sizeof error, ", with an estimated error of %.2g %%", 100 * relative);
    }
    complain("interrupted after %s%s; %s has the picture so far%s%s%s", before, passes, path, error,
             checkpoint != NULL ? "; go on with --resume " : "", checkpoint != NULL ? checkpoint : "");
}
