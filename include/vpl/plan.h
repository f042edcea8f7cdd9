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

// Writes the plan as text, a sentence per decision. Like snprintf, returns the length of the whole text.
size_t vplPlan_Describe(const vplPlan* plan, char* text, size_t size);

// Writes the plan as JSON: the version of the format, the hash of the scene (vplScene_GetHash), every option
// as vplRenderOptions_Get writes it, decisions, stages, what is left out, and estimates.
// vplRenderOptions_Load reads the options back, and they render the same bits with any number of threads,
// instruction set and compiler, as far as no time ends the render; see vplRenderer_WritePlan. Options are
// resolved, as in vplPlan.options, but for three that mean something else as a number or word: min-distance
// stays auto, because each pass has its own; light-shadows stays auto where rays were chosen, because ray
// also replaces shadow maps of emitters; hierarchy stays auto for adaptive patches.
vplResult vplPlan_Write(const vplPlan* plan, const vplScene* scene, const char* path);

// Sets the options that a plan file has; others stay as they are. *sceneHashOut (may be NULL) is the hash of
// the file's scene, to be compared with vplScene_GetHash: with another scene the options are valid, but the
// picture is another. VPL_FILE_ERROR, VPL_OUT_OF_MEMORY, or VPL_PARSE_ERROR with "file:line:column:" in its
// message; then the options are as they were.
vplResult vplRenderOptions_Load(vplContext* context, const char* path, vplRenderOptions* options,
                                uint64_t* sceneHashOut);

VPL_HEADER_END

#endif
