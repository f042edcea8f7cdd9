// SPDX-License-Identifier: MIT
// Ways from the picture so far to an error: more passes, lights that fewer pixels share, paths through pixels at edges. Costs are
// counted in rays and not in seconds, so that the same way is chosen on every machine.
#ifndef VPL_RENDER_PLANNER_WAYS_H
#define VPL_RENDER_PLANNER_WAYS_H

#include "render/planner/edge_steps.h"

// A render that goes on is judged again when its noise is 0.8 of what it was, after so many rays more.
#define VPL_LEAST_MORE 0.56

// The error of the picture so far, and its cost. Errors are squared and relative to the picture's mean, costs are counts of rays.
typedef struct vplErrorState {
    double noise, bias; // a bias that may be chance counts for less
    double square;      // the whole estimate of the error, at least the noise
    double spread;      // its standard error
    double spent;       // rays of its passes, which are in packets
    double truth;       // rays of the truth
    double truthPaths;  // through each of its pixels
    double path;        // rays of a path
    double paths;       // squared error of a picture by one ray's worth of paths
    bool once;          // the picture is drawn at once, without noise: radiosity
    int finer; // how often the plan can be made finer: half of the square of pixels that share lights, or more patches
    double finerBias; // what is left of the squared bias after one of them
    double finerCost; // rays over those of this plan
    bool stuck;       // more paths of the truth do not make its spread smaller
} vplErrorState;

// The truth must have been asked.
vplErrorState vplErrorState_Of(const vplRenderer* renderer);

// Passes, of this plan or of a finer one, then paths through pixels at edges, then paths of the
// truth that prove the error.
typedef struct vplWay {
    double rays;   // of all
    int finer;     // how often the plan is made finer for it
    double passes; // over those that are done: 1 is no more
    int pixels, paths;
    double rest; // the squared error of the picture so far beside its edges
} vplWay;

// Rays of paths of the truth until one and a half standard errors are as small as `margin`.
double vplProofOf(const vplErrorState* state, double spread, double margin);

// Paths through pixels at edges until their variance is half of `left`.
double vplPathsForEdges(const vplErrorState* state, const vplEdgeStep* step, double left);

// The variance of pixels at edges with so many paths each.
double vplVarianceOfEdges(const vplErrorState* state, const vplEdgeStep* step, double paths);

// The steps that may be traced: none where edges may not be traced, or were in vain too often.
vplResult vplFindUsefulSteps(vplRenderer* renderer, vplEdgeStep steps[VPL_EDGE_STEPS], int* countOut);

// The way that needs least rays; infinitely many: there is none.
vplResult vplFindWay(vplRenderer* renderer, const vplErrorState* state, double asked, vplWay* wayOut);

// True where the choice of pixels is most of the truth's spread, so that more paths through them do not help.
bool vplPixelsLimitTruth(const vplRenderer* renderer);

// The number of pixels that vplWidenTruth asks for.
int vplCountWiderTruth(const vplRenderer* renderer);

// True if the truth may have so many.
bool vplHasRoomForWiderTruth(const vplRenderer* renderer);

// Pixels at edges are traced. More of their paths, or of the truth, may prove that the error is met; else the picture is as before.
// *moreOut: the picture is to be judged again.
vplResult vplProveEdges(vplRenderer* renderer, const vplErrorState* state, double asked, bool* moreOut);

// Follows a way that needs no more passes: traces its pixels at edges or, if it has none, more paths of the truth, which may prove
// that the error is met.
vplResult vplFinishWay(vplRenderer* renderer, const vplWay* way, bool* moreOut);

// Goes on with another plan, and tells the log that it has `what`. The picture so far is kept until the new plan has one.
vplResult vplGoOnWith(vplRenderer* renderer, const char* what, const vplRenderOptions* options,
                      bool* doneOut);

// Improves the truth if it does not tell the error well enough for a decision: by more paths per pixel, if it has cost less than `paths`
// rays so far; or, if more paths no longer reduce its spread because few pixels have most of the error, by more pixels, if it has cost less
// than `pixels` rays. *moreOut: the truth was improved, and the picture must be judged again.
vplResult vplLearnMore(vplRenderer* renderer, const vplErrorState* state, double asked, double paths,
                       double pixels, bool* moreOut);

// Radiosity has no passes that add up: pixels at edges are traced, or the patches are made smaller, or virtual lights take over.
// (reconsider_patches.c)
vplResult vplReachByPatches(vplRenderer* renderer, const vplErrorState* state, double asked, bool* doneOut,
                            bool* moreOut);

// Go on with path tracing, and with the plan made finer `finer` times. The picture so far is kept until the new plan has one.
vplResult vplGoOnWithPaths(vplRenderer* renderer, bool* doneOut);
vplResult vplGoOnFiner(vplRenderer* renderer, int finer, bool* doneOut);

// Traces pixels at edges where that costs little beside the passes so far, and is likely to prove the error.
vplResult vplTryEdges(vplRenderer* renderer, const vplErrorState* state, double asked, bool* moreOut);

#endif
