// SPDX-License-Identifier: MIT
// From a direction to a texel of a cube map, without branches so that loops over lanes vectorise.
#ifndef VPL_VISIBILITY_CUBE_TEXEL_H
#define VPL_VISIBILITY_CUBE_TEXEL_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct vplCubeTexel {
    int32_t face;
    float s, t;
} vplCubeTexel;

// Magnitudes are compared, not squares, so that directions of any length work. The zero vector gives the
// middle of +z.
static inline vplCubeTexel vplCubeTexelOf(float x, float y, float z)
{
    float ax = fabsf(x), ay = fabsf(y), az = fabsf(z);
    int32_t isZ = (az >= ax) & (az >= ay);
    int32_t isY = !isZ & (ay >= ax);
    float major = isZ ? az : isY ? ay : ax;
    float side = isZ ? z : isY ? y : x;
    int32_t negative = side < 0;
    // right and up of the six frames
    float right = isZ ? (negative ? -x : x) : isY ? x : (negative ? z : -z);
    float up = isY ? (negative ? z : -z) : y;
    float divisor = major > 0 ? major : 1;
    vplCubeTexel texel;
    texel.face = (isZ ? 4 : isY ? 2 : 0) + negative;
    texel.s = (right / divisor + 1) * 0.5f;
    texel.t = (1 - up / divisor) * 0.5f;
    return texel;
}

// Column or row of s or t in a map of `size` texels: s = 1 belongs to the last.
static inline int32_t vplTexelIndex(float s, float size, int32_t last)
{
    int32_t i = (int32_t)(s * size);
    return i < last ? i : last;
}

// A vector in the axes of a face. Only signs change, so that sums keep their bits.
typedef struct vplInFace {
    float right, up, major;
} vplInFace;

static inline vplInFace vplTurnToFace(int32_t face, float x, float y, float z)
{
    const bool negative = face & 1;
    if (face >= 4) {
        return (vplInFace){negative ? -x : x, y, negative ? -z : z};
    }
    if (face >= 2) {
        return (vplInFace){x, negative ? z : -z, negative ? -y : y};
    }
    return (vplInFace){negative ? z : -z, y, negative ? -x : x};
}

#endif
