// SPDX-License-Identifier: MIT
// Based on: IEC 61966-2-1 (sRGB). The table holds the 255 thresholds between codes. No slot has more than one
// of them: they are densest just below 1, with 67 per octave of 128 slots.
#include "image/srgb.h"

#include "math/scalar.h"

#include <string.h>

static double encode(double linear)
{
    if (!(linear > 0)) {
        return 0;
    }
    if (linear >= 1) {
        return 1;
    }
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * vplPow(linear, 1 / 2.4) - 0.055;
}

static double decode(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : vplPow((encoded + 0.055) / 1.055, 2.4);
}

float vplSrgb_Encode(float linear)
{
    return (float)encode(linear);
}

float vplSrgb_Decode(float encoded)
{
    return (float)decode(vplClampf(encoded, 0, 1));
}

uint8_t vplSrgb_Code(float linear)
{
    return (uint8_t)(255 * encode(linear) + 0.5);
}

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
        float x = vplSrgb_Decode(((float)code + 0.5f) / 255); // a few units in the last place off
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
        x = x > 0x1p-13f ? x : 0x1p-13f; // also NaN
        x = x < 1 ? x : 1 - 0x1p-24f;    // has the last code, like 1
        uint32_t bits;
        memcpy(&bits, &x, sizeof bits);
        const uint8_t code = table->code[(bits >> VPL_SRGB_SHIFT) - VPL_SRGB_FIRST];
        codesOut[i] = (uint8_t)(code + (x >= table->next[code]));
    }
}
