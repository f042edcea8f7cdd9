// SPDX-License-Identifier: MIT
// Based on: Walter, Fernandez, Arbree, Bala, Donikian and Greenberg, Lightcuts: A Scalable Approach to Illumination,
// SIGGRAPH 2005, section 4. Departs: one cut for the 16 points of a block, whose rays go in one packet: a cluster is
// refined where any of them asks for it.
#include "base/isa.h"
#include "shading/gbuffer.h"
#include "shading/lightcuts.h"

#include <stdlib.h>
extern double KB, KZ;

vplCutFcn VPL_KERNEL(vplAddCut);
vplTileFcn VPL_KERNEL(vplCutTile);

// What the steps of one cut share.
typedef struct Work {
    const vplShading* shading;
    const vplPoints* points;
    const vplRayStarts* starts; // NULL: no rays
    const float* besides;
    vplCut* cut;
    int64_t* rays;
    double sums[3][VPL_LANES];   // of lights that were reached
    double totals[VPL_LANES];    // estimate of all light, r + g + b
    float inverse[VPL_LANES];    // 1 / the error that may be left in a cluster
    float inverseSum[VPL_LANES]; // 1 / the variance that may be left
} Work;

// ---- the heap

static void sink(vplCut* cut, int i)
{
    const float key = cut->keys[i];
    const int place = cut->places[i];
    while (2 * i + 1 < cut->count) {
        int child = 2 * i + 1;
        child += child + 1 < cut->count && cut->keys[child + 1] > cut->keys[child];
        if (!(cut->keys[child] > key)) {
            break;
        }
        cut->keys[i] = cut->keys[child];
        cut->places[i] = cut->places[child];
        i = child;
    }
    cut->keys[i] = key;
    cut->places[i] = place;
}

