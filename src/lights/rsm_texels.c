// SPDX-License-Identifier: MIT
// What texels of a reflective shadow map hold, and which texel a ray goes through.
#include "lights/rsm.h"

#include "base/context.h"
#include "geometry/emission.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "math/vec.h"

#include <string.h>

typedef struct Finishing {
    vplReflectiveMap* map;
    const vplGeometry* geometry;
    const double* angles; // of corners, see cornerAngle
    int side;             // corners along a side of `angles`
} Finishing;

// ---- solid angles

// Solid angle of the rectangle between the axis and (x, y) on a plane one metre away. Odd in x and in y.
static double cornerAngle(double x, double y)
{
    return vplAtan2(x * y, sqrt(x * x + y * y + 1));
}

// The corners of a quarter of the view, from its corner to its middle: the other quarters mirror it.
static void fillCorners(void* data, int row, int worker)
{
    (void)worker;
    const Finishing* f = data;
    double* angles = (double*)f->angles + (size_t)row * (size_t)f->side;
    const double step = 2.0 / f->map->size, y = f->map->extent[1] * (1 - row * step);
    for (int i = 0; i < f->side; i++) {
        angles[i] = cornerAngle(f->map->extent[0] * (1 - i * step), y);
    }
}

static double cornerAt(const Finishing* f, int i, int j)
{
    const int size = f->map->size, column = 2 * i <= size ? i : size - i, row = 2 * j <= size ? j : size - j;
    const double angle = f->angles[(size_t)row * (size_t)f->side + (size_t)column];
    return (2 * i <= size) == (2 * j <= size) ? angle : -angle;
}

// Steradians of a texel; the difference of corners is the integral over it.
static double texelAngle(const Finishing* f, int i, int j)
{
    return fabs(cornerAt(f, i, j) - cornerAt(f, i + 1, j) - cornerAt(f, i, j + 1) +
                cornerAt(f, i + 1, j + 1));
}

// ---- texels

// Cosine between a spot's axis and the way to a texel's centre.
static double cosineAt(const vplReflectiveMap* m, int i, int j)
{
    const double x = m->extent[0] * ((2 * i + 1.0) / m->size - 1);
    const double y = m->extent[1] * ((2 * j + 1.0) / m->size - 1);
    return 1 / sqrt(1 + x * x + y * y);
}

static vplRgb fluxOf(const Finishing* f, int i, int j)
{
    const vplReflectiveMap* m = f->map;
    const vplEmitterDef* e = &m->emitter;
    double share = e->type == VPL_EMITTER_DIRECTIONAL ? 4 * m->extent[0] * m->extent[1] / m->size / m->size
                                                      : texelAngle(f, i, j);
    share *= e->type == VPL_EMITTER_SPOT ? vplSpot_Falloff(e, cosineAt(m, i, j)) : 1;
    return vplScaleRadiometric(share, e->intensity);
}

static vplVec3 normalOf(const vplReflectiveMap* m, const vplGeometry* g, size_t texel, int triangle,
                        vplVec3 direction)
{
    const vplVec3 plain = g->normals[triangle];
    const vplVec3 lit = vplDot(plain, direction) > 0 ? vplNegate(plain) : plain;
    const vplVec3 smooth =
        vplNormalize(vplVec(m->normal[0][texel], m->normal[1][texel], m->normal[2][texel]));
    const float side = vplDot(smooth, lit);
    return smooth.x == 0 && smooth.y == 0 && smooth.z == 0 ? lit : side < 0 ? vplNegate(smooth) : smooth;
}

static void set3(const float* const planes[3], size_t texel, float a, float b, float c)
{
    ((float*)planes[0])[texel] = a;
    ((float*)planes[1])[texel] = b;
    ((float*)planes[2])[texel] = c;
}

