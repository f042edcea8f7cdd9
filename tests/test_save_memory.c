// SPDX-License-Identifier: MIT
// Renders that are stopped, saved and replayed, with each allocation failing in turn (tests/failing.h).
#include "failing.h"

#include <unistd.h>

static bool goOn(void* user, double fraction)
{
    (void)user;
    return fraction >= 0;
}

static vplRenderOptions smallPaths(void)
{
    vplRenderOptions options = plainOptions();
    options.method = VPL_METHOD_PATH;
    options.output.width = options.output.height = 4;
    options.path.samples = 40;
    return options;
}

// Two passes that could be cancelled, so that sums are copied.
static vplResult tracePasses(Attempt* a)
{
    vplRenderOptions options = smallPaths();
    options.progress = goOn;
    TRY(vplScene_Load(a->context, "tests/data/room.json", &a->scene));
    return vplRender(a->scene, &options, &a->image, NULL);
}

// Variants: path tracing and virtual lights. Removes the file: where memory runs out none may be left.
static vplResult saveAndLoad(Attempt* a)
{
    vplRenderOptions options = smallPaths();
    vplRenderer *first = NULL, *second = NULL;
    bool done;
    options.method = a->variant ? VPL_METHOD_KELLER : VPL_METHOD_PATH;
    options.particles.count = 2;
    options.stop.passes = 2;
    options.shadow.mapSize = 4;
    TRY(vplScene_Load(a->context, "tests/data/room.json", &a->scene));
    vplResult result = vplRenderer_Create(a->scene, &options, &first);
    result = result == VPL_SUCCESS ? vplRenderer_Step(first, &done) : result;
    result = result == VPL_SUCCESS ? vplRenderer_Save(first, a->path) : result;
    result = result == VPL_SUCCESS ? vplRenderer_Create(a->scene, &options, &second) : result;
    result = result == VPL_SUCCESS ? vplRenderer_Load(second, a->path, &done) : result;
    result = result == VPL_SUCCESS ? vplRenderer_GetImage(second, &a->image, NULL) : result;
    unlink(a->path);
    vplRenderer_Destroy(first);
    vplRenderer_Destroy(second);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfSavedRendersIsReported)
{
    failEveryAllocation("SavedRenders", saveAndLoad, "state", 2);
}

static vplResult writeAndReadPlan(Attempt* a)
{
    vplRenderOptions options = smallPaths();
    vplPlan* plan;
    TRY(vplScene_Load(a->context, "tests/data/room.json", &a->scene));
    TRY(vplPlan_Create(a->scene, &options, NULL, &plan));
    vplResult result = vplPlan_Write(plan, a->scene, a->path);
    result = result == VPL_SUCCESS ? vplRenderOptions_Load(a->context, a->path, &options, NULL) : result;
    unlink(a->path);
    vplPlan_Destroy(plan);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfPlanFilesIsReported)
{
    failEveryAllocation("PlanFiles", writeAndReadPlan, "json", 1);
}

TEST_ALONE(EveryFailedAllocationOfPassesThatCanBeCancelledIsReported)
{
    failEveryAllocation("PassesThatCanBeCancelled", tracePasses, "png", 1);
}
