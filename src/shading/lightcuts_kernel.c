// SPDX-License-Identifier: MIT
// Based on: Walter, Fernandez, Arbree, Bala, Donikian and Greenberg, Lightcuts: A Scalable Approach to Illumination,
// SIGGRAPH 2005, section 4. Departs: one cut for the 16 points of a block, whose rays go in one packet: a cluster is
// refined where any of them asks for it.
#include "base/isa.h"
#include "shading/gbuffer.h"
#include "shading/lightcuts.h"

// A cluster may err by this share of the error that was asked for. The clusters' errors have the mean 0 and nearly
// cancel, but not quite: with a whole share, as in the paper, pixels are off by up to 3.7 times what was asked for, with
// a quarter by 1.35 times, with an eighth by 0.95 times (bench/lightcuts: room, room-area, sponza-sun; 1,000 to 100,000
// particles; largest of all pixels).
static const double SHARE = 1.0 / 8;
// Where nearly all lights are hidden, an error counts as a share of this part of what they would give if they were
// not: a pixel that no light reaches at all would need all of a million lights to know. With a sixteenth, the largest
// cut of a million in the room is 10,733 lights, with a thirty-second 124,833.
static const double DARK = 1.0 / 16;

vplTileFcn VPL_KERNEL(vplCutTile);

