// SPDX-License-Identifier: MIT
// The colour spaces of FLIP.
#ifndef VPL_IMAGE_FLIP_COLOUR_H
#define VPL_IMAGE_FLIP_COLOUR_H

// Converts linear RGB, clamped to [0, 1], to YCxCz: luminance in [-16, 100], red-green, blue-yellow.
void vplToOpponent(const float rgb[3], float opponent[3]);

// Perceived distance between two YCxCz colours: HyAB, |dL| + |d(a, b)|, in Hunt-adjusted L*a*b*, after
// clamping to the RGB cube.
double vplHuntHyab(const float a[3], const float b[3]);

// That distance between linear green and blue, the largest that two colours can have.
double vplHuntHyabOfGreenAndBlue(void);

#endif
