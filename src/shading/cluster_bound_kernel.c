// SPDX-License-Identifier: MIT
// Upper bound of the contribution of a cluster's lights to a point.
// Based on: Walter et al., Lightcuts, SIGGRAPH 2005, section 4.1. Departs: the largest n.l follows from the
// box along n and its bounding sphere across n, instead of from a box turned to n.
//
// The bound holds for the light kernel's results with their rounding: its differences light - point lie
// between those of the box, because rounding is monotone, and its sums of three products err by at most 2^-22
// of the sum of their absolute values; SLACK is four times that.
#include "base/isa.h"
#include "math/scalar.h"
#include "shading/shading.h"

#include <float.h>
#include <math.h>

static const float SLACK = 1e-6f;

// Largest cosine of the angle between an axis and the vectors to (or from) a box: their component along the
// axis is at most `along`, that across it the root of across2 +- radius.
static inline float largestCosine(float along, float across2, float distance2, float radius)
{
    const float slack = 4 * SLACK * distance2;
    const float near = vplMaxf(sqrtf(vplMaxf(across2 - slack, 0)) - radius, 0);
    const float far = sqrtf(vplMaxf(across2, 0) + slack) + radius;
    const float across = along > 0 ? near : far;
    return along / sqrtf(vplMaxf(along * along + across * across, FLT_MIN));
}

// Largest cosine to any axis within a cone, if `cosine` is the largest one to the cone's own axis.
static inline float widen(float cosine, float coneCosine, float coneSine)
{
    const float c = vplMinf(cosine + SLACK, 1), sine = sqrtf(vplMaxf(1 - c * c, 0));
    const float widened = c * coneCosine + sine * coneSine + 2 * SLACK;
    return vplMinf(c >= coneCosine ? 1 : vplMaxf(widened, 0), 1);
}

static inline __attribute__((always_inline)) void findBound(const vplSurface* restrict s,
                                                            const vplLightNode* restrict node,
                                                            float inverseClamp, bool physical,
                                                            float bound[restrict VPL_LANES])
{
    const vplLightNode n = *node;
    const float sx = n.high[0] - n.low[0], sy = n.high[1] - n.low[1], sz = n.high[2] - n.low[2];
    const float radius = 0.5f * (1 + SLACK) * sqrtf(sx * sx + sy * sy + sz * sz);
    const float coneSine = sqrtf(vplMaxf(1 - n.cosine * n.cosine, 0)) + SLACK;
    for (int l = 0; l < VPL_LANES; l++) {
        const float lx = n.low[0] - s->px[l], ly = n.low[1] - s->py[l], lz = n.low[2] - s->pz[l];
        const float hx = n.high[0] - s->px[l], hy = n.high[1] - s->py[l], hz = n.high[2] - s->pz[l];
        const float nx = s->nx[l], ny = s->ny[l], nz = s->nz[l];
        const float slack = SLACK * (vplMaxf(fabsf(lx), fabsf(hx)) + vplMaxf(fabsf(ly), fabsf(hy)) +
                                     vplMaxf(fabsf(lz), fabsf(hz)));
        const float cx = 0.5f * (lx + hx), cy = 0.5f * (ly + hy), cz = 0.5f * (lz + hz);
        const float distance2 = cx * cx + cy * cy + cz * cz;
        const float along =
            slack + vplMaxf(nx * lx, nx * hx) + vplMaxf(ny * ly, ny * hy) + vplMaxf(nz * lz, nz * hz);
        const float centre = nx * cx + ny * cy + nz * cz;
        float here = largestCosine(along, distance2 - centre * centre, distance2, radius);
        here = along > 0 ? here + SLACK : 0;
        if (!physical) {
            bound[l] = here;
            continue;
        }
        const float back = slack - vplMinf(n.axis[0] * lx, n.axis[0] * hx) -
                           vplMinf(n.axis[1] * ly, n.axis[1] * hy) - vplMinf(n.axis[2] * lz, n.axis[2] * hz);
        const float axis = n.axis[0] * cx + n.axis[1] * cy + n.axis[2] * cz;
        const float there =
            widen(largestCosine(back, distance2 - axis * axis, distance2, radius), n.cosine, coneSine);
        const float dx = vplMaxf(vplMaxf(lx, -hx), 0), dy = vplMaxf(vplMaxf(ly, -hy), 0),
                    dz = vplMaxf(vplMaxf(lz, -hz), 0);
        const float inverse = 1 / vplMaxf(dx * dx + dy * dy + dz * dz, FLT_MIN);
        bound[l] = (1 + 8 * SLACK) * here * there * vplMinf(inverse, inverseClamp);
    }
}

void VPL_KERNEL(vplClusterBoundDocumented)(const vplSurface* restrict surface,
                                           const vplLightNode* restrict node, float inverseClamp,
                                           float bound[restrict VPL_LANES])
{
    findBound(surface, node, inverseClamp, false, bound);
}

void VPL_KERNEL(vplClusterBoundPhysical)(const vplSurface* restrict surface,
                                         const vplLightNode* restrict node, float inverseClamp,
                                         float bound[restrict VPL_LANES])
{
    findBound(surface, node, inverseClamp, true, bound);
}
