// SPDX-License-Identifier: MIT
// State of interleaved shading: classes of lights, and what its filter, the second step, reads and writes.
#ifndef VPL_SHADING_INTERLEAVE_FILTER_H
#define VPL_SHADING_INTERLEAVE_FILTER_H

#include "shading/facet_cache.h"

// A task of the filter, in pixels, and the part of the picture that it reads: with the windows of the
// outermost pixels.
enum {
    VPL_FILTER_WIDTH = 64,
    VPL_FILTER_HEIGHT = 32, // 16 takes longer, 64 as long
    VPL_FILTER_COLUMNS = VPL_FILTER_WIDTH + 2 * VPL_MAX_INTERLEAVE,
    VPL_FILTER_ROWS = VPL_FILTER_HEIGHT + 2 * VPL_MAX_INTERLEAVE,
    VPL_FILTER_RUNS = VPL_FILTER_WIDTH / VPL_LANES // runs of 16 pixels in a row
};

// Planes of the whole picture.
enum { VPL_FILTER_INDIRECT = 0, VPL_FILTER_TRIANGLE = 3, VPL_FILTER_PLANES };

// Surfaces at edges that one tile keeps for the filter; the light of more is found without neighbours, which is noisy.
// With cut-outs each pixel can show two besides that in its centre: a pane's, and those seen through it.
enum { VPL_TILE_EDGES = 2048, VPL_CUT_OUT_EDGES = 2 * VPL_TILE_SIDE * VPL_TILE_SIDE };

// A surface at an edge whose indirect light the filter finds.
typedef struct vplKeptEdge {
    uint16_t x, y; // pixel of the picture
    vplEdgeSurface surface;
} vplKeptEdge;

// A worker's copy of a part of the picture; 0 outside the picture.
typedef struct vplFilterScratch {
    _Alignas(64) float indirect[3][VPL_FILTER_ROWS][VPL_FILTER_COLUMNS];
    // Sums over the row of each pixel's window, and their weights. The weights are not read where all is one
    // triangle.
    float rowSums[3][VPL_FILTER_ROWS][VPL_FILTER_WIDTH];
    float rowCounts[VPL_FILTER_ROWS][VPL_FILTER_WIDTH];
    int32_t triangle[VPL_FILTER_ROWS][VPL_FILTER_COLUMNS]; // 1 + index in geometry->normals, 0: nothing
    int32_t uniform[VPL_FILTER_ROWS][VPL_FILTER_RUNS]; // the one triangle in a run and its windows, else 0
    vplFacetCache facets;                              // of both steps, from tile to tile
    // These are set only where some window shows several triangles: normals and planes (n.x = offset) of the
    // triangles, and the distances of these planes along the view axis, all from the eye; 0 where nothing is.
    float offset[VPL_FILTER_ROWS][VPL_FILTER_COLUMNS];
    float distance[VPL_FILTER_ROWS][VPL_FILTER_COLUMNS];
    float normal[3][VPL_FILTER_ROWS][VPL_FILTER_COLUMNS];
    // Lines of sight: forward + right view.right + up view.up.
    float right[VPL_FILTER_COLUMNS], up[VPL_FILTER_ROWS];
} vplFilterScratch;

// State of the strategy.
typedef struct vplInterleave {
    int side; // K
    // The first light of each class; the next class's first ends it.
    int classStart[VPL_MAX_INTERLEAVE * VPL_MAX_INTERLEAVE + 1];
    float* planes; // VPL_FILTER_PLANES of pixelCount values
    size_t pixelCount;
    vplFilterScratch* scratch; // one per worker
    // Coverage antialiasing only; else NULL.
    float* centres;     // share of each pixel's surface in its centre
    vplKeptEdge* edges; // mostEdges per tile
    int mostEdges;
    int* edgeCounts;    // per tile
    int rasterTilesX;   // tiles per row
    int tilesX, tilesY; // tasks of the filter that are run
    int firstTask;      // the first of them
} vplInterleave;

static inline float* vplFilterPlane(const vplInterleave* w, int plane)
{
    return w->planes + (size_t)plane * w->pixelCount;
}

#endif
