// SPDX-License-Identifier: MIT
// Rows of form factors of one member of a team, without zeros: in rooms behind doors most sides do not see each other. A row
// is decoded before it is used, so that the kernels and their bits are those of whole rows: adding a zero changes nothing.
#ifndef VPL_RADIOSITY_SHARED_ROWS_H
#define VPL_RADIOSITY_SHARED_ROWS_H

#include "base/team.h"

#include <vpl/radiosity.h>

// Sides in a block of columns, which has a mask; rows that a sweep of Gauss-Seidel takes together.
enum { VPL_SHARED_LANES = 16, VPL_SWEEP_ROWS = 64 };

// Row i belongs to member i % members, as its own row i / members.
typedef struct vplSharedRows {
    int count, blocks;   // sides; blocks of columns
    int member, members; // this one, and all
    int ownCount;        // own rows
    int perRound;        // blocks of columns that came in one round
    int rounds;
    uint16_t* masks; // [own row][block]; bit l: the factor of column 16 block + l is not 0
    float**
        values; // [round]: factors of that round's columns, row by row. A row's last round has all columns after it, too
    uint32_t* starts; // [round][own row]: where the row begins
    float* nearby;    // [row][column % 64]: of all rows, in the 64 columns around the diagonal
} vplSharedRows;

// Form factors whose `rows` are NULL.
typedef struct vplTeamFactors {
    vplFormFactors factors;
    vplSharedRows shared;
} vplTeamFactors;

// NULL where the process has all rows.
static inline const vplSharedRows* vplFormFactors_GetShared(const vplFormFactors* factors)
{
    return factors->rows == NULL ? &((const vplTeamFactors*)factors)->shared : NULL;
}

// Elements of a decoded row.
static inline size_t vplSharedRows_Columns(const vplSharedRows* s)
{
    return (size_t)s->blocks * VPL_SHARED_LANES;
}

// Writes row i, which must be an own one, into `room`.
void vplSharedRows_Decode(const vplSharedRows* s, int i, float* room);

// Takes the factors of an own row from a row that was decoded and changed. None that was 0 is kept.
void vplSharedRows_Encode(const vplSharedRows* s, int i, const float* room);

// The last round of row i.
static inline int vplSharedRows_LastRound(const vplSharedRows* s, int i)
{
    return i / VPL_SHARED_LANES / s->perRound;
}

// The bytes that a member of a team holds, estimated by rays between 4,096 random pairs of sides, `samples` for each; and
// those that it also holds while rows are computed. sides NULL: for as many sides, of which all see each other.
typedef struct vplSharedBytes {
    double held, scratch;
} vplSharedBytes;

vplSharedBytes vplSharedRows_Estimate(const vplPatchSides* sides, double count, int members, int samples);

#endif
