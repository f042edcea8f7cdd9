// SPDX-License-Identifier: MIT
// The end of every pipeline, for kernels: sums of irradiance become radiance and pixels.
#ifndef VPL_SHADING_RESOLVE_H
#define VPL_SHADING_RESOLVE_H

#include "math/scalar.h"
#include "shading/shading.h"

#include <string.h>

// Index in geometry->normals of each lane of a block, -1 where nothing is. Returns whether any lane has one.
static inline bool vplReadTriangles(const vplTile* tile, int element, int triangles[VPL_LANES])
{
    // Not read as floats: small integers are denormal there.
    memcpy(triangles, tile->planes[VPL_PLANE_TRIANGLE] + element, VPL_LANES * sizeof(int));
    int any = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        any |= triangles[l];
        triangles[l]--;
    }
    return any != 0;
}

static inline bool vplSameTriangle(const int triangles[VPL_LANES])
{
    int different = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        different |= triangles[l] ^ triangles[0];
    }
    return different == 0;
}

// What a triangle makes of irradiance: radiance = emission + factor E.
typedef struct vplReflector {
    double factor[3]; // rho / pi
    float emission[3];
} vplReflector;

static inline vplReflector vplGetReflector(const vplShading* s, int triangle)
{
    if (triangle < 0) {
        return (vplReflector){{0, 0, 0}, {0, 0, 0}};
    }
    const vplFacet f = vplGetFacet(s, triangle);
    const double scale = 1 / VPL_PI;
    vplReflector r = {{f.rho.r * scale, f.rho.g * scale, f.rho.b * scale}, {0, 0, 0}};
    if (s->def->emission) {
        r.emission[0] = f.emission.r;
        r.emission[1] = f.emission.g;
        r.emission[2] = f.emission.b;
    }
    return r;
}

static inline void vplResolveBlock(const vplShading* s, const vplTile* tile, int block,
                                   const int triangles[VPL_LANES], double sums[3][VPL_LANES])
{
    float radiance[3][VPL_LANES];
    vplReflector r = vplGetReflector(s, triangles[0]);
    if (vplSameTriangle(triangles)) {
        for (int c = 0; c < 3; c++) {
            for (int l = 0; l < VPL_LANES; l++) {
                radiance[c][l] = (float)(r.emission[c] + r.factor[c] * sums[c][l]);
            }
        }
    } else {
        for (int l = 0; l < VPL_LANES; l++) {
            if (l > 0 && triangles[l] != triangles[l - 1]) {
                r = vplGetReflector(s, triangles[l]);
            }
            for (int c = 0; c < 3; c++) {
                radiance[c][l] = (float)(r.emission[c] + r.factor[c] * sums[c][l]);
            }
        }
    }
    vplWriteBlock(s, tile, block, radiance);
}

#endif
