// SPDX-License-Identifier: MIT
#include "image/draw.h"
#include "base/numbers.h"
#include "math/scalar.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Interpolates linearly between `count` colours at equal steps.
static vplRgb mixStops(const vplRgb* stops, int count, float t)
{
    float at = (float)(count - 1) * vplClampf(t == t ? t : 0, 0, 1);
    int i = vplMini((int)at, count - 2);
    float f = at - (float)i;
    return (vplRgb){stops[i].r + f * (stops[i + 1].r - stops[i].r),
                    stops[i].g + f * (stops[i + 1].g - stops[i].g),
                    stops[i].b + f * (stops[i + 1].b - stops[i].b)};
}

vplRgb vplFalseColour(float t)
{
    static const vplRgb stops[6] = {
        {0, 0, 0}, {0.06f, 0.01f, 0.25f}, {0.45f, 0.02f, 0.12f}, {0.90f, 0.12f, 0.01f}, {1.0f, 0.60f, 0.02f},
        {1, 1, 1}};
    return mixStops(stops, 6, t);
}

// Every 16th colour of matplotlib's magma (Smith and van der Walt, 2015, CC0), in sRGB. Interpolation stays
// within 0.01 of the others.
vplRgb vplMagma(float t)
{
    static const vplRgb stops[17] = {
        {0.001f, 0.000f, 0.014f}, {0.039f, 0.031f, 0.133f}, {0.112f, 0.065f, 0.276f},
        {0.210f, 0.062f, 0.417f}, {0.315f, 0.071f, 0.485f}, {0.413f, 0.110f, 0.504f},
        {0.511f, 0.147f, 0.508f}, {0.611f, 0.181f, 0.499f}, {0.713f, 0.214f, 0.476f},
        {0.814f, 0.254f, 0.438f}, {0.901f, 0.316f, 0.390f}, {0.959f, 0.414f, 0.360f},
        {0.986f, 0.530f, 0.380f}, {0.996f, 0.648f, 0.442f}, {0.997f, 0.763f, 0.530f},
        {0.993f, 0.878f, 0.634f}, {0.987f, 0.991f, 0.750f}};
    vplRgb c = mixStops(stops, 17, t);
    return (vplRgb){vplSrgb_Decode(c.r), vplSrgb_Decode(c.g), vplSrgb_Decode(c.b)};
}

static void setPixel(vplImage* image, int x, int y, vplRgb colour)
{
    if (x >= 0 && y >= 0 && x < image->width && y < image->height) {
        float* p = image->pixels + 3 * ((size_t)y * (size_t)image->width + (size_t)x);
        p[0] = colour.r;
        p[1] = colour.g;
        p[2] = colour.b;
    }
}

static const struct {
    char character;
    uint8_t rows[7]; // of 5 bits, top first
} GLYPHS[] = {
    {'0', {14, 17, 19, 21, 25, 17, 14}}, {'1', {4, 12, 4, 4, 4, 4, 14}},
    {'2', {14, 17, 1, 2, 4, 8, 31}},     {'3', {31, 2, 4, 2, 1, 17, 14}},
    {'4', {2, 6, 10, 18, 31, 2, 2}},     {'5', {31, 16, 30, 1, 1, 17, 14}},
    {'6', {6, 8, 16, 30, 17, 17, 14}},   {'7', {31, 1, 2, 4, 8, 8, 8}},
    {'8', {14, 17, 17, 14, 17, 17, 14}}, {'9', {14, 17, 17, 15, 1, 2, 12}},
    {'.', {0, 0, 0, 0, 0, 12, 12}},      {'-', {0, 0, 0, 31, 0, 0, 0}},
    {'+', {0, 4, 4, 31, 4, 4, 0}},       {'e', {0, 0, 14, 17, 31, 16, 14}},
    {'%', {24, 25, 2, 4, 8, 19, 3}},
};

// Writes digits and "+-.e%" with their top left corner at (x, y); a glyph is 5 by 7 pixels.
static void drawText(vplImage* image, int x, int y, vplRgb colour, const char* text)
{
    for (; *text; text++, x += 6) {
        for (size_t g = 0; g < sizeof GLYPHS / sizeof *GLYPHS; g++) {
            for (int i = 0; GLYPHS[g].character == *text && i < 35; i++) {
                if (GLYPHS[g].rows[i / 5] >> (4 - i % 5) & 1) {
                    setPixel(image, x + i % 5, y + i / 5, colour);
                }
            }
        }
    }
}

int vplColourBar_GetHeight(int width)
{
    return width >= 160 ? 26 : 0;
}

void vplColourBar_Draw(vplImage* image, int top, float largest, vplColourFcn* colour)
{
    for (int x = 0; x < image->width; x++) {
        for (int y = top + 2; y < top + 14; y++) {
            setPixel(image, x, y, colour((float)x / (float)(image->width - 1)));
        }
    }
    int labels = image->width >= 320 ? 5 : 3;
    for (int i = 0; i < labels; i++) {
        char text[32];
        double value = (double)largest * i / (labels - 1);
        vplFormat(text, sizeof text, value != 0 && (value < 0.001 || value >= 1e5) ? "%.1e" : "%.4g", value);
        int wide = 6 * (int)strlen(text) - 1;
        int x = (image->width - 1) * i / (labels - 1) - wide * i / (labels - 1);
        drawText(image, x, top + 17, (vplRgb){1, 1, 1}, text);
    }
}

static void drawMark(vplImage* image, float x, float y, float radius, bool square, vplRgb colour)
{
    if (!(fabsf(x) < 1e6f && fabsf(y) < 1e6f)) {
        return;
    }
    for (int j = (int)floorf(y - radius); j <= (int)ceilf(y + radius); j++) {
        for (int i = (int)floorf(x - radius); i <= (int)ceilf(x + radius); i++) {
            float dx = (float)i + 0.5f - x, dy = (float)j + 0.5f - y;
            float d = square ? vplMaxf(fabsf(dx), fabsf(dy)) : sqrtf(dx * dx + dy * dy);
            if (d <= radius) {
                setPixel(image, i, j, d > radius - 1 && radius > 2 ? (vplRgb){0, 0, 0} : colour);
            }
        }
    }
}

void vplDrawDisc(vplImage* image, float x, float y, float radius, vplRgb colour)
{
    drawMark(image, x, y, radius, false, colour);
}

void vplDrawSquare(vplImage* image, float x, float y, float half, vplRgb colour)
{
    drawMark(image, x, y, half, true, colour);
}
