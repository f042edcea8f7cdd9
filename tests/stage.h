// SPDX-License-Identifier: MIT
// A small scene for tests of shading, lights above it, and the surfaces that a camera sees.
#ifndef VPL_TESTS_STAGE_H
#define VPL_TESTS_STAGE_H

#include "shapes.h"

// Makes a floor with a step and a wall behind it in front of an empty background: surfaces that differ in
// normal, and surfaces that differ only in plane.
vplGeometry* stage(vplContext* context);

vplView stageView(vplVec3 eye, int width, int height);

// Makes lights above the stage that shine down. The caller frees them.
vplShadeLight* rollLights(int count, uint64_t seed);

// Shades with physical lighting; side 0: deferred, else interleaved with this side.
vplShadeDef stageDef(const vplShadeLight* lights, int count, int side);

vplImage* shadeStage(const vplGeometry* g, const vplView* view, const vplShadeDef* def);

// The surface in a pixel: depth along the view axis, position relative to the eye, normal.
typedef struct PixelSample {
    double w, p[3], n[3];
} PixelSample;

// Returns one sample per pixel. The caller frees them.
PixelSample* samplePixels(const vplGeometry* g, const vplView* view);

#endif
