// SPDX-License-Identifier: MIT
// The windows of a cube map, level by level: four tiles make a window, and every other window of one level is
// a tile of the next. Each step only raises planes, so what holds for the tiles holds for the windows.
#include "visibility/cube_bounds.h"
#include "base/context.h"
#include "visibility/bound_planes.h"

#include <math.h>
#include <string.h>

VPL_KERNEL_TABLE(FLAT, vplFlatTileFcn, vplFlatTile);
VPL_KERNEL_TABLE(RAISES, vplTileRaisesFcn, vplTileRaises);

// Windows of 1/16 of a face or so are the narrowest, because the disc of samples is sized by the scene and not by
// texels: half of that takes 1.5 to 2 times as long and tells 1 % more points of a room, 7 % of a conference room.
// Tiles are whole vectors.
static int tileShift(int size)
{
    return size > 32 * VPL_LANES ? 5 : 4;
}

static vplCubeBounds* allocateBounds(vplContext* context, int size)
{
    vplCubeBounds layout = {.tileShift = tileShift(size)};
    layout.tile = 1 << layout.tileShift;
    size_t count = 0;
    do {
        const int step = layout.tile << layout.levelCount, side = (size + step - 1) / step;
        layout.side[layout.levelCount] = side;
        layout.first[layout.levelCount++] = (int)count;
        count += 6 * (size_t)side * (size_t)side;
    } while (layout.side[layout.levelCount - 1] > 4);
    vplCubeBounds* bounds = vplAlloc(context, sizeof layout + count * sizeof(vplCubeBound), 1);
    if (bounds != NULL) {
        memcpy(bounds, &layout, sizeof layout);
    }
    return bounds;
}

// What the tasks of a level need. A task is one row of windows of one face.
typedef struct Level {
    const vplCubeMap* map;
    vplCubeBounds* bounds;
    vplCubeBound* tiles; // of this level
    bool* flat;          // of level 0: one plane holds the corners
    int level;
} Level;

static vplCubeTile readTile(const Level* at, int face, int i, int j)
{
    const vplCubeMap* map = at->map;
    const int tile = at->bounds->tile, size = map->size, column = i * tile, row = j * tile;
    const int width = size - column, height = size - row;
    return (vplCubeTile){.texels = map->texels + ((size_t)face * (size_t)size + (size_t)row) * (size_t)size +
                                   column,
                         .far = map->far,
                         .size = size,
                         .column = column,
                         .row = row,
                         .width = width < tile ? width : tile,
                         .height = height < tile ? height : tile,
                         .side = tile};
}

static void findFlatTiles(void* data, int task, int worker)
{
    (void)worker;
    const Level* at = data;
    const int side = at->bounds->side[0];
    for (int i = 0; i < side; i++) {
        const vplCubeTile tile = readTile(at, task / side, i, task % side);
        const size_t place = (size_t)task * (size_t)side + (size_t)i;
        at->flat[place] = FLAT[at->map->context->isa](&tile, &at->tiles[place]);
    }
}

// Where a tile does not lie in one plane, what it shows is most often what the tiles around it show, or else
// nothing nearer than its nearest texel: the plane at infinity, raised.
static vplCubeBound boundOther(const Level* at, int face, int row, int column)
{
    const int side = at->bounds->side[0];
    const vplCubeTile tile = readTile(at, face, column, row);
    const vplTexelArea area = vplFindArea(at->map->size, tile.column, tile.row, tile.side);
    vplCandidates candidates = {{{0, 0, 0}}, 1};
    for (int k = 0; k < 9; k++) {
        const int x = column + k % 3 - 1, y = row + k / 3 - 1, place = (face * side + y) * side + x;
        if (x >= 0 && x < side && y >= 0 && y < side && at->flat[place]) {
            vplAddCandidate(&area, at->tiles[place].planes[0], &candidates);
        }
    }
    vplRaises raises;
    vplCubeBound bound = vplEmptyBound();
    bound.farthest = RAISES[at->map->context->isa](&tile, candidates.planes, candidates.count, &raises);
    vplChoosePlanes(&area, &candidates, &raises, &bound);
    return bound;
}

static void boundOtherTiles(void* data, int task, int worker)
{
    (void)worker;
    const Level* at = data;
    const int side = at->bounds->side[0];
    for (int i = 0; i < side; i++) {
        if (!at->flat[task * side + i]) {
            at->tiles[task * side + i] = boundOther(at, task / side, task % side, i);
        }
    }
}

// A tile that becomes part of a window.
typedef struct Part {
    const vplCubeBound* bound;
    vplTexelArea area;
} Part;

// How far the candidates must be raised over a part: what lies behind both of its planes needs the smaller raise,
// what lies behind one of them the larger.
static void raiseOver(const Part* part, const vplCandidates* c, vplRaises* raises)
{
    const bool both = part->bound->kind == VPL_BOUND_BOTH;
    double above[2][VPL_BOUND_CANDIDATES];
    for (int i = 0; i < c->count; i++) {
        for (int k = 0; k < 2; k++) {
            above[k][i] = vplMostAbove(&part->area, part->bound->planes[k], c->planes[i]);
        }
        const double one = both ? vplLarger(above[0][i], above[1][i]) : vplSmaller(above[0][i], above[1][i]);
        raises->one[i] = vplLarger(raises->one[i], one);
        for (int k = 0; k < i; k++) {
            const double first = vplSmaller(above[0][i], above[0][k]),
                         second = vplSmaller(above[1][i], above[1][k]);
            const double two = both ? vplLarger(first, second) : vplSmaller(first, second);
            raises->two[k][i] = vplLarger(raises->two[k][i], two);
        }
    }
}

