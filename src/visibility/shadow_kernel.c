// SPDX-License-Identifier: MIT
// The shadow factor of 16 fragments. Compiled once per instruction set; all give the same bits.
// Based on: Franchi and Ferrante, Virtual Point Lights, "Rendering the Point Light with Shadows"; William
// Reeves, David Salesin and Robert Cook, Rendering Antialiased Shadows with Depth Maps, SIGGRAPH 1987 (PCF).
//
// The exact bias: a fragment at distance r on a plane whose normal is at angle t to the light is compared with
// a sample whose ray is off by at most a. On that plane the sample's ray is shortest when it is turned by a
// towards the normal, where it has length r cos t / cos(t - a) (and r cos t where a > t: then the normal itself
// is within reach). A bias of r minus that never shadows the plane by itself.
#include "base/isa.h"
#include "visibility/cube_texel.h"
#include "visibility/shadow.h"

static inline float maxOf(float a, float b)
{
    return a > b ? a : b;
}

vplShadowBiasFcn VPL_KERNEL(vplShadowBias);

void VPL_KERNEL(vplShadowBias)(const vplShadow* shadow, const float* restrict distance,
                               const float* restrict cosine, float* restrict bias)
{
    const vplShadowDef* d = &shadow->def;
    if (d->biasRule == VPL_BIAS_PAIR) {
        for (int l = 0; l < VPL_LANES; l++) {
            bias[l] = d->biasStatic + d->biasDynamic * (1 - cosine[l]);
        }
        return;
    }
    const float texel = shadow->texelTangent;
    const float radius = d->pcfSamples > 1 ? d->pcfOffset : 0;
    for (int l = 0; l < VPL_LANES; l++) {
        float r = maxOf(distance[l], 1e-30f);
        float kernel = radius / r;
        float rest = 1 - texel * kernel;
        float tangent = (texel + kernel) / maxOf(rest, 1e-6f); // of the sum of both angles
        float cosA = 1 / sqrtf(1 + tangent * tangent);
        float sinA = tangent * cosA;
        float cosT = cosine[l];
        float sinT = sqrtf(maxOf(1 - cosT * cosT, 0));
        float turned = sinT * cosA <= cosT * sinA ? 1 : cosT * cosA + sinT * sinA;
        // 2^-20 of the distance covers the rounding of both distances.
        bias[l] = r * (1 - cosT / turned) + r * 0x1p-20f;
    }
}

// An orthonormal frame around l whose only seam is a cone around straight up, where ceilings are.
static void discFrame(const float* restrict lx, const float* restrict ly, const float* restrict lz,
                      float axis[6][VPL_LANES])
{
    for (int i = 0; i < VPL_LANES; i++) {
        float x = lx[i], y = ly[i], z = lz[i];
        float sign = y > -0.9f ? 1 : -1;
        float a = -1 / (sign + y);
        float b = x * z * a;
        axis[0][i] = b;
        axis[1][i] = -z;
        axis[2][i] = sign + z * z * a;
        axis[3][i] = 1 + sign * x * x * a;
        axis[4][i] = -sign * x;
        axis[5][i] = sign * b;
    }
}

// How many samples lie in shadow, by lane.
static void countShadowed(const vplShadow* shadow, const float* restrict x, const float* restrict y,
                          const float* restrict z, float axis[6][VPL_LANES], const float* restrict limit,
                          float* restrict shadowed)
{
    const vplCubeMap* map = shadow->map;
    const float* restrict texels = map->texels;
    const int32_t size = map->size, last = size - 1;
    const float sizeF = (float)size, off = shadow->def.pcfOffset, far = map->far;
    for (int l = 0; l < VPL_LANES; l++) {
        shadowed[l] = 0;
    }
    for (int s = 0; s < shadow->def.pcfSamples; s++) {
        const float u = off * shadow->offsets[s][0], v = off * shadow->offsets[s][1];
        int32_t place[VPL_LANES];
        for (int l = 0; l < VPL_LANES; l++) {
            float dx = x[l] + (u * axis[0][l] + v * axis[3][l]);
            float dy = y[l] + (u * axis[1][l] + v * axis[4][l]);
            float dz = z[l] + (u * axis[2][l] + v * axis[5][l]);
            vplCubeTexel t = vplCubeTexelOf(dx, dy, dz);
            int32_t column = vplTexelIndex(t.s, sizeF, last), row = vplTexelIndex(t.t, sizeF, last);
            place[l] = (t.face * size + row) * size + column;
        }
        for (int l = 0; l < VPL_LANES; l++) {
            shadowed[l] += limit[l] > texels[place[l]] * far ? 1.0f : 0.0f;
        }
    }
}

vplShadowFactorFcn VPL_KERNEL(vplShadowFactor);

void VPL_KERNEL(vplShadowFactor)(const vplShadow* shadow, const vplSurface* surface, float* restrict factor)
{
    const vplVec3 p = shadow->map->position;
    float x[VPL_LANES], y[VPL_LANES], z[VPL_LANES]; // from the light to the fragment: the document's -l
    float lx[VPL_LANES], ly[VPL_LANES], lz[VPL_LANES], distance[VPL_LANES], cosine[VPL_LANES];
    float bias[VPL_LANES], limit[VPL_LANES], axis[6][VPL_LANES], shadowed[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        x[l] = surface->px[l] - p.x;
        y[l] = surface->py[l] - p.y;
        z[l] = surface->pz[l] - p.z;
        distance[l] = sqrtf(x[l] * x[l] + y[l] * y[l] + z[l] * z[l]);
        float inverse = 1 / maxOf(distance[l], 1e-30f); // a fragment in the light itself is not shadowed
        lx[l] = -x[l] * inverse;
        ly[l] = -y[l] * inverse;
        lz[l] = -z[l] * inverse;
        float c = lx[l] * surface->nx[l] + ly[l] * surface->ny[l] + lz[l] * surface->nz[l];
        c = c > 0 ? c : 0;
        cosine[l] = c < 1 ? c : 1;
    }
    VPL_KERNEL(vplShadowBias)(shadow, distance, cosine, bias);
    discFrame(lx, ly, lz, axis);
    for (int l = 0; l < VPL_LANES; l++) {
        limit[l] = distance[l] - bias[l];
    }
    countShadowed(shadow, x, y, z, axis, limit, shadowed);
    const float samples = (float)shadow->def.pcfSamples;
    for (int l = 0; l < VPL_LANES; l++) {
        factor[l] = shadowed[l] / samples;
    }
}
