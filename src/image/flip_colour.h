// SPDX-License-Identifier: MIT
// The colour spaces of FLIP, all from and to floats of one pixel.
#ifndef VPL_IMAGE_FLIP_COLOUR_H
#define VPL_IMAGE_FLIP_COLOUR_H

// Linear RGB, clamped to [0, 1], to YCxCz: luminance from -16 to 100, red-green, blue-yellow.
void vplToOpponent(const float rgb[3], float opponent[3]);

// Distance of two YCxCz colours as seen: clamped to the RGB cube, in L*a*b* with Hunt's effect, |dL| + |d(a, b)|.
double vplHuntHyab(const float a[3], const float b[3]);

// The largest distance that there is.
double vplHuntHyabOfGreenAndBlue(void);

#endif
