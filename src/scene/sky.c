// SPDX-License-Identifier: MIT
// Based on: A. J. Preetham, Peter Shirley and Brian Smits, A Practical Analytic Model for Daylight, SIGGRAPH 1999:
// appendix A.1 (transmittances of the sun's light), A.2 (Perez coefficients, chromaticity and luminance of the zenith) and
// table 2 (radiance of the sun, absorption by ozone and water vapour). Chris Wyman, Peter-Pike Sloan and Peter Shirley,
// Simple Analytic Approximations to the CIE XYZ Color Matching Functions, JCGT 2013. Departs: mixed gases are left out,
// which absorb beyond 759 nm only; a grey ground lies below the horizon, where the model has no values.
#include "scene/sky.h"

#include "math/scalar.h"

static const double LUMENS_PER_WATT = 683;
static const double GROUND_REFLECTANCE = 0.2; // of grass and soil

// ---- colours

// Linear sRGB (D65) of X, Y, Z; what no display shows becomes 0.
static vplRgb rgbOf(const double xyz[3])
{
    static const double rows[3][3] = {{3.2404542, -1.5371385, -0.4985314},
                                      {-0.9692660, 1.8760108, 0.0415560},
                                      {0.0556434, -0.2040259, 1.0572252}};
    float out[3];
    for (int i = 0; i < 3; i++) {
        const double value = rows[i][0] * xyz[0] + rows[i][1] * xyz[1] + rows[i][2] * xyz[2];
        out[i] = value > 0 ? (float)value : 0;
    }
    return (vplRgb){out[0], out[1], out[2]};
}

// A Gaussian whose width differs on both sides of its middle; nanometres.
static double lobe(double wavelength, double middle, double below, double above)
{
    const double t = (wavelength - middle) / (wavelength < middle ? below : above);
    return vplExp(-0.5 * t * t);
}

static void matchColour(double nm, double xyz[3])
{
    xyz[0] = 1.056 * lobe(nm, 599.8, 37.9, 31.0) + 0.362 * lobe(nm, 442.0, 16.0, 26.7) -
             0.065 * lobe(nm, 501.1, 20.4, 26.2);
    xyz[1] = 0.821 * lobe(nm, 568.8, 46.9, 40.5) + 0.286 * lobe(nm, 530.9, 16.3, 31.1);
    xyz[2] = 1.217 * lobe(nm, 437.0, 11.8, 36.0) + 0.681 * lobe(nm, 459.0, 26.0, 13.8);
}

// ---- the sky

static double polynomial(const double c[4], double x)
{
    return ((c[0] * x + c[1]) * x + c[2]) * x + c[3];
}

// Chromaticity of the zenith: rows for T^2, T and 1, each a polynomial in the angle between sun and zenith.
static double chromaticity(const double rows[3][4], double turbidity, double theta)
{
    return (polynomial(rows[0], theta) * turbidity + polynomial(rows[1], theta)) * turbidity +
           polynomial(rows[2], theta);
}

static double distribution(const double p[5], double cosTheta, double gamma, double cosGamma)
{
    return (1 + p[0] * vplExp(p[1] / cosTheta)) *
           (1 + p[2] * vplExp(p[3] * gamma) + p[4] * cosGamma * cosGamma);
}

static void findZenith(vplSky* s)
{
    static const double x[3][4] = {{0.00166, -0.00375, 0.00209, 0},
                                   {-0.02903, 0.06377, -0.03202, 0.00394},
                                   {0.11693, -0.21196, 0.06052, 0.25886}};
    static const double y[3][4] = {{0.00275, -0.00610, 0.00317, 0},
                                   {-0.04214, 0.08970, -0.04153, 0.00516},
                                   {0.15346, -0.26756, 0.06670, 0.26688}};
    const double t = s->turbidity, theta = s->sunTheta;
    double sine, cosine;
    vplSinCos((4.0 / 9 - t / 120) * (VPL_PI - 2 * theta), &sine, &cosine);
    s->zenith[0] = (4.0453 * t - 4.9710) * (sine / cosine) - 0.2155 * t + 2.4192;
    s->zenith[1] = chromaticity(x, t, theta);
    s->zenith[2] = chromaticity(y, t, theta);
}

vplSky vplSky_Make(double elevation, double turbidity)
{
    // Slope and offset in T of A to E, for Y, x and y.
    static const double perez[3][5][2] = {
        {{0.1787, -1.4630}, {-0.3554, 0.4275}, {-0.0227, 5.3251}, {0.1206, -2.5771}, {-0.0670, 0.3703}},
        {{-0.0193, -0.2592}, {-0.0665, 0.0008}, {-0.0004, 0.2125}, {-0.0641, -0.8989}, {-0.0033, 0.0452}},
        {{-0.0167, -0.2608}, {-0.0950, 0.0092}, {-0.0079, 0.2102}, {-0.0441, -1.6537}, {-0.0109, 0.0529}}};
    vplSky s = {.turbidity = turbidity, .sunTheta = VPL_PI / 2 - elevation};
    vplSinCos(elevation, &s.sunDirection[1], &s.sunDirection[0]);
    findZenith(&s);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 5; k++) {
            s.perez[i][k] = perez[i][k][0] * turbidity + perez[i][k][1];
        }
        s.atZenith[i] = distribution(s.perez[i], 1, s.sunTheta, s.sunDirection[1]);
    }
    return s;
}

