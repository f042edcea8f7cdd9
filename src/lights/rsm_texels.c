// SPDX-License-Identifier: MIT
// Texels of a reflective shadow map: position, normal and flux are found from the triangle on demand, and the
// texel of a ray. In double: at grazing angles the hit has ten times the rounding error of the ray.
#include "lights/kernels.h"

#include "base/context.h"
#include "geometry/cut_outs.h"
#include "geometry/emission.h"
#include "geometry/paint.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "math/vec.h"

typedef struct Place {
    int face, i, j;
    double x, y; // of the texel's centre: tangents across and up, parallel: metres
} Place;

static Place placeOf(const vplReflectiveMap* m, int64_t texel)
{
    const int64_t size = m->size;
    Place p = {(int)(texel / (size * size)), (int)(texel % size), (int)(texel / size % size), 0, 0};
    p.x = m->extent[0] * ((2 * p.i + 1.0) / m->size - 1);
    p.y = m->extent[1] * (1 - (2 * p.j + 1.0) / m->size);
    return p;
}

// ---- flux

// Solid angle of the rectangle between the axis and (x, y) on a plane one metre away. Odd in x and in y.
static double cornerAngle(double x, double y)
{
    return vplAtan2(x * y, sqrt(x * x + y * y + 1));
}

// Steradians of a texel; the difference of corners is the integral over it.
static double texelAngle(const vplReflectiveMap* m, const Place* p)
{
    const double x = m->extent[0] / m->size, y = m->extent[1] / m->size;
    return fabs(cornerAngle(p->x - x, p->y - y) - cornerAngle(p->x + x, p->y - y) -
                cornerAngle(p->x - x, p->y + y) + cornerAngle(p->x + x, p->y + y));
}

static vplRgb fluxOf(const vplReflectiveMap* m, const Place* p)
{
    const vplEmitterDef* e = &m->emitter;
    double share = e->type == VPL_EMITTER_DIRECTIONAL ? 4 * m->extent[0] * m->extent[1] / m->size / m->size
                                                      : texelAngle(m, p);
    share *= e->type == VPL_EMITTER_SPOT ? vplSpot_Falloff(e, 1 / sqrt(1 + p->x * p->x + p->y * p->y)) : 1;
    return vplScaleRadiometric(share, e->intensity);
}

// ---- place

// The point where the ray through a texel's centre meets a triangle's plane, metres. A triangle that is seen
// edge-on, or does not quite cover the centre (coverage is snapped to 1/256 texel), is hit within the depths
// of its corners.
static vplVec3 meetPlane(const vplReflectiveMap* m, const vplGeometry* g, const Place* p, int triangle)
{
    const bool parallel = m->emitter.type == VPL_EMITTER_DIRECTIONAL;
    const vplTriangleCorners corners = vplGeometry_Corners(g, triangle);
    double n[3], from[3], way[3], corner[3] = {0}, height = 0, fall = 0, square = 0;
    vplTriangle_Cross(&corners, n);
    for (int k = 0; k < 3; k++) {
        const double forward = vplComponent(m->forward[p->face], k);
        const double side =
            p->x * vplComponent(m->right[p->face], k) + p->y * vplComponent(m->up[p->face], k);
        from[k] = vplComponent(m->origin, k) + (parallel ? side : 0);
        way[k] = forward + (parallel ? 0 : side);
        height += n[k] * (vplComponent(corners.corner[0], k) - from[k]);
        fall += n[k] * way[k];
        square += n[k] * n[k];
        for (int i = 0; i < 3; i++) {
            corner[i] += forward * ((double)vplComponent(corners.corner[i], k) - vplComponent(m->origin, k));
        }
    }
    const double least = fmin(corner[0], fmin(corner[1], corner[2]));
    const double most = fmax(corner[0], fmax(corner[1], corner[2]));
    const double meets = height / fall, t = meets < least  ? least
                                            : meets < most ? meets
                                                           : most; // most: not a number
    const double off =
        square > 0 ? (height - t * fall) / square : 0; // returns to the plane where t was clamped
    return vplVec((float)(from[0] + t * way[0] + off * n[0]), (float)(from[1] + t * way[1] + off * n[1]),
                  (float)(from[2] + t * way[2] + off * n[2]));
}

