// SPDX-License-Identifier: MIT
// False colours, a numbered colour bar, and marks on pictures.
#ifndef VPL_IMAGE_DRAW_H
#define VPL_IMAGE_DRAW_H

#include <vpl/imagetools.h>

// Linear RGB of t, clamped to [0, 1]: black, violet, red, orange, yellow, white.
vplRgb vplFalseColour(float t);

// Linear RGB of t, clamped to [0, 1], in the magma colours of FLIP's maps: black, violet, red, pale yellow.
vplRgb vplMagma(float t);

// Height of the colour bar below a picture of this width; 0 if the picture is too narrow for one.
int vplColourBar_GetHeight(int width);

typedef vplRgb vplColourFcn(float t);

// Draws a bar of these colours from row `top` on, with numbers from 0 to `largest`.
void vplColourBar_Draw(vplImage* image, int top, float largest, vplColourFcn* colour);

// Draws a filled disc with a dark rim, clipped to the picture.
void vplDrawDisc(vplImage* image, float x, float y, float radius, vplRgb colour);

// Draws a filled square with a dark rim, clipped to the picture.
void vplDrawSquare(vplImage* image, float x, float y, float half, vplRgb colour);

#endif
