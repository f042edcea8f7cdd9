// SPDX-License-Identifier: MIT
#include "radiosity/factors/shared_rows.h"

#include <string.h>

enum { LANES = VPL_SHARED_LANES };

// The columns of a row that came in one round.
typedef struct Part {
    const uint16_t* masks; // of the row
    float* values;
    int first, end; // blocks
} Part;

static Part partOf(const vplSharedRows* s, int row, int round)
{
    const size_t own = (size_t)(row / s->members);
    const int first = round * s->perRound;
    const bool last = round == vplSharedRows_LastRound(s, row);
    return (Part){.masks = s->masks + own * (size_t)s->blocks,
                  .values = s->values[round] + s->starts[(size_t)round * (size_t)s->ownCount + own],
                  .first = first,
                  .end = last ? s->blocks : first + s->perRound};
}

void vplSharedRows_Decode(const vplSharedRows* s, int i, float* room)
{
    memset(room, 0, vplSharedRows_Columns(s) * sizeof *room);
    for (int round = 0; round <= vplSharedRows_LastRound(s, i); round++) {
        const Part part = partOf(s, i, round);
        const float* from = part.values;
        for (int b = part.first; b < part.end; b++) {
            float* to = room + (size_t)b * LANES;
            for (uint32_t left = part.masks[b]; left != 0; left &= left - 1) {
                to[__builtin_ctz(left)] = *from++;
            }
        }
    }
}

void vplSharedRows_Encode(const vplSharedRows* s, int i, const float* room)
{
    for (int round = 0; round <= vplSharedRows_LastRound(s, i); round++) {
        const Part part = partOf(s, i, round);
        float* to = part.values;
        for (int b = part.first; b < part.end; b++) {
            const float* from = room + (size_t)b * LANES;
            for (uint32_t left = part.masks[b]; left != 0; left &= left - 1) {
                *to++ = from[__builtin_ctz(left)];
            }
        }
    }
}
