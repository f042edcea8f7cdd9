// SPDX-License-Identifier: MIT
#include "roofline.h"

#include "base/isa.h"

#define PEAK_KERNELS(X) X(PeakFcn, run, runPeak)

typedef struct PeakKernels {
    PEAK_KERNELS(VPL_KERNEL_FIELD)
} PeakKernels;

VPL_KERNEL_TABLE(PEAKS, PeakKernels, PEAK_KERNELS);

PeakFcn* getPeak(vplIsa isa)
{
    return PEAKS[isa].run;
}
