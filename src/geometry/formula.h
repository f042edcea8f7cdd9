// SPDX-License-Identifier: MIT
// Quads and boxes that rays test by their own formula instead of as triangles.
#ifndef VPL_GEOMETRY_FORMULA_H
#define VPL_GEOMETRY_FORMULA_H

#include <vpl/geometry.h>

// True for a quad or box whose corners, rounded to float, are not where its matrix puts them.
bool vplNeedsFormula(const vplGeometryObject* object, const vplMeshDef* shape, const vplVec3* positions);

// Finds the closest hit nearer than tMax among g->formulaObjects.
bool vplHitByFormula(const vplGeometry* g, const vplRay* ray, float tMax, vplHit* hitOut);

#endif
