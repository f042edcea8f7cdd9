// SPDX-License-Identifier: MIT
#include "roofline.h"

#include "base/isa.h"

VPL_KERNEL_TABLE(PEAKS, PeakFcn, runPeak);

PeakFcn* getPeak(vplIsa isa)
{
    return PEAKS[isa];
}