static void rise(vplCut* cut, int i)
{
    const float key = cut->keys[i];
    const int place = cut->places[i];
    while (i > 0 && key > cut->keys[(i - 1) / 2]) {
        cut->keys[i] = cut->keys[(i - 1) / 2];
        cut->places[i] = cut->places[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    cut->keys[i] = key;
    cut->places[i] = place;
}

// ---- clusters

// What light `i` of the tree, of intensity 1, gives to the lanes, shadows included.
static void evaluate(Work* w, int i, float gives[VPL_LANES])
{
    const vplShading* s = w->shading;
    const vplTreeLight* from = &s->lightcuts->tree->lights[i];
    vplShadeLight light = from->light;
    light.r = light.g = light.b = 1;
    float part[3][VPL_LANES], visible[VPL_LANES];
    const vplShadow* map = s->def->lightShadows ? &s->def->lightShadows[from->index] : NULL;
    w->cut->evaluations++;
    if (!vplLightVisibly(s, w->points, w->starts, map, &light, s->inverseBound, part, visible, w->rays)) {
        memset(gives, 0, VPL_LANES * sizeof *gives);
        return;
    }
    for (int l = 0; l < VPL_LANES; l++) {
        gives[l] = visible[l] * part[0][l];
    }
}

static void addTotals(Work* w, float intensity, const float gives[VPL_LANES])
{
    for (int l = 0; l < VPL_LANES; l++) {
        w->totals[l] += (double)intensity * (double)gives[l];
    }
}

static void addSums(double sums[3][VPL_LANES], const float rgb[3], const float gives[VPL_LANES])
{
    for (int c = 0; c < 3; c++) {
        const double colour = (double)rgb[c];
        for (int l = 0; l < VPL_LANES; l++) {
            sums[c][l] += colour * (double)gives[l];
        }
    }
}

// One light, exactly.
static void addLight(Work* w, int i, const float gives[VPL_LANES])
{
    const vplShadeLight* light = &w->shading->lightcuts->tree->lights[i].light;
    const float rgb[3] = {light->r, light->g, light->b};
    addSums(w->sums, rgb, gives);
    addTotals(w, light->r + light->g + light->b, gives);
}

static float keyOf(const Work* w, const vplCutEntry* e)
{
    float key[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const float a = e->bound[l] * w->inverse[l], b = e->spread[l] * w->inverseSum[l];
        key[l] = a > b ? a : b;
    }
    float largest = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        largest = key[l] > largest ? key[l] : largest;
    }
    return largest;
}

// Puts a cluster into the cut, or where it is one light, into the sums.
static void place(Work* w, vplCluster cluster, const float gives[VPL_LANES], const float spread[VPL_LANES])
{
    if (cluster.count == 1) {
        addLight(w, cluster.first, gives);
        return;
    }
    const vplShading* s = w->shading;
    const vplLightNode* node = &s->lightcuts->tree->nodes[cluster.node];
    const int at = w->cut->places[w->cut->count];
    vplCutEntry* e = &w->cut->entries[at];
    e->cluster = cluster;
    memcpy(e->gives, gives, sizeof e->gives);
    s->clusterBound(w->points->surface, node, s->inverseBound, e->bound);
    for (int l = 0; l < VPL_LANES; l++) {
        e->bound[l] *= node->intensity;
        e->spread[l] = spread[l] * node->intensity * node->intensity;
    }
    addTotals(w, node->intensity, gives);
    w->cut->keys[w->cut->count] = keyOf(w, e);
    rise(w->cut, w->cut->count++);
}

// Takes the worst cluster out of the heap; its entry is the next that will be used.
static vplCutEntry* pop(vplCut* cut)
{
    const int place = cut->places[0];
    cut->count--;
    cut->keys[0] = cut->keys[cut->count];
    cut->places[0] = cut->places[cut->count];
    cut->places[cut->count] = place;
    sink(cut, 0);
    return &cut->entries[place];
}

static void sumUp(Work* w, vplCluster cluster)
{
    for (int i = cluster.first; i < cluster.first + cluster.count; i++) {
        float gives[VPL_LANES];
        evaluate(w, i, gives);
        addLight(w, i, gives);
    }
}

// One half keeps the representative, and with it what is known of it.
static void split(Work* w)
{
    const vplLightTree* tree = w->shading->lightcuts->tree;
    const vplCutEntry e = *pop(w->cut);
    const vplLightNode* node = &tree->nodes[e.cluster.node];
    addTotals(w, -node->intensity, e.gives);
    if (w->cut->count + 2 > VPL_CUT_CAPACITY) {
        sumUp(w, e.cluster);
        return;
    }
    vplCluster halves[2];
    vplLightTree_Halves(tree, e.cluster, halves);
    const int kept = node->representative < halves[1].first ? 0 : 1;
    float gives[2][VPL_LANES], spread[VPL_LANES];
    memcpy(gives[kept], e.gives, sizeof gives[kept]);
    evaluate(w, vplLightTree_Representative(tree, halves[1 - kept]), gives[1 - kept]);
    for (int l = 0; l < VPL_LANES; l++) {
        const float d = gives[0][l] - gives[1][l];
        spread[l] = 0.5f * d * d;
    }
    place(w, halves[0], gives[0], spread);
    place(w, halves[1], gives[1], spread);
}

// ---- the cut

// Totals from the start, without the rounding of what came and went, and with them keys and heap.
static void renew(Work* w)
{
    const vplShading* s = w->shading;
    vplCut* cut = w->cut;
    double variance[VPL_LANES] = {0};
    for (int l = 0; l < VPL_LANES; l++) {
        w->totals[l] = (double)w->besides[l] + (w->sums[0][l] + w->sums[1][l] + w->sums[2][l]);
    }
    for (int i = 0; i < cut->count; i++) {
        const vplCutEntry* e = &cut->entries[cut->places[i]];
        addTotals(w, s->lightcuts->tree->nodes[e->cluster.node].intensity, e->gives);
        for (int l = 0; l < VPL_LANES; l++) {
            variance[l] += (double)e->spread[l];
        }
    }
    for (int l = 0; l < VPL_LANES; l++) {
        const double most = w->points->triangle[l] < 0 ? INFINITY : s->def->cutError * w->totals[l];
        w->inverse[l] = (float)(1 / (most * KB > 1e-30 ? most * KB : 1e-30));
        const double allowed = most * most / (KZ * KZ);
        w->inverseSum[l] =
            variance[l] > allowed ? (float)(2 * cut->count / (allowed > 1e-35 ? allowed : 1e-35)) : 0;
    }
    for (int i = 0; i < cut->count; i++) {
        cut->keys[i] = keyOf(w, &cut->entries[cut->places[i]]);
    }
    for (int i = cut->count / 2 - 1; i >= 0; i--) {
        sink(cut, i);
    }
}

static void refine(Work* w)
{
    vplCut* cut = w->cut;
    int next = 16;
    while (cut->count > 0) {
        if (!(cut->keys[0] > 1) || cut->count >= next) {
            renew(w);
            next = cut->count + cut->count / 4 + 8;
            if (!(cut->keys[0] > 1)) {
                return;
            }
        }
        split(w);
    }
}

void VPL_KERNEL(vplAddCut)(const vplShading* s, const vplPoints* points,
                           const float besides[restrict VPL_LANES], double sums[restrict 3][VPL_LANES],
                           int64_t* rays)
{
    const vplLightTree* tree = s->lightcuts->tree;
    vplRayStarts starts;
    const bool casts = s->def->lightShadows == NULL && s->def->lightRays;
    if (casts) {
        vplFindRayStarts(s, points, &starts);
    }
    Work w = {
        .shading = s, .points = points, .starts = casts ? &starts : NULL, .besides = besides, .rays = rays};
    w.cut = vplTakeCut(s->lightcuts);
    w.cut->count = w.cut->evaluations = 0;
    const vplCluster root = vplLightTree_Root(tree);
    float gives[VPL_LANES];
    const float none[VPL_LANES] = {0};
    evaluate(&w, vplLightTree_Representative(tree, root), gives);
    place(&w, root, gives, none);
    refine(&w);
    for (int i = 0; i < w.cut->count; i++) {
        const vplCutEntry* e = &w.cut->entries[w.cut->places[i]];
        addSums(w.sums, tree->nodes[e->cluster.node].rgb, e->gives);
    }
    int pixels = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        pixels += points->triangle[l] >= 0;
    }
    vplReturnCut(s->lightcuts, w.cut, pixels);
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            sums[c][l] += w.sums[c][l];
        }
    }
}

void VPL_KERNEL(vplCutTile)(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    vplTileSums* tileSums = tile->scratch;
    vplSeen seen = {.triangle = -1};
    for (int block = 0; block < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; block++) {
        const int x = block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE, y = block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE;
        if (x >= tile->width || y >= tile->height) {
            continue;
        }
        vplBlock b;
        if (vplReadBlock(s, tile, block * VPL_LANES, &seen, &b)) {
            _Alignas(64) float part[3][VPL_LANES], besides[VPL_LANES];
            vplDirectIrradiance(s, &b.points, part, &tileSums->shadowRays);
            vplStartSums(&b, part);
            for (int l = 0; l < VPL_LANES; l++) {
                besides[l] = part[0][l] + part[1][l] + part[2][l];
            }
            s->addCut(s, &b.points, besides, b.sums, &tileSums->shadowRays);
        }
        vplWriteLit(s, tile, block, &b);
    }
    __atomic_fetch_add(s->shadowRays, tileSums->shadowRays, __ATOMIC_RELAXED);
}
