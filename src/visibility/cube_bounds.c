// SPDX-License-Identifier: MIT
// Builds the bounds of a cube map: the regions of level 0 from texels, each further level from the one below.
#include "visibility/cube_bounds.h"
#include "base/arena.h"
#include "visibility/kernels.h"

#include <string.h>

static vplCubeBounds* allocateBounds(vplArena* arena, int size)
{
    vplCubeBounds layout = {.levelCount = 0};
    int count = 0, side = (size + VPL_REGION_SIDE - 1) / VPL_REGION_SIDE;
    for (bool more = true; more; side = (side + 1) / 2) {
        more = side > 1;
        layout.side[layout.levelCount] = side;
        layout.first[layout.levelCount++] = count;
        count += 6 * side * side;
    }
    vplCubeBounds* bounds = vplArena_Alloc(arena, sizeof layout + (size_t)count * sizeof(vplCubeRegion), 1);
    if (bounds != NULL) {
        memcpy(bounds, &layout, sizeof layout);
    }
    return bounds;
}

// A task is one row of regions of a level: of all faces for level 0, else of one face.
typedef struct Level {
    const vplCubeMap* map;
    vplCubeBounds* bounds;
    int level;
} Level;

static void boundTexels(void* data, int row, int worker)
{
    (void)worker;
    const Level* at = data;
    vplVisibilityKernels_Get(at->map->context->isa)->boundRegions(at->map, row, at->bounds);
}

static void mergeRegions(void* data, int task, int worker)
{
    (void)worker;
    const Level* at = data;
    const vplCubeBounds* b = at->bounds;
    const int side = b->side[at->level], below = b->side[at->level - 1];
    const int face = task / side, row = 2 * (task % side);
    const vplCubeRegion* upper = b->regions + b->first[at->level - 1] + (face * below + row) * below;
    const vplCubeRegion* lower = row + 1 < below ? upper + below : upper;
    vplCubeRegion* out = at->bounds->regions + b->first[at->level] + task * side;
    for (int i = 0; i < side; i++) {
        const int left = 2 * i, right = vplMini(left + 1, below - 1);
        for (int k = 0; k < VPL_REGION_VALUES; k++) {
            out[i].least[k] = vplMinf(vplMinf(upper[left].least[k], upper[right].least[k]),
                                      vplMinf(lower[left].least[k], lower[right].least[k]));
        }
    }
}

vplResult vplCubeMap_FindBounds(vplCubeMap* map)
{
    REQUIRE(CONTEXT_OF(map), map);
    vplCubeBounds* bounds = allocateBounds(map->arena, map->size);
    if (bounds == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    Level level = {map, bounds, 0};
    TRY(vplParallelForAsking(map->context, bounds->side[0], boundTexels, &level));
    for (level.level = 1; level.level < bounds->levelCount; level.level++) {
        TRY(vplParallelForAsking(map->context, 6 * bounds->side[level.level], mergeRegions, &level));
    }
    vplArena_Free(map->arena, map->bounds);
    map->bounds = bounds;
    return VPL_SUCCESS;
}
