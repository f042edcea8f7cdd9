// SPDX-License-Identifier: MIT
// Draws the pictures of the textured example scene: patterns FOLDER writes tiles.png, bricks.png and leaf.png, 128 pixels
// wide.
#include <vpl/vpl.h>

#include <stdio.h>

enum { SIZE = 128 };

// A number in [0, 1) for each stone or brick.
static float chance(int i)
{
    uint32_t x = (uint32_t)i * 2654435761u;
    x = (x ^ x >> 15) * 2246822519u;
    return (float)(x >> 8) * 0x1p-24f;
}

// Two by two tiles, dark and light.
static vplRgb tiles(int x, int y)
{
    const int dark = (x / (SIZE / 2) + y / (SIZE / 2)) % 2;
    return dark ? (vplRgb){0.06f, 0.10f, 0.16f} : (vplRgb){0.80f, 0.76f, 0.66f};
}

// Eight courses of bricks, two to a course, in a bond.
static vplRgb bricks(int x, int y)
{
    const int course = y / 16, shifted = (x + course % 2 * 32) % SIZE;
    if (y % 16 < 2 || shifted % 64 < 2) {
        return (vplRgb){0.55f, 0.52f, 0.48f};
    }
    const float shade = 0.7f + 0.5f * chance(2 * course + shifted / 64);
    return (vplRgb){0.46f * shade, 0.14f * shade, 0.08f * shade};
}

// White inside an ellipse that stands upright: an opacity.
static vplRgb leaf(int x, int y)
{
    const float u = ((float)x + 0.5f) / SIZE * 2 - 1, v = ((float)y + 0.5f) / SIZE * 2 - 1;
    const float inside = 4 * u * u + v * v < 1 ? 1.0f : 0.0f;
    return (vplRgb){inside, inside, inside};
}

static bool draw(vplContext* context, const char* folder, const char* name, vplRgb (*pattern)(int, int))
{
    char path[4096];
    vplImage* image = NULL;
    snprintf(path, sizeof path, "%s/%s.png", folder, name);
    if (vplImage_Create(context, SIZE, SIZE, &image) != VPL_SUCCESS) {
        return false;
    }
    for (int i = 0; i < SIZE * SIZE; i++) {
        const vplRgb c = pattern(i % SIZE, i / SIZE);
        image->pixels[3 * i] = c.r;
        image->pixels[3 * i + 1] = c.g;
        image->pixels[3 * i + 2] = c.b;
    }
    const bool written = vplImage_Write(image, path, NULL) == VPL_SUCCESS;
    vplImage_Destroy(image);
    return written;
}

int main(int count, char** words)
{
    vplContext* context = NULL;
    if (count != 2) {
        fprintf(stderr, "usage: patterns FOLDER\n");
        return 2;
    }
    const bool done = vplContext_Create(NULL, &context) == VPL_SUCCESS &&
                      draw(context, words[1], "tiles", tiles) && draw(context, words[1], "bricks", bricks) &&
                      draw(context, words[1], "leaf", leaf);
    vplContext_Destroy(context);
    return done ? 0 : 1;
}
