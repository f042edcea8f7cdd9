// SPDX-License-Identifier: MIT
// The picture's pixels.
#include "shading/shading.h"

#include <string.h>

void vplWriteBlock(const vplShading* shading, const vplTile* tile, int block, float values[3][VPL_LANES])
{
    vplImage* image = shading->image;
    const int x = block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE, y = block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE;
    const int width = tile->width - x < VPL_BLOCK_SIDE ? tile->width - x : VPL_BLOCK_SIDE;
    float pixels[VPL_LANES][3];
    for (int l = 0; l < VPL_LANES; l++) {
        pixels[l][0] = values[0][l];
        pixels[l][1] = values[1][l];
        pixels[l][2] = values[2][l];
    }
    for (int row = 0; row < VPL_BLOCK_SIDE && y + row < tile->height && width > 0; row++) {
        float* to =
            image->pixels + 3 * ((size_t)(tile->y + y + row) * (size_t)image->width + (size_t)(tile->x + x));
        memcpy(to, pixels[row * VPL_BLOCK_SIDE], (size_t)width * sizeof pixels[0]);
    }
}
