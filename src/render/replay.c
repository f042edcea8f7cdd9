// SPDX-License-Identifier: MIT
#include "render/replay.h"

#include <string.h>

vplRenderOptions vplReplayOptions(const vplPlan* p)
{
    vplRenderOptions o = p->options;
    if (p->clampArea > 0) { // each pass has a distance of its own, by the number of its lights
        o.lights.minDistance = -1;
    }
    if (o.lights.shadows == VPL_LIGHT_SHADOWS_RAY &&
        !p->emitterRays) { // ray would replace maps of emitters, too
        o.lights.shadows = VPL_LIGHT_SHADOWS_AUTO;
    }
    if (o.radiosity.placement == VPL_PATCHES_ADAPTIVE &&
        p->linkAbove == VPL_ALL_PAIRS) { // each draft decides anew
        o.radiosity.hierarchy = VPL_HIERARCHY_AUTO;
    }
    o.sequence.history = NULL;
    o.progress = NULL;
    o.progressUser = NULL;
    return o;
}

bool vplReplayText(const vplOption* option, const vplRenderOptions* options, char text[64])
{
    return option->kind != VPL_OPTION_PART &&
           vplRenderOptions_Get(options, option->name, text, 64) == VPL_SUCCESS;
}

void vplReplayList(const vplPlan* plan, vplByteBuffer* text)
{
    const vplRenderOptions replay = vplReplayOptions(plan);
    int count;
    const vplOption* options = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        char value[64];
        if (vplReplayText(&options[i], &replay, value)) {
            vplByteBuffer_Append(text, options[i].name, strlen(options[i].name));
            vplByteBuffer_Append(text, "=", 1);
            vplByteBuffer_Append(text, value, strlen(value));
            vplByteBuffer_Append(text, "\n", 1);
        }
    }
    vplByteBuffer_Append(text, "\n\n\n", (4 - text->size % 4) % 4);
}

bool vplIsStop(const vplOption* option)
{
    const bool grows = strcmp(option->name, "grow-from") == 0; // which light belongs to which pass
    return (strcmp(option->group, "When to stop") == 0 && !grows) || strcmp(option->name, "spp") == 0;
}
