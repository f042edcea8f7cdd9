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

// X(type, field, function)
#define VPL_RASTER_KERNELS(X)                                                                                \
    X(vplDrawTileFcn, drawTile, vplDrawTile)                                                                 \
    X(vplRunPassesFcn, runPasses, vplRunPasses)

typedef struct vplRasterKernels {
    VPL_RASTER_KERNELS(VPL_KERNEL_FIELD)
} vplRasterKernels;

const vplRasterKernels* vplRasterKernels_Get(vplIsa isa);

#ifdef VPL_KERNEL_ISA
VPL_RASTER_KERNELS(VPL_KERNEL_PROTOTYPE)
#endif

#endif
