// SPDX-License-Identifier: MIT
// vplSrgb_Code by table, with the same result: the 6.2 million codes of 1920x1080 pixels take 8 ms instead of
// 300.
#ifndef VPL_IMAGE_SRGB_H
#define VPL_IMAGE_SRGB_H

#include <vpl/imagetools.h>

enum {
    // The bits of a float above these choose its slot: 128 slots per octave.
    VPL_SRGB_SHIFT = 16,
    // Slot of 2^-13. Smaller values are black.
    VPL_SRGB_FIRST = (127 - 13) << (23 - VPL_SRGB_SHIFT),
    VPL_SRGB_SLOTS = 13 << (23 - VPL_SRGB_SHIFT)
};

typedef struct vplSrgbTable {
    uint8_t code[VPL_SRGB_SLOTS]; // of the smallest float in a slot
    float next[256];              // the smallest float with the next code; infinity after the last
} vplSrgbTable;

void vplSrgbTable_Fill(vplSrgbTable* table);

// Stores vplSrgb_Code of `count` values.
void vplSrgbTable_Encode(const vplSrgbTable* table, const float* linear, size_t count, uint8_t* codesOut);

#endif
