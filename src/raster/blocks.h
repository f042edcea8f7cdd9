// SPDX-License-Identifier: MIT
// Draws one block of a triangle: depth, owner, planes. Included by the tile kernel only.
#ifndef VPL_RASTER_BLOCKS_H
#define VPL_RASTER_BLOCKS_H

#include "raster/coverage.h"
#include "raster/shaders.h"
#include "raster/barycentrics.h"
#include "raster/tiny.h"

#include <math.h>

typedef struct Draw {
    vplTileState* state;
    const vplRaster* raster;
    const vplPipeline* pipeline;
    const vplShaded* shaded;
    const Batch* batch;
    int place, owner;           // the triangle's place in its batch and its name in state->owner
    Barycentrics* barycentrics; // the triangle's, where hasBarycentrics
    float leastDepth;           // 0, or -1 where depth is reversed
    float texel;                // width of a pixel of a view of 90 by 90 degrees, at distance 1
    bool hasBarycentrics;
    bool keep;      // stores blocks for the passes
    bool depthOnly; // nothing but depth is written, where it is less
    bool distances; // depth is a distance
    bool names;     // owners are numbers among all meshes' triangles, not refs
    bool rejects;   // hidden blocks are skipped,
    bool tightens;  // and bounds of depths lowered
} Draw;

// -1 where a depth passes the test against the one that is there.
static inline int32_t passes(vplDepthCompare compare, float depth, float old)
{
    switch (compare) {
    case VPL_DEPTH_LESS:
        return depth < old ? -1 : 0;
    case VPL_DEPTH_LESS_EQUAL:
        return depth <= old ? -1 : 0;
    case VPL_DEPTH_EQUAL:
        return depth == old ? -1 : 0;
    case VPL_DEPTH_ALWAYS:
        break;
    }
    return -1;
}

// Leaves the lanes covered that pass the owner and depth tests. Returns 0 if there are none. Callers pass a
// constant `compare`, so that each test is a loop without branches.
static inline int32_t testLanes(vplTileState* state, vplDepthCompare compare, bool ownerTest, int owner,
                                int at)
{
    vplFragments* f = &state->block;
    int32_t covered[VPL_LANES], owners[VPL_LANES], any = 0;
    float depth[VPL_LANES], old[VPL_LANES];
    memcpy(covered, f->covered, sizeof covered);
    memcpy(depth, f->depth, sizeof depth);
    memcpy(old, state->depth + at, sizeof old);
    if (ownerTest) {
        memcpy(owners, state->owner + at, sizeof owners);
        for (int l = 0; l < VPL_LANES; l++) {
            covered[l] &= owners[l] == owner ? -1 : 0;
        }
    }
    for (int l = 0; l < VPL_LANES; l++) {
        covered[l] &= passes(compare, depth[l], old[l]);
        any |= covered[l];
    }
    memcpy(f->covered, covered, sizeof covered);
    return any;
}

static inline int32_t testFragments(vplTileState* state, const vplPipeline* p, int owner, int at)
{
    switch (p->depthCompare) {
    case VPL_DEPTH_LESS:
        return testLanes(state, VPL_DEPTH_LESS, p->ownerTest, owner, at);
    case VPL_DEPTH_LESS_EQUAL:
        return testLanes(state, VPL_DEPTH_LESS_EQUAL, p->ownerTest, owner, at);
    case VPL_DEPTH_EQUAL:
        return testLanes(state, VPL_DEPTH_EQUAL, p->ownerTest, owner, at);
    case VPL_DEPTH_ALWAYS:
        break;
    }
    return testLanes(state, VPL_DEPTH_ALWAYS, p->ownerTest, owner, at);
}

static inline void needBarycentrics(Draw* d)
{
    if (!d->hasBarycentrics) {
        setUpBarycentrics(d->raster, d->batch, d->place, d->shaded, d->barycentrics);
        d->hasBarycentrics = true;
    }
}

