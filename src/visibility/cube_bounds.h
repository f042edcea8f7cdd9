// SPDX-License-Identifier: MIT
// What all texels in a square window of a cube map have in common, so that many shadow tests need one look.
// Based on: the depth hierarchy of Ned Greene, Michael Kass and Gavin Miller, Hierarchical Z-Buffer Visibility,
// SIGGRAPH 1993. Departs: the near side is bounded by planes instead of a smallest depth, because a floor seen
// at a slant spans more depth within a window than any bias; and windows overlap by half, so that a footprint
// not larger than half a window always lies within one.
#ifndef VPL_VISIBILITY_CUBE_BOUNDS_H
#define VPL_VISIBILITY_CUBE_BOUNDS_H

#include <vpl/visibility.h>

#include "base/isa.h"

// How many planes bound a window, and how.
typedef enum vplBoundKind {
    VPL_BOUND_ONE,    // both planes are the same
    VPL_BOUND_EITHER, // the texels lie behind each of both: an edge that sticks out
    VPL_BOUND_BOTH // every texel lies behind one of both at least: an inner edge, or one thing before another
} vplBoundKind;

// Of the texels in one window. A texel whose centre is in the unit direction d at distance D (stored distance
// times far) lies behind a plane if (plane . d) D >= 1. Where all texels show one plane, the bound is its normal
// divided by its distance from the map's position, but for rounding. Axes are the face's right, up and forward.
typedef struct vplCubeBound {
    float planes[2][3];
    float farthest; // no stored distance is larger
    int32_t kind;
} vplCubeBound;

enum { VPL_BOUND_LEVELS = 10 };

// Level k has a window at every multiple of (tile << k) texels in both directions, side[k]^2 in a face, each two
// such steps wide or up to the end of the face.
typedef struct vplCubeBounds {
    int tile, tileShift; // texels between two windows of level 0, and its binary logarithm
    int levelCount;
    int side[VPL_BOUND_LEVELS], first[VPL_BOUND_LEVELS];
    vplCubeBound
        bounds[]; // window (i, j) of level k of a face: first[k] + (face * side[k] + j) * side[k] + i
} vplCubeBounds;

// A square of texels in a face, or what of it lies inside the face.
typedef struct vplCubeTile {
    const float* texels; // the first; the next row is `size` further
    float far;
    int size;                             // texels along the face
    int column, row, width, height, side; // width and height are at most `side`, a multiple of VPL_LANES
} vplCubeTile;

enum { VPL_MAX_CUBE_TILE = 32 };

// False where the texels of a tile do not lie in one plane: then the bound is undefined.
typedef bool vplFlatTileFcn(const vplCubeTile* tile, vplCubeBound* boundOut);

enum { VPL_BOUND_CANDIDATES = 6 };

// How far planes must be raised for a region to lie behind them: each alone, and two together so that it lies
// behind their higher one. At least 0.
typedef struct vplRaises {
    double one[VPL_BOUND_CANDIDATES], two[VPL_BOUND_CANDIDATES][VPL_BOUND_CANDIDATES];
} vplRaises;

// The raises of a tile; of two[i][k] those with i < k are set. Returns the largest stored distance.
typedef float vplTileRaisesFcn(const vplCubeTile* tile, const float planes[][3], int count,
                               vplRaises* raisesOut);

#endif
