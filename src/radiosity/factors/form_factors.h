// SPDX-License-Identifier: MIT
// The steps that compute a matrix of form factors.
#ifndef VPL_RADIOSITY_FORM_FACTORS_H
#define VPL_RADIOSITY_FORM_FACTORS_H

#include "base/arena.h"
#include "geometry/bvh.h"
#include "radiosity/factors/shared_rows.h"
#include "radiosity/radiosity_kernels.h"

// Blocks of sides that a member of a team computes in a round: 26 MB of strips at 50,000 sides.
enum { VPL_STRIPS_PER_ROUND = 4 };

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
    float *rows, *rowSums;   // those of `factors`, to write; rows NULL: `shared` has them
    vplSharedRows* shared;   // NULL: the process has all rows
    float* rooms;            // per worker, for a row of `shared`
    vplFormFactors* factors; // the result
} vplFactorWork;

// The factors of a block of sides with all that come after it, before they are sent to those that hold them: of the block's
// sides with others, [16][columns], and of others with the block's, [columns][16].
typedef struct vplFactorStrip {
    float *there, *back;
} vplFactorStrip;

// What all tasks share that compute pairs of sides.
typedef struct vplPairWork {
    const vplFactorWork* work;
    const vplGeometry* geometry;
    vplTraceAnyPacketFcn* trace;
    int64_t *rays, *analyticPairs; // one per task
    vplFactorSamples* samples;     // two per worker: of the row and of the column, after the first sixteen
} vplPairWork;

// Allocates for so many tasks.
vplResult vplPairWork_Open(vplFactorWork* work, int tasks, vplPairWork* pairsOut);

// Computes the factors of a block of sides with the blocks in [first, end), none of which comes before it. strip NULL: writes
// them into work->rows.
void vplPairWork_Fill(const vplPairWork* pairs, int task, int worker, int block, int first, int end,
                      const vplFactorStrip* strip);

// Adds the counts of all tasks to the result.
void vplPairWork_Count(const vplPairWork* pairs, int tasks);

// The most that a matrix of one process may take: more where the context has a higher limit of memory.
static inline int64_t vplMostFormFactorBytes(const vplContext* context)
{
    const int64_t limit = (int64_t)context->memoryLimit;
    return limit > VPL_MAX_FORM_FACTOR_BYTES ? limit : VPL_MAX_FORM_FACTOR_BYTES;
}

// The unoccluded mean of cos cos / (pi r^2) over the open cells of two sides, by the contour integral, 1/m^2.
float vplSideExchange(const vplPatchSide* a, const vplPatchSide* b);

// Fills `blocks`.
vplResult vplFactorWork_MakeBlocks(vplFactorWork* work);

// The samples of a block for pairs of points 16 * chunk to 16 * chunk + 15.
void vplFactorSamples_Fill(const vplFactorWork* work, int block, int chunk, vplFactorSamples* samples);

// Fills rows and counts rays and analyticPairs.
vplResult vplFactorWork_FillRows(vplFactorWork* work);

// The same for the rows of this member of a team (share_factors.c).
vplResult vplFactorWork_ShareRows(vplFactorWork* work);

// Fills rowSums and corrects the rows as def.rowSums says.
vplResult vplFactorWork_CorrectRows(vplFactorWork* work);

#endif
