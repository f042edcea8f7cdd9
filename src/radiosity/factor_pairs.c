// SPDX-License-Identifier: MIT
// Form factors of all pairs of sides, sixteen at a time.
// Based on: Dan Hemgren, Radiosity in Realtime Rendering, 3.3.1: pairs of points with a ray each, half of the pairs by
// A_i F_ij = A_j F_ji. Departs: what two sides exchange with nothing between them is known better than by a few random
// points, so that rays only say how much of it arrives.
#include "base/context.h"
#include "base/isa.h"
#include "base/rng.h"
#include "geometry/bvh.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/form_factors.h"
#include "radiosity/polygon_factor.h"
#include "radiosity/shaft.h"

#include <string.h>

enum { LANES = VPL_FACTOR_LANES };

// The stream of random numbers that pairs of points are joined by.
enum { JOIN_STREAM = 0x4a4f0000 };

// Three points each do for sides whose middles are this many times the larger one's radius apart. In the report's box of
// 784 patches, against 1024 samples (mean over rows of the sum of |F - exact|; milliseconds of one thread): 1.25: 0.0173,
// 29; 1.5: 0.0154, 30; 2: 0.0146, 34; 3: 0.0140, 49; 6: 0.0137, 139. What is left is that of four rays; with 1: 0.0344,
// 16; 2: 0.0242, 21; 8: 0.0115, 48; 16: 0.0085, 85. Pairs of points alone (`analytic` false) 4: 0.107, 27; 16: 0.064, 83.
static const float NEAR = 1.5f;

VPL_KERNEL_TABLE(FIRST, vplFactorFirstFcn, vplFactorFirst);
VPL_KERNEL_TABLE(WEIGHTS, vplFactorWeightsFcn, vplFactorWeights);

typedef struct Filling {
    const vplPatchSides* sides;
    const vplGeometry* geometry;
    const vplFormFactorDef* def;
    const vplFactorBlock* blocks;
    int blockCount;
    float tolerance;
    vplFactorFirstFcn* first;
    vplFactorWeightsFcn* weights;
    vplTraceAnyPacketFcn* trace;
    float* rows;
    int64_t *rays, *analyticPairs; // one per task
    vplFactorPoints* points;       // two per worker: of the row and of the column, after the first sixteen
} Filling;

// Pairs of two blocks: side i of one, sixteen of the other.
typedef struct Tile {
    int row, column; // blocks
    const vplFactorBlock *a, *b;
    bool clear; // nothing stands between
    vplBlockers blockers;
    uint32_t seen[LANES];
    float known[LANES][LANES];  // what is exchanged without anything between, 1/m^2; analytic only
    float weight[LANES][LANES]; // sums over pairs of points
    float free[LANES][LANES];   // of those that no ray found blocked
    int64_t rays, analyticPairs;
} Tile;

// ---- before rays

// The share of what two whole sides exchange that their open cells do: by the middles of all cells.
static double openShare(const vplPatchSide* a, const vplPatchSide* b)
{
    const float middle = 2.0f / 3;
    double all = 0, open = 0;
    for (int i = 0; i < VPL_PATCH_CELLS; i++) {
        const vplVec3 p = vplPatchSide_SampleCell(a, i, middle, middle);
        for (int k = 0; k < VPL_PATCH_CELLS; k++) {
            const vplVec3 q = vplPatchSide_SampleCell(b, k, middle, middle);
            const double x = (double)(q.x - p.x), y = (double)(q.y - p.y), z = (double)(q.z - p.z);
            const double square = x * x + y * y + z * z;
            const double ca = x * (double)a->normal.x + y * (double)a->normal.y + z * (double)a->normal.z;
            const double cb = -(x * (double)b->normal.x + y * (double)b->normal.y + z * (double)b->normal.z);
            const double part = ca > 0 && cb > 0 ? ca / square * (cb / square) : 0;
            all += part;
            open += (a->open >> i & 1) && (b->open >> k & 1) ? part : 0;
        }
    }
    return all > 0 ? open / all : 0;
}

// The mean of cos cos / (pi r^2) over what is open of two sides, by the integral along their edges.
static float exactMean(const vplPatchSide* a, const vplPatchSide* b)
{
    const uint16_t all = (uint16_t)((1 << VPL_PATCH_CELLS) - 1);
    const double exchange = vplTriangleExchange(a->corners, b->corners, &vplEdgesQuick);
    const double share = a->open == all && b->open == all ? 1 : openShare(a, b);
    return (float)(exchange * share / (double)a->area / (double)b->area);
}