// Most windows show one plane: that of the first part, raised over the others. False for all others.
static bool boundFlat(const vplTexelArea* area, const Part* parts, int count, vplCubeBound* bound)
{
    const float* plane = parts[0].bound->planes[0];
    const double same = VPL_SAME_PLANE * fabs((double)plane[2]);
    double raise = 0;
    float farthest = 0;
    for (int i = 0; i < count; i++) {
        const vplCubeBound* part = parts[i].bound;
        const double above = vplMostAbove(area, part->planes[0], plane);
        const double below = vplMostAbove(area, plane, part->planes[0]);
        if (part->kind != VPL_BOUND_ONE || !(vplLarger(above, below) <= same)) {
            return false;
        }
        raise = vplLarger(raise, above);
        farthest = part->farthest > farthest ? part->farthest : farthest;
    }
    vplRaisePlane(plane, raise, bound->planes[0]);
    memcpy(bound->planes[1], bound->planes[0], sizeof bound->planes[0]);
    bound->farthest = farthest;
    bound->kind = VPL_BOUND_ONE;
    return true;
}

static vplCubeBound boundParts(const vplTexelArea* area, const Part* parts, int count)
{
    vplCubeBound bound;
    if (boundFlat(area, parts, count, &bound)) {
        return bound;
    }
    bound = vplEmptyBound();
    vplCandidates candidates = {.count = 0};
    vplRaises raises = {{0}, {{0}}};
    for (int i = 0; i < count; i++) {
        bound.farthest =
            parts[i].bound->farthest > bound.farthest ? parts[i].bound->farthest : bound.farthest;
        vplAddCandidate(area, parts[i].bound->planes[0], &candidates);
        if (parts[i].bound->kind != VPL_BOUND_ONE) {
            vplAddCandidate(area, parts[i].bound->planes[1], &candidates);
        }
    }
    for (int i = 0; i < count; i++) {
        raiseOver(&parts[i], &candidates, &raises);
    }
    vplChoosePlanes(area, &candidates, &raises, &bound);
    return bound;
}

// One row of windows from the tiles of their level.
static void boundWindows(void* data, int task, int worker)
{
    (void)worker;
    const Level* at = data;
    const vplCubeBounds* b = at->bounds;
    const int side = b->side[at->level], step = b->tile << at->level, size = at->map->size;
    const int face = task / side, row = task % side;
    for (int column = 0; column < side; column++) {
        const vplTexelArea area = vplFindArea(size, column * step, row * step, 2 * step);
        Part parts[4];
        int count = 0;
        for (int k = 0; k < 4; k++) {
            const int i = column + (k & 1), j = row + (k >> 1);
            if (i < side && j < side) {
                parts[count++] = (Part){&at->tiles[(face * side + j) * side + i],
                                        vplFindArea(size, i * step, j * step, step)};
            }
        }
        at->bounds->bounds[b->first[at->level] + task * side + column] = boundParts(&area, parts, count);
    }
}

// A tile is as wide as two of the level below: the window there that starts where it starts.
static void collectTiles(const Level* at, int level)
{
    const vplCubeBounds* b = at->bounds;
    const int side = b->side[level], below = b->side[level - 1];
    for (int i = 0; i < 6 * side * side; i++) {
        const int face = i / (side * side), row = i / side % side, column = i % side;
        at->tiles[i] = b->bounds[b->first[level - 1] + (face * below + 2 * row) * below + 2 * column];
    }
}

static void findWindows(vplContext* context, Level* level)
{
    const vplCubeBounds* bounds = level->bounds;
    vplParallelFor(context, 6 * bounds->side[0], findFlatTiles, level);
    vplParallelFor(context, 6 * bounds->side[0], boundOtherTiles, level);
    for (level->level = 0; level->level < bounds->levelCount; level->level++) {
        if (level->level > 0) {
            collectTiles(level, level->level);
        }
        vplParallelFor(context, 6 * bounds->side[level->level], boundWindows, level);
    }
}

vplResult vplCubeMap_FindBounds(vplCubeMap* map)
{
    vplContext* context = map->context;
    vplCubeBounds* bounds = allocateBounds(context, map->size);
    if (bounds == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const size_t tiles = 6 * (size_t)bounds->side[0] * (size_t)bounds->side[0];
    Level level = {map, bounds, vplAlloc(context, tiles, sizeof *level.tiles),
                   vplAlloc(context, tiles, sizeof *level.flat), 0};
    const bool enough = level.tiles != NULL && level.flat != NULL;
    if (enough) {
        findWindows(context, &level);
    }
    vplFree(context, level.flat);
    vplFree(context, level.tiles);
    vplFree(context, enough ? (void*)map->bounds : bounds);
    map->bounds = enough ? bounds : map->bounds;
    return enough ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}
