// SPDX-License-Identifier: MIT
// Codes grow with the light, so 255 thresholds say all. No slot holds more than one of them: where they are nearest
// together, just below 1, 67 share an octave.
#include "image/srgb_table.h"

#include <math.h>
#include <string.h>

static float floatOf(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

void vplSrgbTable_Fill(vplSrgbTable* table)
{
    table->next[255] = INFINITY;
    for (int code = 0; code < 255; code++) {
        float x = vplSrgb_Decode(((float)code + 0.5f) / 255); // a few units off
        while (vplSrgb_Code(x) > code) {
            x = nextafterf(x, 0);
        }
        while (vplSrgb_Code(x) <= code) {
            x = nextafterf(x, 2);
        }
        table->next[code] = x;
    }
    for (uint32_t slot = 0, code = 0; slot < VPL_SRGB_SLOTS; slot++) {
        const float least = floatOf((VPL_SRGB_FIRST + slot) << VPL_SRGB_SHIFT);
        while (least >= table->next[code]) {
            code++;
        }
        table->code[slot] = (uint8_t)code;
    }
}

void vplSrgbTable_Encode(const vplSrgbTable* table, const float* linear, size_t count, uint8_t* codesOut)
{
    for (size_t i = 0; i < count; i++) {
        float x = linear[i];
        x = x > 0x1p-13f ? x : 0x1p-13f; // NaN, too
        x = x < 1 ? x : 1 - 0x1p-24f;    // the last float before 1 has the last code, too
        uint32_t bits;
        memcpy(&bits, &x, sizeof bits);
        const uint8_t code = table->code[(bits >> VPL_SRGB_SHIFT) - VPL_SRGB_FIRST];
        codesOut[i] = (uint8_t)(code + (x >= table->next[code]));
    }
}
