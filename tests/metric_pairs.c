// SPDX-License-Identifier: MIT
#include "metric_pairs.h"

uint32_t mix(uint32_t n)
{
    n = (n ^ n >> 16) * 0x45d9f3bu;
    n = (n ^ n >> 16) * 0x45d9f3bu;
    return n ^ n >> 16;
}

int noise(uint32_t seed, uint32_t index)
{
    return (int)(mix(seed * 1000003u + index) >> 24);
}

int referenceValue(int pair, int x, int y, int channel, int width)
{
    switch (pair) {
    case 0: // ramps
        return (4 * x + y * (channel + 1)) % 256;
    case 1: // a checkerboard
        return (x / 8 + y / 6) % 2 == 0 ? 40 + 60 * channel : 200 - 50 * channel;
    default:
        return noise(7, (uint32_t)((y * width + x) * 3 + channel));
    }
}

float testValue(int pair, int x, int y, int channel, int width)
{
    float same = (float)referenceValue(pair, x, y, channel, width) / 256;
    switch (pair) {
    case 0:
        return same + (float)(noise(11, (uint32_t)((y * width + x) * 3 + channel)) - 128) / 1024;
    case 1:
        return (float)referenceValue(pair, x < 2 ? 0 : x - 2, y < 1 ? 0 : y - 1, channel, width) / 256;
    default:
        return (x + y) % 5 ? same : 1.5f * (float)referenceValue(pair, x, y, (channel + 1) % 3, width) / 256;
    }
}

Pair makePair(vplContext* context, int kind, int width, int height)
{
    Pair p;
    assert_int_equal(vplImage_Create(context, width, height, &p.a), VPL_SUCCESS);
    assert_int_equal(vplImage_Create(context, width, height, &p.b), VPL_SUCCESS);
    for (int i = 0; i < 3 * width * height; i++) {
        int x = i / 3 % width, y = i / 3 / width;
        p.a->pixels[i] = testValue(kind, x, y, i % 3, width);
        p.b->pixels[i] = (float)referenceValue(kind, x, y, i % 3, width) / 256;
    }
    return p;
}

void freePair(Pair p)
{
    vplImage_Destroy(p.a);
    vplImage_Destroy(p.b);
}

vplImage* makeFlat(vplContext* context, int width, int height, float r, float g, float b)
{
    vplImage* image;
    assert_int_equal(vplImage_Create(context, width, height, &image), VPL_SUCCESS);
    for (int i = 0; i < width * height; i++) {
        image->pixels[3 * i] = r;
        image->pixels[3 * i + 1] = g;
        image->pixels[3 * i + 2] = b;
    }
    return image;
}
