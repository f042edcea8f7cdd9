// SPDX-License-Identifier: MIT
// Where a round of adaptive patches wants more of them.
#ifndef VPL_RENDER_STAGES_PATCH_PRIORITY_H
#define VPL_RENDER_STAGES_PATCH_PRIORITY_H

#include "render/stage.h"

// The refinement priority of each patch, from the solution of the run; scratch memory comes from the arena.
vplResult vplFindPriorities(const vplRun* run, vplArena* scratch, float* priorityOut);

#endif