// Interpolates varyings and runs the surface shader.
static void makeSurface(Draw* d)
{
    vplFragments* f = &d->state->block;
    if (d->shaded->varyingCount > 0 || d->pipeline->needsW) {
        needBarycentrics(d);
        findW(d->barycentrics, f->x, f->y, f->w);
        interpolate(d->barycentrics, d->shaded->varyingCount, f->x, f->y, f);
    }
    if (d->pipeline->surface != NULL) {
        d->pipeline->surface(d->pipeline->vertexUniforms, f);
    }
}

static void keepBlock(vplTileState* state)
{
    const vplFragments* f = &state->block;
    vplKeptBlock* kept = (vplKeptBlock*)(state->kept + (size_t)state->keptCount++ * state->keptStride);
    float* to = (float*)(kept + 1);
    kept->x = f->x;
    kept->y = f->y;
    kept->element = f->element;
    kept->primitive = f->primitive;
    kept->count = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        kept->covered[l] = f->covered[l];
        kept->count -= f->covered[l];
    }
    memcpy(to, f->depth, sizeof f->depth);
    memcpy(to + VPL_LANES, f->w, sizeof f->w);
    memcpy(to + 2 * VPL_LANES, f->varying, (size_t)keptVaryings(state) * sizeof f->varying[0]);
}

// Counters of fragments by lane. Neighbouring blocks use different ones, so that no block waits for the one
// before.
static inline int32_t* countersOf(vplTileState* state, int at)
{
    return state->fragmentLanes[at / VPL_LANES % VPL_COUNTERS];
}

// Writes the owners for writeNearer, before the depths change.
static inline void writeNearerOwner(vplTileState* state, int owner, int at, const float drawn[VPL_LANES],
                                    bool filled)
{
    float depth[VPL_LANES];
    int32_t covered[VPL_LANES], owners[VPL_LANES];
    memcpy(depth, state->depth + at, sizeof depth);
    memcpy(covered, state->block.covered, sizeof covered);
    memcpy(owners, state->owner + at, sizeof owners);
    for (int l = 0; l < VPL_LANES; l++) {
        const int32_t kept = owners[l];
        const int32_t passed = (filled ? -1 : covered[l]) & (drawn[l] < depth[l] ? -1 : 0);
        owners[l] = passed ? owner : kept;
    }
    memcpy(state->owner + at, owners, sizeof owners);
}

// Ends draws that write depth only: keeps the nearer of two depths. `filled`: all lanes are covered. Lanes
// are copied first, so that the compiler knows that arrays do not overlap.
static inline void writeNearer(vplTileState* state, int owner, int at, const float drawn[VPL_LANES],
                               bool filled)
{
    int32_t* counts = countersOf(state, at);
    float depth[VPL_LANES];
    int32_t covered[VPL_LANES];
    if (state->owner != NULL) {
        writeNearerOwner(state, owner, at, drawn, filled);
    }
    memcpy(depth, state->depth + at, sizeof depth);
    memcpy(covered, state->block.covered, sizeof covered);
    for (int l = 0; l < VPL_LANES; l++) {
        const float v = drawn[l], kept = depth[l];
        const int32_t passed = (filled ? -1 : covered[l]) & (v < kept ? -1 : 0);
        depth[l] = passed ? v : kept;
        counts[l] -= passed;
    }
    memcpy(state->depth + at, depth, sizeof depth);
}

static inline void drawDepth(const Draw* d, const Setup* s, double z, int at, bool filled)
{
    float drawn[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        drawn[l] = clampDepth(z + s->laneZ[l], d->leastDepth);
    }
    writeNearer(d->state, d->owner, at, drawn, filled);
}

