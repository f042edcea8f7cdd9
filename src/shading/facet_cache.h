// SPDX-License-Identifier: MIT
// G-buffer facet cache, for kernels: neighbouring pixels show few triangles, and looking one up reads six
// places of memory.
#ifndef VPL_SHADING_FACET_CACHE_H
#define VPL_SHADING_FACET_CACHE_H

#include "shading/shading.h"

#include <string.h>

// 512 facets are 40 KB: 287 ms of processor time per frame of Sponza (1920x1080), 292 ms with 64.
enum { VPL_FACET_CACHE_BITS = 9, VPL_FACET_CACHE_SIZE = 1 << VPL_FACET_CACHE_BITS };

typedef struct vplFacetCache {
    int triangles[VPL_FACET_CACHE_SIZE]; // -1: empty
    vplFacet facets[VPL_FACET_CACHE_SIZE];
} vplFacetCache;

static inline void vplFacetCache_Clear(vplFacetCache* cache)
{
    memset(cache->triangles, 0xff, sizeof cache->triangles);
}

// `triangle` is an index in geometry->normals. The facet is valid until the next call.
static inline const vplFacet* vplFacetCache_Get(const vplShading* s, int triangle, vplFacetCache* cache)
{
    // Neighbours in a mesh differ by a constant; multiplying by an odd number spreads them.
    const uint32_t at = (uint32_t)triangle * 2654435769u >> (32 - VPL_FACET_CACHE_BITS);
    if (cache->triangles[at] != triangle) {
        cache->triangles[at] = triangle;
        cache->facets[at] = vplGetFacet(s, triangle);
    }
    return &cache->facets[at];
}

#endif
