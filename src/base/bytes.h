// SPDX-License-Identifier: MIT
// Numbers in files, which are little-endian on every machine.
#ifndef VPL_BASE_BYTES_H
#define VPL_BASE_BYTES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline uint32_t vplTakeWord(const uint8_t* from)
{
    return from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
}

// Returns the byte behind what was put, like the functions below.
static inline uint8_t* vplPutWord(uint8_t* to, uint32_t word)
{
    for (int i = 0; i < 4; i++) {
        to[i] = (uint8_t)(word >> 8 * i);
    }
    return to + 4;
}

static inline uint8_t* vplPutFloats(uint8_t* to, const float* values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        to = vplPutWord(to, bits);
    }
    return to;
}

static inline uint8_t* vplPutDouble(uint8_t* to, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return vplPutWord(vplPutWord(to, (uint32_t)bits), (uint32_t)(bits >> 32));
}

#endif
