// SPDX-License-Identifier: MIT
// One path, and the light that reaches its vertices directly.
#ifndef VPL_REFERENCE_PATH_H
#define VPL_REFERENCE_PATH_H

#include "math/sobol.h"
#include "reference/path_trace.h"

// What all paths read.
typedef struct vplPathScene {
    const vplGeometry* geometry;
    vplEmission* emission;
    vplPathDef def;
    vplSobol sobol;
    vplVec3 right, up, forward; // of the camera
    double scaleX, scaleY;      // tangents of its half-angles
    double trianglePower;       // W, of all triangles that emit
} vplPathScene;

// Where the numbers of one path come from.
typedef struct vplPathNumbers {
    const vplPathScene* scene;
    uint64_t stream; // a pixel's half of the samples
    uint32_t index;  // of the path in it
} vplPathNumbers;

// Four numbers in [0, 1), the `set`-th of the path.
void vplPathNumbers_Get(const vplPathNumbers* numbers, uint32_t set, float out[4]);

// A point where a path is reflected.
typedef struct vplPathVertex {
    vplHit hit;
    vplVec3 normal;  // of the surface, on the side the path came from
    vplVec3 shading; // to shade with, turned the same way
    vplRgb rho;
} vplPathVertex;

// Radiance that the sources send to the vertex and it reflects. u picks the place on an emitting triangle, the first
// number of `set` the emitter where there are many.
typedef struct vplDirectLight {
    double r, g, b;
} vplDirectLight;

vplDirectLight vplSampleDirect(const vplPathScene* scene, const vplPathVertex* vertex, const float u[2],
                               const vplPathNumbers* numbers, uint32_t set, int64_t* rays);

// The weight of emission that a path from `vertex` met by itself at `hit`, in direction `direction` (unit).
double vplWeightOfChance(const vplPathScene* scene, const vplPathVertex* vertex, const vplHit* hit,
                         vplVec3 direction);

// Follows one path through pixel (x, y) and adds the radiance it brings to sum.
void vplFollowPath(const vplPathScene* scene, int x, int y, const vplPathNumbers* numbers, double sum[3],
                   int64_t* rays);

#endif
