// SPDX-License-Identifier: MIT
// The world-space scene, and how near its surfaces are to each other.
#include "geometry/bvh.h"
#include "render/plan.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

// A ray tree that would take more than this share of the budget is built from groups of triangles.
static const double SHARE_OF_TREE = 0.3;

static vplResult buildTree(const vplRun* run, vplGeometry* g)
{
    const double budget = run->plan->options.stop.budgetMs,
                 ms = vplTimeOfTree(run->context, g->triangleCount);
    return vplGeometry_BuildTree(g, budget > 0 && ms > SHARE_OF_TREE * budget);
}

vplResult vplMakeGeometry(const vplRun* run, void** resultOut)
{
    vplGeometry* geometry = run->before;
    const bool updates = geometry != NULL && vplGeometry_CanUpdate(geometry, run->scene);
    if (!updates) {
        TRY(vplGeometry_CreateForRaster(run->scene, &geometry));
    }
    *resultOut = geometry; // the runner destroys it if what follows fails
    TRY(updates ? vplGeometry_Update(geometry, run->scene) : VPL_SUCCESS);
    return run->plan->castsRays ? buildTree(run, geometry) : VPL_SUCCESS;
}

void vplDestroyGeometry(void* result)
{
    vplGeometry_Destroy(result);
}

void vplReportGeometry(const vplRun* run)
{
    const vplGeometry* g = run->results[VPL_STAGE_GEOMETRY];
    run->stats->triangles = g->triangleCount;
    run->stats->objects = g->objectCount;
}

// The share of directions in which a surface sees something nearer than the distance. Around this share
// squared error times time is flat in rooms; larger shares make smooth parts of Sponza noisy
// (bench/lightcuts, room: 0.16 at 1 m, 0.14 at 1.8 m).
static const double NEAR_SHARE = 0.2;

vplResult vplMakeNearDistance(const vplRun* run, void** resultOut)
{
    float* metres = vplArena_Alloc(run->arena, 1, sizeof *metres);
    TRY(vplArena_Check(run->arena));
    *resultOut = metres;
    return vplFindNearDistance(run->results[VPL_STAGE_GEOMETRY], &run->plan->view, NEAR_SHARE, metres);
}
