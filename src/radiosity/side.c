// SPDX-License-Identifier: MIT
#include "radiosity/side.h"

#include "geometry/triangle.h"
#include "math/vec.h"

// All are open of most.
int vplPatchSide_OpenCell(const vplPatchSide* side, int k)
{
    if (side->open == (1 << VPL_PATCH_CELLS) - 1) {
        return k;
    }
    unsigned open = side->open;
    for (; k > 0; k--) {
        open &= open - 1;
    }
    return __builtin_ctz(open);
}

vplHit vplPatchSide_HitAt(const vplPatchSides* sides, const vplPatchSide* side, vplVec3 at)
{
    const vplPatches* patches = sides->patches;
    const vplGeometry* g = patches->geometry;
    const int triangle = vplPatches_TriangleOf(patches, side->patch);
    return (vplHit){.object = g->owners[triangle],
                    .face = vplGeometry_FaceOf(g, triangle),
                    .triangle = triangle,
                    .position = at,
                    .normal = g->normals[triangle]};
}

int vplPatchSides_Find(const vplPatchSides* sides, const vplHit* hit, vplVec3 direction)
{
    const int patch = vplPatches_Find(sides->patches, hit->triangle, hit->position);
    return patch < 0 ? -1 : vplSideOf(sides, patch, vplDot(direction, hit->normal) > 0);
}
