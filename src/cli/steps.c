// SPDX-License-Identifier: MIT
// One picture, step by step, so that an interrupted render still has the picture of the passes that were done.
#include "cli/steps.h"

#include <stdio.h>

// Passes that the options ask for; 0 where a time or an error ends them.
static int countPasses(const vplPlan* plan)
{
    const vplRenderOptions* o = &plan->options;
    if (o->method != VPL_METHOD_PATH) {
        return o->stop.passes;
    }
    return o->path.samples < VPL_MAX_SAMPLES ? (o->path.samples + VPL_PATHS_PER_PASS - 1) / VPL_PATHS_PER_PASS
                                             : 0;
}

static vplResult getPicture(vplRenderer* r, bool layers, Picture* picture)
{
    if (picture->passesAsked < 0) {
        return vplRenderer_Finish(r, &picture->image, layers ? &picture->layers : NULL, &picture->stats);
    }
    return layers ? vplRenderer_GetLayers(r, &picture->layers, &picture->stats)
                  : vplRenderer_GetImage(r, &picture->image, &picture->stats);
}

static vplResult stepAll(const Arguments* a, vplRenderer* r, Picture* picture)
{
    const bool layers = vplRenderer_GetPlan(r)->options.output.aovs != 0;
    vplResult result = VPL_SUCCESS;
    int steps = 0;
    for (bool done = false; !done && result == VPL_SUCCESS;) {
        result = vplRenderer_Step(r, &done);
        steps += result == VPL_SUCCESS;
    }
    if (result == VPL_CANCELLED && steps > 0 && !a->noPartial) {
        picture->passesAsked = countPasses(vplRenderer_GetPlan(r));
        result = VPL_SUCCESS;
    }
    return result == VPL_SUCCESS ? getPicture(r, layers, picture) : result;
}

vplResult renderPicture(const Arguments* a, const vplScene* scene, const vplRenderOptions* options,
                        Picture* pictureOut)
{
    vplRenderer* r;
    Picture picture = {.passesAsked = -1};
    TRY(vplRenderer_Create(scene, options, &r));
    const vplResult result = stepAll(a, r, &picture);
    vplRenderer_Destroy(r);
    *pictureOut = picture;
    return result;
}

void freePicture(Picture* picture)
{
    vplImage_Destroy(picture->image);
    vplLayers_Destroy(picture->layers);
}

bool isPartial(const Picture* picture)
{
    return picture->passesAsked >= 0;
}

void sayPartial(const Picture* picture, const char* before, const char* path)
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
    complain("interrupted after %s%s; %s has the picture so far%s", before, passes, path, error);
}
