// SPDX-License-Identifier: MIT
// Condition under which reflective shadow maps and rays must agree on an emitter's shadow. A benchmark and a
// test share it.
#ifndef VPL_RSM_BAND_H
#define VPL_RSM_BAND_H

#include "lights/kernels.h"
#include "math/vec.h"

// Returns a ray of the map's emitter that passes the ray through `point` at an offset of `across` and `down`
// metres (at distance 1 unless the projection is parallel). Its length is 1 per `depthOut`, the point's
// depth.
static inline vplRay rayBeside(const vplReflectiveMap* m, int face, vplVec3 point, float across, float down,
                               float* depthOut)
{
    const vplVec3 way = vplSub(point, m->origin), f = m->forward[face];
    const float depth = vplDot(way, f);
    const vplVec3 side = vplSub(vplScale(across, m->right[face]), vplScale(down, m->up[face]));
    *depthOut = depth;
    if (m->emitter.type == VPL_EMITTER_DIRECTIONAL) {
        const vplVec3 start = vplSub(point, vplScale(depth, f));
        return (vplRay){vplAdd(start, side), vplScale(depth, f), {0, 0}};
    }
    return (vplRay){m->origin, vplAdd(way, vplScale(depth, side)), {0, 0}};
}

static inline int faceOf(const vplReflectiveMap* m, vplVec3 point)
{
    vplCubePoint p = {0};
    if (m->faceCount == 6) {
        vplCube_Find(vplSub(point, m->origin), m->size, &p);
    }
    return p.face;
}

// Returns whether all rays that pass within a texel and a 128th (coverage is snapped to 1/256) of the point
// agree with the point's own ray (`dark`): either all find an occluder nearer than the point and its plane by
// the tolerance, or none finds one nearer than both. Then the map must agree, too.
static inline bool isSureReflective(const vplGeometry* g, const vplReflectiveMap* m, vplVec3 point,
                                    vplVec3 normal, bool dark)
{
    enum { GRID = 9 };
    const bool parallel = m->emitter.type == VPL_EMITTER_DIRECTIONAL;
    const int face = faceOf(m, point);
    const float sideX = (float)(2 * m->extent[0] / m->size), sideY = (float)(2 * m->extent[1] / m->size);
    const float larger = fmaxf(sideX, sideY);
    bool same = true;
    for (int k = 0; k < GRID * GRID && same; k++) {
        const float a = ((float)(k % GRID) / (GRID - 1) * 2 - 1) * (1 + 0x1p-7f);
        const float b = ((float)(k / GRID) / (GRID - 1) * 2 - 1) * (1 + 0x1p-7f);
        float depth;
        const vplRay ray = rayBeside(m, face, point, a * sideX, b * sideY, &depth);
        const float meets = vplDot(vplSub(point, ray.origin), normal) / vplDot(ray.direction, normal);
        const float plane = meets > 0 && meets < 1 ? meets : 1;
        const float most = VPL_REFLECTIVE_TOLERANCE * larger + 0x1p-14f;
        const float slack = 0x1p-6f * fabsf(1 - plane) + (parallel ? most / depth : most);
        same = vplGeometry_IsOccluded(g, &ray, plane * (1 - slack)) == dark;
        if (same && !dark) {
            same = !vplGeometry_IsOccluded(g, &ray, plane * (1 - 0x1p-14f));
        }
    }
    return same;
}

#endif
