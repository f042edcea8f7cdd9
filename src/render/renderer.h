// SPDX-License-Identifier: MIT
// The state of a render between its steps.
#ifndef VPL_RENDER_RENDERER_H
#define VPL_RENDER_RENDERER_H

#include "base/clock.h"
#include "render/plan.h"
#include "render/planner/edges.h"
#include "render/planner/truth.h"

// The time of a ray of a path, with all that is computed for it, over that of a ray of a pass with virtual lights (room,
// hall, sibenik, bunny, boxes: 1.5, 1.8, 1.7, 1.4, 1.2). It is a number and not measured, so that the same plans are
// chosen on every machine.
#define VPL_PATH_RAY 1.6

// The same where patches guide the path (flat, six-rooms, corridor, 3,000 patches: 1.4 to 1.8 times the time).
#define VPL_GUIDED_RAY (1.6 * VPL_PATH_RAY)

// A picture of an earlier plan, which is shown as long as the plan under way has none that is better.
typedef struct vplKeptPicture {
    vplImage* image; // NULL: there is none
    vplPlan* plan;
    int passes, paths;
    int edgePixels, edgePaths; // as of vplRenderer
    double error;              // relative, noise and bias; negative: unknown
} vplKeptPicture;

// Relative errors of the picture; negative where they are unknown.
typedef struct vplErrorParts {
    double noise; // differs from pass to pass, and falls as they add up
    double total;
    double bound; // the error is below it in nineteen of twenty pictures
} vplErrorParts;

// The alternative that the planner gave up when it began path tracing or tried patches.
typedef struct vplTurn {
    // Rays that virtual lights would have needed instead of path tracing. While patches are tried: rays that path tracing is foreseen to
    // need if it follows the patches; 0 if virtual lights follow.
    double rays;
    // Squared relative error of path tracing times its rays: as foreseen, then as measured; 0: path tracing was not begun, and no patches that
    // guided paths were given up.
    double pathSquare;
    int side; // of the square of pixels that share virtual lights; 0: there is no alternative
} vplTurn;

struct vplRenderer {
    vplRunner runner;
    vplRenderOptions asked; // by the caller
    uint64_t stamp;         // of the scene when the render began
    vplCameraDef view;      // a copy of the caller's, to which asked.view points
    vplPlan* plan;          // under way
    bool coarse;            // its picture only serves until a better plan has one
    bool replanned;         // its options are not `asked`
    vplImage* base;         // all of the picture; direct light alone where passes add the rest
    // The sums over passes of w x and of w x^2, where x is a pass's picture and w its share of --particles; NULL without
    // passes.
    double* sums[2];
    double weight; // sum of w
    // Layers: direct light alone, or where passes add up, the sum of what their lights on area lights send,
    // which `base` lacks; NULL: there is none.
    vplImage* direct;
    int done;                  // passes
    int paths;                 // path tracing: per pixel so far
    vplEdges* edges;           // pixels that are path-traced; NULL: none
    int edgePixels, edgePaths; // what they were made with, as of vplPathOptions; 0: there are none
    int edgeTries;             // with the passes so far, that left more error than was asked for
    double
        coarserSquare; // squared error beside edges of the plan before, which had fewer patches; 0: there was none
    // The budget of patches, in rays: what virtual lights or paths were foreseen to need, minus what earlier patches cost in vain. 0:
    // patches were not tried; at least 1 afterwards.
    double lightRays;
    bool stale;             // results of stages are not those of the last pass
    double start, cpuStart; // ms
    double planStart;       // ms, of the plan under way
    double planRays;        // of all plans before it
    double passMs;          // of all its passes
    double baseMs, lastMs;  // of its last pass: time of direct light, and the rest
    double deadline;        // ms; infinite: none
    double pace;            // the time of the coarse picture over that foreseen for it; 1: unknown
    double
        closingMs; // the last part of the time, which is for pixels at edges; 0: there is none, negative: not known yet
    bool late;      // the deadline has ended a step
    double watched; // ms, when progress was last reported
    double gap;     // ms, longest time between two reports: so much later a pass may end that is cancelled
    vplKeptPicture kept;
    bool
        showsKept; // the kept picture was given to the caller, because it is better than that of the plan under way
    vplTruth* truth;     // NULL: not asked yet
    vplJudgement judged; // of the last picture that the truth was asked about
    bool guided;         // patches guided the truth's paths then
    vplErrorParts error; // of the picture of all passes so far
    vplTurn turn;        // where path tracing was begun
    int64_t otherRays;   // of traced edges and replaced truths; from 0 where a state is loaded
    double judgedNoise;  // noise when the truth was asked last
    double spreadBefore; // of the truth, before it was refined after the last pass; infinite: it was not
    bool unreviewed;     // the last pass is part of the picture, but vplReview was cancelled after it
    char ended[VPL_PLAN_TEXT]; // why the error that was asked for was not reached; empty: it was, or none was
};

// Replaces the plan under way by one for other options; its picture begins anew. `coarse` as above. After a failure the
// plan under way goes on.
vplResult vplRenderer_Plan(vplRenderer* renderer, const vplRenderOptions* options, bool coarse);

// The same, but keeps the picture so far, with its error (negative: unknown), until the new plan has one.
vplResult vplRenderer_Replace(vplRenderer* renderer, const vplRenderOptions* options, bool coarse,
                              double error);

