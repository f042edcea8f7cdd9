// SPDX-License-Identifier: MIT
// What a tile of the G-buffer shows: light, depth, normals or a shadow factor. Lit in squares of 4 x 4 blocks,
// whose points, sums and lights stay in the first cache.
#include "base/isa.h"
#include "math/vec.h"
#include "shading/normals.h"
#include "shading/resolve.h"

enum { SQUARE = 4, SQUARES = VPL_TILE_BLOCKS / SQUARE, SQUARE_BLOCKS = SQUARE * SQUARE };

vplFragmentFcn VPL_KERNEL(vplWriteGbuffer);
vplTileFcn VPL_KERNEL(vplLightTile), VPL_KERNEL(vplShowTile);

void VPL_KERNEL(vplWriteGbuffer)(const void* uniforms, vplFragments* f)
{
    const vplObjectUniforms* u = uniforms;
    const int triangle = u->shading->geometry->objects[u->object].firstTriangle + f->primitive;
    int32_t id[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        id[l] = triangle + 1;
    }
    memcpy(f->plane[VPL_PLANE_TRIANGLE], id, sizeof id);
    memcpy(f->plane[VPL_PLANE_POSITION], f->varying[0], 3 * sizeof f->varying[0]);
    if (u->normals != NULL) {
        memcpy(f->plane[VPL_PLANE_NORMAL], f->varying[VPL_CAMERA_VARYINGS], 3 * sizeof f->varying[0]);
    }
}

// A block of the G-buffer.
typedef struct Block {
    _Alignas(64) vplSurface surface, plane; // `plane` only where some object is smooth
    vplPoints points;
    vplReflector reflector; // where all lanes show one triangle
    bool same;
    double sums[3][VPL_LANES];
} Block;

// Normals of the triangles that a block shows, and which of them are smooth.
static void readFacets(const vplShading* s, const int triangles[VPL_LANES], vplSurface* plane,
                       int32_t smooth[VPL_LANES])
{
    const vplGeometry* g = s->geometry;
    vplVec3 n = {0, 0, 0};
    int32_t isSmooth = 0;
    for (int l = 0, last = -1; l < VPL_LANES; l++) {
        const int triangle = triangles[l];
        if (triangle != last) {
            last = triangle;
            n = triangle < 0 ? vplVec(0, 0, 0) : vplGetFacet(s, triangle).normal;
            isSmooth = triangle >= 0 && g->objects[g->owners[triangle]].smooth ? -1 : 0;
        }
        plane->nx[l] = n.x;
        plane->ny[l] = n.y;
        plane->nz[l] = n.z;
        smooth[l] = isSmooth;
    }
}

// One coordinate of a block: 0 where nothing is, because nothing was written there.
static void readPlane(const vplTile* tile, int plane, int element, const int triangles[VPL_LANES],
                      float valueOut[VPL_LANES])
{
    float value[VPL_LANES];
    memcpy(value, tile->planes[plane] + element, sizeof value);
    for (int l = 0; l < VPL_LANES; l++) {
        const float there = value[l];
        valueOut[l] = triangles[l] < 0 ? 0 : there;
    }
}

// False where it is empty.
static bool readBlock(const vplShading* s, const vplTile* tile, int element, Block* b)
{
    if (!vplReadTriangles(tile, element, b->points.triangle)) {
        b->same = true;
        return false;
    }
    readPlane(tile, VPL_PLANE_POSITION, element, b->points.triangle, b->surface.px);
    readPlane(tile, VPL_PLANE_POSITION + 1, element, b->points.triangle, b->surface.py);
    readPlane(tile, VPL_PLANE_POSITION + 2, element, b->points.triangle, b->surface.pz);
    b->points.surface = b->points.plane = &b->surface;
    b->same = vplSameTriangle(b->points.triangle);
    int32_t smooth[VPL_LANES];
    vplSurface* flat = s->smooth ? &b->plane : &b->surface;
    if (b->same) {
        const vplFacet facet = vplGetFacet(s, b->points.triangle[0]);
        const vplGeometry* g = s->geometry;
        vplSetNormals(facet.normal, flat);
        b->reflector = vplReflectorOf(s, &facet);
        memset(smooth, g->objects[g->owners[b->points.triangle[0]]].smooth ? 0xff : 0, sizeof smooth);
    } else {
        readFacets(s, b->points.triangle, flat, smooth);
    }
    if (!s->smooth) {
        return true;
    }
    b->points.plane = &b->plane;
    memcpy(&b->plane, &b->surface, 3 * sizeof b->surface.px);
    readPlane(tile, VPL_PLANE_NORMAL, element, b->points.triangle, b->surface.nx);
    readPlane(tile, VPL_PLANE_NORMAL + 1, element, b->points.triangle, b->surface.ny);
    readPlane(tile, VPL_PLANE_NORMAL + 2, element, b->points.triangle, b->surface.nz);
    vplFinishNormals(&b->plane, smooth, &b->surface);
    return true;
}

// ---- light

