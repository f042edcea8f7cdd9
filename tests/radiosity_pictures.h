// SPDX-License-Identifier: MIT
// Rooms and pictures for end-to-end tests of radiosity.
#ifndef VPL_TESTS_RADIOSITY_PICTURES_H
#define VPL_TESTS_RADIOSITY_PICTURES_H

#include "scenes.h"
#include "shapes.h"

#include "math/vec.h"

// Makes a closed room with a box on the floor, lit by an area light or a point light.
vplScene* boxRoom(vplContext* context, float rho, bool areaLight);

vplRenderOptions radiosityOptions(int patches);

vplImage* showOf(const vplScene* scene, vplRenderOptions o, vplShow show);

double meanOf(const vplImage* image);

vplImage* pathsOf(const vplScene* scene, vplShow show, int spp);

vplComparison compare(const vplImage* a, const vplImage* b);

// Returns the mean product of the errors against two truths of independent noise, in which their noise
// cancels.
double commonError(const vplImage* image, vplImage* const truth[2]);

#endif
