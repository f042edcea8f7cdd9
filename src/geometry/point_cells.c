// SPDX-License-Identifier: MIT
#include "geometry/point_cells.h"

#include "math/double3.h"

#include <math.h>
#include <string.h>

vplResult vplPointCells_Create(vplArena* arena, const vplVec3* points, size_t count, double size,
                               vplPointCells* cells)
{
    *cells = (vplPointCells){.points = points, .mask = 15, .size = size};
    while (cells->mask < count) {
        cells->mask = 2 * cells->mask + 1;
    }
    cells->table = vplArena_Alloc(arena, cells->mask + 1, sizeof *cells->table);
    cells->next = vplArena_Alloc(arena, count, sizeof *cells->next);
    TRY(vplArena_Check(arena));
    memset(cells->table, 0xff, (cells->mask + 1) * sizeof *cells->table);
    return VPL_SUCCESS;
}

static size_t slotOf(const vplPointCells* cells, const vplCell* cell)
{
    uint64_t h = (uint64_t)cell->at[0] * UINT64_C(0x9E3779B97F4A7C15);
    h = (h ^ (h >> 32) ^ (uint64_t)cell->at[1]) * UINT64_C(0xBF58476D1CE4E5B9);
    h = (h ^ (h >> 32) ^ (uint64_t)cell->at[2]) * UINT64_C(0x94D049BB133111EB);
    return (size_t)(h ^ (h >> 32)) & cells->mask;
}

vplCell vplPointCells_At(const vplPointCells* cells, const double position[3])
{
    vplCell cell;
    for (int k = 0; k < 3; k++) {
        cell.at[k] = (int64_t)floor(position[k] / cells->size);
    }
    return cell;
}

int vplPointCells_First(const vplPointCells* cells, const vplCell* cell)
{
    return cells->table[slotOf(cells, cell)];
}

void vplPointCells_Add(vplPointCells* cells, int point)
{
    double at[3];
    vplToDouble3(cells->points[point], at);
    const vplCell cell = vplPointCells_At(cells, at);
    const size_t slot = slotOf(cells, &cell);
    cells->next[point] = cells->table[slot];
    cells->table[slot] = point;
}
