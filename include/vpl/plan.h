// SPDX-License-Identifier: MIT
// The plan of a picture: every decision that was left to the library, every stage that will run, and every
// stage that is left out, each with its reason. Rendering follows the plan and decides nothing itself; vpl
// info, --explain, --dry-run and refusals print it.
#ifndef VPL_PLAN_H
#define VPL_PLAN_H

#include <vpl/options.h>

VPL_HEADER_BEGIN

// Most steps of particles that plans and statistics list.
enum { VPL_MAX_STEPS_REPORTED = 64 };

// A plan, and a machine that another one plans for; plantools.h has their fields.
typedef struct vplPlan vplPlan;
typedef struct vplMachine vplMachine;

// Plans a render. If `machine` is NULL, the scene's context describes it. A picture that cannot be rendered
// has a plan too, whose `problem` says why; VPL_INVALID_ARGUMENT means that an option is out of its range.
vplResult vplPlan_Create(const vplScene* scene, const vplRenderOptions* options, const vplMachine* machine,
                         vplPlan** planOut);

// NULL is allowed.
void vplPlan_Destroy(vplPlan* plan);

// Writes the plan as text, a sentence per decision; stages of 64 KiB and more are named with their memory. Like snprintf, returns the
// length of the whole text.
size_t vplPlan_Describe(const vplPlan* plan, char* text, size_t size);

VPL_HEADER_END

#endif
