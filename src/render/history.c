// SPDX-License-Identifier: MIT
#include "render/history.h"

#include "scene/scene.h"

vplResult vplHistory_Create(vplContext* context, vplHistory** historyOut)
{
    vplHistory* history = vplAllocZero(context, 1, sizeof *history);
    if (history == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    history->context = context;
    *historyOut = history;
    return VPL_SUCCESS;
}

void vplHistory_Destroy(vplHistory* history)
{
    if (history != NULL) {
        vplContext* context = history->context;
        if (history->ssvp != NULL) {
            history->destroySsvp(history->ssvp);
        }
        if (history->radiosity != NULL) {
            history->destroyRadiosity(history->radiosity);
        }
        vplGeometry_Destroy(history->geometry);
        vplFree(context, history);
    }
}

vplResult vplHistory_Open(vplHistory* history, const vplScene* scene, vplGeometry** geometryOut)
{
    if (history->context != scene->context) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions.history was made with another context than the scene's");
    }
    if (history->sceneStamp != 0 && history->sceneStamp != scene->stamp) {
        return vplFail(
            scene->context, VPL_INVALID_ARGUMENT,
            "vplRenderOptions.history is of another scene, or something was added to the scene since");
    }
    if (history->geometry == NULL) {
        vplResult result = vplGeometry_Create(scene, &history->geometry);
        if (result != VPL_SUCCESS) {
            return result;
        }
        history->sceneStamp = scene->stamp;
    }
    *geometryOut = history->geometry;
    return VPL_SUCCESS;
}
