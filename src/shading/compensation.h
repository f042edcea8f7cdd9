// SPDX-License-Identifier: MIT
// Short rays that bring back what the bound of near virtual lights takes away.
#ifndef VPL_SHADING_COMPENSATION_H
#define VPL_SHADING_COMPENSATION_H

#include "math/sobol.h"
#include "shading/shading.h"

// Sixteen virtual lights side by side: px, py, pz, nx, ny, nz.
typedef struct vplLightLanes {
    _Alignas(64) float at[6][VPL_LANES];
} vplLightLanes;

// What one point, with its normal, receives from each per unit of intensity: the arithmetic of vplLightsPhysical,
// with a bound for each light, and without the part up to `taken` of 1/d^2.
typedef void vplPointKernelFcn(const vplLightLanes* restrict lights, const float point[restrict 6],
                               const float inverseBound[restrict VPL_LANES], float taken,
                               float geometry[restrict VPL_LANES]);

vplPointKernelFcn* vplGetPointKernel(vplIsa isa);

// One render's compensation.
typedef struct vplNearLight {
    const vplCompensationDef* def;
    vplShading hits; // lights what rays meet: emitters and lamps by vplDirectIrradiance
    vplShadeDef hitsDef;
    vplPointKernelFcn* kernel;
    vplSobol sobol;
    float distance;                       // D, metres
    float lampDistance, areaLightInverseBound; // the smaller one of lights on lamps
} vplNearLight;

// A point to be lit, and the numbers that its choices are drawn with.
typedef struct vplLitPoint {
    vplHit hit;
    vplVec3 shading, plane; // normals on the side that is lit
    uint32_t pixel, ray, bounce;
} vplLitPoint;

// The place that the view shows at pixel coordinates (x, y); false where there is none.
bool vplLookAt(const vplGeometry* g, const vplView* view, double x, double y, vplLitPoint* p);

// Some virtual lights for a point to choose from.
typedef struct vplLightChoice {
    const vplShadeLight* lights;
    int count, chosen;
    int areaLightCount; // the first of them lie on lamps
    float taken;   // as the kernel's
} vplLightChoice;

// Irradiance of `chosen` of the lights, one from each of as many equal parts of the list, count / chosen times as
// bright; of all where there are no more. Shadows as the shading's def says.
void vplLightPoint(const vplShading* shading, const vplNearLight* near, const vplLightChoice* from,
                   const vplLitPoint* point, float irradiance[3], int64_t* rays);

#endif
