// SPDX-License-Identifier: MIT
// Shadow maps of all kinds behind one interface, for tests of their common properties.
#ifndef VPL_TESTS_SHADOW_MAPS_H
#define VPL_TESTS_SHADOW_MAPS_H

#include "shapes.h"

#include "visibility/blocks.h"

typedef enum MapKind {
    MAP_CUBE,            // one sample, exact bias
    MAP_SOFT_CUBE,       // 16 samples within the automatic radius
    MAP_WIDE_CUBE,       // 16 samples within 5 cm
    MAP_HEMI,            // hemi-octahedral
    MAP_PARABOLOID,      // one hemisphere
    MAP_TWO_PARABOLOIDS, // both hemispheres
    MAP_REFLECTIVE_POINT,
    MAP_REFLECTIVE_SPOT,
    MAP_REFLECTIVE_DIRECTIONAL,
    MAP_KINDS
} MapKind;

typedef struct ShadowMap {
    MapKind kind;
    const vplGeometry* geometry;
    vplVec3 position, forward;
    vplCubeMap* cube;
    vplShadow shadow; // the cube's
    vplHemiMaps* hemi;
    vplParaboloidMaps* paraboloids;
    vplReflectiveMap* reflective;
} ShadowMap;

const char* nameOfKind(MapKind kind);

// Makes a map from `position` in all directions (cubes, points, two paraboloids) or along `forward`. The
// caller must close the map on failure, too.
vplResult tryOpenMap(ShadowMap* map, MapKind kind, const vplGeometry* geometry, vplVec3 position,
                     vplVec3 forward, int size);
ShadowMap openMap(MapKind kind, const vplGeometry* geometry, vplVec3 position, vplVec3 forward, int size);
void closeMap(ShadowMap* map);

void setPoint(vplSurface* surface, int lane, vplVec3 position, vplVec3 normal);
void factorBlock(const ShadowMap* map, const vplSurface* surface, float factorOut[VPL_LANES]);
float factorAt(const ShadowMap* map, vplVec3 position, vplVec3 normal);

// Returns the vector from a point to the light: to its position, or 20 m against its direction.
vplVec3 wayToMap(const ShadowMap* map, vplVec3 point);

// Returns whether the map covers the point: it must lie in the cone of a spot, or in front of the plane of a
// half space and away from its rim.
bool isInView(const ShadowMap* map, vplVec3 point);

// Returns whether the rays around the one to the point all agree on `dark`, so that the map must agree, too.
bool isSureAt(const ShadowMap* map, vplVec3 point, vplVec3 normal, bool dark);

// Returns whether the ray from position along d, or one 2e-6 beside it (an edge may fall on either side),
// hits a surface at t = 1 / stored; stored 0: no hit.
bool holdsRay(const vplGeometry* g, const vplVec3 positionRightUp[3], vplVec3 d, float stored);

// Returns the hash of all texels.
uint64_t hashMap(const ShadowMap* map);

vplCubeMap* makeCubeMap(const vplGeometry* g, vplVec3 position, int size);

// A cube map whose six texels all store the same value, distance / far.
typedef struct FlatMap {
    vplCubeMap map;
    float texels[6];
} FlatMap;

void makeFlatMap(FlatMap* flat, vplContext* context, vplVec3 light, float far, float stored);

// Makes a shadow with the exact bias; samples within `offset` metres, negative: automatic.
vplShadow exactShadow(const vplCubeMap* map, int samples, float offset);

// Makes a hard shadow with static and dynamic bias, metres.
vplShadow pairShadow(const vplCubeMap* map, float biasStatic, float biasDynamic);

// Makes a floor of 20 m and a wall that stands on it at x = x0.
vplGeometry* wallOnFloor(vplContext* context, float x0);

#endif