static void finishTexel(const Finishing* f, int i, int j, size_t texel)
{
    const vplReflectiveMap* m = f->map;
    const vplGeometry* g = f->geometry;
    const int triangle = --((int32_t*)m->triangle)[texel];
    if (triangle < 0) {
        ((float*)m->distance)[texel] = INFINITY;
        set3(m->position, texel, 0, 0, 0);
        set3(m->normal, texel, 0, 0, 0);
        set3(m->albedo, texel, 0, 0, 0);
        set3(m->flux, texel, 0, 0, 0);
        return;
    }
    const bool parallel = m->emitter.type == VPL_EMITTER_DIRECTIONAL;
    const vplVec3 at = {m->position[0][texel], m->position[1][texel], m->position[2][texel]};
    const vplVec3 way = vplSub(at, m->origin), direction = parallel ? m->forward[0] : vplNormalize(way);
    const vplVec3 normal = normalOf(m, g, texel, triangle, direction);
    const vplRgb albedo = g->materials[g->triangleMaterials[triangle]].diffuse;
    const vplRgb flux = fluxOf(f, i, j);
    ((float*)m->distance)[texel] = parallel ? vplDot(way, direction) : vplLength(way);
    set3(m->normal, texel, normal.x, normal.y, normal.z);
    set3(m->albedo, texel, albedo.r, albedo.g, albedo.b);
    set3(m->flux, texel, flux.r, flux.g, flux.b);
}

static void finishRow(void* data, int index, int worker)
{
    (void)worker;
    const Finishing* f = data;
    const int size = f->map->size;
    for (int i = 0; i < size; i++) {
        finishTexel(f, i, index % size, (size_t)index * (size_t)size + (size_t)i);
    }
}

vplResult vplReflectiveMap_Finish(vplReflectiveMap* map, const vplGeometry* geometry)
{
    vplContext* context = map->context;
    Finishing f = {map, geometry, NULL, map->size / 2 + 1};
    if (map->emitter.type != VPL_EMITTER_DIRECTIONAL) {
        f.angles = vplAlloc(context, (size_t)f.side * (size_t)f.side, sizeof *f.angles);
        if (f.angles == NULL) {
            return VPL_OUT_OF_MEMORY;
        }
        vplParallelFor(context, f.side, fillCorners, &f);
    }
    vplParallelFor(context, map->faceCount * map->size, finishRow, &f);
    vplFree(context, (void*)f.angles);
    return VPL_SUCCESS;
}

// ---- look-ups

// The column or row of a coordinate in [-1, 1], or -1.
static int64_t cellOf(double x, int size)
{
    const double cell = (x + 1) * 0.5 * size;
    return x >= -1 && x <= 1 ? (cell < size ? (int64_t)cell : size - 1) : -1;
}

int64_t vplReflectiveMap_Find(const vplReflectiveMap* map, const vplRay* ray)
{
    const int64_t size = map->size;
    if (map->emitter.type == VPL_EMITTER_POINT) {
        int face, i, j;
        float s, t;
        return vplCube_Find(ray->direction, map->size, &face, &s, &t, &i, &j) ? (face * size + j) * size + i
                                                                              : -1;
    }
    const bool parallel = map->emitter.type == VPL_EMITTER_DIRECTIONAL;
    const vplVec3 p = parallel ? vplSub(ray->origin, map->origin) : ray->direction;
    const double depth = parallel ? 1 : (double)vplDot(map->forward[0], p);
    if (!(depth > 0)) {
        return -1;
    }
    const int64_t i = cellOf((double)vplDot(map->right[0], p) / depth / map->extent[0], map->size);
    const int64_t j = cellOf(-(double)vplDot(map->up[0], p) / depth / map->extent[1], map->size);
    return i >= 0 && j >= 0 ? j * size + i : -1;
}

bool vplReflectiveMap_GetHit(const vplReflectiveMap* map, const vplGeometry* geometry, int64_t texel,
                             vplHit* hitOut, vplVec3* directionOut)
{
    const int triangle = map->triangle[texel];
    if (triangle < 0) {
        return false;
    }
    const vplVec3 at = {map->position[0][texel], map->position[1][texel], map->position[2][texel]};
    vplHit hit = {.t = map->distance[texel],
                  .object = geometry->owners[triangle],
                  .face = vplGeometry_FaceOf(geometry, triangle),
                  .triangle = triangle,
                  .normal = geometry->normals[triangle]};
    hit.position = vplGeometry_InsideAt(geometry, triangle, at, &hit.u, &hit.v);
    *directionOut = map->emitter.type == VPL_EMITTER_DIRECTIONAL
                        ? map->forward[0]
                        : vplNormalize(vplSub(hit.position, map->origin));
    *hitOut = hit;
    return true;
}
