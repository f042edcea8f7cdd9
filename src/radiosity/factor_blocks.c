// SPDX-License-Identifier: MIT
// Sides side by side, so that one instruction meets sixteen, with the points that they are sampled at.
#include "base/context.h"
#include "base/rng.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/form_factors.h"
#include "radiosity/shaft.h"
#include "radiosity/side.h"

// Streams of random numbers: this one and those after it, one per sixteen points.
enum { POINT_STREAM = 0x46460000 };

enum { ALL_CELLS = (1 << VPL_PATCH_CELLS) - 1 };

static void put(float to[3][VPL_FACTOR_LANES], int lane, vplVec3 v)
{
    to[0][lane] = v.x;
    to[1][lane] = v.y;
    to[2][lane] = v.z;
}

static int listOpen(const vplPatchSide* side, int cells[VPL_PATCH_CELLS])
{
    int count = 0;
    for (int k = 0; k < VPL_PATCH_CELLS; k++) {
        if (side->open >> k & 1) {
            cells[count++] = k;
        }
    }
    return count;
}

// A ray that leaves the side, for what it starts from and does not meet.
static vplRay leave(const vplPatchSides* sides, const vplPatchSide* side, vplVec3 from)
{
    const vplHit start = vplPatchSide_HitAt(sides, side, from);
    return vplGeometry_Leave(sides->patches->geometry, &start, side->normal);
}

// Sixteen strata, each uniform over a sixteenth of what is open: of a side without closed cells, its cells.
static void fillLane(const vplPatchSides* sides, const vplFormFactorDef* def, int index, int chunk,
                     vplFactorPoints* points)
{
    const vplPatchSide* side = &sides->sides[index];
    const int lane = index % VPL_FACTOR_LANES;
    int cells[VPL_PATCH_CELLS];
    const int open = listOpen(side, cells);
    for (int p = 0; p < VPL_FACTOR_POINTS; p++) {
        const vplRandom4 r = vplRandomAt(def->seed, POINT_STREAM + (uint32_t)chunk,
                                         (uint64_t)index * VPL_FACTOR_POINTS + (uint64_t)p);
        const int stratum = p % 4 * 4 + p / 4;
        const float place = ((float)stratum + vplUnitFloat(r.v[0])) * (float)open / VPL_FACTOR_POINTS;
        const int cell = cells[vplMini((int)place, open - 1)];
        const vplVec3 at = vplPatchSide_SampleCell(side, cell, vplUnitFloat(r.v[1]), vplUnitFloat(r.v[2]));
        put(points->at[p], lane, at);
        put(points->start[p], lane, leave(sides, side, at).origin);
    }
}

void vplFactorPoints_Fill(const vplPatchSides* sides, const vplFormFactorDef* def, int block, int chunk,
                          vplFactorPoints* points)
{
    const int first = block * VPL_FACTOR_LANES;
    for (int i = first; i < vplMini(first + VPL_FACTOR_LANES, sides->count); i++) {
        fillLane(sides, def, i, chunk, points);
    }
}

// ---- what stays

// Three points that stand for a triangle: exact for polynomials of degree 2 (Strang and Fix, An Analysis of the Finite
// Element Method, 1973).
static void fillWhole(const vplPatchSide* side, int lane, vplFactorBlock* block)
{
    for (int q = 0; q < VPL_FACTOR_MIDDLES; q++) {
        vplVec3 sum = {0, 0, 0};
        for (int c = 0; c < 3; c++) {
            sum = vplAdd(sum, vplScale(c == q ? 2.0f / 3 : 1.0f / 6, side->corners[c]));
        }
        put(block->middle[q], lane, sum);
    }
}

// Of a side with closed cells: means of the middles of open ones, of a third of them each; a cell on the border of two
// thirds counts in both by its shares.
static void fillPart(const vplPatchSide* side, int lane, vplFactorBlock* block)
{
    const float middle = 2.0f / 3; // twice this is the middle of a cell: weights of 1/3
    int cells[VPL_PATCH_CELLS];
    const int open = listOpen(side, cells);
    for (int q = 0; q < VPL_FACTOR_MIDDLES; q++) {
        vplVec3 sum = {0, 0, 0};
        for (int c = 0; c < open; c++) {
            const int low = vplMaxi(3 * c, q * open), high = vplMini(3 * c + 3, (q + 1) * open);
            if (high > low) {
                const vplVec3 at = vplPatchSide_SampleCell(side, cells[c], middle, middle);
                sum = vplAdd(sum, vplScale((float)(high - low) / (float)open, at));
            }
        }
        put(block->middle[q], lane, sum);
    }
}

static void fillSide(const vplPatchSides* sides, const vplFormFactorDef* def, int index,
                     vplFactorBlock* block)
{
    const vplPatchSide* side = &sides->sides[index];
    const int lane = index % VPL_FACTOR_LANES;
    vplVec3 sum = {0, 0, 0};
    for (int c = 0; c < 3; c++) {
        put(block->corner[c], lane, side->corners[c]);
        sum = vplAdd(sum, vplScale(1.0f / 3, side->corners[c]));
    }
    put(block->centre, lane, sum);
    put(block->normal, lane, side->normal);
    for (int c = 0; c < 3; c++) {
        const vplVec3 way = vplSub(side->corners[c], sum);
        block->radius2[lane] = vplMaxf(block->radius2[lane], vplDot(way, way));
    }
    const vplRay ray = leave(sides, side, side->incentre);
    block->skipFirst[lane] = ray.skip.first;
    block->skipCount[lane] = ray.skip.count;
    if (def->kind == VPL_FORM_FACTORS_INCENTRE) {
        put(block->points.at[0], lane, side->incentre);
        put(block->points.start[0], lane, ray.origin);
        const vplVec3 cross =
            vplCross(vplSub(side->corners[1], side->corners[0]), vplSub(side->corners[2], side->corners[0]));
        block->area[lane] = 0.5f * vplLength(cross);
    } else {
        (side->open == ALL_CELLS ? fillWhole : fillPart)(side, lane, block);
        block->area[lane] = side->area;
    }
}

typedef struct Filling {
    const vplPatchSides* sides;
    const vplFormFactorDef* def;
    vplFactorBlock* blocks;
} Filling;

static void fillBlock(void* data, int index, int worker)
{
    (void)worker;
    const Filling* f = data;
    const int first = index * VPL_FACTOR_LANES;
    for (int i = first; i < vplMini(first + VPL_FACTOR_LANES, f->sides->count); i++) {
        fillSide(f->sides, f->def, i, &f->blocks[index]);
    }
    vplFactorBlock_Bound(&f->blocks[index]);
    if (f->def->kind == VPL_FORM_FACTORS_MONTE_CARLO) {
        vplFactorPoints_Fill(f->sides, f->def, index, 0, &f->blocks[index].points);
    }
}

vplResult vplFactorBlocks_Create(const vplPatchSides* sides, const vplFormFactorDef* def,
                                 vplFactorBlock** blocksOut)
{
    const int count = (sides->count + VPL_FACTOR_LANES - 1) / VPL_FACTOR_LANES;
    Filling filling = {sides, def, vplAllocZero(sides->context, (size_t)count, sizeof *filling.blocks)};
    if (filling.blocks == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplParallelFor(sides->context, count, fillBlock, &filling);
    *blocksOut = filling.blocks;
    return VPL_SUCCESS;
}
