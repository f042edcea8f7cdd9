// SPDX-License-Identifier: MIT
// The environment behind all surfaces: radiance, times the share of a pixel's samples that show nothing. Drawn by itself and
// added to the picture, because no strategy of shading has a place for pixels without surfaces.
#include "math/vec.h"
#include "shading/edges.h"

// Tests whether the picture of the environment is finer than the pixels of the view, so that its detail needs all samples.
static bool isFine(const vplShading* s)
{
    const double pixel =
        2 / (s->view->height * (double)s->view->scaleY); // radians, in the middle of the view
    return 2 * VPL_PI / s->geometry->environment->width < pixel;
}

static vplRgb radianceAt(const vplShading* s, int x, int y, vplSubPixel at)
{
    return vplEnvironment_Radiance(s->geometry->environment, vplNormalize(vplSightOf(s->view, x, y, at)));
}

// What a pixel shows of the environment: its centre, and of each sample the same or its own.
static vplRgb backgroundOf(const vplShading* s, const vplTile* tile, int element, bool open, bool fine, int x,
                           int y)
{
    const int count = tile->sampleCount;
    const float share = 1 / (float)(count + 1);
    vplRgb sum = {0, 0, 0}, centre = {0, 0, 0};
    bool any = open;
    for (int i = 0; i < count && !any; i++) {
        any = tile->samples[i][element] < 0;
    }
    if (any) {
        centre = radianceAt(s, x, y, (vplSubPixel){0, 0});
        sum = open ? vplRgbScale(share, centre) : sum;
    }
    for (int i = 0; i < count && any; i++) {
        if (tile->samples[i][element] < 0) {
            const vplRgb l = fine ? radianceAt(s, x, y, vplSubPixel_OfSample(i, count)) : centre;
            sum = (vplRgb){sum.r + share * l.r, sum.g + share * l.g, sum.b + share * l.b};
        }
    }
    return sum;
}

static void drawTile(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    const bool fine = isFine(s);
    for (int block = 0; block < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; block++) {
        const int x0 = block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE,
                  y0 = block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE;
        float values[3][VPL_LANES] = {{0}};
        int centre[VPL_LANES];
        if (x0 >= tile->width || y0 >= tile->height) {
            continue;
        }
        vplReadTriangles(tile, block * VPL_LANES, centre);
        for (int l = 0; l < VPL_LANES; l++) {
            const int x = tile->x + x0 + l % VPL_BLOCK_SIDE, y = tile->y + y0 + l / VPL_BLOCK_SIDE;
            const vplRgb shown = backgroundOf(s, tile, block * VPL_LANES + l, centre[l] < 0, fine, x, y);
            values[0][l] = shown.r;
            values[1][l] = shown.g;
            values[2][l] = shown.b;
        }
        vplWriteBlock(s, tile, block, values);
    }
}

static vplResult openBackground(vplShading* shading, vplFramebuffer* framebuffer)
{
    vplOpenGbuffer(shading, framebuffer, drawTile);
    return VPL_SUCCESS;
}

const vplStrategy vplBackgroundStrategy = {.open = openBackground, .record = vplRecordGbuffer};
