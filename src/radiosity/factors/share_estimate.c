// SPDX-License-Identifier: MIT
// How much memory shared rows of form factors will take.
#include "base/rng.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/factors/form_factors.h"
#include "radiosity/sides/side.h"

enum { PAIRS = 4096, PAIR_STREAM = 0x53485250 };

static vplSidePoint pointOf(const vplPatchSides* sides, int index, vplRandom4 r)
{
    const vplPatchSide* side = &sides->sides[index];
    const int open = __builtin_popcount(side->open);
    const int cell =
        vplPatchSide_OpenCell(side, vplMini((int)(vplUnitFloat(r.v[1]) * (float)open), open - 1));
    return vplPatchSide_SampleCell(sides, side, cell, vplUnitFloat(r.v[2]), vplUnitFloat(r.v[3]));
}

static bool seeEachOther(const vplPatchSides* sides, const vplSidePoint* from, const vplSidePoint* to)
{
    const vplVec3 way = vplSub(to->at, from->at);
    if (vplDot(way, from->normal) <= 0 || vplDot(way, to->normal) >= 0) {
        return false;
    }
    const vplRay ray = vplPatchSides_Leave(sides, from, way);
    return !vplGeometry_IsOccluded(sides->patches->geometry, &ray, 0.999f);
}

// The share of random pairs of sides that have a factor: one of their pairs of points sees each other.
static double findShare(const vplPatchSides* sides, int samples)
{
    int found = 0;
    for (uint32_t i = 0; i < PAIRS && sides->count > 0; i++) {
        bool sees = false;
        const vplRandom4 pair = vplRandomAt(0, PAIR_STREAM, i);
        const int a = (int)(pair.v[0] % (uint32_t)sides->count),
                  b = (int)(pair.v[1] % (uint32_t)sides->count);
        for (uint32_t k = 0; k < (uint32_t)samples && !sees; k++) {
            const uint64_t point = 2 * ((uint64_t)i * (uint64_t)samples + k);
            const vplSidePoint from = pointOf(sides, a, vplRandomAt(0, PAIR_STREAM + 1, point)),
                               to = pointOf(sides, b, vplRandomAt(0, PAIR_STREAM + 1, point + 1));
            sees = seeEachOther(sides, &from, &to);
        }
        found += sees;
    }
    return (double)found / PAIRS;
}

vplSharedBytes vplSharedRows_Estimate(const vplPatchSides* sides, double count, int members, int samples)
{
    const double share = sides != NULL ? findShare(sides, vplMini(samples, 16)) : 1;
    const double pairs = count * count / members, block = VPL_SHARED_LANES;
    const double strips = VPL_STRIPS_PER_ROUND * 2 * block * sizeof(float) * count;
    return (vplSharedBytes){.held = pairs * (share * sizeof(float) + 2 / block) + // factors and masks
                                    pairs / (block * VPL_STRIPS_PER_ROUND * members) * sizeof(uint32_t) +
                                    VPL_SWEEP_ROWS * sizeof(float) * count,
                            .scratch = 2 * strips + strips * share + sizeof(vplFactorBlock) / block * count};
}
