// SPDX-License-Identifier: MIT
// Points by the cell of space that they lie in: a hash table whose slots chain points. Cells that share a slot share a
// chain, so callers test distances.
#ifndef VPL_GEOMETRY_POINT_CELLS_H
#define VPL_GEOMETRY_POINT_CELLS_H

#include "base/arena.h"

#include <vpl/vecmath.h>

typedef struct vplPointCells {
    const vplVec3* points;
    int *table, *next; // of slots and of points; -1: no more
    size_t mask;
    double size; // of a cell, metres
} vplPointCells;

typedef struct vplCell {
    int64_t at[3];
} vplCell;

// Makes an empty table for up to `count` points. The points outlive it.
vplResult vplPointCells_Create(vplArena* arena, const vplVec3* points, size_t count, double size,
                               vplPointCells* cellsOut);

void vplPointCells_Add(vplPointCells* cells, int point);

vplCell vplPointCells_At(const vplPointCells* cells, const double position[3]);

// The first point of the chain in which the points of a cell are; next[] goes on. -1: none.
int vplPointCells_First(const vplPointCells* cells, const vplCell* cell);

#endif
