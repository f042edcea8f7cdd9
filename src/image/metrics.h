// SPDX-License-Identifier: MIT
// Helpers of the picture metrics.
#ifndef VPL_IMAGE_METRICS_H
#define VPL_IMAGE_METRICS_H

#include <vpl/imagetools.h>

// Fails unless both pictures have the same size and finite pixels.
vplResult vplRequirePair(const vplImage* a, const vplImage* b);

// Adds numbers from first to last, the order of summation of all metrics.
double vplSumInOrder(const double* values, int count);

#endif
