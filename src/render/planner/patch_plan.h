// SPDX-License-Identifier: MIT
// Radiosity for an error that is asked for: light that patches exchange has no noise, so that in rooms of few triangles some hundred
// patches and paths through the pixels at edges leave less error than virtual lights do in the same time.
#ifndef VPL_RENDER_PLANNER_PATCH_PLAN_H
#define VPL_RENDER_PLANNER_PATCH_PLAN_H

#include "render/plan.h"

// True if the options leave the choice between radiosity and virtual lights. If options of radiosity are set, as --patches is, they stay
// as they are.
bool vplMayChoosePatches(const vplRenderOptions* options);

// Chooses radiosity, with as many patches as are likely to be enough for the error, where that suits the scene, the picture and the
// options. Returns true if it is chosen.
bool vplChoosePatches(const vplRunner* runner, vplPlan* plan);

// Patches of a first try instead of virtual lights or paths.
#define VPL_FIRST_PATCHES 1000

// The least that are chosen.
#define VPL_FEWEST_PATCHES 450

// The least rays per pixel that are chosen for a gather.
#define VPL_FEWEST_GATHER 4

// If pixels gather the light of patches, the next try has so many times the rays.
#define VPL_MORE_GATHER 2

// The planner tries patches once, if the first try and the passes that it discards cost at most this share of the rays that virtual
// lights or paths are foreseen to need. The share is small, because patches do not reach the error where little light finds its way.
#define VPL_SHARE_OF_PATCHES (1.0 / 3)

// True if VPL_FIRST_PATCHES suit the scene and the options that were asked for, and are foreseen to cost at most as much as `rays` rays.
bool vplMayTryPatches(const vplRunner* runner, const vplPlan* plan, const vplRenderOptions* asked,
                      double rays);

// The caller's options, with what the planner has chosen for the virtual lights of the plan.
vplRenderOptions vplAskedLikePlan(const vplRenderer* renderer);

// The caller's options for radiosity with so many patches. `gather`: rays from each pixel, negative for auto.
vplRenderOptions vplAskedWithPatches(const vplRenderer* renderer, int patches, int gather);

// The caller's options for virtual lights: with rays that compensate the clamp, which virtual lights have by default, and with which
// --method auto does not choose radiosity.
vplRenderOptions vplAskedOfLights(const vplRenderer* renderer);

// True if patches are likely to leave less error in a given time than virtual lights: in plain scenes, and where doors hide most lights
// from the picture; and if the fewest of them are foreseen to cost at most as much as `rays` rays. *gatherOut: rays of their gather.
bool vplPatchesSuitTime(const vplRunner* runner, const vplPlan* plan, const vplRenderOptions* asked,
                        double rays, int* gatherOut);

// Counts rays of patches that were in vain: they and those that follow get no more than virtual lights were foreseen to need.
void vplCountVainPatches(vplRenderer* renderer, double rays);

// Rays that virtual lights are foreseen to need for the error that was asked for, if few of them reach the picture; else 0.
double vplForeseenLightRays(const vplPlan* plan);

// A next try has so many times the patches. Their error beside edges, squared, falls by as much, and form factors take about n^1.5
// rays (room-area, cornell-area, cornell-spot: n^1.4 to n^1.9 from 1,000 to 4,000).
#define VPL_MORE_PATCHES      3
#define VPL_MORE_PATCHES_COST 5.2

// The most patches that are tried: their form factors take at most a third of the memory that form factors may take, or
// that the context may.
double vplMostPatches(const vplContext* context);

#endif
