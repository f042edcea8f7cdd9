// SPDX-License-Identifier: MIT
// Measures radiosity with a moving light and unchanged form factors. `bench/radiosity_motion SCENE [WIDTH
// HEIGHT]`; the first light moves a little each frame and jumps between frames 20 and 21. Each frame does one
// sweep, as the document proposes after Burenius.
//   first      ms of the first frame, which makes patches and form factors
//   frame      median ms of the other frames, and the frames per second
//   light      median ms of the emitters' light at patches
//   solve      median ms of the stage solve
//   lag k      RMSE / mean of the indirect picture k frames after the jump, against the converged one
#include "bench.h"

#include <math.h>
#include <string.h>

enum { FRAMES = 32, JUMP = 21 };

static vplScene* scene;
static int width = 640, height = 480;

static void moveLight(void)
{
    const vplEmitterDef* def = vplScene_GetEmitter(scene, 0);
    vplEmitterKey keys[4];
    for (int i = 0; i < 4; i++) {
        static const double frames[4] = {0, JUMP - 1, JUMP, FRAMES};
        static const float at[4] = {-0.1f, 0.1f, -0.5f, -0.5f};
        keys[i] = vplMakeEmitterKey(def, frames[i]);
        keys[i].position = vplAdd(def->position, vplVec(at[i], 0, 0));
    }
    check(vplScene_SetEmitterPath(scene, 0, keys, 4));
}

static double stage(const vplRenderStats* s, const char* name)
{
    double ms = 0;
    for (int i = 0; i < s->stageCount; i++) {
        ms += strcmp(s->stages[i].name, name) == 0 ? s->stages[i].ms : 0;
    }
    return ms;
}

static vplImage* renderFrame(vplHistory* history, int frame, int patches, bool indirect, vplSolver solver,
                             vplRenderStats* stats)
{
    vplRenderOptions o = plainOptions();
    vplImage* image;
    o.method = VPL_METHOD_RADIOSITY;
    o.output.show = indirect ? VPL_SHOW_INDIRECT : VPL_SHOW_PICTURE;
    o.output.width = width;
    o.output.height = height;
    o.radiosity.patches = patches;
    o.sequence.frame = frame;
    o.sequence.history = history;
    o.radiosity.solver = solver;
    o.radiosity.iterations = history != NULL && frame > 0 ? 1 : 1000;
    o.radiosity.residual = history != NULL && frame > 0 ? o.radiosity.residual : 1e-7;
    check(vplRender(scene, &o, &image, stats));
    return image;
}

static void timeFrames(vplContext* context, int patches)
{
    vplHistory* history;
    double total[FRAMES], light[FRAMES], solve[FRAMES];
    vplRenderStats stats;
    check(vplHistory_Create(context, &history));
    for (int f = 0; f < FRAMES; f++) {
        vplImage_Destroy(renderFrame(history, f, patches, false, VPL_SOLVER_GAUSS_SEIDEL, &stats));
        total[f] = stats.totalMs;
        light[f] = stage(&stats, "patch light");
        solve[f] = stage(&stats, "solve");
    }
    vplHistory_Destroy(history);
    const double first = total[0], frame = medianOf(total + 1, JUMP - 1);
    printf("%7d %7d %8.0f %8.1f %6.1f %8.2f %8.2f\n", stats.patches, stats.patchSides, first, frame,
           1000 / frame, medianOf(light + 1, JUMP - 1), medianOf(solve + 1, JUMP - 1));
}

static void lag(vplContext* context, int patches, vplSolver solver)
{
    vplHistory* history;
    vplRenderStats stats;
    vplImage* truth = renderFrame(NULL, JUMP, patches, true, VPL_SOLVER_GAUSS_SEIDEL, &stats);
    check(vplHistory_Create(context, &history));
    printf("%7d %-12s", stats.patches, solver == VPL_SOLVER_JACOBI ? "jacobi" : "gauss-seidel");
    for (int f = 0; f < FRAMES; f++) {
        vplImage* image = renderFrame(history, f, patches, true, solver, &stats);
        vplComparison c;
        check(vplImage_Compare(image, truth, &c));
        if (f >= JUMP - 1 && f < JUMP + 6) {
            printf(" %8.4f", c.relativeRmse);
        }
        vplImage_Destroy(image);
    }
    puts("");
    vplHistory_Destroy(history);
    vplImage_Destroy(truth);
}

int main(int count, char** words)
{
    vplContext* context;
    if (count < 2) {
        fprintf(stderr, "usage: radiosity_motion SCENE [WIDTH HEIGHT]\n");
        return 2;
    }
    if (count > 3) {
        width = atoi(words[2]);
        height = atoi(words[3]);
    }
    openScene(words[1], 0, VPL_ISA_AUTO, &context, &scene);
    moveLight();
    puts("patches   sides    first    frame    fps    light    solve   (ms)");
    timeFrames(context, 784);
    timeFrames(context, 3000);
    puts("patches solver        before     jump        1        2        3        4        5");
    lag(context, 784, VPL_SOLVER_GAUSS_SEIDEL);
    lag(context, 784, VPL_SOLVER_JACOBI);
    lag(context, 3000, VPL_SOLVER_GAUSS_SEIDEL);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
