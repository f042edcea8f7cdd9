// SPDX-License-Identifier: MIT
// Form factors of all pairs of sides, sixteen at a time.
// Based on: Dan Hemgren, Radiosity in Realtime Rendering, 3.3.1: pairs of points with a ray each, and half of
// the pairs by A_i F_ij = A_j F_ji. Departs: the unoccluded exchange of two sides is computed, and rays only
// estimate the visible fraction.
#include "base/rng.h"
#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/factors/analytic.h"
#include "radiosity/factors/form_factors.h"
#include "radiosity/factors/shaft.h"
#include "radiosity/sides/side.h"

#include <string.h>

enum {
    LANES = VPL_SIDE_LANES,
    PAIR_STREAM = 0x4a4f0000 // of the random numbers that choose pairs of points
};

// Quadrature with three points per side serves sides whose centres are at least this many times the larger
// radius apart. Twice this distance lowers the error by a tenth and takes 1.6 times as long
// (bench/form_factors).
static const float NEAR = 1.5f;

// All pairs between two blocks of sides.
typedef struct Tile {
    const vplPairWork* shared;
    int row, column; // blocks
    float tolerance; // metres
    const vplFactorBlock *a, *b;
    vplBlockers blockers;        // of rays between the two
    uint32_t pairs[LANES];       // bit l of i: side i of a and side l of b exchange light
    float exact[LANES][LANES];   // unoccluded mean of cos cos / (pi r^2), 1/m^2; analytic only
    float sum[LANES][LANES];     // over pairs of points
    float visible[LANES][LANES]; // over those that no ray found blocked
    int64_t rays, analyticPairs;
} Tile;

// ---- before rays

static uint32_t usedLanes(const vplFactorBlock* block)
{
    uint32_t used = 0;
    for (int l = 0; l < LANES; l++) {
        used |= (uint32_t)(block->area[l] > 0) << l;
    }
    return used;
}

// Corners this near to a plane count as in it: eight times the rounding of the blocks' largest coordinate. Sides
// in one plane do not exchange light.
static float toleranceOf(const vplFactorBlock* a, const vplFactorBlock* b)
{
    float largest = 0;
    for (int k = 0; k < 3; k++) {
        largest = vplMaxf(largest, vplMaxf(fabsf(a->low[k]), fabsf(a->high[k])));
        largest = vplMaxf(largest, vplMaxf(fabsf(b->low[k]), fabsf(b->high[k])));
    }
    return largest * 0x1p-21f;
}

// The mean of cos cos / (pi r^2) over the samples of side i of the row and those of each side of the column: for groups,
// which have no integral.
static void sampledMeans(const Tile* tile, int i, float meanOut[LANES])
{
    const vplFactorSamples *from = &tile->a->samples, *to = &tile->b->samples;
    float sum[LANES] = {0};
    for (int k = 0; k < VPL_FACTOR_SAMPLES; k++) {
        const float point[3] = {from->at[k][0][i], from->at[k][1][i], from->at[k][2][i]};
        const float normal[3] = {from->normal[k][0][i], from->normal[k][1][i], from->normal[k][2][i]};
        const int other = (5 * k + i) % VPL_FACTOR_SAMPLES;
        float term[LANES], direction[3][LANES];
        tile->shared->work->kernels->pointTerms(point, normal, to->at[other], to->normal[other], term,
                                                direction);
        for (int l = 0; l < LANES; l++) {
            sum[l] += term[l] / VPL_FACTOR_SAMPLES;
        }
    }
    memcpy(meanOut, sum, sizeof sum);
}

static vplSidePoint sampleOf(const vplFactorSamples* samples, int k, int lane)
{
    return (vplSidePoint){
        .at = {samples->at[k][0][lane], samples->at[k][1][lane], samples->at[k][2][lane]},
        .normal = {samples->normal[k][0][lane], samples->normal[k][1][lane], samples->normal[k][2][lane]}};
}

// The mean of cos cos / (pi r^2) of a group and a triangle beside it: closed forms from the group's samples.
static float meanBeside(const vplFactorSamples* group, int lane, const vplPatchSide* triangle)
{
    const vplTriangleCorners corners = {{triangle->corners[0], triangle->corners[1], triangle->corners[2]}};
    double sum = 0;
    for (int k = 0; k < VPL_FACTOR_SAMPLES; k++) {
        const vplSidePoint p = sampleOf(group, k, lane);
        sum += vplPointFormFactor(p.at, p.normal, triangle->corners);
    }
    return vplClampToFloat(sum / (VPL_FACTOR_SAMPLES * vplTriangle_Area(&corners)));
}

