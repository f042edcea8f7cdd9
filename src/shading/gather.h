// SPDX-License-Identifier: MIT
// What interleaved shading keeps between its two steps: lighting, and gathering what neighbours received.
#ifndef VPL_SHADING_GATHER_H
#define VPL_SHADING_GATHER_H

#include "shading/seen.h"

enum {
    VPL_GATHER_WIDTH = 64,  // pixels of a task of the second step
    VPL_GATHER_HEIGHT = 32, // 16 takes longer, 64 as long
    VPL_GATHER_COLUMNS =
        VPL_GATHER_WIDTH + 2 * VPL_MAX_INTERLEAVE, // with the windows of the outermost pixels,
    VPL_GATHER_ROWS = VPL_GATHER_HEIGHT + 2 * VPL_MAX_INTERLEAVE,
    VPL_GATHER_RUNS = VPL_GATHER_WIDTH / VPL_LANES // runs of 16 pixels in a row
};

// Planes of the whole picture.
enum { VPL_GATHER_INDIRECT = 0, VPL_GATHER_TRIANGLE = 3, VPL_GATHER_PLANES };

// A worker's copy of a part of the picture. 0 outside the picture.
typedef struct vplGatherRoom {
    _Alignas(64) float indirect[3][VPL_GATHER_ROWS][VPL_GATHER_COLUMNS];
    float rowSums[3][VPL_GATHER_ROWS][VPL_GATHER_WIDTH]; // over the window of each pixel
    float rowCounts[VPL_GATHER_ROWS]
                   [VPL_GATHER_WIDTH]; // and its weight; not asked for where all is one triangle
    int32_t triangle[VPL_GATHER_ROWS][VPL_GATHER_COLUMNS]; // 1 + index in geometry->normals, 0: nothing
    int32_t uniform[VPL_GATHER_ROWS][VPL_GATHER_RUNS]; // the one triangle in a run and its windows, else 0
    vplSeen seen;                                      // of both steps, from tile to tile
    // Where some window shows several triangles only: normals and planes n.x = offset of these, and distances along the
    // view axis in these planes, all from the eye. 0 where nothing is.
    float offset[VPL_GATHER_ROWS][VPL_GATHER_COLUMNS];
    float distance[VPL_GATHER_ROWS][VPL_GATHER_COLUMNS];
    float normal[3][VPL_GATHER_ROWS][VPL_GATHER_COLUMNS];
    float right[VPL_GATHER_COLUMNS],
        up[VPL_GATHER_ROWS]; // line of sight: forward + right view.right + up view.up
} vplGatherRoom;

typedef struct vplInterleave {
    vplShadeDef def; // with the lights in the order of their classes
    vplShadeLight* lights;
    vplHemiMap* shadows; // NULL where lights have no maps
    int* clusters;       // NULL where lights have no clusters
    int* classes;        // one per light of the caller's
    int classStart[VPL_MAX_INTERLEAVE * VPL_MAX_INTERLEAVE +
                   1];    // a class's first light; that of the next ends them
    float* planes;        // VPL_GATHER_PLANES of pixelCount values
    vplGatherRoom* rooms; // one per worker
    size_t pixelCount;
    int side;           // K
    int tilesX, tilesY; // of the second step
} vplInterleave;

static inline float* vplGatherPlane(const vplInterleave* w, int plane)
{
    return w->planes + (size_t)plane * w->pixelCount;
}

#endif