vplRgb vplSky_Radiance(const vplSky* s, const double d[3])
{
    const double up = d[1] > 1e-3 ? d[1] : 1e-3; // the distribution ends at the horizon
    const double cosGamma = s->sunDirection[0] * d[0] + s->sunDirection[1] * d[1];
    const double gamma = vplAcos(cosGamma);
    double value[3];
    for (int i = 0; i < 3; i++) {
        value[i] = s->zenith[i] * distribution(s->perez[i], up, gamma, cosGamma) / s->atZenith[i];
    }
    const double luminance = value[0] > 0 ? 1000 * value[0] / LUMENS_PER_WATT : 0;
    const double xyz[3] = {luminance * value[1] / value[2], luminance,
                           luminance * (1 - value[1] - value[2]) / value[2]};
    return rgbOf(xyz);
}

// ---- the sun

enum { WAVELENGTHS = 38, FIRST_NM = 380, STEP_NM = 10 };

// Radiance outside the atmosphere, 10 W/(m^2 nm sr).
static const double SUN_RADIANCE[WAVELENGTHS] = {1655, 1623, 2112, 2588, 2582, 2423, 2676, 2966, 3054, 3006,
                                                 3066, 2883, 2871, 2782, 2710, 2723, 2636, 2550, 2506, 2531,
                                                 2535, 2513, 2463, 2417, 2368, 2321, 2282, 2234, 2197, 2153,
                                                 2110, 2073, 2024, 1987, 1943, 1907, 1863, 1826};

// Absorption by ozone, 1/cm.
static const double OZONE[WAVELENGTHS] = {
    0,     0,     0,     0,     0,     0,     0,     0.003, 0.006, 0.009, 0.014, 0.021, 0.030,
    0.040, 0.048, 0.063, 0.075, 0.085, 0.103, 0.120, 0.120, 0.115, 0.125, 0.120, 0.105, 0.090,
    0.079, 0.067, 0.057, 0.048, 0.036, 0.028, 0.023, 0.018, 0.014, 0.011, 0.010, 0.009};

// Absorption by water vapour from 690 nm on, 1/cm.
enum { FIRST_WATER = 31 };
static const double WATER[WAVELENGTHS - FIRST_WATER] = {0.016, 0.024, 0.0125, 1.0, 0.87, 0.061, 0.001};

// Share of the sun's light of wavelength i that arrives through `mass` atmospheres.
static double transmittance(int i, double turbidity, double mass)
{
    const double micrometres = 1e-3 * (FIRST_NM + STEP_NM * i), haze = 0.04608 * turbidity - 0.04586;
    const double ozoneCm = 0.35, waterCm = 2;
    const double water = i >= FIRST_WATER ? WATER[i - FIRST_WATER] * waterCm * mass : 0;
    return vplExp(-0.008735 * mass * vplPow(micrometres, -4.08) - haze * mass * vplPow(micrometres, -1.3) -
                  OZONE[i] * ozoneCm * mass - 0.2385 * water / vplPow(1 + 20.07 * water, 0.45));
}

vplRgb vplSky_SunIrradiance(const vplSky* s)
{
    const double solidAngle = 6.7443e-5, degrees = s->sunTheta * (180 / VPL_PI);
    const double mass = 1 / (s->sunDirection[1] + 0.15 * vplPow(93.885 - degrees, -1.253));
    double sum[3] = {0, 0, 0};
    for (int i = 0; i < WAVELENGTHS; i++) {
        double xyz[3];
        const double irradiance =
            10 * SUN_RADIANCE[i] * transmittance(i, s->turbidity, mass) * solidAngle * STEP_NM;
        matchColour(FIRST_NM + STEP_NM * i, xyz);
        for (int k = 0; k < 3; k++) {
            sum[k] += irradiance * xyz[k];
        }
    }
    return rgbOf(sum);
}

// ---- the picture

// The direction of a pixel's centre, and the solid angle of the pixel.
static double pixelDirection(int x, int y, int width, int height, double direction[3])
{
    double sinTheta, cosTheta, sinPhi, cosPhi, unused, top, bottom;
    vplSinCosQuarters(2 * (y + 0.5) / height, &sinTheta, &cosTheta);
    vplSinCosQuarters(4 * ((x + 0.5) / width - 0.5), &sinPhi, &cosPhi); // 0 is -z, a quarter +x
    vplSinCosQuarters(2.0 * y / height, &unused, &top);
    vplSinCosQuarters(2.0 * (y + 1) / height, &unused, &bottom);
    direction[0] = sinTheta * sinPhi;
    direction[1] = cosTheta;
    direction[2] = -sinTheta * cosPhi;
    return (top - bottom) * 2 * VPL_PI / width;
}

void vplSky_Paint(const vplSky* s, int width, int height, float* pixels)
{
    const vplRgb sun = vplSky_SunIrradiance(s);
    double onGround[3] = {sun.r * s->sunDirection[1], sun.g * s->sunDirection[1], sun.b * s->sunDirection[1]};
    for (int y = 0; y < height; y++) {
        const bool above = 2 * y + 1 <= height;
        for (int x = 0; x < width; x++) {
            float* p = pixels + 3 * ((size_t)y * (size_t)width + (size_t)x);
            double direction[3];
            const double angle = pixelDirection(x, y, width, height, direction);
            const vplRgb l = above ? vplSky_Radiance(s, direction) : (vplRgb){0, 0, 0};
            const float radiance[3] = {l.r, l.g, l.b};
            for (int c = 0; c < 3; c++) {
                p[c] = above ? radiance[c] : (float)(GROUND_REFLECTANCE / VPL_PI * onGround[c]);
                onGround[c] += above ? radiance[c] * direction[1] * angle : 0;
            }
        }
    }
}
