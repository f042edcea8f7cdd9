// SPDX-License-Identifier: MIT
// What two triangles exchange with nothing between them, in full and at less cost.
#ifndef VPL_RADIOSITY_POLYGON_FACTOR_H
#define VPL_RADIOSITY_POLYGON_FACTOR_H

#include "radiosity/edge_integral.h"

#include <vpl/vecmath.h>

// The rules of vplTriangleFormFactor, and of pairs of patches, whose shadow rays err more than that.
extern const vplEdgeRule vplEdgesExact, vplEdgesQuick;

// A_a F_ab = A_b F_ba, m^2.
double vplTriangleExchange(const vplVec3 a[3], const vplVec3 b[3], const vplEdgeRule* rule);

#endif
