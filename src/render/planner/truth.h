// SPDX-License-Identifier: MIT
// A picture's error against the truth, from a few hundred path-traced pixels of it.
#ifndef VPL_RENDER_PLANNER_TRUTH_H
#define VPL_RENDER_PLANNER_TRUTH_H

#include "render/planner/edges.h"

typedef struct vplTruth vplTruth;

// An estimate of the mean square error of a picture, over its red, green and blue values.
typedef struct vplJudgement {
    double square;       // without bias; may be negative where the error is small
    double spread;       // standard error of `square`
    double mean;         // of the true picture
    double pathVariance; // of a picture with one path per pixel; divide by the number of paths
    double pathRays;     // rays of a path
    int64_t rays;        // cast for the truth, so far
} vplJudgement;

// Numbers of pixels: usually, for pictures whose error is in few pixels, and at most.
enum { VPL_TRUTH_PIXELS = 512, VPL_MANY_TRUTH_PIXELS = 1024, VPL_MOST_TRUTH_PIXELS = 8192 };

// The number of paths through each pixel that vplTruth_Create traces.
enum { VPL_FIRST_TRUTH_PATHS = 8 };

// Chooses `count` pixels of the picture, or all if it has fewer, and traces the first paths through them. Pixels that differ much from
// their neighbours, as at edges, are chosen with a higher probability and have a smaller weight. The run's geometry must outlive it.
vplResult vplTruth_Create(const vplRun* run, const vplImage* picture, int count, vplTruth** truthOut);

// NULL is allowed.
void vplTruth_Destroy(vplTruth* truth);

// The chosen pixels with their paths so far, for saving them. A truth that is made from them goes on to the same bits.
typedef struct vplTruthState {
    struct vplSparsePixel* pixels;
    double* weights;
    int count;
    int each; // paths of each half of a pixel
} vplTruthState;

vplTruthState vplTruth_GetState(const vplTruth* truth);

// A truth of `count` pixels for a picture of the run's plan, all 0 and to be filled in; vplTruth_SetPaths ends that.
vplResult vplTruth_Open(const vplRun* run, int count, vplTruth** truthOut);
void vplTruth_SetPaths(vplTruth* truth, int each);

// True if patches guide its paths as long as the run's plan has form factors of all pairs of them. The results of its stages must be there.
bool vplTruth_IsGuided(const vplRun* run, const vplTruth* truth);

// Traces `share` times as many paths as there are so far, in addition to these; at least two through each pixel.
vplResult vplTruth_Refine(const vplRun* run, vplTruth* truth, double share);

// Paths per chosen pixel so far. With few of them the error and its spread are uncertain where rare paths carry light.
enum { VPL_SURE_PATHS = 64 };

int vplTruth_Paths(const vplTruth* truth);

// Rays that were cast since the truth was made or loaded. NULL: 0.
int64_t vplTruth_Rays(const vplTruth* truth);

// A pixel of the truth, for a picture of the same size. Sums over all of them are estimates for the whole picture.
typedef struct vplTruthPixel {
    int x, y;
    double
        square; // mean square error of its values, times the pixels of the picture that it stands for over all
    double mean;         // of its true values, times the same
    double pathVariance; // of one path as if paths were independent, times the same
    // The variance of the mean of its paths by the difference of their halves, times the same. It is smaller than follows from
    // pathVariance, because paths are spread evenly: where the edge of a lamp runs through a pixel, 128 paths have a thirtieth
    // of the variance of independent ones (cornell-area).
    double meanVariance;
} vplTruthPixel;

vplTruthPixel vplTruth_GetPixel(const vplTruth* truth, const vplImage* picture, int index);

int vplTruth_CountPixels(const vplTruth* truth);

// Estimates the error of a picture of the same size. `edges` may be NULL; the error of its pixels is the noise of their own paths,
// which are more than those of the truth.
vplJudgement vplTruth_Judge(const vplTruth* truth, const vplImage* picture, const vplEdges* edges);

#endif
