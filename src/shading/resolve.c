// SPDX-License-Identifier: MIT
// The end of every pipeline: groups are folded into double sums, sums become radiance and pixels.
#include "math/vec.h"
#include "shading/shading.h"

#include <string.h>

enum { BLOCKS = VPL_TILE_BLOCKS * VPL_TILE_BLOCKS };

void vplFoldTile(void* data, vplTile* tile, int worker)
{
    (void)data;
    (void)worker;
    vplTileSums* sums = tile->scratch;
    const int rows = (tile->height + VPL_BLOCK_SIDE - 1) / VPL_BLOCK_SIDE;
    for (int c = 0; c < 3; c++) {
        float* part = tile->planes[VPL_PLANE_IRRADIANCE + c];
        for (int i = 0; i < rows * VPL_TILE_BLOCKS * VPL_LANES; i++) {
            sums->irradiance[c][i] += (double)part[i];
            part[i] = 0;
        }
    }
}

bool vplReadTriangles(const vplTile* tile, int element, int triangles[VPL_LANES])
{
    // Not read as floats: small integers are denormal there.
    memcpy(triangles, tile->planes[VPL_PLANE_TRIANGLE] + element, VPL_LANES * sizeof(int));
    int any = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        any |= triangles[l];
        triangles[l]--;
    }
    return any != 0;
}

void vplWriteBlock(const vplShading* shading, const vplTile* tile, int block, float values[3][VPL_LANES])
{
    vplImage* image = shading->image;
    const int x = block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE, y = block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE;
    for (int l = 0; l < VPL_LANES; l++) {
        const int px = x + (l & 3), py = y + (l >> 2);
        if (px < tile->width && py < tile->height) {
            float* pixel =
                image->pixels + 3 * ((size_t)(tile->y + py) * (size_t)image->width + (size_t)(tile->x + px));
            pixel[0] = values[0][l];
            pixel[1] = values[1][l];
            pixel[2] = values[2][l];
        }
    }
}

void vplResolveTile(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    const vplTileSums* sums = tile->scratch;
    __atomic_fetch_add(s->shadowRays, sums->shadowRays, __ATOMIC_RELAXED);
    for (int block = 0; block < BLOCKS; block++) {
        const int at = block * VPL_LANES;
        int triangles[VPL_LANES], last = -1;
        float radiance[3][VPL_LANES] = {{0}};
        if (vplReadTriangles(tile, at, triangles)) {
            vplFacet facet = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
            for (int l = 0; l < VPL_LANES; l++) {
                if (triangles[l] < 0) {
                    continue;
                }
                if (triangles[l] != last) {
                    last = triangles[l];
                    facet = vplGetFacet(s, last);
                    if (!s->def->emission) {
                        facet.emission = (vplRgb){0, 0, 0};
                    }
                }
                const double scale = 1 / VPL_PI;
                radiance[0][l] =
                    (float)(facet.emission.r + facet.rho.r * scale * sums->irradiance[0][at + l]);
                radiance[1][l] =
                    (float)(facet.emission.g + facet.rho.g * scale * sums->irradiance[1][at + l]);
                radiance[2][l] =
                    (float)(facet.emission.b + facet.rho.b * scale * sums->irradiance[2][at + l]);
            }
        }
        vplWriteBlock(s, tile, block, radiance);
    }
}
