// SPDX-License-Identifier: MIT
// Predicted times: the work of each stage (count_work.c), in the speeds of a machine.
#include "base/context.h"
#include "render/plan.h"
#include "render/stages/make.h"

#include <math.h>
#include <stddef.h>

// Fitted to 1 thread of an AMD EPYC (Zen 4, AVX-512); see README.md, Time.
vplSpeeds vplUsualSpeeds(void)
{
    return (vplSpeeds){.buildTriangle = 700,
                       .drawTriangle = 60,
                       .drawTexel = 4,
                       .drawPixel = 150,
                       .pixelLight = 0.7,
                       .shadowRay = 110,
                       .pathRay = 300,
                       .formFactor = 60};
}

double* vplSpeedAt(vplSpeeds* speeds, int index)
{
    double* const fields[VPL_SPEED_COUNT] = {
        &speeds->buildTriangle, &speeds->drawTriangle, &speeds->drawTexel, &speeds->drawPixel,
        &speeds->pixelLight,    &speeds->shadowRay,    &speeds->pathRay,   &speeds->formFactor};
    return fields[index];
}

double vplTimeOf(const vplSpeeds* speeds, const vplWork* work)
{
    vplSpeeds copy = *speeds;
    double sum = 0;
    for (int i = 0; i < VPL_SPEED_COUNT; i++) {
        sum += work->counts[i] * *vplSpeedAt(&copy, i);
    }
    return 1e-6 * sum;
}

static double countThreads(const vplSpeeds* speeds, int workers)
{
    return speeds->threads > 0 ? fmin(speeds->threads, workers) : 0.1 + 0.9 * workers;
}

double vplTimeOfTree(const vplContext* context, int triangles)
{
    const vplSpeeds speeds = context->speeds != NULL ? *context->speeds : vplUsualSpeeds();
    return 1e-6 * triangles * speeds.buildTriangle / countThreads(&speeds, context->workerCount);
}

// Stages that each pass runs again.
static bool isPerPass(int id)
{
    return id == VPL_STAGE_PARTICLES || id == VPL_STAGE_VIRTUAL_LIGHTS || id == VPL_STAGE_PICTURE ||
           id == VPL_STAGE_PATHS;
}

// Paths are traced in passes of up to 32 per pixel; where a time ends them, the first has one, and where an error does two.
static void sumPaths(vplPlan* p, double before, double all)
{
    const bool open = vplPathsAreOpen(p);
    const double paths = open ? 32 : p->options.path.samples;
    p->passMs = all * fmin(32, paths) / paths;
    p->firstMs = before + (open ? all * (p->options.stop.budgetMs > 0 ? 1 : 2) / paths : p->passMs);
    p->predictedMs = before + all;
}

void vplEstimateTime(vplRunner* r, const vplMachine* machine, vplPlan* p)
{
    const vplContext* context = r->run.context;
    const vplSpeeds* given = machine != NULL ? machine->speeds : context->speeds;
    const vplSpeeds speeds = given != NULL ? *given : vplUsualSpeeds();
    const int workers = machine != NULL ? machine->workerCount : context->workerCount;
    const double threads = countThreads(&speeds, workers);
    vplWork works[VPL_MAX_PLAN_STAGES];
    double once = 0, each = 0;
    p->usualSpeeds = given == NULL;
    vplCountWork(r, p, works);
    for (int i = 0; i < p->stageCount; i++) {
        vplPlanStage* stage = &p->stages[i];
        stage->ms = vplTimeOf(&speeds, &works[i]) / threads;
        *(isPerPass(stage->id) ? &each : &once) += stage->ms;
    }
    if (p->options.method == VPL_METHOD_PATH) {
        sumPaths(p, once, each);
        return;
    }
    p->passMs = each;
    p->firstMs = once + each;
    p->predictedMs =
        once + each * (p->progressive && p->options.stop.passes > 1 ? p->options.stop.passes : 1);
}
