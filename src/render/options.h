// SPDX-License-Identifier: MIT
// Options from the inside: the value of a table row, and the checks that need no scene geometry.
#ifndef VPL_RENDER_OPTIONS_H
#define VPL_RENDER_OPTIONS_H

#include <vpl/stages.h>

// The value of a number or choice; 0 for a seed.
double vplOption_GetNumber(const vplOption* option, const vplRenderOptions* options);

// The size in which the picture is rendered, before it is enlarged by --pixel-size; and the number of its pixels.
int vplRenderedWidth(const vplOutputOptions* options);
int vplRenderedHeight(const vplOutputOptions* options);
double vplCountPixels(const vplOutputOptions* options);

// The pipeline that "usual" stands for.
vplAccumulation vplUsualPipeline(const vplRenderOptions* options);

// The side of the square of pixels that share lights that "auto" stands for.
int vplUsualSquare(const vplRenderOptions* options);

// Checks that every option is in its range and the camera is one of the scene's.
vplResult vplCheckOptions(const vplScene* scene, const vplRenderOptions* options);

#endif
