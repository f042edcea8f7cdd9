// SPDX-License-Identifier: MIT
// Lightcuts: lights each block by a cut through the light tree.
// Based on: Walter, Fernandez, Arbree, Bala, Donikian and Greenberg, Lightcuts: A Scalable Approach to
// Illumination, SIGGRAPH 2005, section 4. Departs: one cut for the 16 points of a block, whose rays form one
// packet; a cluster is split if its error is too large at any of them.
#include "base/isa.h"
#include "shading/edges.h"
#include "shading/lightcuts.h"

// Largest error of a cluster, as a share of the error that is allowed for a pixel. The errors of clusters
// have the mean 0 and mostly cancel: with 1, as in the paper, the largest pixel error is 3.7 times the
// allowed one, with 1/8 0.95 times (bench/lightcuts).
static const double SHARE = 1.0 / 8;
// Errors are relative to a pixel's light, or to this share of its unshadowed light if that is more: a pixel
// in full shadow would evaluate every light to know it. With 1/16 the largest cut of a million lights in the
// room is 10,733 lights, with 1/32 124,833 (bench/lightcuts).
static const double DARK = 1.0 / 16;

// State of one cut.
typedef struct Work {
    const vplShading* shading;
    const vplLightTree* tree;
    vplReceiver receiver;
    vplCut* cut;
    float otherLight[VPL_LANES]; // direct light, r + g + b
    double sums[3][VPL_LANES];   // of lights that are in the cut themselves
    double open[VPL_LANES];      // the same if nothing were between, r + g + b
    float inverse[VPL_LANES];    // 1 / error that a cluster may have
} Work;

// ---- the heap

static void siftDown(vplCut* cut, int i)
{
    const float key = cut->keys[i];
    const int index = cut->indices[i];
    while (2 * i + 1 < cut->count) {
        int child = 2 * i + 1;
        child += child + 1 < cut->count && cut->keys[child + 1] > cut->keys[child];
        if (!(cut->keys[child] > key)) {
            break;
        }
        cut->keys[i] = cut->keys[child];
        cut->indices[i] = cut->indices[child];
        i = child;
    }
    cut->keys[i] = key;
    cut->indices[i] = index;
}