// The context of a renderer; NULL for NULL.
static inline vplContext* vplRenderer_ContextOf(const vplRenderer* renderer)
{
    return renderer != NULL ? renderer->runner.run.context : NULL;
}

// Identifies what is rendered: the scene, and the caller's camera where there is one.
uint64_t vplRenderer_HashScene(const vplRenderer* renderer);

// The hash of all options of the plan, which pieces carry (pieces.c). VPL_OUT_OF_MEMORY.
vplResult vplRenderer_HashOptions(const vplRenderer* renderer, uint64_t* hashOut);

// True if layers need the direct light of each pass alone. False also if it is the same in all passes: then it is the base.
bool vplPassesSplitLight(const vplPlan* plan);

// Draws direct light alone, for layers. If there are several passes, it is the part that this pass adds. The pass must have been
// drawn.
vplResult vplRenderer_DrawDirect(vplRenderer* renderer, vplImage** imageOut);

// Makes sums of passes, all 0.
vplResult vplRenderer_OpenSums(vplRenderer* renderer);

// Traces pixels at edges of the picture of all passes so far. If as many pixels are traced already, their paths stay and further ones
// follow, which are none if it fails or is cancelled; other pixels replace those that are traced. The next pass forgets all.
vplResult vplRenderer_TraceEdges(vplRenderer* renderer, int pixels, int paths);

void vplRenderer_ForgetEdges(vplRenderer* renderer);

// Draws the next pass and adds it to the sums, or the whole picture where that is drawn at once. It is not counted yet.
vplResult vplRenderer_RunPass(vplRenderer* renderer);

// Makes the picture of all passes so far of the plan under way.
vplResult vplRenderer_Resolve(vplRenderer* renderer, vplImage** imageOut);

// Makes patches and their light again, which guide paths, where the planning of another plan was cancelled or the render was loaded since the
// last pass.
vplResult vplRenderer_RefreshPatches(vplRenderer* renderer);

// True if there is a picture that can be shown.
bool vplRenderer_HasPicture(const vplRenderer* renderer);

// The plan of the picture that callers get, its passes and its paths per pixel.
typedef struct vplShown {
    const vplPlan* plan;
    int passes, paths; // 0: there is no picture yet
    int edgePixels, edgePaths;
} vplShown;

vplShown vplRenderer_Shown(const vplRenderer* renderer);

// Compares the picture with the truth, which must be there, and fills in the renderer's error.
void vplJudgePicture(vplRenderer* renderer, const vplImage* picture);

// Compares the picture with the truth; traces more of it until the error is clear, or a third of `ms` is over. `plansAgain`: the next
// plan depends on it, so that a few paths are not enough.
vplResult vplJudge(vplRenderer* renderer, double asked, bool plansAgain, double ms);

// Traces this share of as many paths of the truth again as there are, and keeps the spread that it had.
vplResult vplRefineTruth(vplRenderer* renderer, double share);

// Replaces the truth by one of about VPL_WIDER_TRUTH times as many pixels, and at least as many paths in all: where rare paths carry
// light, the first paths alone confirmed errors that were too large (hall at 20 %: three of eleven pictures had up to 21.6 %).
#define VPL_WIDER_TRUTH 4
vplResult vplWidenTruth(vplRenderer* renderer);

// Forgets the truth, but not that its rays were cast. The next judgement makes another one.
void vplForgetTruth(vplRenderer* renderer);

// After the truth was asked: goes on with another plan where that promises the error in less time, and ends a render that more passes do not improve.
// *moreOut: the truth is better known now, or pixels at edges are traced, so that the picture is to be judged again.
vplResult vplReconsider(vplRenderer* renderer, double asked, bool* doneOut, bool* moreOut);

// Decides after the first pass, from which noise and bias cannot be told apart. Traces pixels at edges if that costs little compared
// with the pass and is likely to prove the error that was asked for, or goes on with patches if they may need far fewer rays.
vplResult vplReconsiderEarly(vplRenderer* renderer, double asked, bool* doneOut, bool* moreOut);

// After a pass of path tracing that --method auto has chosen for an error: goes back to virtual lights where the noise of the
// paths says that they need more rays.
vplResult vplTurnBack(vplRenderer* renderer, double asked, bool* doneOut);

// Replaces a plan of patches that would take too long, before it has a picture: by a plan with this share of its patches or, if these
// are hardly more than the plan before had, by virtual lights, whose passes are short.
vplResult vplFitPatches(vplRenderer* renderer, double share);

// True if the options' count of passes or paths is reached.
bool vplIsComplete(const vplRenderer* renderer);

// Rays that the plan under way has cast so far.
static inline double vplRaysOfPlan(const vplRenderer* r)
{
    return (double)r->runner.stats.rays - r->planRays;
}

// Milliseconds until the deadline.
static inline double vplTimeLeft(const vplRenderer* r)
{
    return r->deadline - vplClockMs();
}

// After a pass: decides whether the render is done, goes on, or goes on with another plan.
vplResult vplReview(vplRenderer* renderer, bool* doneOut);

// Makes the first plan, which is coarse where another would not have a picture soon enough.
vplResult vplRenderer_PlanFirst(vplRenderer* renderer);

// Paths per pixel of the next pass of path tracing.
int vplNextPaths(const vplRenderer* renderer);

// Fills in the statistics of the whole render so far. `image` may be NULL.
void vplRenderer_FinishStats(vplRenderer* renderer, const vplImage* image, vplRenderStats* statsOut);

#endif