// Draws distances from the eye, or along the view axis. Based on: Franchi and Ferrante, Virtual Point Lights,
// "Rendering the Cube Shadow Map". Departs: w is turned into a distance by the texel's own direction.
static inline void drawDistance(const Draw* d, int x, int y, int at, bool filled)
{
    const bool alongAxis = d->pipeline->distanceAlongAxis;
    const float scale = d->pipeline->distanceScale, texel = d->texel;
    float drawn[VPL_LANES];
    x += d->state->tile.x;
    y += d->state->tile.y;
    findW(d->barycentrics, x, y, drawn);
    for (int l = 0; l < VPL_LANES && !alongAxis; l++) {
        const float s = ((float)x + (float)(l & 3) + 0.5f) * texel - 1;
        const float t = 1 - ((float)y + (float)(l >> 2) + 0.5f) * texel;
        drawn[l] *= sqrtf(1 + s * s + t * t);
    }
    for (int l = 0; l < VPL_LANES; l++) {
        drawn[l] *= scale;
    }
    writeNearer(d->state, d->owner, at, drawn, filled);
}

static inline void writeDepth(vplTileState* state, int owner, int at)
{
    const vplFragments* f = &state->block;
    float depth[VPL_LANES];
    memcpy(depth, state->depth + at, sizeof depth);
    for (int l = 0; l < VPL_LANES; l++) {
        const float drawn = f->depth[l], kept = depth[l];
        depth[l] = f->covered[l] ? drawn : kept;
    }
    memcpy(state->depth + at, depth, sizeof depth);
    if (state->owner != NULL) {
        int32_t owners[VPL_LANES];
        memcpy(owners, state->owner + at, sizeof owners);
        for (int l = 0; l < VPL_LANES; l++) {
            const int32_t kept = owners[l];
            owners[l] = f->covered[l] ? owner : kept;
        }
        memcpy(state->owner + at, owners, sizeof owners);
    }
}

// Writes depth, owners and planes of the lanes in f->covered, as the pipeline says.
static void drawFragments(Draw* d, const Setup* s, double z)
{
    vplTileState* state = d->state;
    const vplPipeline* p = d->pipeline;
    vplFragments* f = &state->block;
    const int at = f->element;
    if (p->writesDepth) {
        makeSurface(d);
        runFragmentShader(p, f, state->tile.planes, d->raster->framebuffer.planeCount);
    } else {
        for (int l = 0; l < VPL_LANES; l++) {
            f->depth[l] = clampDepth(z + s->laneZ[l], d->leastDepth);
        }
    }
    if (!testFragments(state, p, d->owner, at)) {
        return;
    }
    if (d->keep) {
        makeSurface(d);
        keepBlock(state);
        return;
    }
    int32_t* counts = countersOf(state, at);
    for (int l = 0; l < VPL_LANES; l++) {
        counts[l] -= f->covered[l];
    }
    if (p->depthWrite) {
        writeDepth(state, d->owner, at);
    }
    if (p->fragment != NULL) {
        if (!p->writesDepth) {
            makeSurface(d);
            runFragmentShader(p, f, state->tile.planes, d->raster->framebuffer.planeCount);
        }
        blendPlanes(p, f, state->tile.planes, d->raster->framebuffer.planeCount);
    }
}

// z: depth in lane 0. `edge`: edge functions in lane 0, or NULL: all lanes are inside the triangle and the
// picture.
static inline __attribute__((always_inline)) void drawBlock(Draw* d, const Setup* s, int x, int y, double z,
                                                            const int32_t edge[3])
{
    vplTileState* state = d->state;
    vplFragments* f = &state->block;
    const bool filled = edge == NULL;
    const int block = (y / VPL_BLOCK_SIDE) * VPL_TILE_BLOCKS + x / VPL_BLOCK_SIDE;
    if (!filled && !cover(&state->tile, s, edge, x, y, f->covered)) {
        return;
    }
    if (d->distances) {
        drawDistance(d, x, y, block * VPL_LANES, filled);
        return;
    }
    if (d->depthOnly) {
        drawDepth(d, s, z, block * VPL_LANES, filled);
        return;
    }
    if (filled) {
        memset(f->covered, 0xff, sizeof f->covered);
    }
    f->x = state->tile.x + x;
    f->y = state->tile.y + y;
    f->element = block * VPL_LANES;
    drawFragments(d, s, z);
}

#endif
