// SPDX-License-Identifier: MIT
// Path tracing of some pixels of a picture: a truth that costs little, by which other methods' errors are
// estimated.
#ifndef VPL_REFERENCE_SPARSE_PATHS_H
#define VPL_REFERENCE_SPARSE_PATHS_H

#include "base/context.h"
#include "reference/path_scene.h"

// Sums of two halves of a pixel's paths, which are independent of each other.
typedef struct vplSparsePixel {
    int x, y;
    vplRadiance sums[2];
    double squares; // of the radiance of all paths, mean over red, green and blue
    int64_t rays;
} vplSparsePixel;

// The variance of the mean of a pixel's paths, of which each half has `each`, estimated by the difference of the halves.
double vplSparsePixel_Variance(const vplSparsePixel* pixel, double each);

typedef struct vplSparsePaths {
    vplPathScene scene;
    vplSparsePixel* pixels; // borrowed
    int count;
    int done, now; // paths of each half of each pixel: before the pass under way, and in it
    int64_t cast;  // rays of all passes
} vplSparsePaths;

// The geometry, the def's trees and the pixels, which are to be zero but for x and y, must outlive it.
vplResult vplSparsePaths_Init(vplSparsePaths* paths, const vplGeometry* geometry, const vplPathDef* def,
                              vplSparsePixel* pixels, int count);

// Frees all but the pixels.
void vplSparsePaths_Free(vplSparsePaths* paths);

// Adds `each` paths to both halves of all pixels. If it is cancelled or fails, it adds none.
vplResult vplSparsePaths_Trace(vplSparsePaths* paths, int each, vplProgressRange progress);

#endif
