// SPDX-License-Identifier: MIT
// An assembly from the inside.
#ifndef VPL_RENDER_ASSEMBLY_H
#define VPL_RENDER_ASSEMBLY_H

#include "base/context.h"
#include "render/piece_file.h"

// A piece of a mean whose pass waits for those before it.
typedef struct vplWaiting {
    int index;
    float* values; // of the pass, then of its direct light if pieces have it
    double share;
} vplWaiting;

struct vplAssembly {
    vplContext* context;
    vplPieceHeader first; // of the first piece that was added; grid.count 0: none was
    vplImage* base;       // direct light of a mean, else the picture
    double* sums;         // of the passes of a mean
    vplImage* direct;     // direct light alone, of a mean the sum over passes; NULL: no piece has it
    double* weights;      // of each band
    int* next;            // the pass of each band that is added next
    // By index. A header may promise 2^31 pieces, so those that came decide how much memory is taken.
    vplWaiting* waiting;
    size_t waitingCount, waitingRoom;
    int missing;
};

#endif
