// SPDX-License-Identifier: MIT
// Shaders of the passes: direct light once, then virtual lights one by one or in batches.
#include "base/isa.h"
#include "shading/gbuffer.h"

static inline int triangleOf(const vplPassUniforms* u, const vplFragments* f)
{
    return u->shading->geometry->objects[u->object].firstTriangle + f->primitive;
}

// The points of a block, which the surface shader has written.
static inline vplPoints pointsOf(const vplPassUniforms* u, const vplFragments* f)
{
    vplPoints points;
    points.surface = (const vplSurface*)f->varying[0];
    points.plane = u->shading->smooth ? (const vplSurface*)f->varying[VPL_SURFACE_VARYINGS] : points.surface;
    const int triangle = triangleOf(u, f);
    for (int l = 0; l < VPL_LANES; l++) {
        points.triangle[l] = f->covered[l] ? triangle : -1;
    }
    return points;
}

// The surface shader: a triangle and interpolated positions become a vplSurface.
void VPL_KERNEL(vplShadeSurface)(const void* uniforms, vplFragments* f)
{
    const vplObjectUniforms* u = uniforms;
    const vplShading* s = u->shading;
    const int triangle = s->geometry->objects[u->object].firstTriangle + f->primitive;
    const vplVec3 n = vplGetFacet(s, triangle).normal;
    vplSurface* surface = (vplSurface*)f->varying[0];
    if (!s->smooth) {
        vplSetNormals(n, surface);
        return;
    }
    vplSurface* plane = (vplSurface*)f->varying[VPL_SURFACE_VARYINGS];
    memcpy(plane, surface, 3 * sizeof f->varying[0]);
    vplSetNormals(n, plane);
    int32_t smooth[VPL_LANES];
    memset(smooth, u->normals != NULL ? 0xff : 0, sizeof smooth);
    vplFinishNormals(plane, smooth, surface);
}

void VPL_KERNEL(vplShadeDirect)(const void* uniforms, vplFragments* f)
{
    const vplPassUniforms* u = uniforms;
    vplTileSums* sums = f->scratch;
    const vplPoints points = pointsOf(u, f);
    vplDirectIrradiance(u->shading, &u->shading->direct, &points, f->plane, &sums->shadowRays);
    vplAddLightOfRaysOfBlock(u->shading, &points, f->x, f->y, f->plane, &sums->shadowRays);
    vplStoreTriangle(triangleOf(u, f), f);
}

// Moves a finished group of a block from its planes to the sums.
static void flushBlock(vplFragments* f)
{
    vplTileSums* sums = f->scratch;
    for (int c = 0; c < 3; c++) {
        double sum[VPL_LANES];
        memcpy(sum, sums->irradiance[c] + f->element, sizeof sum);
        for (int l = 0; l < VPL_LANES; l++) {
            const float part = f->plane[c][l];
            sum[l] += f->covered[l] ? (double)part : 0.0;
            f->plane[c][l] = 0;
        }
        memcpy(sums->irradiance[c] + f->element, sum, sizeof sum);
    }
}

// Adds `count` consecutive passes, whose lights follow each other in the list. The kernel starts from the
// framebuffer's sum of the group, so that the order of additions does not depend on lights per pass or passes
// per call.
void VPL_KERNEL(vplShadeLights)(const void* const* uniforms, int count, vplFragments* f)
{
    const vplPassUniforms *u = uniforms[0], *last = uniforms[count - 1];
    vplTileSums* sums = f->scratch;
    const vplPoints points = pointsOf(u, f);
    const int end = last->first + last->count;
    for (int first = u->first; first < end;) {
        const int groupEnd = (first / VPL_LIGHT_GROUP + 1) * VPL_LIGHT_GROUP;
        const int next = groupEnd < end ? groupEnd : end;
        vplIndirectIrradiance(u->shading, &points, first, next - first, f->plane, &sums->shadowRays);
        first = next;
        if (first == groupEnd) {
            flushBlock(f);
        }
    }
}

void VPL_KERNEL(vplFlushTile)(void* data, vplTile* tile, int worker)
{
    (void)data;
    (void)worker;
    vplTileSums* sums = tile->scratch;
    const int rows = (tile->height + VPL_BLOCK_SIDE - 1) / VPL_BLOCK_SIDE;
    for (int c = 0; c < 3; c++) {
        float* restrict part = tile->planes[VPL_PLANE_IRRADIANCE + c];
        double* restrict sum = sums->irradiance[c];
        for (int i = 0; i < rows * VPL_TILE_BLOCKS * VPL_LANES; i++) {
            sum[i] += (double)part[i];
            part[i] = 0;
        }
    }
}

void VPL_KERNEL(vplResolveTile)(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    const vplTileSums* tileSums = tile->scratch;
    __atomic_fetch_add(s->shadowRays, tileSums->shadowRays, __ATOMIC_RELAXED);
    vplFacetCache cache;
    vplFacetCache_Clear(&cache);
    for (int block = 0; block < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; block++) {
        vplBlock b;
        const bool any = vplReadTriangles(tile, block * VPL_LANES, b.points.triangle);
        b.same = vplSameTriangle(b.points.triangle);
        if (any && b.same) {
            b.reflector = vplFacetCache_Get(s, b.points.triangle[0], &cache)->reflector;
        }
        for (int c = 0; c < 3; c++) {
            memcpy(b.sums[c], tileSums->irradiance[c] + block * VPL_LANES, sizeof b.sums[c]);
        }
        vplWriteLit(s, tile, block, &cache, &b);
    }
}