// That of two groups beside each other: all pairs of their samples.
static float meanOfGroups(const Tile* tile, int i, int l)
{
    double sum = 0;
    for (int k = 0; k < VPL_FACTOR_SAMPLES; k++) {
        const vplSidePoint p = sampleOf(&tile->a->samples, k, i);
        for (int j = 0; j < VPL_FACTOR_SAMPLES; j++) {
            const vplSidePoint q = sampleOf(&tile->b->samples, j, l);
            const vplVec3 way = vplSub(q.at, p.at);
            const double square = (double)vplDot(way, way), a = (double)vplDot(way, p.normal),
                         b = -(double)vplDot(way, q.normal);
            sum += a > 0 && b > 0 ? a / square * (b / square) / VPL_PI : 0;
        }
    }
    return vplClampToFloat(sum / (VPL_FACTOR_SAMPLES * VPL_FACTOR_SAMPLES));
}

static float meanBesideGroup(const Tile* tile, int i, int l)
{
    const vplPatchSide* sides = tile->shared->work->sides->sides;
    return !(tile->a->groups >> i & 1)   ? meanBeside(&tile->b->samples, l, &sides[tile->row * LANES + i])
           : !(tile->b->groups >> l & 1) ? meanBeside(&tile->a->samples, i, &sides[tile->column * LANES + l])
                                         : meanOfGroups(tile, i, l);
}

// Finds the pairs of row i that exchange light and, if analytic, how much without occluders.
static void estimateRow(Tile* tile, int i)
{
    const vplFactorWork* work = tile->shared->work;
    vplFactorEstimate estimate;
    work->kernels->estimateFactors(tile->a, i, tile->b, tile->tolerance, NEAR * NEAR, &estimate);
    const uint32_t used = tile->a->area[i] > 0 ? usedLanes(tile->b) : 0,
                   groups = tile->a->groups >> i & 1 ? used : tile->b->groups & used;
    tile->pairs[i] =
        (estimate.facing | groups) & (tile->row == tile->column ? 0xfffeu << i & 0xffffu : 0xffffu);
    if (!work->def.analytic || tile->pairs[i] == 0) {
        return;
    }
    if ((tile->pairs[i] & ~groups) != 0) {
        memcpy(tile->exact[i], estimate.mean, sizeof estimate.mean);
    }
    if ((tile->pairs[i] & groups) != 0) {
        float means[LANES];
        sampledMeans(tile, i, means);
        for (int l = 0; l < LANES; l++) {
            tile->exact[i][l] = groups >> l & 1 ? means[l] : tile->exact[i][l];
        }
        for (uint32_t left = tile->pairs[i] & estimate.near & groups; left != 0; left &= left - 1) {
            const int l = __builtin_ctz(left);
            tile->exact[i][l] = meanBesideGroup(tile, i, l);
        }
    }
    for (uint32_t left = tile->pairs[i] & estimate.near & ~groups; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        tile->exact[i][l] = vplSideExchange(&work->sides->sides[tile->row * LANES + i],
                                            &work->sides->sides[tile->column * LANES + l]);
        tile->analyticPairs++;
    }
    for (uint32_t left = tile->pairs[i]; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        tile->pairs[i] &= ~((uint32_t) !(tile->exact[i][l] > 0) << l);
    }
}

// ---- rays

static uint32_t findBlocked(const Tile* tile, const vplRayPacket* packet)
{
    const vplPairWork* shared = tile->shared;
    if (!shared->work->def.bruteForce) {
        return tile->blockers.count < 0 ? vplGeometry_AreOccluded(shared->geometry, packet, 1)
                                        : shared->trace(&tile->blockers.bvh, packet, 1);
    }
    uint32_t blocked = 0;
    for (uint32_t left = packet->active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        const vplRay ray = vplRayPacket_Get(packet, l);
        blocked |= (uint32_t)vplAnyOfTriangles(shared->geometry, &ray, 1) << l;
    }
    return blocked;
}

