// SPDX-License-Identifier: MIT
// All kernels of the rasterizer: one list, from which prototypes and a table for each instruction set are
// made.
#ifndef VPL_RASTER_KERNELS_H
#define VPL_RASTER_KERNELS_H

#include "base/isa.h"
#include "raster/raster.h"

// Draws the triangles refs[list[0]] to refs[list[count - 1]] of one command into one tile. `keep` stores the
// blocks for the passes instead of shading them.
typedef void vplDrawTileFcn(vplTileState* state, const vplRaster* raster, const vplCommand* command,
                            const int* list, int count, bool keep);

// Shades the kept blocks of a mesh by all passes of a chain.
typedef void vplRunPassesFcn(vplTileState* state, const vplRaster* raster, int firstCommand);

// X(type, field, function, instruction set)
#define VPL_RASTER_KERNELS(X, isa)                                                                           \
    X(vplDrawTileFcn, drawTile, vplDrawTile, isa)                                                            \
    X(vplRunPassesFcn, runPasses, vplRunPasses, isa)

#define VPL_PROTOTYPE(type, field, function, isa) type VPL_JOIN(function, isa);

typedef struct vplRasterKernels {
#define VPL_FIELD(type, field, function, isa) type* field;
    VPL_RASTER_KERNELS(VPL_FIELD, )
#undef VPL_FIELD
} vplRasterKernels;

const vplRasterKernels* vplRasterKernels_Get(vplIsa isa);

// In *_kernel.c: the prototypes of this instruction set.
#ifdef VPL_KERNEL_ISA
VPL_RASTER_KERNELS(VPL_PROTOTYPE, VPL_KERNEL_ISA)
#endif

#endif
