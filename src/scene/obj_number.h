// SPDX-License-Identifier: MIT
#ifndef VPL_SCENE_OBJ_NUMBER_H
#define VPL_SCENE_OBJ_NUMBER_H

#include <stdbool.h>

// Reads [start, end) as a decimal number: sign, digits with a point among them, exponent. False if it is
// anything else ("nan", "0x1", "1,5", ""). *out is the nearest float, ties to even, infinite beyond FLT_MAX:
// the same bits everywhere, whatever the locale.
bool vplReadNumber(const char* start, const char* end, float* out);

#endif
