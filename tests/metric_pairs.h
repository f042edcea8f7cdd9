// SPDX-License-Identifier: MIT
// Makes pairs of pictures for tests of metrics, from integer arithmetic, so that other implementations can
// make the same.
#ifndef VPL_TESTS_METRIC_PAIRS_H
#define VPL_TESTS_METRIC_PAIRS_H

#include "test.h"

#include <stdlib.h>

// Hashes 32 bits to 32 well-mixed bits.
uint32_t mix(uint32_t n);

// Returns a byte of noise for value `index`.
int noise(uint32_t seed, uint32_t index);

int referenceValue(int pair, int x, int y, int channel, int width);

// Returns a value of the test picture: ramps with grain, edges shifted by (2, 1), or noise with some colours
// swapped or above 1.
float testValue(int pair, int x, int y, int channel, int width);

typedef struct Pair {
    vplImage *a, *b; // test and reference
} Pair;

Pair makePair(vplContext* context, int kind, int width, int height);

void freePair(Pair p);
vplImage* makeFlat(vplContext* context, int width, int height, float r, float g, float b);

#endif
