// SPDX-License-Identifier: MIT
// The filter for surfaces at edges that are not in the centres of their pixels. Their indirect light is the
// mean over the pixels around that show the same surface, with the weights of the filter. Where no pixel
// shows it, the lights of some classes are added.
#ifndef VPL_SHADING_INTERLEAVE_FILTER_EDGES_H
#define VPL_SHADING_INTERLEAVE_FILTER_EDGES_H

#include "shading/accumulate.h"
#include "shading/edges.h"
#include "shading/interleave_filter_mixed.h"

// The least number of lights that light a surface which no pixel around shows.
enum { LONE_LIGHTS = 64 };

// Adds the lights of some classes to a block, weighted as if they were all; a vplAddToBlockFcn. `user` points
// to the number of the class that is next.
static inline void vplAddSomeClasses(const vplShading* s, void* user, vplBlock* b, int64_t* rays)
{
    static const int lit = 0;
    const vplInterleave* w = s->state;
    const int classes = w->side * w->side;
    int *turn = user, lights = 0, used = 0;
    double before[3][VPL_LANES];
    vplLitBlocks to = {.blocks = b, .lit = &lit, .count = 1, .culls = s->lights.columns[0] != NULL};
    if (to.culls) {
        to.bounds = vplFindBounds(b, &lit, 1);
    }
    memcpy(before, b->sums, sizeof before);
    memset(b->sums, 0, sizeof b->sums);
    for (; used < classes && lights < LONE_LIGHTS; used++) {
        const int class = *turn % classes, first = w->classStart[class];
        *turn = class + 1;
        vplAddLights(s, &to, first, w->classStart[class + 1] - first, rays);
        lights += w->classStart[class + 1] - first;
    }
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            b->sums[c][l] = before[c][l] + b->sums[c][l] * classes / used;
        }
    }
}

// Surfaces kept by the tile of a part.
typedef struct KeptEdges {
    const vplKeptEdge* edges;
    int count;
} KeptEdges;

static inline KeptEdges edgesOf(const vplInterleave* w, const Part* part)
{
    if (w->edges == NULL) {
        return (KeptEdges){NULL, 0};
    }
    const int tile = part->y / VPL_TILE_SIDE * w->rasterTilesX + part->x / VPL_TILE_SIDE;
    return (KeptEdges){w->edges + (size_t)tile * (size_t)w->mostEdges, w->edgeCounts[tile]};
}

static inline bool isInPart(const Part* part, const vplKeptEdge* e)
{
    return e->y >= part->y && e->y < part->y + part->height;
}

// The mean indirect irradiance around an edge. Returns false where no pixel shows its surface.
static inline bool meanAroundEdge(const vplShading* s, vplFilterScratch* scratch, const Part* part,
                                  const vplKeptEdge* e, float mean[3])
{
    const vplInterleave* w = s->state;
    const vplView* v = s->view;
    const int side = w->side, x = e->x - part->x, y = e->y - part->y;
    const vplFacet facet = *vplFacetCache_Get(s, e->surface.triangle, &scratch->facets);
    const vplVec3 n = facet.normal,
                  sight = vplSightOf(v, e->x, e->y, vplSubPixel_OfSample(e->surface.sample, s->samples));
    const float slack = MAX_DISTANCE * vplEdgeDistance(s, e->surface.triangle, &facet, sight);
    const float forward = vplDot(n, v->forward), up = vplDot(n, v->up), right = vplDot(n, v->right);
    float sum[3] = {0, 0, 0}, weights = 0;
    for (int i = 0; i < tapsOf(side); i++) {
        const int row = y + i;
        for (int k = 0; k < tapsOf(side); k++) {
            const int at = x + k;
            const float cosine = n.x * scratch->normal[0][row][at] + n.y * scratch->normal[1][row][at] +
                                 n.z * scratch->normal[2][row][at];
            const float ahead = forward + scratch->up[row] * up + scratch->right[at] * right;
            const float above = fabsf(scratch->distance[row][at] * ahead - facet.offset);
            const float weight =
                cosine >= MIN_NORMALS && above <= slack ? weightOf(side, i) * weightOf(side, k) : 0;
            weights += weight;
            for (int c = 0; c < 3; c++) {
                sum[c] += weight * scratch->indirect[c][row][at];
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        mean[c] = weights > 0 ? sum[c] / weights : 0;
    }
    return weights > 0;
}

static inline void filterEdges(const vplShading* s, vplFilterScratch* scratch, const Part* part,
                               KeptEdges kept)
{
    int64_t rays = 0;
    int turn = part->y; // of the classes
    vplEdgeQueue lone = {s, &scratch->facets, vplAddSomeClasses, &turn, &rays, .indirect = true};
    for (int i = 0; i < kept.count; i++) {
        const vplKeptEdge* e = &kept.edges[i];
        float mean[3];
        if (!isInPart(part, e)) {
            continue;
        }
        if (!meanAroundEdge(s, scratch, part, e, mean)) {
            vplEdgeQueue_Push(&lone, &e->surface, e->x, e->y);
            continue;
        }
        const vplReflector* r = &vplFacetCache_Get(s, e->surface.triangle, &scratch->facets)->reflector;
        float* pixel = s->image->pixels + 3 * ((size_t)e->y * (size_t)s->image->width + e->x);
        double factor[3];
        vplFactorInPixel(s, r, e->surface.triangle, e->x, e->y, factor);
        for (int c = 0; c < 3; c++) {
            pixel[c] += e->surface.share * (float)factor[c] * mean[c];
        }
    }
    vplEdgeQueue_Flush(&lone);
    __atomic_fetch_add(s->shadowRays, rays, __ATOMIC_RELAXED);
}

#endif
