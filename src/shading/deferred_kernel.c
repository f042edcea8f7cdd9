// SPDX-License-Identifier: MIT
// What a tile of the G-buffer shows: light, depth, normals or a shadow factor. Lit in squares of 4 x 4 blocks,
// whose points, sums and lights stay in the first cache.
#include "base/isa.h"
#include "shading/add_lights.h"

enum { SQUARE = 4, SQUARES = VPL_TILE_BLOCKS / SQUARE, SQUARE_BLOCKS = SQUARE * SQUARE };

vplFragmentFcn VPL_KERNEL(vplWriteGbuffer);
vplTileFcn VPL_KERNEL(vplLightTile), VPL_KERNEL(vplShowTile);

void VPL_KERNEL(vplWriteGbuffer)(const void* uniforms, vplFragments* f)
{
    const vplObjectUniforms* u = uniforms;
    vplShowTriangle(u->shading->geometry->objects[u->object].firstTriangle + f->primitive, f);
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

static void lightSquare(const vplShading* s, vplTile* tile, int firstBlock, vplSeen* seen,
                        vplBlock blocks[SQUARE_BLOCKS])
{
    vplTileSums* tileSums = tile->scratch;
    int lit[SQUARE_BLOCKS], litCount = 0;
    for (int i = 0; i < SQUARE_BLOCKS; i++) {
        vplBlock* b = &blocks[i];
        if (vplReadBlock(s, tile, blockOf(firstBlock, i) * VPL_LANES, seen, b)) {
            vplLightOnce(s, tile, blockOf(firstBlock, i), b);
            lit[litCount++] = i;
        }
    }
    const bool culls = s->columns[0] != NULL && litCount > 0;
    vplBounds bounds = {{0}, {0}};
    if (culls) {
        bounds = vplFindBounds(blocks, lit, litCount);
    }
    vplAddLights(s, blocks, lit, litCount, culls ? &bounds : NULL, 0, s->def->lightCount,
                 &tileSums->shadowRays);
}

void VPL_KERNEL(vplLightTile)(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    const vplTileSums* tileSums = tile->scratch;
    vplSeen seen;
    vplSeen_Clear(&seen);
    vplBlock blocks[SQUARE_BLOCKS];
    for (int square = 0; square < SQUARES * SQUARES; square++) {
        const int x = square % SQUARES, y = square / SQUARES;
        if (x * SQUARE * VPL_BLOCK_SIDE < tile->width && y * SQUARE * VPL_BLOCK_SIDE < tile->height) {
            const int firstBlock = (y * VPL_TILE_BLOCKS + x) * SQUARE;
            lightSquare(s, tile, firstBlock, &seen, blocks);
            for (int i = 0; i < SQUARE_BLOCKS; i++) {
                vplWriteLit(s, tile, blockOf(firstBlock, i), &seen, &blocks[i]);
            }
        }
    }
    __atomic_fetch_add(s->shadowRays, tileSums->shadowRays, __ATOMIC_RELAXED);
}

// ---- a look at the stages

void VPL_KERNEL(vplShowTile)(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    const vplView* view = s->view;
    const bool depth = s->def->output == VPL_OUTPUT_DEPTH, normals = s->def->output == VPL_OUTPUT_NORMALS;
    vplSeen seen;
    vplSeen_Clear(&seen);
    for (int block = 0; block < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; block++) {
        vplBlock b;
        float values[3][VPL_LANES] = {{0}}, factor[VPL_LANES] = {0};
        if (!vplReadBlock(s, tile, block * VPL_LANES, &seen, &b)) {
            vplWriteBlock(s, tile, block, values);
            continue;
        }
        if (s->def->output == VPL_OUTPUT_SHADOW_FACTOR) {
            const vplReflectiveMap* map = vplEmitterMapOf(s->def, 0);
            if (map != NULL) {
                vplReflectiveMap_FactorBlock(map, b.points.plane, factor);
            } else {
                vplShadow_FactorBlock(&s->def->shadows[0], b.points.plane, factor);
            }
        }
        for (int l = 0; l < VPL_LANES; l++) {
            if (b.points.triangle[l] < 0) {
                continue;
            }
            const vplVec3 p = vplVec(b.surface.px[l], b.surface.py[l], b.surface.pz[l]);
            const float grey = depth ? vplDot(view->forward, vplSub(p, view->eye)) : factor[l];
            values[0][l] = normals ? b.surface.nx[l] : grey;
            values[1][l] = normals ? b.surface.ny[l] : grey;
            values[2][l] = normals ? b.surface.nz[l] : grey;
        }
        vplWriteBlock(s, tile, block, values);
    }
}
