// SPDX-License-Identifier: MIT
#ifndef VPL_SCENE_OBJ_NUMBER_H
#define VPL_SCENE_OBJ_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

// Reads [start, end) as a decimal number: sign, digits with an optional point, exponent. False for anything
// else ("nan", "0x1", "1,5", ""). *out is the nearest float, ties to even, infinite beyond FLT_MAX, with the
// same bits on every machine and for every locale. The byte at `end` must not continue the number: it is 0 or
// a blank.
bool vplReadNumber(const char* start, const char* end, float* out);

// Reads a decimal integer with an optional sign from *at, which it moves behind the digits. False if there is
// no digit. The value saturates near 2^50, beyond any index or useful exponent.
bool vplReadInteger(const char** at, const char* end, int64_t* out);

#endif
