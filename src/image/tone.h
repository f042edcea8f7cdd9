// SPDX-License-Identifier: MIT
// Shared by exposure and tone maps.
#ifndef VPL_IMAGE_TONE_H
#define VPL_IMAGE_TONE_H

#include <vpl/imagetools.h>

// Luminance of linear sRGB (Rec. 709).
static inline double vplLuminance(const float* pixel)
{
    return 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2];
}

#endif
