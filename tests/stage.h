// SPDX-License-Identifier: MIT
// A small scene for tests of shading, lights over it, and what a camera sees of it.
#ifndef VPL_TESTS_STAGE_H
#define VPL_TESTS_STAGE_H

#include "shapes.h"

// A step in a floor, a wall behind it, and nothing beyond: normals that differ, and planes that do.
vplGeometry* stage(vplContext* context);

vplView stageView(vplVec3 eye, int width, int height);

// Lights above, which shine down. The caller frees.
vplShadeLight* rollLights(int count, uint64_t seed);

// Physical; side 0: deferred, else interleaved.
vplShadeDef stageDef(const vplShadeLight* lights, int count, int side);

vplImage* shadeStage(const vplGeometry* g, const vplView* view, const vplShadeDef* def);

// What a pixel shows: distance along the view axis, the place from the eye, the normal.
typedef struct PixelSample {
    double w, p[3], n[3];
} PixelSample;

// One per pixel. The caller frees.
PixelSample* samplePixels(const vplGeometry* g, const vplView* view);

#endif