static void beginTile(const Filling* f, Tile* tile)
{
    memset(tile->weight, 0, sizeof tile->weight);
    memset(tile->free, 0, sizeof tile->free);
    for (int i = 0; i < LANES; i++) {
        vplFactorFirst first;
        f->first(tile->a, i, tile->b, f->tolerance, NEAR * NEAR, &first);
        tile->seen[i] = first.seen & (tile->row == tile->column ? 0xfffeu << i & 0xffffu : 0xffffu);
        if (!f->def->analytic || tile->seen[i] == 0) {
            continue;
        }
        memcpy(tile->known[i], first.middle, sizeof first.middle);
        for (uint32_t left = tile->seen[i] & first.near; left != 0; left &= left - 1) {
            const int l = __builtin_ctz(left);
            tile->known[i][l] = exactMean(&f->sides->sides[tile->row * LANES + i],
                                          &f->sides->sides[tile->column * LANES + l]);
            tile->analyticPairs++;
        }
        for (uint32_t left = tile->seen[i]; left != 0; left &= left - 1) {
            const int l = __builtin_ctz(left);
            tile->seen[i] &= ~((uint32_t) !(tile->known[i][l] > 0) << l);
        }
    }
}

// ---- rays

static uint32_t findBlocked(const Filling* f, const Tile* tile, const vplRayPacket* packet)
{
    if (!f->def->bruteForce) {
        return tile->blockers.count < 0 ? vplGeometry_AreOccluded(f->geometry, packet, 1)
                                        : f->trace(&tile->blockers.bvh, packet, 1);
    }
    uint32_t blocked = 0;
    for (uint32_t left = packet->active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        const vplRay ray = vplRayPacket_Get(packet, l);
        blocked |= (uint32_t)vplAnyOfTriangles(f->geometry, &ray, 1) << l;
    }
    return blocked;
}

// One pair of points for side i of the row and each side of the column that is asked for.
static void joinPoints(const Filling* f, Tile* tile, int i, uint32_t asked, const vplFactorPoints* from,
                       int at, const float to[3][LANES])
{
    const vplFactorBlock* a = tile->a;
    float weight[LANES];
    const float point[3] = {from->at[at][0][i], from->at[at][1][i], from->at[at][2][i]};
    const float normal[3] = {a->normal[0][i], a->normal[1][i], a->normal[2][i]};
    vplRayPacket packet;
    f->weights(point, normal, to, tile->b->normal, weight, packet.direction);
    packet.active = 0;
    for (int l = 0; l < LANES; l++) {
        packet.active |= (uint32_t)(weight[l] > 0) << l;
        packet.origin[0][l] = from->start[at][0][i];
        packet.origin[1][l] = from->start[at][1][i];
        packet.origin[2][l] = from->start[at][2][i];
        packet.skipFirst[l] = a->skipFirst[i];
        packet.skipCount[l] = a->skipCount[i];
    }
    packet.active &= asked;
    if (packet.active == 0) {
        return;
    }
    uint32_t blocked = 0;
    if (!tile->clear) {
        tile->rays += __builtin_popcount(packet.active);
        blocked = findBlocked(f, tile, &packet);
    }
    for (uint32_t left = packet.active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        tile->weight[i][l] += weight[l];
        tile->free[i][l] += blocked >> l & 1 ? 0 : weight[l];
    }
}

// Sides whose planes cut each other may have got only points that are behind them, and then nothing is known of what
// stands between. Such pairs get more points until one will do: with none, rows of the report's box of 784 patches sum to
// 0.2 % too little, and err by 0.0125 instead of 0.008.
static uint32_t notJoined(const Tile* tile, int i)
{
    uint32_t lanes = 0;
    for (int l = 0; l < LANES; l++) {
        lanes |= (uint32_t) !(tile->weight[i][l] > 0) << l;
    }
    return lanes & tile->seen[i];
}

// Points of four quarters meet those of four quarters, whatever the number of samples: both steps are odd.
static void joinBlocks(const Filling* f, Tile* tile, int chunk, const vplFactorPoints* from,
                       const vplFactorPoints* to)
{
    const int samples = f->def->samples - chunk * VPL_FACTOR_POINTS;
    for (int i = 0; i < LANES; i++) {
        const uint64_t index =
            (uint64_t)(tile->row * LANES + i) * (uint64_t)f->blockCount + (uint64_t)tile->column;
        uint32_t asked = tile->seen[i];
        const vplRandom4 r =
            asked ? vplRandomAt(f->def->seed, JOIN_STREAM + (uint32_t)chunk, index) : (vplRandom4){{0}};
        for (uint32_t k = 0; k < VPL_FACTOR_POINTS && asked != 0; k++) {
            joinPoints(f, tile, i, asked, from, (int)((r.v[0] + k) % VPL_FACTOR_POINTS),
                       to->at[(r.v[1] + 5 * k) % VPL_FACTOR_POINTS]);
            if ((int)k + 1 >= samples) {
                asked = f->def->analytic ? notJoined(tile, i) : 0;
            }
        }
    }
}