// The solid surface that a texel shows.
static bool getSolidHit(const vplReflectiveMap* map, const vplGeometry* geometry, int64_t texel,
                        vplHit* hitOut, vplVec3* directionOut)
{
    const int triangle = map->triangle[texel];
    if (triangle < 0) {
        return false;
    }
    const Place p = placeOf(map, texel);
    const vplVec3 at = meetPlane(map, geometry, &p, triangle);
    vplHit hit = {.object = geometry->owners[triangle],
                  .face = vplGeometry_FaceOf(geometry, triangle),
                  .triangle = triangle,
                  .normal = geometry->normals[triangle]};
    hit.position = vplGeometry_InsideAt(geometry, triangle, at, &hit.u, &hit.v);
    const vplVec3 way = vplSub(hit.position, map->origin);
    const bool parallel = map->emitter.type == VPL_EMITTER_DIRECTIONAL;
    *directionOut = parallel ? map->forward[0] : vplNormalize(way);
    hit.t = parallel ? vplDot(way, map->forward[0]) : vplLength(way);
    *hitOut = hit;
    return true;
}

// The cut-out that the ray through a texel's centre meets nearer than tMax, metres.
static bool getCutOut(const vplReflectiveMap* map, const vplGeometry* geometry, int64_t texel, float tMax,
                      vplHit* hitOut, vplVec3* directionOut)
{
    const Place p = placeOf(map, texel);
    const bool parallel = map->emitter.type == VPL_EMITTER_DIRECTIONAL;
    const vplVec3 side =
        vplAdd(vplScale((float)p.x, map->right[p.face]), vplScale((float)p.y, map->up[p.face]));
    const vplVec3 forward = map->forward[p.face];
    const vplRay ray = {parallel ? vplAdd(map->origin, side) : map->origin,
                        parallel ? forward : vplNormalize(vplAdd(forward, side)),
                        {0, 0}};
    if (!vplCutOuts_ClosestHit(geometry, &ray, tMax, hitOut)) {
        return false;
    }
    *directionOut = ray.direction;
    return true;
}

bool vplReflectiveMap_GetHit(const vplReflectiveMap* map, const vplGeometry* geometry, int64_t texel,
                             vplHit* hitOut, vplVec3* directionOut)
{
    const int64_t size = map->size;
    if (texel < 0 || texel >= map->faceCount * size * size) {
        return false;
    }
    const bool solid = getSolidHit(map, geometry, texel, hitOut, directionOut);
    return (geometry->cutOuts != NULL &&
            getCutOut(map, geometry, texel, solid ? hitOut->t : INFINITY, hitOut, directionOut)) ||
           solid;
}

bool vplReflectiveMap_GetTexel(const vplReflectiveMap* map, const vplGeometry* geometry, int64_t texel,
                               vplReflectiveTexel* texelOut)
{
    vplHit hit;
    vplVec3 direction;
    if (!vplReflectiveMap_GetHit(map, geometry, texel, &hit, &direction)) {
        return false;
    }
    const Place p = placeOf(map, texel);
    const vplVec3 lit = vplDot(hit.normal, direction) > 0 ? vplNegate(hit.normal) : hit.normal;
    const vplVec3 smooth = vplGeometry_ShadingNormal(geometry, &hit);
    const bool parallel = map->emitter.type == VPL_EMITTER_DIRECTIONAL;
    const float texelWidth = 2 * (float)map->extent[1] / (float)map->size; // metres, or metres per metre
    const vplFootprint footprint = {direction, parallel ? texelWidth : texelWidth * hit.t};
    *texelOut = (vplReflectiveTexel){
        .distance = hit.t,
        .position = hit.position,
        .normal = vplDot(smooth, lit) < 0 ? vplNegate(smooth) : smooth,
        .albedo = vplGeometry_Reflectance(geometry, hit.triangle, hit.position, &footprint),
        .flux = fluxOf(map, &p),
        .triangle = hit.triangle,
    };
    return true;
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
        vplCubePoint p;
        return vplCube_Find(ray->direction, map->size, &p) ? (p.face * size + p.row) * size + p.column : -1;
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

void vplReflectiveMap_FactorBlock(const vplReflectiveMap* map, const vplSurface* surface,
                                  float factorOut[VPL_LANES])
{
    vplGetLightsKernels(map->context->isa)->reflectiveFactor(map, surface, factorOut);
}

float vplReflectiveMap_Factor(const vplReflectiveMap* map, vplVec3 position, vplVec3 normal)
{
    const vplSurface surface = vplSurface_OfPoint(position, normal);
    float factor[VPL_LANES];
    vplReflectiveMap_FactorBlock(map, &surface, factor);
    return factor[0];
}
