// SPDX-License-Identifier: MIT
// The environment as lights of kernels: far points that face the scene.
#include "lights/sky_lights.h"

#include "geometry/emission.h"
#include "math/vec.h"

#include <math.h>

vplVec3 vplSkyLight_Position(const vplEmission* e, vplVec3 towards)
{
    return vplAdd(e->centre, vplScale(VPL_SKY_DISTANCE * (float)e->radius, towards));
}

// Points of a lattice by the golden ratio, which for a constant radiance is the spherical Fibonacci lattice.
// Source: Ricardo Marques and others, Spherical Fibonacci Point Sets for Illumination Integrals, CGF 2013.
int vplSampleSky(const vplEmission* e, int count, vplShadeLight* out)
{
    if (e == NULL || out == NULL) {
        return 0;
    }
    const vplEnvironment* environment = e->geometry->environment;
    if (e->environment < 0) {
        return 0;
    }
    const double distance = (double)VPL_SKY_DISTANCE * e->radius;
    for (int i = 0; i < count; i++) {
        const double turns = 0.61803398874989485 * (i + 0.5);
        const vplEnvironmentSample sky =
            vplEnvironment_Sample(environment, (i + 0.5) / count, turns - floor(turns));
        const vplVec3 towards = sky.direction, at = vplSkyLight_Position(e, towards);
        const vplRgb intensity = vplScaleRadiometric(distance * distance / (sky.density * count), sky.light);
        out[i] = (vplShadeLight){at.x,       at.y,        at.z,        -towards.x, -towards.y,
                                 -towards.z, intensity.r, intensity.g, intensity.b};
    }
    return count;
}
