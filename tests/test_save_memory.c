// SPDX-License-Identifier: MIT
// Renders that are stopped, saved and replayed, with each allocation failing in turn (tests/failing.h).
#include "failing.h"

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

TEST_ALONE(EveryFailedAllocationOfPassesThatCanBeCancelledIsReported)
{
    failEveryAllocation("PassesThatCanBeCancelled", tracePasses, "png", 1);
}