// What the steps of one cut share.
typedef struct Work {
    const vplShading* shading;
    const vplPoints* points;
    const vplRayStarts* starts; // NULL: no rays
    const float* besides;
    vplCut* cut;
    int64_t* rays;
    double sums[3][VPL_LANES]; // of lights that were reached
    double open[VPL_LANES];    // the same if nothing were between, r + g + b
    float inverse[VPL_LANES];  // 1 / the error that may be left in a cluster
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

// What a light of intensity 1 gives to the lanes, with and without what is between.
typedef struct Gift {
    float gives[VPL_LANES], open[VPL_LANES];
} Gift;

static void evaluate(Work* w, int i, Gift* gift)
{
    const vplShading* s = w->shading;
    const vplTreeLight* from = &s->lightcuts->tree->lights[i];
    vplShadeLight light = from->light;
    light.r = light.g = light.b = 1;
    float part[3][VPL_LANES], visible[VPL_LANES];
    const vplHemiMap* map = s->def->lightShadows ? &s->def->lightShadows[from->index] : NULL;
    w->cut->evaluations++;
    if (!vplLightVisibly(s, w->points, w->starts, map, &light, s->inverseBound, part, visible, w->rays)) {
        memset(gift, 0, sizeof *gift);
        return;
    }
    for (int l = 0; l < VPL_LANES; l++) {
        gift->gives[l] = visible[l] * part[0][l];
        gift->open[l] = part[0][l];
    }
}

static void addScaled(double sums[VPL_LANES], float scale, const float values[VPL_LANES])
{
    for (int l = 0; l < VPL_LANES; l++) {
        sums[l] += (double)scale * (double)values[l];
    }
}

// One light, exactly.
static void addLight(Work* w, int i, const Gift* gift)
{
    const vplShadeLight* light = &w->shading->lightcuts->tree->lights[i].light;
    addScaled(w->sums[0], light->r, gift->gives);
    addScaled(w->sums[1], light->g, gift->gives);
    addScaled(w->sums[2], light->b, gift->gives);
    addScaled(w->open, light->r + light->g + light->b, gift->open);
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

// Puts a cluster into the cut, or where it is one light, into the sums.
static void place(Work* w, vplCluster cluster, const Gift* gift)
{
    if (cluster.count == 1) {
        addLight(w, cluster.first, gift);
        return;
    }
    const vplShading* s = w->shading;
    const vplLightNode* node = &s->lightcuts->tree->nodes[cluster.node];
    vplCut* cut = w->cut;
    vplCutEntry* e = &cut->entries[cut->places[cut->count]];
    e->cluster = cluster;
    memcpy(e->gives, gift->gives, sizeof e->gives);
    memcpy(e->open, gift->open, sizeof e->open);
    s->clusterBound(w->points->surface, node, s->inverseBound, e->bound);
    for (int l = 0; l < VPL_LANES; l++) {
        e->bound[l] *= node->intensity;
    }
    cut->keys[cut->count] = keyOf(w, e);
    rise(cut, cut->count++);
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
        Gift gift;
        evaluate(w, i, &gift);
        addLight(w, i, &gift);
    }
}

// One half keeps the representative, and with it what is known of it.
static void split(Work* w)
{
    const vplLightTree* tree = w->shading->lightcuts->tree;
    const vplCutEntry* e = pop(w->cut);
    const vplCluster cluster = e->cluster;
    if (w->cut->count + 2 > VPL_CUT_CAPACITY) {
        sumUp(w, cluster);
        return;
    }
    vplCluster halves[2];
    vplLightTree_Halves(tree, cluster, halves);
    const int kept = tree->nodes[cluster.node].representative < halves[1].first ? 0 : 1;
    Gift gifts[2];
    memcpy(gifts[kept].gives, e->gives, sizeof e->gives);
    memcpy(gifts[kept].open, e->open, sizeof e->open);
    evaluate(w, vplLightTree_Representative(tree, halves[1 - kept]), &gifts[1 - kept]);
    place(w, halves[0], &gifts[0]);
    place(w, halves[1], &gifts[1]);
}

// ---- the cut

// Sums over the cut so far; with them, what error is allowed, keys and heap.
static void renew(Work* w)
{
    const vplShading* s = w->shading;
    vplCut* cut = w->cut;
    double totals[VPL_LANES], open[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        totals[l] = (double)w->besides[l] + (w->sums[0][l] + w->sums[1][l] + w->sums[2][l]);
        open[l] = (double)w->besides[l] + w->open[l];
    }
    for (int i = 0; i < cut->count; i++) {
        const vplCutEntry* e = &cut->entries[cut->places[i]];
        const float intensity = s->lightcuts->tree->nodes[e->cluster.node].intensity;
        addScaled(totals, intensity, e->gives);
        addScaled(open, intensity, e->open);
    }
    const double share = (double)s->def->cutError * SHARE;
    for (int l = 0; l < VPL_LANES; l++) {
        const double dark = DARK * open[l], of = totals[l] > dark ? totals[l] : dark;
        const double inverse = 1 / (share * of);
        w->inverse[l] = w->points->triangle[l] < 0 ? 0 : inverse < 1e37 ? (float)inverse : 1e37f;
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

// Adds the light of all clusters to a block whose sums hold what else it receives: that counts where an error is a
// share of a pixel's light.
static void addCut(const vplShading* s, vplCutWorker* worker, vplBlock* b, int64_t* rays)
{
    const vplPoints* points = &b->points;
    const vplLightTree* tree = s->lightcuts->tree;
    vplRayStarts starts;
    const bool casts = s->def->lightShadows == NULL && s->def->lightRays;
    if (casts) {
        vplFindRayStarts(s, points, &starts);
    }
    float besides[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        besides[l] = (float)(b->sums[0][l] + b->sums[1][l] + b->sums[2][l]);
    }
    Work w = {.shading = s,
              .points = points,
              .starts = casts ? &starts : NULL,
              .besides = besides,
              .cut = &worker->cut,
              .rays = rays};
    w.cut->count = w.cut->evaluations = 0;
    const vplCluster root = vplLightTree_Root(tree);
    Gift gift;
    evaluate(&w, vplLightTree_Representative(tree, root), &gift);
    place(&w, root, &gift);
    refine(&w);
    for (int i = 0; i < w.cut->count; i++) {
        const vplCutEntry* e = &w.cut->entries[w.cut->places[i]];
        for (int c = 0; c < 3; c++) {
            addScaled(w.sums[c], tree->nodes[e->cluster.node].rgb[c], e->gives);
        }
    }
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
    vplSeen seen;
    vplSeen_Clear(&seen);
    for (int block = 0; block < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; block++) {
        const int x = block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE, y = block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE;
        if (x >= tile->width || y >= tile->height) {
            continue;
        }
        vplBlock b;
        if (vplReadBlock(s, tile, block * VPL_LANES, &seen, &b)) {
            vplLightOnce(s, tile, block, &b);
            addCut(s, &s->lightcuts->workers[worker], &b, &tileSums->shadowRays);
        }
        vplWriteLit(s, tile, block, &seen, &b);
    }
    __atomic_fetch_add(s->shadowRays, tileSums->shadowRays, __ATOMIC_RELAXED);
}
