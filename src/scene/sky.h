// SPDX-License-Identifier: MIT
// The clear sky and its sun, as numbers. Luminances are divided by 683 lm/W, so that they are radiances whose colour a
// display shows.
#ifndef VPL_SCENE_SKY_H
#define VPL_SCENE_SKY_H

#include <vpl/vecmath.h>

typedef struct vplSky {
    double turbidity;
    double sunTheta;        // angle between the sun and the zenith, radians
    double zenith[3];       // luminance Y in kcd/m^2, chromaticities x and y
    double perez[3][5];     // A to E of the distribution, for Y, x and y
    double atZenith[3];     // the distribution straight up
    double sunDirection[2]; // horizontal (+x) and vertical part of the direction to the sun
} vplSky;

// `elevation` of the sun in radians, [0, pi / 2]; turbidity in [2, 10].
vplSky vplSky_Make(double elevation, double turbidity);

// Radiance from a direction above the horizon (unit, y up), W/(m^2 sr).
vplRgb vplSky_Radiance(const vplSky* sky, const double direction[3]);

// Irradiance of the sun on a surface that faces it, W/m^2.
vplRgb vplSky_SunIrradiance(const vplSky* sky);

// Fills a picture of all directions, the sun left out. Below the horizon lies a ground that reflects a fifth of the light
// of sky and sun.
void vplSky_Paint(const vplSky* sky, int width, int height, float* pixels);

#endif
