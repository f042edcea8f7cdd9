// SPDX-License-Identifier: MIT
// The steps that compute a matrix of form factors.
#ifndef VPL_RADIOSITY_FORM_FACTORS_H
#define VPL_RADIOSITY_FORM_FACTORS_H

#include "base/arena.h"
#include "radiosity/radiosity_kernels.h"

// The matrix in the making.
typedef struct vplFactorWork {
    const vplPatchSides* sides;
    vplFormFactorDef def;
    const vplRadiosityKernels* kernels;
    vplContext* context;
    vplArena* scratch;      // freed at the end
    vplFactorBlock* blocks; // of all sides
    int blockCount;
    int count;               // of sides
    float *rows, *rowSums;   // those of `factors`, to write
    vplFormFactors* factors; // the result
} vplFactorWork;

// The unoccluded mean of cos cos / (pi r^2) over the open cells of two sides, by the contour integral, 1/m^2.
float vplSideExchange(const vplPatchSide* a, const vplPatchSide* b);

// Fills `blocks`.
vplResult vplFactorWork_MakeBlocks(vplFactorWork* work);

// The samples of a block for pairs of points 16 * chunk to 16 * chunk + 15.
void vplFactorSamples_Fill(const vplFactorWork* work, int block, int chunk, vplFactorSamples* samples);

// Fills rows and counts rays and analyticPairs.
vplResult vplFactorWork_FillRows(vplFactorWork* work);

// Fills rowSums and corrects the rows as def.rowSums says.
vplResult vplFactorWork_CorrectRows(vplFactorWork* work);

#endif