// Where the points of some blocks lie and where they face.
static vplBounds findBounds(const Block* blocks, const int* lit, int count)
{
    float low[6][VPL_LANES], high[6][VPL_LANES];
    for (int k = 0; k < 6; k++) {
        for (int l = 0; l < VPL_LANES; l++) {
            low[k][l] = INFINITY;
            high[k][l] = -INFINITY;
        }
    }
    for (int i = 0; i < count; i++) {
        const Block* b = &blocks[lit[i]];
        for (int k = 0; k < 6; k++) {
            const float* value = b->surface.px + k * VPL_LANES;
            for (int l = 0; l < VPL_LANES; l++) {
                const float v = value[l];
                const float least = v < low[k][l] ? v : low[k][l], most = v > high[k][l] ? v : high[k][l];
                low[k][l] = b->points.triangle[l] < 0 ? low[k][l] : least;
                high[k][l] = b->points.triangle[l] < 0 ? high[k][l] : most;
            }
        }
    }
    vplBounds bounds;
    for (int k = 0; k < 6; k++) {
        bounds.low[k] = low[k][0];
        bounds.high[k] = high[k][0];
        for (int l = 1; l < VPL_LANES; l++) {
            bounds.low[k] = low[k][l] < bounds.low[k] ? low[k][l] : bounds.low[k];
            bounds.high[k] = high[k][l] > bounds.high[k] ? high[k][l] : bounds.high[k];
        }
    }
    return bounds;
}

static void startSums(Block* b, float part[3][VPL_LANES])
{
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            b->sums[c][l] = (double)part[c][l];
        }
    }
}

static void addGroup(Block* b, float part[3][VPL_LANES])
{
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            b->sums[c][l] += (double)part[c][l];
        }
    }
}

// Virtual lights first .. first + count - 1, without those that face away from all blocks or the other way round.
static void addLights(const vplShading* s, Block* blocks, const int* lit, int litCount,
                      const vplBounds* bounds, int first, int count)
{
    int32_t keep[VPL_LIGHT_GROUP];
    vplShadeLight kept[VPL_LIGHT_GROUP];
    int keptCount = 0;
    s->cull(bounds, s->columns, first, count, keep);
    for (int i = 0; i < count; i++) {
        kept[keptCount] = s->def->lights[first + i];
        keptCount += keep[i];
    }
    for (int i = 0; keptCount > 0 && i < litCount; i++) {
        _Alignas(64) float part[3][VPL_LANES] = {{0}};
        s->lightKernel(&blocks[lit[i]].surface, kept, keptCount, s->inverseBound, part);
        addGroup(&blocks[lit[i]], part);
    }
}

static void addShadowedLights(const vplShading* s, Block* b, int first, int count, int64_t* rays)
{
    _Alignas(64) float part[3][VPL_LANES] = {{0}};
    vplIndirectIrradiance(s, &b->points, first, count, part, rays);
    addGroup(b, part);
}

// Block i of a square.
static inline int blockOf(int firstBlock, int i)
{
    return firstBlock + i / SQUARE * VPL_TILE_BLOCKS + i % SQUARE;
}

static void lightSquare(const vplShading* s, vplTile* tile, int firstBlock, Block blocks[SQUARE_BLOCKS])
{
    vplTileSums* tileSums = tile->scratch;
    int lit[SQUARE_BLOCKS], litCount = 0;
    for (int i = 0; i < SQUARE_BLOCKS; i++) {
        Block* b = &blocks[i];
        if (readBlock(s, tile, blockOf(firstBlock, i) * VPL_LANES, b)) {
            _Alignas(64) float part[3][VPL_LANES];
            vplDirectIrradiance(s, &b->points, part, &tileSums->shadowRays);
            startSums(b, part);
            lit[litCount++] = i;
        }
    }
    const int lightCount = s->def->lightCount;
    const bool culls = lightCount > 0 && litCount > 0 && s->columns[0] != NULL;
    vplBounds bounds = {{0}, {0}};
    if (culls) {
        bounds = findBounds(blocks, lit, litCount);
    }
    for (int first = 0; first < lightCount; first += VPL_LIGHT_GROUP) {
        const int count = lightCount - first < VPL_LIGHT_GROUP ? lightCount - first : VPL_LIGHT_GROUP;
        if (culls) {
            addLights(s, blocks, lit, litCount, &bounds, first, count);
            continue;
        }
        for (int i = 0; i < litCount; i++) {
            addShadowedLights(s, &blocks[lit[i]], first, count, &tileSums->shadowRays);
        }
    }
}

static void writeSquare(const vplShading* s, const vplTile* tile, int firstBlock, Block blocks[SQUARE_BLOCKS])
{
    for (int i = 0; i < SQUARE_BLOCKS; i++) {
        Block* b = &blocks[i];
        float radiance[3][VPL_LANES] = {{0}};
        if (b->same && b->points.triangle[0] < 0) {
            vplWriteBlock(s, tile, blockOf(firstBlock, i), radiance);
            continue;
        }
        if (b->same) {
            vplResolveSame(&b->reflector, b->sums, radiance);
        } else {
            vplResolveMixed(s, b->points.triangle, b->sums, radiance);
        }
        vplWriteBlock(s, tile, blockOf(firstBlock, i), radiance);
    }
}

void VPL_KERNEL(vplLightTile)(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    const vplTileSums* tileSums = tile->scratch;
    Block blocks[SQUARE_BLOCKS];
    for (int square = 0; square < SQUARES * SQUARES; square++) {
        const int x = square % SQUARES, y = square / SQUARES;
        if (x * SQUARE * VPL_BLOCK_SIDE < tile->width && y * SQUARE * VPL_BLOCK_SIDE < tile->height) {
            const int firstBlock = (y * VPL_TILE_BLOCKS + x) * SQUARE;
            lightSquare(s, tile, firstBlock, blocks);
            writeSquare(s, tile, firstBlock, blocks);
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
    for (int block = 0; block < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; block++) {
        Block b;
        float values[3][VPL_LANES] = {{0}}, factor[VPL_LANES] = {0};
        if (!readBlock(s, tile, block * VPL_LANES, &b)) {
            vplWriteBlock(s, tile, block, values);
            continue;
        }
        if (s->def->output == VPL_OUTPUT_SHADOW_FACTOR) {
            vplShadow_FactorBlock(&s->def->shadows[0], b.points.plane, factor);
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