static void siftUp(vplCut* cut, int i)
{
    const float key = cut->keys[i];
    const int index = cut->indices[i];
    while (i > 0 && key > cut->keys[(i - 1) / 2]) {
        cut->keys[i] = cut->keys[(i - 1) / 2];
        cut->indices[i] = cut->indices[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    cut->keys[i] = key;
    cut->indices[i] = index;
}

// ---- clusters

// Contribution of a light of intensity 1, with and without visibility.
typedef struct Contribution {
    float visible[VPL_LANES], open[VPL_LANES];
} Contribution;

static void evaluate(Work* w, int i, Contribution* out)
{
    const vplLightList* list = &w->shading->lights;
    const vplTreeLight* from = &w->tree->lights[i];
    vplShadeLight light = from->light;
    light.r = light.g = light.b = 1;
    const vplHemiMap* map = list->maps ? &list->maps[from->index] : NULL;
    vplReceived received;
    w->cut->evaluations++;
    if (!vplReceiveLight(&w->receiver, &light, map, list->inverseClamp, &received)) {
        memset(out, 0, sizeof *out);
        return;
    }
    for (int l = 0; l < VPL_LANES; l++) {
        out->visible[l] = received.visible[l] * received.open[0][l];
        out->open[l] = received.open[0][l];
    }
}

static void addScaled(double sums[VPL_LANES], float scale, const float values[VPL_LANES])
{
    for (int l = 0; l < VPL_LANES; l++) {
        sums[l] += (double)scale * (double)values[l];
    }
}

// One light, exactly.
static void addLight(Work* w, int i, const Contribution* from)
{
    const vplShadeLight* light = &w->tree->lights[i].light;
    addScaled(w->sums[0], light->r, from->visible);
    addScaled(w->sums[1], light->g, from->visible);
    addScaled(w->sums[2], light->b, from->visible);
    addScaled(w->open, light->r + light->g + light->b, from->open);
}

static float keyOf(const Work* w, const vplCutEntry* e)
{
    float largest = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const float key = e->bound[l] * w->inverse[l];
        largest = key > largest ? key : largest;
    }
    return largest;
}

// Puts a cluster into the cut, or a cluster of one light into the sums.
static void insert(Work* w, vplCluster cluster, const Contribution* from)
{
    if (cluster.count == 1) {
        addLight(w, cluster.first, from);
        return;
    }
    const vplShading* s = w->shading;
    const vplLightNode* node = &w->tree->nodes[cluster.node];
    vplCut* cut = w->cut;
    vplCutEntry* e = &cut->entries[cut->indices[cut->count]];
    e->cluster = cluster;
    memcpy(e->visible, from->visible, sizeof e->visible);
    memcpy(e->open, from->open, sizeof e->open);
    s->kernels.clusterBound(w->receiver.points->surface, node, s->lights.inverseClamp, e->bound);
    for (int l = 0; l < VPL_LANES; l++) {
        e->bound[l] *= node->intensity;
    }
    cut->keys[cut->count] = keyOf(w, e);
    siftUp(cut, cut->count++);
}

// Takes the worst cluster out of the heap. Its entry is the next to be reused.
static vplCutEntry* pop(vplCut* cut)
{
    const int index = cut->indices[0];
    cut->count--;
    cut->keys[0] = cut->keys[cut->count];
    cut->indices[0] = cut->indices[cut->count];
    cut->indices[cut->count] = index;
    siftDown(cut, 0);
    return &cut->entries[index];
}

static void sumUp(Work* w, vplCluster cluster)
{
    for (int i = cluster.first; i < cluster.first + cluster.count; i++) {
        Contribution one;
        evaluate(w, i, &one);
        addLight(w, i, &one);
    }
}

// Splits the worst cluster. One half keeps the representative and its contribution.
static void split(Work* w)
{
    const vplLightTree* tree = w->tree;
    const vplCutEntry* e = pop(w->cut);
    const vplCluster cluster = e->cluster;
    if (w->cut->count + 2 > VPL_CUT_CAPACITY) {
        sumUp(w, cluster);
        return;
    }
    vplCluster halves[2];
    vplLightTree_Halves(tree, cluster, halves);
    const int kept = tree->nodes[cluster.node].representative < halves[1].first ? 0 : 1;
    Contribution of[2];
    memcpy(of[kept].visible, e->visible, sizeof e->visible);
    memcpy(of[kept].open, e->open, sizeof e->open);
    evaluate(w, vplLightTree_Representative(tree, halves[1 - kept]), &of[1 - kept]);
    insert(w, halves[0], &of[0]);
    insert(w, halves[1], &of[1]);
}

// ---- the cut

// Sums the cut, from which follow the allowed error, the keys and the heap.
static void updateErrors(Work* w)
{
    vplCut* cut = w->cut;
    double totals[VPL_LANES], open[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        totals[l] = (double)w->otherLight[l] + (w->sums[0][l] + w->sums[1][l] + w->sums[2][l]);
        open[l] = (double)w->otherLight[l] + w->open[l];
    }
    for (int i = 0; i < cut->count; i++) {
        const vplCutEntry* e = &cut->entries[cut->indices[i]];
        const float intensity = w->tree->nodes[e->cluster.node].intensity;
        addScaled(totals, intensity, e->visible);
        addScaled(open, intensity, e->open);
    }
    const double share = (double)w->shading->def->cutError * SHARE;
    for (int l = 0; l < VPL_LANES; l++) {
        const double dark = DARK * open[l], of = totals[l] > dark ? totals[l] : dark;
        const double inverse = 1 / (share * of);
        w->inverse[l] = w->receiver.points->triangle[l] < 0 ? 0 : inverse < 1e37 ? (float)inverse : 1e37f;
    }
    for (int i = 0; i < cut->count; i++) {
        cut->keys[i] = keyOf(w, &cut->entries[cut->indices[i]]);
    }
    for (int i = cut->count / 2 - 1; i >= 0; i--) {
        siftDown(cut, i);
    }
}

static void refine(Work* w)
{
    vplCut* cut = w->cut;
    int next = 16;
    while (cut->count > 0) {
        if (!(cut->keys[0] > 1) || cut->count >= next) {
            updateErrors(w);
            next = cut->count + cut->count / 4 + 8;
            if (!(cut->keys[0] > 1)) {
                return;
            }
        }
        split(w);
    }
}

static void refineFromRoot(Work* w)
{
    const vplCluster root = vplLightTree_Root(w->tree);
    Contribution one;
    w->cut->count = w->cut->evaluations = 0;
    evaluate(w, vplLightTree_Representative(w->tree, root), &one);
    insert(w, root, &one);
    refine(w);
    for (int i = 0; i < w->cut->count; i++) {
        const vplCutEntry* e = &w->cut->entries[w->cut->indices[i]];
        for (int c = 0; c < 3; c++) {
            addScaled(w->sums[c], w->tree->nodes[e->cluster.node].rgb[c], e->visible);
        }
    }
}

// Adds the light of all clusters to a block whose sums hold its other light, to which errors are relative,
// too.
static void addCut(const vplShading* s, void* user, vplBlock* b, int64_t* rays)
{
    vplCutWorker* worker = user;
    const vplPoints* points = &b->points;
    const vplLightcuts* lightcuts = s->state;
    vplRayStarts starts;
    if (s->lights.castsRays) {
        vplFindRayStarts(s, points, &starts);
    }
    Work w = {.shading = s,
              .tree = lightcuts->tree,
              .receiver = {s, points, s->lights.castsRays ? &starts : NULL, rays},
              .cut = &worker->cut};
    for (int l = 0; l < VPL_LANES; l++) {
        w.otherLight[l] = (float)(b->sums[0][l] + b->sums[1][l] + b->sums[2][l]);
    }
    refineFromRoot(&w);
    for (int l = 0; l < VPL_LANES; l++) {
        const bool shown = points->triangle[l] >= 0;
        worker->pixels += shown;
        worker->evaluations += shown ? w.cut->evaluations : 0;
    }
    worker->largest = w.cut->evaluations > worker->largest ? w.cut->evaluations : worker->largest;
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            b->sums[c][l] += w.sums[c][l];
        }
    }
}

void VPL_KERNEL(vplCutTile)(void* data, vplTile* tile, int worker)
{
    const vplShading* s = data;
    vplTileSums* tileSums = tile->scratch;
    const vplLightcuts* lightcuts = s->state;
    vplFacetCache cache;
    vplFacetCache_Clear(&cache);
    for (int block = 0; block < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; block++) {
        const int x = block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE, y = block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE;
        if (x >= tile->width || y >= tile->height) {
            continue;
        }
        if (block % VPL_TILE_BLOCKS == 0 && !vplTask_GoesOn(s->geometry->context)) {
            return;
        }
        vplBlock b;
        if (vplReadBlock(s, tile, block * VPL_LANES, &cache, &b)) {
            vplStartLight(s, tile, block, &b);
            addCut(s, &lightcuts->workers[worker], &b, &tileSums->shadowRays);
        }
        vplWriteLit(s, tile, block, &cache, &b);
    }
    vplSmoothTile(s, tile, &cache, addCut, &lightcuts->workers[worker]);
    __atomic_fetch_add(s->shadowRays, tileSums->shadowRays, __ATOMIC_RELAXED);
}
