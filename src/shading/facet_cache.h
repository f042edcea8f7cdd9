// SPDX-License-Identifier: MIT
// G-buffer facet cache, for kernels: neighbouring pixels show few triangles, and looking one up reads six
// places of memory.
#ifndef VPL_SHADING_FACET_CACHE_H
#define VPL_SHADING_FACET_CACHE_H

#include "math/scalar.h"
#include "shading/shading.h"

#include <string.h>

// How a triangle reflects irradiance E: radiance = emission + factor E.
typedef struct vplReflector {
    double factor[3]; // rho / pi
    float emission[3];
} vplReflector;

typedef struct vplCachedFacet {
    vplVec3 normal; // as vplFacet's
    float offset;
    vplReflector reflector;
    bool smooth;
} vplCachedFacet;

// 512 facets are 40 KB: 287 ms of processor time per frame of Sponza (1920x1080), 292 ms with 64.
enum { VPL_FACET_CACHE_BITS = 9, VPL_FACET_CACHE_SIZE = 1 << VPL_FACET_CACHE_BITS };

typedef struct vplFacetCache {
    int triangles[VPL_FACET_CACHE_SIZE]; // -1: empty
    vplCachedFacet facets[VPL_FACET_CACHE_SIZE];
} vplFacetCache;

static inline void vplFacetCache_Clear(vplFacetCache* cache)
{
    memset(cache->triangles, 0xff, sizeof cache->triangles);
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

// `triangle` is an index in geometry->normals. The facet is valid until the next call.
static inline const vplCachedFacet* vplFacetCache_Get(const vplShading* s, int triangle, vplFacetCache* cache)
{
    // Neighbours in a mesh differ by a constant; multiplying by an odd number spreads them.
    const uint32_t at = (uint32_t)triangle * 2654435769u >> (32 - VPL_FACET_CACHE_BITS);
    vplCachedFacet* facet = &cache->facets[at];
    if (cache->triangles[at] != triangle) {
        const vplGeometry* g = s->geometry;
        const vplFacet found = vplGetFacet(s, triangle);
        cache->triangles[at] = triangle;
        *facet = (vplCachedFacet){found.normal, found.offset, vplReflectorOf(s, &found),
                                  g->objects[g->owners[triangle]].smooth};
    }
    return facet;
}

#endif
