// SPDX-License-Identifier: MIT
// The light kernel: the one place where virtual lights become irradiance. Compiled once per instruction set;
// all give the same bits, because + - * / and sqrtf round correctly everywhere.
// Based on: Franchi and Ferrante, Virtual Point Lights (documented); Alexander Keller, Instant Radiosity,
// SIGGRAPH 1997 (physical), with the geometry term bounded as r^2 -> max(r^2, c).
#include "base/isa.h"
#include "lights/light_term.h"
#include "shading/shading.h"

#include <float.h>
#include <math.h>
#include <string.h>

vplLightKernelFcn VPL_KERNEL(vplLightsDocumented), VPL_KERNEL(vplLightsPhysical);
vplEmitterKernelFcn VPL_KERNEL(vplEmitterCosine);

void VPL_KERNEL(vplLightsDocumented)(const vplSurface* restrict surface, const vplShadeLight* restrict lights,
                                     int count, float inverseBound, float irradiance[restrict 3][VPL_LANES])
{
    (void)inverseBound;
    float r[VPL_LANES], g[VPL_LANES], b[VPL_LANES];
    memcpy(r, irradiance[0], sizeof r);
    memcpy(g, irradiance[1], sizeof g);
    memcpy(b, irradiance[2], sizeof b);
    for (int i = 0; i < count; i++) {
        const vplShadeLight light = lights[i];
        for (int l = 0; l < VPL_LANES; l++) {
            float x = light.px - surface->px[l], y = light.py - surface->py[l], z = light.pz - surface->pz[l];
            float cosine = vplDocumentedCosine(x, y, z, surface->nx[l], surface->ny[l], surface->nz[l]);
            r[l] += light.r * cosine;
            g[l] += light.g * cosine;
            b[l] += light.b * cosine;
        }
    }
    memcpy(irradiance[0], r, sizeof r);
    memcpy(irradiance[1], g, sizeof g);
    memcpy(irradiance[2], b, sizeof b);
}

void VPL_KERNEL(vplLightsPhysical)(const vplSurface* restrict surface, const vplShadeLight* restrict lights,
                                   int count, float inverseBound, float irradiance[restrict 3][VPL_LANES])
{
    float r[VPL_LANES], g[VPL_LANES], b[VPL_LANES];
    memcpy(r, irradiance[0], sizeof r);
    memcpy(g, irradiance[1], sizeof g);
    memcpy(b, irradiance[2], sizeof b);
    for (int i = 0; i < count; i++) {
        const vplShadeLight light = lights[i];
        for (int l = 0; l < VPL_LANES; l++) {
            float x = light.px - surface->px[l], y = light.py - surface->py[l], z = light.pz - surface->pz[l];
            float geometry = vplBoundedGeometry(vplLightTermOf(x, y, z, surface->nx[l], surface->ny[l],
                                                               surface->nz[l], light.nx, light.ny, light.nz),
                                                inverseBound);
            r[l] += light.r * geometry;
            g[l] += light.g * geometry;
            b[l] += light.b * geometry;
        }
    }
    memcpy(irradiance[0], r, sizeof r);
    memcpy(irradiance[1], g, sizeof g);
    memcpy(irradiance[2], b, sizeof b);
}

// Cosine towards an emitter, without its falloff; also the vector to it, its squared length and its length.
static inline float cosineTo(const vplSurface* surface, int l, const vplEmitterRay* e, bool parallel,
                             float way[3], float* d2, float* d)
{
    way[0] = parallel ? -e->direction.x : e->position.x - surface->px[l];
    way[1] = parallel ? -e->direction.y : e->position.y - surface->py[l];
    way[2] = parallel ? -e->direction.z : e->position.z - surface->pz[l];
    const float square = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
    const float c = surface->nx[l] * way[0] + surface->ny[l] * way[1] + surface->nz[l] * way[2];
    *d2 = square > FLT_MIN ? square : FLT_MIN;
    *d = sqrtf(*d2);
    return (c > 0 ? c : 0) / *d;
}

static inline bool anyPositive(const float cosine[VPL_LANES])
{
    int any = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        any |= cosine[l] > 0;
    }
    return any;
}

// Directional: n.l. Point: n.l / d^2. Spot: that times the smooth step of its cone (see vplSpot_Falloff).
bool VPL_KERNEL(vplEmitterCosine)(const vplSurface* restrict surface, const vplEmitterRay* emitter,
                                  float cosine[restrict VPL_LANES])
{
    const vplEmitterRay e = *emitter;
    float way[3], d2, d;
    if (e.parallel) {
        for (int l = 0; l < VPL_LANES; l++) {
            cosine[l] = cosineTo(surface, l, &e, true, way, &d2, &d);
        }
        return anyPositive(cosine);
    }
    if (!e.spot) {
        for (int l = 0; l < VPL_LANES; l++) {
            const float c = cosineTo(surface, l, &e, false, way, &d2, &d);
            cosine[l] = e.falloff ? c / d2 : c;
        }
        return anyPositive(cosine);
    }
    for (int l = 0; l < VPL_LANES; l++) {
        float c = cosineTo(surface, l, &e, false, way, &d2, &d);
        c = e.falloff ? c / d2 : c;
        const float axis = -(e.direction.x * way[0] + e.direction.y * way[1] + e.direction.z * way[2]) / d;
        float step = (axis - e.cosOuter) * e.inverseRing;
        step = step > 0 ? step : 0;
        step = step < 1 ? step : 1;
        cosine[l] = c * (step * step * (3 - 2 * step));
    }
    return anyPositive(cosine);
}
