// SPDX-License-Identifier: MIT
// Shared by everything that rasterizes a geometry.
#ifndef VPL_VISIBILITY_DRAWING_H
#define VPL_VISIBILITY_DRAWING_H

#include "geometry/cut_outs.h"
#include "math/vec.h"

#include <vpl/geometry.h>
#include <vpl/raster.h>

static inline vplMesh vplMeshOfObject(const vplGeometry* g, int object)
{
    const vplGeometryObject* o = &g->objects[object];
    const uint32_t* indices = g->cutOuts != NULL ? g->cutOuts->indices : g->indices;
    return (vplMesh){indices + 3 * (size_t)o->firstTriangle, o->vertexCount, o->triangleCount};
}

// Slightly more than the distance of the farthest vertex; 1 where there is none.
static inline float vplFarthestVertex(const vplGeometry* g, vplVec3 from)
{
    float farthest = 0;
    for (int i = 0; i < g->vertexCount; i++) {
        farthest = fmaxf(farthest, vplLength(vplSub(g->positions[i], from)));
    }
    return farthest > 0 ? farthest * 1.0001f : 1;
}

#endif
