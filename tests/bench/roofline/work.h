// SPDX-License-Identifier: MIT
// The functions that run the loops, for the table in loops.c.
#ifndef VPL_BENCH_ROOFLINE_WORK_H
#define VPL_BENCH_ROOFLINE_WORK_H

#include "roofline.h"

enum { MAP = 1024, SMALL_MAP = 16 };
enum { FILL_NEARER = 0, FILL_HIDDEN, FILL_ADD, FILL_ADD_CHEAP, FILL_ADD_IDLE };
enum { RAY_CHAIN = 0, RAY_SINGLE, RAY_BLOCKS };

// Each function takes a Work and one of the constants above (lights: 1 for physical), and returns how many
// items it did.
typedef double LoopFcn(void* work, int which);

LoopFcn addLights, addLightsOneByOne, cullLights, fill, drawTexels, lookUp, traceRays;

#endif
