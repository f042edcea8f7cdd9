// SPDX-License-Identifier: MIT
// Marks on pictures: false colours, a numbered colour bar, digits, discs and lines. For eyes only.
#ifndef VPL_IMAGE_DRAW_H
#define VPL_IMAGE_DRAW_H

#include <vpl/image.h>

// Black, violet, red, orange, yellow, white for t from 0 to 1; clamped outside. Linear RGB.
vplRgb vplFalseColour(float t);

// The magma colours that FLIP's maps are shown in: black, violet, red, pale yellow. Linear RGB.
vplRgb vplMagma(float t);

// Height of the colour bar below a picture of this width: 0 where a picture is too narrow for one.
int vplColourBar_GetHeight(int width);

typedef vplRgb vplColourFcn(float t);

// Draws a bar of these colours from row `top`, with five numbers from 0 to `largest`.
void vplColourBar_Draw(vplImage* image, int top, int height, float largest, vplColourFcn* colour);

// Writes text (digits and "+-.e%") with its top left corner at (x, y); a glyph is 5 by 7 pixels of `zoom`.
void vplDrawText(vplImage* image, int x, int y, int zoom, vplRgb colour, const char* text);

// A filled disc with a dark rim, clipped to the picture.
void vplDrawDisc(vplImage* image, float x, float y, float radius, vplRgb colour);

// A filled square with a dark rim, clipped to the picture.
void vplDrawSquare(vplImage* image, float x, float y, float half, vplRgb colour);

// A line one pixel wide, clipped to the picture.
void vplDrawLine(vplImage* image, float x0, float y0, float x1, float y1, vplRgb colour);

#endif
