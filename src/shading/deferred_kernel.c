// SPDX-License-Identifier: MIT
// Tiles of the G-buffer: writing them, lighting them, and showing what they hold or a shadow factor. Light is
// added in squares of 4 x 4 blocks, whose points, sums and lights stay in the first-level cache.
#include "base/isa.h"
#include "lights/kernels.h"
#include "math/scalar.h"
#include "shading/accumulate.h"
#include "shading/edges.h"

enum { SQUARE = 4, SQUARES = VPL_TILE_BLOCKS / SQUARE, SQUARE_BLOCKS = SQUARE * SQUARE };

void VPL_KERNEL(vplWriteGbuffer)(const void* uniforms, vplFragments* f)
{
    const vplObjectUniforms* u = uniforms;
    vplStoreTriangle(u->shading->geometry->objects[u->object].firstTriangle + f->primitive, f);
    memcpy(f->plane[VPL_PLANE_POSITION], f->varying[0], 3 * sizeof f->varying[0]);
    if (u->normals != NULL) {
        memcpy(f->plane[VPL_PLANE_NORMAL], f->varying[VPL_CAMERA_VARYINGS], 3 * sizeof f->varying[0]);
    }
}

// ---- light

// Block i of a square.
static inline int blockOf(int firstBlock, int i)
{
    return firstBlock + i / SQUARE * VPL_TILE_BLOCKS + i % SQUARE;
}

static void lightSquare(const vplShading* s, vplTile* tile, int firstBlock, vplFacetCache* cache,
                        vplBlock blocks[SQUARE_BLOCKS])
{
    vplTileSums* tileSums = tile->scratch;
    int lit[SQUARE_BLOCKS], litCount = 0;
    for (int i = 0; i < SQUARE_BLOCKS; i++) {
        vplBlock* b = &blocks[i];
        if (vplReadBlock(s, tile, blockOf(firstBlock, i) * VPL_LANES, cache, b)) {
            vplStartLight(s, tile, blockOf(firstBlock, i), b);
            lit[litCount++] = i;
        }
    }
    vplLitBlocks to = {.blocks = blocks, .lit = lit, .count = litCount};
    to.culls = s->lights.columns[0] != NULL && litCount > 0;
    if (to.culls) {
        to.bounds = vplFindBounds(blocks, lit, litCount);
    }
    vplAddLights(s, &to, 0, s->lights.count, &tileSums->shadowRays);
}

void VPL_KERNEL(vplLightTile)(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    const vplTileSums* tileSums = tile->scratch;
    vplFacetCache cache;
    vplFacetCache_Clear(&cache);
    vplBlock blocks[SQUARE_BLOCKS];
    for (int square = 0; square < SQUARES * SQUARES; square++) {
        const int x = square % SQUARES, y = square / SQUARES;
        if (x * SQUARE * VPL_BLOCK_SIDE < tile->width && y * SQUARE * VPL_BLOCK_SIDE < tile->height) {
            const int firstBlock = (y * VPL_TILE_BLOCKS + x) * SQUARE;
            lightSquare(s, tile, firstBlock, &cache, blocks);
            for (int i = 0; i < SQUARE_BLOCKS; i++) {
                vplWriteLit(s, tile, blockOf(firstBlock, i), &cache, &blocks[i]);
            }
        }
    }
    vplSmoothTile(s, tile, &cache, vplAddAllLights, NULL);
    __atomic_fetch_add(s->shadowRays, tileSums->shadowRays, __ATOMIC_RELAXED);
}

// ---- stages

// The albedo of a surface includes its emission, because a denoiser reads albedo as the part of a pixel's
// colour that does not depend on the light around.
static vplRgb showAlbedo(const vplShading* s, int triangle, vplVec3 point, const float emission[3])
{
    const vplRgb rho = vplReflectanceSeen(s->geometry, s->view, triangle, point);
    return (vplRgb){vplMinf(rho.r + emission[0], 1), vplMinf(rho.g + emission[1], 1),
                    vplMinf(rho.b + emission[2], 1)};
}

// The shown values of lane l, which shows something.
static vplRgb showPoint(const vplShading* s, const vplBlock* b, int l, float factor, vplFacetCache* cache)
{
    const int triangle = b->points.triangle[l];
    float grey = factor;
    switch (s->def->output) {
    case VPL_OUTPUT_NORMALS:
        return (vplRgb){b->surface.nx[l], b->surface.ny[l], b->surface.nz[l]};
    case VPL_OUTPUT_ALBEDO:
        return showAlbedo(s, triangle, vplSurface_At(&b->surface, l),
                          vplFacetCache_Get(s, triangle, cache)->reflector.emission);
    case VPL_OUTPUT_OBJECT:
        grey = (float)(s->geometry->owners[triangle] + 1);
        break;
    case VPL_OUTPUT_DEPTH: {
        const vplVec3 p = vplVec(b->surface.px[l], b->surface.py[l], b->surface.pz[l]);
        grey = vplDot(s->view->forward, vplSub(p, s->view->eye));
        break;
    }
    default:
        break;
    }
    return (vplRgb){grey, grey, grey};
}

void VPL_KERNEL(vplShowTile)(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    vplFacetCache cache;
    vplFacetCache_Clear(&cache);
    for (int block = 0; block < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; block++) {
        vplBlock b;
        float values[3][VPL_LANES] = {{0}}, factor[VPL_LANES] = {0};
        if (!vplReadBlock(s, tile, block * VPL_LANES, &cache, &b)) {
            vplWriteBlock(s, tile, block, values);
            continue;
        }
        if (s->def->output == VPL_OUTPUT_SHADOW_FACTOR) {
            const vplReflectiveMap* map = vplDirectLight_Map(&s->direct, 0);
            if (map != NULL) {
                vplReflectiveMap_FactorBlock(map, b.points.plane, factor);
            } else {
                vplShadow_FactorBlock(&s->direct.shadows[0], b.points.plane, factor);
            }
        }
        for (int l = 0; l < VPL_LANES; l++) {
            if (b.points.triangle[l] >= 0) {
                const vplRgb shown = showPoint(s, &b, l, factor[l], &cache);
                values[0][l] = shown.r;
                values[1][l] = shown.g;
                values[2][l] = shown.b;
            }
        }
        vplWriteBlock(s, tile, block, values);
    }
}
