// SPDX-License-Identifier: MIT
// Paths for the pixels that differ most from their neighbours (--edge-pixels). At edges of lamps, rims of shadows and gaps of
// doors few pixels have most of a picture's error, and more virtual lights do not mend it.
#ifndef VPL_RENDER_PLANNER_EDGES_H
#define VPL_RENDER_PLANNER_EDGES_H

#include "render/stage.h"

// A contrast is sorted into bins by the first 12 bits of its float: 16 bins per power of two.
enum { VPL_CONTRAST_BINS = 4096 };

// The bin of a pixel's contrast.
int vplContrastBin(const vplImage* image, int x, int y);

typedef struct vplEdges vplEdges;

// Chooses at most `most` pixels of the picture, all those of the highest bins that fit, and traces `paths` paths through each. The
// run's geometry and plan must outlive it.
vplResult vplEdges_Create(const vplRun* run, const vplImage* picture, int most, int paths,
                          vplEdges** edgesOut);

// Traces further paths, until each pixel has `paths`: the same bits as with all at once. If it fails or is cancelled, none is added.
vplResult vplEdges_Refine(const vplRun* run, vplEdges* edges, int paths);

// NULL is allowed.
void vplEdges_Destroy(vplEdges* edges);

// Rays that were cast for it.
int64_t vplEdges_Rays(const vplEdges* edges);

// Replaces the chosen pixels of a picture by their paths.
void vplEdges_Draw(const vplEdges* edges, vplImage* picture);

// The variance of a chosen pixel's values, their mean; negative where the pixel is not chosen.
double vplEdges_VarianceAt(const vplEdges* edges, size_t pixel);

// The squared error that the noise of the chosen pixels leaves in the picture, over all its values, and its standard error.
typedef struct vplEdgeNoise {
    double square, spread;
} vplEdgeNoise;

// All 0 for NULL.
vplEdgeNoise vplEdges_Noise(const vplEdges* edges, int pixelsOfPicture);

#endif
