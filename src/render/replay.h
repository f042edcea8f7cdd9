// SPDX-License-Identifier: MIT
// The options that give a plan's picture again, for files.
#ifndef VPL_RENDER_REPLAY_H
#define VPL_RENDER_REPLAY_H

#include "base/file.h"
#include "render/plan.h"

// The options of a plan, resolved but for those whose resolved value would mean something else. They make an
// equal plan.
vplRenderOptions vplReplayOptions(const vplPlan* plan);

// Writes option `name` as text that vplRenderOptions_Set reads. Returns false for a part of another option.
bool vplReplayText(const vplOption* option, const vplRenderOptions* options, char text[64]);

// Appends all options of vplReplayOptions as lines "name=value", with empty lines up to a multiple of 4 bytes.
void vplReplayList(const vplPlan* plan, vplByteBuffer* text);

// True for options that only say when a render ends: passes, spp, budget, max-error, quality.
bool vplIsStop(const vplOption* option);

#endif
