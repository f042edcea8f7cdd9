// SPDX-License-Identifier: MIT
// The truth that the other methods are judged against: paths from the camera, without bias.
#include "render/plan.h"
#include "render/stages/make.h"

const vplStageId VPL_PATH_RECIPE[] = {VPL_STAGE_GEOMETRY, VPL_STAGE_EMITTER_TREES, VPL_STAGE_PATHS,
                                      VPL_STAGE_COUNT};

vplResult vplDecideLightVertices(vplRunner* r, vplPlan* p)
{
    char why[VPL_PLAN_TEXT];
    if (p->options.path.lightVertices >= 0) {
        return VPL_SUCCESS;
    }
    if (!VPL_STAGES[VPL_STAGE_LIGHT_PATHS].isNeeded(p, why)) {
        p->options.path.lightVertices = 1;
        vplDecide(p, "light-vertices", "%s", why);
        return VPL_SUCCESS;
    }
    TRY(vplFindLightVertices(&r->run));
    p->options.path.lightVertices = vplCountLightVertices(&r->run);
    vplDecide(p, "light-vertices", "%.0f %% of reflected light is found at later vertices of light paths",
              100 * *(const double*)r->run.results[VPL_STAGE_LIGHT_PATHS]);
    return VPL_SUCCESS;
}
