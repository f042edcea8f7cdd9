// SPDX-License-Identifier: MIT
// Sides in blocks of sixteen, and the points at which they are sampled.
#include "base/context.h"
#include "base/rng.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "radiosity/factors/form_factors.h"
#include "radiosity/sides/side.h"

// The first stream of random numbers; each chunk of sixteen samples takes the next.
enum { SAMPLE_STREAM = 0x46460000 };

// ---- samples

static void setSample(const vplFactorWork* work, int p, int lane, const vplSidePoint* point,
                      vplFactorSamples* samples)
{
    const vplRay ray = vplPatchSides_Leave(work->sides, point, point->normal);
    vplSetLane(samples->at[p], lane, point->at);
    vplSetLane(samples->normal[p], lane, point->normal);
    vplSetLane(samples->origin[p], lane, ray.origin);
    samples->skipFirst[p][lane] = ray.skip.first;
    samples->skipCount[p][lane] = ray.skip.count;
}

// Sixteen strata of equal area: the cells of a side whose cells are all open.
static void fillLane(const vplFactorWork* work, int index, int chunk, vplFactorSamples* samples)
{
    const vplPatchSide* side = &work->sides->sides[index];
    const int lane = index % VPL_SIDE_LANES, open = __builtin_popcount(side->open);
    for (int p = 0; p < VPL_FACTOR_SAMPLES; p++) {
        const vplRandom4 r = vplRandomAt(work->def.seed, SAMPLE_STREAM + (uint32_t)chunk,
                                         (uint64_t)index * VPL_FACTOR_SAMPLES + (uint64_t)p);
        const int stratum = p % 4 * 4 + p / 4;
        const float place = ((float)stratum + vplUnitFloat(r.v[0])) * (float)open / VPL_FACTOR_SAMPLES;
        const int cell = vplPatchSide_OpenCell(side, vplMini((int)place, open - 1));
        const vplSidePoint point =
            vplPatchSide_SampleCell(work->sides, side, cell, vplUnitFloat(r.v[1]), vplUnitFloat(r.v[2]));
        setSample(work, p, lane, &point, samples);
    }
}

void vplFactorSamples_Fill(const vplFactorWork* work, int block, int chunk, vplFactorSamples* samples)
{
    const int first = block * VPL_SIDE_LANES;
    for (int i = first; i < vplMini(first + VPL_SIDE_LANES, work->count); i++) {
        fillLane(work, i, chunk, samples);
    }
}

// ---- quadrature points

// Three points of a triangle, exact for polynomials of degree 2.
// Source: Strang and Fix, An Analysis of the Finite Element Method, 1973.
static void fillWhole(const vplPatchSide* side, int lane, vplFactorBlock* block)
{
    for (int q = 0; q < VPL_QUADRATURE_POINTS; q++) {
        vplVec3 sum = {0, 0, 0};
        for (int c = 0; c < 3; c++) {
            sum = vplAdd(sum, vplScale(c == q ? 2.0f / 3 : 1.0f / 6, side->corners[c]));
        }
        vplSetLane(block->quadrature[q], lane, sum);
    }
}

// For a side with closed cells: the centroid of each third of the open cells, taken in order. A cell that
// belongs to two thirds counts in both, by its fractions.
static void fillPart(const vplPatchSide* side, int lane, vplFactorBlock* block)
{
    const int open = __builtin_popcount(side->open);
    for (int q = 0; q < VPL_QUADRATURE_POINTS; q++) {
        vplVec3 sum = {0, 0, 0};
        for (int c = 0; c < open; c++) {
            const int low = vplMaxi(3 * c, q * open), high = vplMini(3 * c + 3, (q + 1) * open);
            if (high > low) {
                const vplVec3 at = vplPatchSide_CellCentre(side, vplPatchSide_OpenCell(side, c));
                sum = vplAdd(sum, vplScale((float)(high - low) / (float)open, at));
            }
        }
        vplSetLane(block->quadrature[q], lane, sum);
    }
}

