// SPDX-License-Identifier: MIT
#ifndef VPL_SCENE_OBJ_NUMBER_H
#define VPL_SCENE_OBJ_NUMBER_H

#include <stdbool.h>

// Reads [start, end) as a decimal number: sign, digits with an optional point, exponent. False for anything
// else ("nan", "0x1", "1,5", ""). *out is the nearest float, ties to even, infinite beyond FLT_MAX, with the
// same bits on every machine and for every locale.
bool vplReadNumber(const char* start, const char* end, float* out);

#endif