static void castRays(const Filling* f, Tile* tile, int worker)
{
    uint32_t any = 0;
    for (int i = 0; i < LANES; i++) {
        any |= tile->seen[i];
    }
    if (any == 0) {
        return;
    }
    if (!f->def->bruteForce) {
        vplBlockers_Find(f->geometry, tile->a, tile->b, f->tolerance, &tile->blockers);
        tile->clear = tile->blockers.count == 0;
        if (tile->clear && f->def->analytic) {
            return;
        }
    }
    if (f->def->kind == VPL_FORM_FACTORS_INCENTRE) {
        for (int i = 0; i < LANES; i++) {
            if (tile->seen[i] != 0) {
                joinPoints(f, tile, i, tile->seen[i], &tile->a->points, 0, tile->b->points.at[0]);
            }
        }
        return;
    }
    joinBlocks(f, tile, 0, &tile->a->points, &tile->b->points);
    for (int chunk = 1; chunk * VPL_FACTOR_POINTS < f->def->samples; chunk++) {
        vplFactorPoints* points = f->points + 2 * (size_t)worker;
        vplFactorPoints_Fill(f->sides, f->def, tile->row, chunk, &points[0]);
        vplFactorPoints_Fill(f->sides, f->def, tile->column, chunk, &points[1]);
        joinBlocks(f, tile, chunk, &points[0], &points[1]);
    }
}

// ---- all of it

// The mean that was found, of cos cos V / (pi r^2).
static float meanOf(const Filling* f, const Tile* tile, int i, int l)
{
    const float weight = tile->weight[i][l], open = tile->free[i][l];
    if (f->def->kind == VPL_FORM_FACTORS_INCENTRE) {
        return open;
    }
    if (!f->def->analytic) {
        return open / (float)f->def->samples;
    }
    return tile->clear ? tile->known[i][l] : weight > 0 ? tile->known[i][l] * (open / weight) : 0;
}

// Neither side can get more than all that the other sends (X095).
static void storeTile(const Filling* f, const Tile* tile)
{
    const size_t count = (size_t)f->sides->count;
    const bool whole = f->def->kind == VPL_FORM_FACTORS_INCENTRE;
    for (int i = 0; i < LANES; i++) {
        const size_t row = (size_t)tile->row * LANES + (size_t)i;
        for (uint32_t left = tile->seen[i]; left != 0; left &= left - 1) {
            const int l = __builtin_ctz(left);
            const size_t column = (size_t)tile->column * LANES + (size_t)l;
            const float mean = meanOf(f, tile, i, l), areaA = tile->a->area[i], areaB = tile->b->area[l];
            const float larger = areaA > areaB ? areaA : areaB;
            const float most = whole ? mean : vplMinf(mean, 1 / larger);
            f->rows[row * count + column] = most * areaB;
            f->rows[column * count + row] = most * areaA;
        }
    }
}

static void fillRow(void* data, int row, int worker)
{
    const Filling* f = data;
    Tile tile = {.row = row, .a = &f->blocks[row]};
    for (int column = row; column < f->blockCount; column++) {
        tile.column = column;
        tile.b = &f->blocks[column];
        beginTile(f, &tile);
        castRays(f, &tile, worker);
        storeTile(f, &tile);
    }
    f->rays[row] = tile.rays;
    f->analyticPairs[row] = tile.analyticPairs;
}

// Half a unit in the last place of the largest coordinate, eight times: sides in one plane see nothing of each other.
static float toleranceOf(const vplGeometry* g)
{
    float largest = 0;
    for (int k = 0; k < 3; k++) {
        const float low = fabsf(vplComponent(g->boundsMin, k)), high = fabsf(vplComponent(g->boundsMax, k));
        largest = vplMaxf(largest, vplMaxf(low, high));
    }
    return largest * 0x1p-21f;
}

vplResult vplFormFactors_Fill(const vplPatchSides* sides, const vplFormFactorDef* def,
                              const vplFactorBlock* blocks, vplFormFactors* factors)
{
    vplContext* context = sides->context;
    Filling f = {.sides = sides,
                 .geometry = sides->patches->geometry,
                 .def = def,
                 .blocks = blocks,
                 .blockCount = (sides->count + LANES - 1) / LANES,
                 .tolerance = toleranceOf(sides->patches->geometry),
                 .first = FIRST[context->isa],
                 .weights = WEIGHTS[context->isa],
                 .trace = vplGetRayKernels(context->isa)->anyPacket,
                 .rows = (float*)factors->rows};
    const size_t pointCount = def->samples > VPL_FACTOR_POINTS ? 2 * (size_t)context->workerCount : 0;
    f.rays = vplAllocZero(context, (size_t)f.blockCount, sizeof *f.rays);
    f.analyticPairs = f.rays ? vplAllocZero(context, (size_t)f.blockCount, sizeof *f.analyticPairs) : NULL;
    f.points = f.analyticPairs ? vplAllocZero(context, pointCount, sizeof *f.points) : NULL;
    vplResult result = f.points ? vplGeometry_PrepareRays(f.geometry) : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS) {
        result = vplParallelForProgress(context, f.blockCount, fillRow, &f, def->progress, def->progressUser,
                                        0, 1);
    }
    for (int i = 0; i < f.blockCount && result == VPL_SUCCESS; i++) {
        factors->rays += f.rays[i];
        factors->analyticPairs += f.analyticPairs[i];
    }
    vplFree(context, f.rays);
    vplFree(context, f.analyticPairs);
    vplFree(context, f.points);
    return result;
}
