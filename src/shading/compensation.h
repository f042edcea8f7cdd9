// SPDX-License-Identifier: MIT
// Compensation: short rays that bring back the light that the clamp takes from virtual lights.
#ifndef VPL_SHADING_COMPENSATION_H
#define VPL_SHADING_COMPENSATION_H

#include "lights/light_set.h"
#include "math/sobol.h"
#include "shading/shading.h"

typedef struct vplCompensator {
    const vplCompensationDef* def;
    vplDirectLight direct; // lights the hits of short rays
    vplSobol sobol;
    float distance;              // D, the clamp distance, metres
    float areaLightDistance;     // the smaller one of lights that stand for emission,
    float areaLightInverseClamp; // and 1 over its square
} vplCompensator;

// A point to be lit, and the numbers that seed its random choices.
typedef struct vplLitPoint {
    vplHit hit;
    vplVec3 shading, plane; // normals on the side that is lit
    uint32_t pixel, ray, bounce;
} vplLitPoint;

// Turns both normals of the point's hit towards where `direction` came from.
void vplLitPoint_Face(vplLitPoint* point, const vplGeometry* g, vplVec3 direction);

// The reflectance of the surface that a ray has met there.
vplRgb vplLitPoint_Reflectance(const vplLitPoint* point, const vplGeometry* g);

// Finds the point shown at pixel coordinates (x, y); false where there is none.
bool vplFindVisiblePoint(const vplGeometry* g, const vplView* view, double x, double y, vplLitPoint* point);

// A list of virtual lights of which a point draws some.
typedef struct vplLightDraw {
    const vplShadeLight* lights;
    int count, drawn;
    int areaLightCount; // the first of them stand for emission
    float subtracted;   // see vplPointKernelFcn
} vplLightDraw;

// Irradiance of `drawn` of the lights, one from each of as many equal parts of the list, weighted by count /
// drawn; of all lights where there are no more. Rays find shadows if the compensation's def says so.
void vplReceiveDrawnLights(const vplShading* shading, const vplLightDraw* draw, const vplLitPoint* point,
                           float irradiance[3], int64_t* rays);

#endif
