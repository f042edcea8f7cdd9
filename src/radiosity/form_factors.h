// SPDX-License-Identifier: MIT
// Form factors from the inside: sides in blocks of sixteen, and the loops over them.
#ifndef VPL_RADIOSITY_FORM_FACTORS_H
#define VPL_RADIOSITY_FORM_FACTORS_H

#include "geometry/bvh.h"

#include <vpl/radiosity.h>

enum { VPL_FACTOR_LANES = VPL_RAY_PACKET, VPL_FACTOR_POINTS = 16, VPL_FACTOR_MIDDLES = 3 };

// Points that sides are sampled at, and where rays from them start. Any four that follow each other, the first behind
// the last, lie in different quarters of the side.
typedef struct vplFactorPoints {
    float at[VPL_FACTOR_POINTS][3][VPL_FACTOR_LANES];
    float start[VPL_FACTOR_POINTS][3][VPL_FACTOR_LANES];
} vplFactorPoints;

// Sixteen sides. Those that are not there have the normal 0, and so exchange nothing.
typedef struct vplFactorBlock {
    float corner[3][3][VPL_FACTOR_LANES]; // [corner][axis]
    float normal[3][VPL_FACTOR_LANES];
    float middle[VPL_FACTOR_MIDDLES][3][VPL_FACTOR_LANES];        // of thirds of what is open
    float centre[3][VPL_FACTOR_LANES], radius2[VPL_FACTOR_LANES]; // of the corners; metres squared
    float area[VPL_FACTOR_LANES];                                 // 0: not there
    float low[3], high[3];                                        // of the box around all corners
    int32_t skipFirst[VPL_FACTOR_LANES], skipCount[VPL_FACTOR_LANES];
    vplFactorPoints points;
} vplFactorBlock;

// What can be said of side `lane` of a and the sixteen of b without a ray.
typedef struct vplFactorFirst {
    uint32_t seen;                  // bit l: some of each lies in front of the other's plane
    uint32_t near;                  // bit l: too near for `middle`
    float middle[VPL_FACTOR_LANES]; // the mean of cos cos / (pi r^2) over all pairs of middles, 1/m^2
} vplFactorFirst;

// Heights up to `tolerance` are none, metres. Near: middles less than sqrt(near2) times the larger radius apart.
typedef void vplFactorFirstFcn(const vplFactorBlock* a, int lane, const vplFactorBlock* b, float tolerance,
                               float near2, vplFactorFirst* firstOut);

// cos cos / (pi r^2) from one point to sixteen, 1/m^2, and ways there that end just in front of them.
typedef void vplFactorWeightsFcn(const float point[3], const float normal[3],
                                 const float to[3][VPL_FACTOR_LANES],
                                 const float toNormal[3][VPL_FACTOR_LANES], float weightOut[VPL_FACTOR_LANES],
                                 float wayOut[3][VPL_FACTOR_LANES]);

// The sum of row[j] factor[j].
typedef double vplFactorDotFcn(const float* row, const double* factor, int count);

// row[j] times scale times factor[j].
typedef void vplFactorScaleFcn(float* row, double scale, const double* factor, int count);

// Blocks of all sides, (count + 15) / 16.
vplResult vplFactorBlocks_Create(const vplPatchSides* sides, const vplFormFactorDef* def,
                                 vplFactorBlock** blocksOut);

// The points of a block for the pairs of points after 16 * chunk.
void vplFactorPoints_Fill(const vplPatchSides* sides, const vplFormFactorDef* def, int block, int chunk,
                          vplFactorPoints* points);

// Fills rows, rays and analyticPairs.
vplResult vplFormFactors_Fill(const vplPatchSides* sides, const vplFormFactorDef* def,
                              const vplFactorBlock* blocks, vplFormFactors* factors);

// Fills rowSums and does what `rowSums` of the def says.
vplResult vplFormFactors_FixRows(const vplFormFactorDef* def, vplFormFactors* factors);

#endif
