// SPDX-License-Identifier: MIT
#include "kernel_points.h"

vplShadeLight lightAt(vplVec3 p, vplVec3 n, float colour)
{
    return (vplShadeLight){p.x, p.y, p.z, n.x, n.y, n.z, colour, colour, colour};
}

double irradianceAt(const vplContext* context, vplLightFormula formula, vplVec3 p, vplVec3 n,
                    const vplShadeLight* lights, int count)
{
    vplSurface surface;
    float e[3][VPL_LANES] = {{0}};
    for (int l = 0; l < VPL_LANES; l++) {
        surface.px[l] = p.x, surface.py[l] = p.y, surface.pz[l] = p.z;
        surface.nx[l] = n.x, surface.ny[l] = n.y, surface.nz[l] = n.z;
    }
    vplAccumulateLights(context, formula, &surface, lights, count, e);
    for (int l = 1; l < VPL_LANES; l++) {
        assert_true(e[0][l] == e[0][0]);
    }
    return (double)e[0][0];
}
