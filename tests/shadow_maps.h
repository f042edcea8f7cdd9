// SPDX-License-Identifier: MIT
// Shadow maps of every kind behind one interface, for tests of what all of them promise.
#ifndef VPL_TESTS_SHADOW_MAPS_H
#define VPL_TESTS_SHADOW_MAPS_H

#include "shapes.h"

typedef enum MapKind {
    MAP_CUBE,            // one sample, exact bias
    MAP_SOFT_CUBE,       // 16 samples
    MAP_HEMI,            // hemi-octahedral
    MAP_PARABOLOID,      // one hemisphere
    MAP_TWO_PARABOLOIDS, // both
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
    vplShadow shadow; // of the cube
    vplHemiMaps* hemi;
    vplParaboloidMaps* paraboloids;
    vplReflectiveMap* reflective;
} ShadowMap;

const char* nameOfKind(MapKind kind);

// A map of what is seen from `position` around (cubes, points, two paraboloids) or along `forward`. On
// failure it must be closed as well.
vplResult tryOpenMap(ShadowMap* map, MapKind kind, const vplGeometry* geometry, vplVec3 position,
                     vplVec3 forward, int size);
ShadowMap openMap(MapKind kind, const vplGeometry* geometry, vplVec3 position, vplVec3 forward, int size);
void closeMap(ShadowMap* map);

void setPoint(vplSurface* surface, int lane, vplVec3 position, vplVec3 normal);
void factorBlock(const ShadowMap* map, const vplSurface* surface, float factorOut[VPL_LANES]);
float factorAt(const ShadowMap* map, vplVec3 position, vplVec3 normal);

// From a point to the light: to the position, or 20 m against the direction.
vplVec3 wayToMap(const ShadowMap* map, vplVec3 point);

// Whether the map covers the point: in the cone of a spot, before the plane of a half space and not at its
// rim.
bool isInView(const ShadowMap* map, vplVec3 point);

// Whether the rays around the one to the point all say `dark`, so that the map must say the same.
bool isSureAt(const ShadowMap* map, vplVec3 point, vplVec3 normal, bool dark);

// Whether a ray from position along d (or one a hair beside it, to the right or up: edges go to either side)
// meets something at 1 / stored times d; 0: nothing.
bool holdsRay(const vplGeometry* g, const vplVec3 positionRightUp[3], vplVec3 d, float stored);

// Of all texels.
uint64_t hashMap(const ShadowMap* map);

#endif
