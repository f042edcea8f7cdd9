// SPDX-License-Identifier: MIT
// Triangles that were looked up lately, for kernels: neighbours show few of them, again and again, and to look one up
// reads six places of memory.
#ifndef VPL_SHADING_SEEN_H
#define VPL_SHADING_SEEN_H

#include "math/scalar.h"
#include "shading/shading.h"

#include <string.h>

// What a triangle makes of irradiance: radiance = emission + factor E.
typedef struct vplReflector {
    double factor[3]; // rho / pi
    float emission[3];
} vplReflector;

typedef struct vplSeenFacet {
    vplVec3 normal; // as vplFacet's
    float offset;
    vplReflector reflector;
    bool smooth;
} vplSeenFacet;

// 512 are 40 kilobytes: 287 instead of 292 ms of processor time of a frame of Sponza, 1920x1080, than with 64.
enum { VPL_SEEN_BITS = 9, VPL_SEEN_COUNT = 1 << VPL_SEEN_BITS };

typedef struct vplSeen {
    int triangles[VPL_SEEN_COUNT]; // whose facets these are; -1: none's
    vplSeenFacet facets[VPL_SEEN_COUNT];
} vplSeen;

static inline void vplSeen_Clear(vplSeen* seen)
{
    memset(seen->triangles, 0xff, sizeof seen->triangles);
}

static inline vplReflector vplReflectorOf(const vplShading* s, const vplFacet* f)
{
    const double scale = 1 / VPL_PI;
    vplReflector r = {{f->rho.r * scale, f->rho.g * scale, f->rho.b * scale}, {0, 0, 0}};
    if (s->def->emission) {
        r.emission[0] = f->emission.r;
        r.emission[1] = f->emission.g;
        r.emission[2] = f->emission.b;
    }
    return r;
}

// `triangle` is an index in geometry->normals. Valid until the next one is asked for.
static inline const vplSeenFacet* vplSee(const vplShading* s, int triangle, vplSeen* seen)
{
    // Neighbours of a mesh lie a constant apart: a product by an odd number spreads these.
    const uint32_t at = (uint32_t)triangle * 2654435769u >> (32 - VPL_SEEN_BITS);
    vplSeenFacet* known = &seen->facets[at];
    if (seen->triangles[at] != triangle) {
        const vplGeometry* g = s->geometry;
        const vplFacet facet = vplGetFacet(s, triangle);
        seen->triangles[at] = triangle;
        *known = (vplSeenFacet){facet.normal, facet.offset, vplReflectorOf(s, &facet),
                                g->objects[g->owners[triangle]].smooth};
    }
    return known;
}

#endif
