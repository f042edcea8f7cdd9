// SPDX-License-Identifier: MIT
// Pairs of pictures for tests of metrics, from whole numbers: the same in other implementations.
#ifndef VPL_TESTS_METRIC_PAIRS_H
#define VPL_TESTS_METRIC_PAIRS_H

#include "test.h"

#include <stdlib.h>

// 32 bits in, 32 well-mixed bits out.
uint32_t mix(uint32_t n);

// A byte of noise for value `index`.
int noise(uint32_t seed, uint32_t index);

int referenceValue(int pair, int x, int y, int channel, int width);

// Grain on ramps, edges shifted by (2, 1), or noise with colours that are swapped and beyond 1 here and
// there.
float testValue(int pair, int x, int y, int channel, int width);

typedef struct Pair {
    vplImage *a, *b; // test and reference
} Pair;

Pair makePair(vplContext* context, int kind, int width, int height);

void freePair(Pair p);
vplImage* makeFlat(vplContext* context, int width, int height, float r, float g, float b);

#endif