// ---- blocks

// Sets the sphere around a group.
static void fillGroup(const vplPatches* patches, const vplPatchSide* side, int lane, vplFactorBlock* block)
{
    const vplPatchParts parts = vplPatches_GetParts(patches, side->patch);
    block->groups |= 1u << lane;
    block->radius2[lane] = 0;
    vplSetLane(block->centre, lane, side->incentre);
    for (int k = 0; k < 3 * parts.count; k++) {
        const vplVec3 corner = patches->positions[patches->nodes[parts.nodes[k / 3]].corners[k % 3]],
                      way = vplSub(corner, side->incentre);
        block->radius2[lane] = vplMaxf(block->radius2[lane], vplDot(way, way));
    }
}

static void fillSide(const vplFactorWork* work, int index, vplFactorBlock* block)
{
    const vplPatchSide* side = &work->sides->sides[index];
    const int lane = index % VPL_SIDE_LANES;
    vplVec3 centre = {0, 0, 0};
    for (int c = 0; c < 3; c++) {
        vplSetLane(block->corner[c], lane, side->corners[c]);
        centre = vplAdd(centre, vplScale(1.0f / 3, side->corners[c]));
    }
    vplSetLane(block->centre, lane, centre);
    vplSetLane(block->normal, lane, side->normal);
    for (int c = 0; c < 3; c++) {
        const vplVec3 way = vplSub(side->corners[c], centre);
        block->radius2[lane] = vplMaxf(block->radius2[lane], vplDot(way, way));
    }
    if (vplPatches_IsGroup(work->sides->patches, side->patch)) {
        fillGroup(work->sides->patches, side, lane, block);
    }
    if (work->def.kind == VPL_FORM_FACTORS_INCENTRE) {
        const vplSidePoint middle = {side->incentre, side->normal,
                                     vplPatches_TriangleOf(work->sides->patches, side->patch)};
        setSample(work, 0, lane, &middle, &block->samples);
        const vplVec3 cross =
            vplCross(vplSub(side->corners[1], side->corners[0]), vplSub(side->corners[2], side->corners[0]));
        block->area[lane] = 0.5f * (float)vplCrossLength(cross);
    } else {
        (side->open == VPL_ALL_CELLS ? fillWhole : fillPart)(side, lane, block);
        block->area[lane] = side->area;
    }
}

static void findBounds(vplFactorBlock* block)
{
    for (int k = 0; k < 3; k++) {
        block->low[k] = INFINITY;
        block->high[k] = -INFINITY;
        for (int i = 0; i < 3 * VPL_SIDE_LANES; i++) {
            const float at = block->corner[i / VPL_SIDE_LANES][k][i % VPL_SIDE_LANES];
            if (block->area[i % VPL_SIDE_LANES] > 0) {
                block->low[k] = vplMinf(block->low[k], at);
                block->high[k] = vplMaxf(block->high[k], at);
            }
        }
    }
}

static void fillBlock(void* data, int index, int worker)
{
    (void)worker;
    const vplFactorWork* work = data;
    vplFactorBlock* block = &work->blocks[index];
    const int first = index * VPL_SIDE_LANES;
    for (int i = first; i < vplMini(first + VPL_SIDE_LANES, work->count); i++) {
        fillSide(work, i, block);
    }
    findBounds(block);
    if (work->def.kind == VPL_FORM_FACTORS_MONTE_CARLO) {
        vplFactorSamples_Fill(work, index, 0, &block->samples);
    }
}

vplResult vplFactorWork_MakeBlocks(vplFactorWork* work)
{
    work->blockCount = (work->count + VPL_SIDE_LANES - 1) / VPL_SIDE_LANES;
    work->blocks = vplArena_AllocZero(work->scratch, (size_t)work->blockCount, sizeof *work->blocks);
    TRY(vplArena_Check(work->scratch));
    return vplParallelForAsking(work->context, work->blockCount, fillBlock, work);
}
