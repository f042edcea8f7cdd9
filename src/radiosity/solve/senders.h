// SPDX-License-Identifier: MIT
// Which sides send light to a side: a choice among them in proportion to what they send.
#ifndef VPL_RADIOSITY_SENDERS_H
#define VPL_RADIOSITY_SENDERS_H

#include "base/arena.h"
#include "radiosity/radiosity_kernels.h"

typedef struct vplSenders {
    const vplFormFactors* factors;
    int count, blockCount; // of sides, and of blocks of them in a row
    const float* light;    // radiosity of each side, mean over red, green and blue
    float* upTo; // [side][block]: the light that the side receives from this block and those before it
} vplSenders;

// `sent`: radiosity of each side, W/m^2; it is copied. The form factors must not be shared by a team. The arena owns the result, which takes a
// 32nd of the memory of the form factors.
vplResult vplSenders_Create(vplArena* arena, const vplTransport* transport, const vplRgb* sent,
                            vplSenders* sendersOut);

// The light that a side receives from all others.
static inline double vplSenders_Total(const vplSenders* s, int side)
{
    return (double)s->upTo[((size_t)side + 1) * (size_t)s->blockCount - 1];
}

// Chooses a side that sends light to `side`, whose total must be above 0, by u in [0, 1).
int vplSenders_Choose(const vplSenders* senders, int side, double u);

// The probability of that choice.
double vplSenders_Probability(const vplSenders* senders, int side, int sender);

#endif
