// SPDX-License-Identifier: MIT
// The shadow factor of 16 fragments. Compiled once per instruction set; all give the same bits.
// Based on: Franchi and Ferrante, Virtual Point Lights, "Rendering the Point Light with Shadows"; William
// Reeves, David Salesin and Robert Cook, Rendering Antialiased Shadows with Depth Maps, SIGGRAPH 1987 (PCF).
//
// The exact bias: a fragment at distance r on a plane whose normal is at angle t to the light is compared
// with a sample whose ray is off by at most a. On that plane the sample's ray is shortest when it is turned
// by a towards the normal, where it has length r cos t / cos(t - a) (and r cos t where a > t: then the normal
// itself is within reach). A bias of r minus that never shadows the plane by itself.
#include "math/scalar.h"
#include "visibility/cube_texel.h"
#include "visibility/kernels.h"
#include "visibility/map_gather.h"

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
    for (int l = 0; l < VPL_LANES; l++) {
        float r = vplMaxf(distance[l], 1e-30f);
        float kernel = d->pcfOffset / r + shadow->pcfTangent;
        float rest = 1 - texel * kernel;
        float tangent = (texel + kernel) / vplMaxf(rest, 1e-6f); // of the sum of both angles
        float cosA = 1 / sqrtf(1 + tangent * tangent);
        float sinA = tangent * cosA;
        float cosT = cosine[l];
        float sinT = sqrtf(vplMaxf(1 - cosT * cosT, 0));
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

// The index of a texel in the map.
static inline int32_t placeOf(vplCubeTexel t, int32_t size)
{
    const int32_t column = vplTexelIndex(t.s, (float)size, size - 1);
    const int32_t row = vplTexelIndex(t.t, (float)size, size - 1);
    return (t.face * size + row) * size + column;
}

// Counts the samples in shadow, all lanes side by side.
static void countShadowed(const vplShadow* shadow, const vplShadowPoints* restrict p,
                          const float axis[6][VPL_LANES], float* restrict shadowed)
{
    const vplCubeMap* map = shadow->map;
    const float* restrict texels = map->texels;
    const int32_t size = map->size;
    const float far = map->farPlane;
    for (int l = 0; l < VPL_LANES; l++) {
        shadowed[l] = 0;
    }
    for (int s = 0; s < shadow->def.pcfSamples; s++) {
        int32_t place[VPL_LANES];
        for (int l = 0; l < VPL_LANES; l++) {
            const float u = p->radius[l] * shadow->offsets[s][0], v = p->radius[l] * shadow->offsets[s][1];
            float dx = p->x[l] + (u * axis[0][l] + v * axis[3][l]);
            float dy = p->y[l] + (u * axis[1][l] + v * axis[4][l]);
            float dz = p->z[l] + (u * axis[2][l] + v * axis[5][l]);
            place[l] = placeOf(vplCubeTexelOf(dx, dy, dz), size);
        }
        float stored[VPL_LANES];
        vplGather(texels, place, stored);
        for (int l = 0; l < VPL_LANES; l++) {
            shadowed[l] += p->limit[l] > stored[l] * far ? 1.0f : 0.0f;
        }
    }
}

// The samples' places on the unit disc; padded to whole vectors.
typedef struct Disc {
    float u[VPL_MAX_PCF_SAMPLES], v[VPL_MAX_PCF_SAMPLES];
} Disc;

static void fillDisc(const vplShadow* shadow, Disc* restrict disc)
{
    for (int first = 0; first < shadow->def.pcfSamples; first += VPL_LANES) {
        for (int l = first; l < first + VPL_LANES; l++) {
            disc->u[l] = shadow->offsets[l][0];
            disc->v[l] = shadow->offsets[l][1];
        }
    }
}

// Counts which of the first `count` texels are nearer than the limit.
static inline int32_t countBehind(const float* restrict texels, const int32_t place[VPL_LANES], float far,
                                  float limit, int32_t count)
{
    float stored[VPL_LANES];
    int32_t behind = 0;
    vplGather(texels, place, stored);
    for (int l = 0; l < VPL_LANES; l++) {
        behind += (limit > stored[l] * far) & (l < count);
    }
    return behind;
}

// Counts the samples of one point in shadow, 16 at a time. `inFace`: all samples lie in the point's face,
// which then need not be found for each (bench/shadow: 1.2x). Callers pass a constant.
static inline __attribute__((always_inline)) float countPoint(const vplShadow* shadow,
                                                              const vplShadowPoints* restrict p, int lane,
                                                              const float axis[6][VPL_LANES],
                                                              const Disc* restrict disc, bool inFace)
{
    const vplCubeMap* map = shadow->map;
    const int32_t size = map->size, samples = shadow->def.pcfSamples, face = p->face[lane];
    const float far = map->farPlane, limit = p->limit[lane], radius = p->radius[lane];
    // In the axes of the face where that is known.
    vplInFace at = {p->x[lane], p->y[lane], p->z[lane]};
    vplInFace alongU = {axis[0][lane], axis[1][lane], axis[2][lane]};
    vplInFace alongV = {axis[3][lane], axis[4][lane], axis[5][lane]};
    if (inFace) {
        at = vplTurnToFace(face, at.right, at.up, at.major);
        alongU = vplTurnToFace(face, alongU.right, alongU.up, alongU.major);
        alongV = vplTurnToFace(face, alongV.right, alongV.up, alongV.major);
    }
    int32_t count = 0;
    for (int32_t first = 0; first < samples; first += VPL_LANES) {
        const float* restrict u = disc->u + first;
        const float* restrict v = disc->v + first;
        int32_t place[VPL_LANES];
        for (int l = 0; l < VPL_LANES; l++) {
            const float du = radius * u[l], dv = radius * v[l];
            const float right = at.right + (du * alongU.right + dv * alongV.right);
            const float up = at.up + (du * alongU.up + dv * alongV.up);
            const float major = at.major + (du * alongU.major + dv * alongV.major);
            place[l] =
                placeOf(inFace ? (vplCubeTexel){face, (right / major + 1) * 0.5f, (1 - up / major) * 0.5f}
                               : vplCubeTexelOf(right, up, major),
                        size);
        }
        count += countBehind(map->texels, place, far, limit, samples - first);
    }
    return (float)count;
}

// Counts for the points that the map's bounds do not decide.
static void countUnknown(const vplShadow* shadow, const vplShadowPoints* p, const float axis[6][VPL_LANES],
                         const int32_t known[VPL_LANES], float shadowed[VPL_LANES])
{
    Disc disc;
    fillDisc(shadow, &disc);
    for (int l = 0; l < VPL_LANES; l++) {
        if (!known[l]) {
            shadowed[l] = p->face[l] >= 0 ? countPoint(shadow, p, l, axis, &disc, true)
                                          : countPoint(shadow, p, l, axis, &disc, false);
        }
    }
}

int VPL_KERNEL(vplShadowFactor)(const vplShadow* shadow, const vplSurface* surface, float* restrict factor)
{
    const vplVec3 light = shadow->map->position;
    vplShadowPoints p;
    float lx[VPL_LANES], ly[VPL_LANES], lz[VPL_LANES], distance[VPL_LANES], cosine[VPL_LANES];
    float bias[VPL_LANES], axis[6][VPL_LANES], shadowed[VPL_LANES];
    int32_t known[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = surface->px[l] - light.x, y = surface->py[l] - light.y, z = surface->pz[l] - light.z;
        distance[l] = sqrtf(x * x + y * y + z * z);
        float inverse = 1 / vplMaxf(distance[l], 1e-30f); // a fragment in the light itself is not shadowed
        lx[l] = -x * inverse;
        ly[l] = -y * inverse;
        lz[l] = -z * inverse;
        float c = lx[l] * surface->nx[l] + ly[l] * surface->ny[l] + lz[l] * surface->nz[l];
        c = c > 0 ? c : 0;
        cosine[l] = c < 1 ? c : 1;
        p.x[l] = x;
        p.y[l] = y;
        p.z[l] = z;
        p.inverse[l] = inverse;
        p.radius[l] = shadow->def.pcfOffset + shadow->pcfTangent * vplMinf(distance[l], 1e30f);
    }
    VPL_KERNEL(vplShadowBias)(shadow, distance, cosine, bias);
    for (int l = 0; l < VPL_LANES; l++) {
        p.limit[l] = distance[l] - bias[l];
    }
    int decided = 0;
    if (shadow->def.pcfSamples < VPL_MIN_BOUND_SAMPLES) {
        discFrame(lx, ly, lz, axis);
        countShadowed(shadow, &p, axis, shadowed);
    } else {
        decided = VPL_KERNEL(vplTestBounds)(shadow, surface, &p, known, shadowed);
        if (decided < VPL_LANES) {
            discFrame(lx, ly, lz, axis);
            countUnknown(shadow, &p, axis, known, shadowed);
        }
    }
    const float samples = (float)shadow->def.pcfSamples;
    for (int l = 0; l < VPL_LANES; l++) {
        factor[l] = shadowed[l] / samples;
    }
    return decided;
}