// Joins sample `index` of side i of the row with one point of each side of the column that `asked` names.
static void joinPoints(Tile* tile, int i, uint32_t asked, const vplFactorSamples* from, int index,
                       const vplFactorSamples* to, int other)
{
    const float point[3] = {from->at[index][0][i], from->at[index][1][i], from->at[index][2][i]};
    const float normal[3] = {from->normal[index][0][i], from->normal[index][1][i], from->normal[index][2][i]};
    float term[LANES];
    vplRayPacket packet;
    tile->shared->work->kernels->pointTerms(point, normal, to->at[other], to->normal[other], term,
                                            packet.direction);
    packet.active = 0;
    for (int l = 0; l < LANES; l++) {
        packet.active |= (uint32_t)(term[l] > 0) << l;
        packet.origin[0][l] = from->origin[index][0][i];
        packet.origin[1][l] = from->origin[index][1][i];
        packet.origin[2][l] = from->origin[index][2][i];
        packet.skipFirst[l] = from->skipFirst[index][i];
        packet.skipCount[l] = from->skipCount[index][i];
    }
    packet.active &= asked;
    if (packet.active == 0) {
        return;
    }
    uint32_t blocked = 0;
    if (tile->blockers.count != 0) {
        tile->rays += __builtin_popcount(packet.active);
        blocked = findBlocked(tile, &packet);
    }
    for (uint32_t left = packet.active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        tile->sum[i][l] += term[l];
        tile->visible[i][l] += blocked >> l & 1 ? 0 : term[l];
    }
}

// The pairs of row i for which no pair of points faces each other so far, as may happen to sides whose planes
// intersect each other. They get more points, since their visible fraction is unknown; without, rows sum to
// 0.2 % too little in Hemgren's box (bench/form_factors).
static uint32_t notJoined(const Tile* tile, int i)
{
    uint32_t lanes = 0;
    for (int l = 0; l < LANES; l++) {
        lanes |= (uint32_t) !(tile->sum[i][l] > 0) << l;
    }
    return lanes & tile->pairs[i];
}

// Joins the samples of one chunk. Both steps through the samples are odd, so that any four pairs use points
// of all four quarters of both sides.
static void joinChunk(Tile* tile, int chunk, const vplFactorSamples* from, const vplFactorSamples* to)
{
    const vplFactorWork* work = tile->shared->work;
    const int samples = work->def.samples - chunk * VPL_FACTOR_SAMPLES;
    for (int i = 0; i < LANES; i++) {
        const uint64_t index =
            (uint64_t)(tile->row * LANES + i) * (uint64_t)work->blockCount + (uint64_t)tile->column;
        uint32_t asked = tile->pairs[i];
        const vplRandom4 r =
            asked ? vplRandomAt(work->def.seed, PAIR_STREAM + (uint32_t)chunk, index) : (vplRandom4){{0}};
        for (uint32_t k = 0; k < VPL_FACTOR_SAMPLES && asked != 0; k++) {
            const int p = (int)((r.v[0] + k) % VPL_FACTOR_SAMPLES);
            joinPoints(tile, i, asked, from, p, to, (int)((r.v[1] + 5 * k) % VPL_FACTOR_SAMPLES));
            if ((int)k + 1 >= samples) {
                asked = work->def.analytic ? notJoined(tile, i) : 0;
            }
        }
    }
}

static void joinAll(Tile* tile, int worker)
{
    const vplFactorWork* work = tile->shared->work;
    if (work->def.kind == VPL_FORM_FACTORS_INCENTRE) {
        for (int i = 0; i < LANES; i++) {
            if (tile->pairs[i] != 0) {
                joinPoints(tile, i, tile->pairs[i], &tile->a->samples, 0, &tile->b->samples, 0);
            }
        }
        return;
    }
    joinChunk(tile, 0, &tile->a->samples, &tile->b->samples);
    for (int chunk = 1; chunk * VPL_FACTOR_SAMPLES < work->def.samples; chunk++) {
        vplFactorSamples* samples = tile->shared->samples + 2 * (size_t)worker;
        vplFactorSamples_Fill(work, tile->row, chunk, &samples[0]);
        vplFactorSamples_Fill(work, tile->column, chunk, &samples[1]);
        joinChunk(tile, chunk, &samples[0], &samples[1]);
    }
}

// ---- tiles

static void computeTile(Tile* tile, int worker)
{
    const vplPairWork* shared = tile->shared;
    uint32_t any = 0;
    tile->tolerance = toleranceOf(tile->a, tile->b);
    memset(tile->sum, 0, sizeof tile->sum);
    memset(tile->visible, 0, sizeof tile->visible);
    for (int i = 0; i < LANES; i++) {
        estimateRow(tile, i);
        any |= tile->pairs[i];
    }
    if (any == 0) {
        return;
    }
    tile->blockers.count = -1;
    if (!shared->work->def.bruteForce && (tile->a->groups | tile->b->groups) == 0) {
        vplBlockers_Find(shared->geometry, tile->a, tile->b, tile->tolerance, &tile->blockers);
    }
    if (tile->blockers.count != 0 || !shared->work->def.analytic) {
        joinAll(tile, worker);
    }
}

