// SPDX-License-Identifier: MIT
// Points of sides, for all that casts rays from them.
#ifndef VPL_RADIOSITY_SIDE_H
#define VPL_RADIOSITY_SIDE_H

#include <vpl/radiosity.h>

// Index in sides->sides of a patch's front (0) or back (1); -1: no light reaches it.
static inline int vplSideOf(const vplPatchSides* sides, int patch, int face)
{
    return sides->ofPatch[2 * (size_t)patch + (size_t)face];
}

// The k-th open cell.
int vplPatchSide_OpenCell(const vplPatchSide* side, int k);

// Where rays leave a side.
vplHit vplPatchSide_HitAt(const vplPatchSides* sides, const vplPatchSide* side, vplVec3 at);

// The side that a ray which goes in `direction` meets at `hit`; -1: none that takes part.
int vplPatchSides_Find(const vplPatchSides* sides, const vplHit* hit, vplVec3 direction);

#endif