// The mean of cos cos V / (pi r^2) over two sides.
static float meanOf(const Tile* tile, int i, int l)
{
    const vplFormFactorDef* def = &tile->shared->work->def;
    const float sum = tile->sum[i][l], visible = tile->visible[i][l];
    if (def->kind == VPL_FORM_FACTORS_INCENTRE) {
        return visible;
    }
    if (!def->analytic) {
        return visible / (float)def->samples;
    }
    return tile->blockers.count == 0 ? tile->exact[i][l] : sum > 0 ? tile->exact[i][l] * (visible / sum) : 0;
}

// Writes F_ij and F_ji, neither above 1 unless they are from incentres. F_ij goes to there[thereStride * i + j], F_ji to
// back[backStride * j + i].
static void storeTile(const Tile* tile, float* there, size_t thereStride, float* back, size_t backStride)
{
    const bool bounded = tile->shared->work->def.kind != VPL_FORM_FACTORS_INCENTRE;
    for (size_t i = 0; i < LANES; i++) {
        for (uint32_t left = tile->pairs[i]; left != 0; left &= left - 1) {
            const size_t l = (size_t)__builtin_ctz(left);
            const float mean = meanOf(tile, (int)i, (int)l), areaA = tile->a->area[i],
                        areaB = tile->b->area[l];
            const float larger = areaA > areaB ? areaA : areaB;
            const float used = bounded ? vplMinf(mean, 1 / larger) : mean;
            there[i * thereStride + l] = used * areaB;
            back[l * backStride + i] = used * areaA;
        }
    }
}

static void storeInRows(const Tile* tile)
{
    const size_t count = (size_t)tile->shared->work->count;
    const size_t row = (size_t)tile->row * LANES, column = (size_t)tile->column * LANES;
    float* rows = tile->shared->work->rows;
    storeTile(tile, rows + row * count + column, count, rows + column * count + row, count);
}

static void storeInStrip(const Tile* tile, const vplFactorStrip* strip)
{
    const size_t columns = (size_t)tile->shared->work->blockCount * LANES;
    const size_t column = (size_t)tile->column * LANES;
    float* there = strip->there + column;
    if (tile->column == tile->row) {
        storeTile(tile, there, columns, there, columns);
    } else {
        storeTile(tile, there, columns, strip->back + column * LANES, LANES);
    }
}

void vplPairWork_Fill(const vplPairWork* pairs, int task, int worker, int block, int first, int end,
                      const vplFactorStrip* strip)
{
    const vplFactorWork* work = pairs->work;
    Tile tile = {.shared = pairs, .row = block, .a = &work->blocks[block]};
    for (int column = first; column < end; column++) {
        tile.column = column;
        tile.b = &work->blocks[column];
        computeTile(&tile, worker);
        if (strip != NULL) {
            storeInStrip(&tile, strip);
        } else {
            storeInRows(&tile);
        }
    }
    pairs->rays[task] += tile.rays;
    pairs->analyticPairs[task] += tile.analyticPairs;
}

vplResult vplPairWork_Open(vplFactorWork* work, int tasks, vplPairWork* pairsOut)
{
    const size_t samples =
        work->def.samples > VPL_FACTOR_SAMPLES ? 2 * (size_t)work->context->workerCount : 0;
    *pairsOut =
        (vplPairWork){.work = work,
                      .geometry = work->sides->patches->geometry,
                      .trace = vplGetRayKernels(work->context->isa)->anyPacket,
                      .rays = vplArena_AllocZero(work->scratch, (size_t)tasks, sizeof *pairsOut->rays),
                      .analyticPairs = vplArena_AllocZero(work->scratch, (size_t)tasks, sizeof(int64_t)),
                      .samples = vplArena_AllocZero(work->scratch, samples, sizeof *pairsOut->samples)};
    return vplArena_Check(work->scratch);
}

void vplPairWork_Count(const vplPairWork* pairs, int tasks)
{
    for (int i = 0; i < tasks; i++) {
        pairs->work->factors->rays += pairs->rays[i];
        pairs->work->factors->analyticPairs += pairs->analyticPairs[i];
    }
}

static void fillRow(void* data, int row, int worker)
{
    const vplPairWork* pairs = data;
    vplPairWork_Fill(pairs, row, worker, row, row, pairs->work->blockCount, NULL);
}

vplResult vplFactorWork_FillRows(vplFactorWork* work)
{
    vplPairWork pairs;
    TRY(vplPairWork_Open(work, work->blockCount, &pairs));
    TRY(vplParallelForProgress(work->context, work->blockCount, fillRow, &pairs,
                               (vplProgressRange){work->def.progress, work->def.progressUser, 0, 1}));
    vplPairWork_Count(&pairs, work->blockCount);
    return VPL_SUCCESS;
}
