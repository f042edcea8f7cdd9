// SPDX-License-Identifier: MIT
// The light tree of Lightcuts.
// Based on: Walter, Fernandez, Arbree, Bala, Donikian and Greenberg, Lightcuts: A Scalable Approach to
// Illumination, SIGGRAPH 2005, section 3. Departs: built top down in O(n log n), by halving the longest side
// of the boxes of positions and normals, instead of merging the pair of clusters whose size and cone are
// smallest.
#include "lights/light_tree.h"
#include "base/context.h"
#include "base/hash.h"
#include "base/rng.h"
#include "lights/light_set.h"

#include <string.h>

// Weight of normals: a difference of 1 counts as much as this share of the diagonal of all lights.
static const float TURN = 0.5f;

enum {
    STREAM = 0x4c43,      // of random numbers
    MAX_HALVINGS = 64,    // deeper clusters are split into halves of equal count
    SUBTREES = 128,       // tasks, about
    MIN_SUBTREE = 1 << 10 // lights of a task
};

// A cluster near the root, or a whole subtree that a task builds.
typedef struct Range {
    vplCluster cluster;
    int depth;
    bool halved; // near the root
} Range;

typedef struct Build {
    vplLightTree* tree;
    float turn;    // metres per unit of a normal
    uint64_t seed; // of representatives
    Range* ranges; // halves come after what they are halves of
    size_t capacity;
    int rangeCount;
} Build;

// The cone around the mean normal. Cosines of rounded unit vectors err by up to 4e-7.
static void findCone(const vplTreeLight* lights, int count, const double sum[3], vplLightNode* node)
{
    const vplVec3 axis = vplNormalize(vplVec((float)sum[0], (float)sum[1], (float)sum[2]));
    float least = 1;
    for (int i = 0; i < count; i++) {
        const vplShadeLight* l = &lights[i].light;
        const float cosine = axis.x * l->nx + axis.y * l->ny + axis.z * l->nz;
        least = cosine < least ? cosine : least;
    }
    node->axis[0] = axis.x;
    node->axis[1] = axis.y;
    node->axis[2] = axis.z;
    const bool none = axis.x == 0 && axis.y == 0 && axis.z == 0;
    node->cosine = none || least < -1 + 2e-6f ? -1 : least - 1e-6f;
}

// Fills box and cone; returns the column to halve and where.
static int measure(const Build* b, vplCluster c, vplLightNode* node, float* atOut)
{
    const vplTreeLight* lights = b->tree->lights + c.first;
    float low[6], high[6];
    double sum[3] = {0};
    for (int k = 0; k < 6; k++) {
        low[k] = high[k] = vplShadeLight_Column(&lights[0].light, k);
    }
    for (int i = 0; i < c.count; i++) {
        for (int k = 0; k < 6; k++) {
            const float v = vplShadeLight_Column(&lights[i].light, k);
            low[k] = v < low[k] ? v : low[k];
            high[k] = v > high[k] ? v : high[k];
        }
        sum[0] += (double)lights[i].light.nx;
        sum[1] += (double)lights[i].light.ny;
        sum[2] += (double)lights[i].light.nz;
    }
    memcpy(node->low, low, sizeof node->low);
    memcpy(node->high, high, sizeof node->high);
    findCone(lights, c.count, sum, node);
    int longest = 0;
    float length = -1;
    for (int k = 0; k < 6; k++) {
        const float extent = (high[k] - low[k]) * (k < 3 ? 1 : b->turn);
        longest = extent > length ? k : longest;
        length = extent > length ? extent : length;
    }
    *atOut = low[longest] + 0.5f * (high[longest] - low[longest]);
    return longest;
}

// Puts the lights below `at` first and returns how many they are.
static int partition(vplTreeLight* lights, int count, int column, float at)
{
    int i = 0, j = count - 1;
    while (true) {
        while (i <= j && vplShadeLight_Column(&lights[i].light, column) < at) {
            i++;
        }
        while (i <= j && !(vplShadeLight_Column(&lights[j].light, column) < at)) {
            j--;
        }
        if (i >= j) {
            return i;
        }
        const vplTreeLight kept = lights[i];
        lights[i] = lights[j];
        lights[j] = kept;
    }
}

static void halve(const Build* b, vplCluster c, int depth)
{
    vplLightNode* node = &b->tree->nodes[c.node];
    float at;
    const int column = measure(b, c, node, &at);
    node->left = depth < MAX_HALVINGS ? partition(b->tree->lights + c.first, c.count, column, at) : 0;
    if (node->left == 0 || node->left == c.count) {
        node->left = c.count / 2;
    }
}

// Sets intensity and representative: that of one of the halves, with a probability of its share of the
// intensity, so that the representative's expected contribution is that of the lights.
static void merge(const Build* b, vplCluster c)
{
    const vplLightTree* tree = b->tree;
    vplLightNode* node = &tree->nodes[c.node];
    vplCluster halves[2];
    vplLightTree_Halves(tree, c, halves);
    float rgb[2][3], intensity[2];
    for (int h = 0; h < 2; h++) {
        const vplShadeLight* light = &tree->lights[halves[h].first].light;
        const vplLightNode* below = &tree->nodes[halves[h].node];
        const float one[3] = {light->r, light->g, light->b};
        memcpy(rgb[h], halves[h].count > 1 ? below->rgb : one, sizeof rgb[h]);
        intensity[h] = rgb[h][0] + rgb[h][1] + rgb[h][2];
    }
    for (int k = 0; k < 3; k++) {
        node->rgb[k] = rgb[0][k] + rgb[1][k];
    }
    node->intensity = intensity[0] + intensity[1];
    const float dice = vplUnitFloat(vplRandomAt(b->seed, STREAM, (uint64_t)c.node).v[0]);
    const int chosen = dice * node->intensity < intensity[0] ? 0 : 1;
    node->representative = vplLightTree_Representative(tree, halves[chosen]);
}

// Recurses at most MAX_HALVINGS + 24 calls deep.
static void buildSubtree(const Build* b, vplCluster c, int depth)
{
    if (c.count < 2) {
        return;
    }
    vplCluster halves[2];
    halve(b, c, depth);
    vplLightTree_Halves(b->tree, c, halves);
    buildSubtree(b, halves[0], depth + 1);
    buildSubtree(b, halves[1], depth + 1);
    merge(b, c);
}

static void subtreeTask(void* data, int task, int worker)
{
    (void)worker;
    const Build* b = data;
    const Range* range = &b->ranges[task];
    if (!range->halved) {
        buildSubtree(b, range->cluster, range->depth);
    }
}

static vplResult pushRange(Build* b, vplCluster cluster, int depth)
{
    TRY(vplReserve(b->tree->context, &b->ranges, &b->capacity, (size_t)b->rangeCount + 1, sizeof *b->ranges));
    b->ranges[b->rangeCount++] = (Range){cluster, depth, false};
    return VPL_SUCCESS;
}

// Splits the clusters near the root. The choice depends on counts alone, not on workers.
static vplResult buildTop(Build* b)
{
    const int share = b->tree->lightCount / SUBTREES, grain = share > MIN_SUBTREE ? share : MIN_SUBTREE;
    TRY(pushRange(b, vplLightTree_Root(b->tree), 0));
    for (int i = 0; i < b->rangeCount; i++) {
        const Range range = b->ranges[i];
        if (range.cluster.count <= grain) {
            continue;
        }
        vplCluster halves[2];
        halve(b, range.cluster, range.depth);
        vplLightTree_Halves(b->tree, range.cluster, halves);
        b->ranges[i].halved = true;
        TRY(pushRange(b, halves[0], range.depth + 1));
        TRY(pushRange(b, halves[1], range.depth + 1));
    }
    return VPL_SUCCESS;
}

static float diagonalOf(const vplShadeLight* lights, int count)
{
    vplVec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i < count; i++) {
        const vplShadeLight* l = &lights[i];
        low = vplVec(fminf(low.x, l->px), fminf(low.y, l->py), fminf(low.z, l->pz));
        high = vplVec(fmaxf(high.x, l->px), fmaxf(high.y, l->py), fmaxf(high.z, l->pz));
    }
    return vplLength(vplSub(high, low));
}

// Other lights get other random numbers, so that the errors of several passes are independent.
static uint64_t seedOf(const vplShadeLight* lights, int count)
{
    const int step = count / 64 + 1;
    uint64_t seed = 0;
    for (int i = 0; i < count; i += step) {
        seed = vplHashFloats(seed, &lights[i].px, 3);
    }
    return seed;
}

static vplResult build(vplLightTree* tree, const vplShadeLight* lights, vplProgressFcn* progress, void* user)
{
    for (int i = 0; i < tree->lightCount; i++) {
        tree->lights[i] = (vplTreeLight){lights[i], i};
    }
    Build b = {.tree = tree, .turn = TURN * diagonalOf(lights, tree->lightCount)};
    b.seed = seedOf(lights, tree->lightCount);
    vplResult result = buildTop(&b);
    if (result == VPL_SUCCESS) {
        result = vplParallelForProgress(tree->context, b.rangeCount, subtreeTask, &b,
                                        (vplProgressRange){progress, user, 0, 1});
    }
    for (int i = b.rangeCount - 1; i >= 0 && result == VPL_SUCCESS; i--) {
        if (b.ranges[i].halved) {
            merge(&b, b.ranges[i].cluster);
        }
    }
    vplFree(tree->context, b.ranges);
    return result;
}

vplResult vplLightTree_Create(vplContext* context, const vplShadeLight* lights, int lightCount,
                              vplProgressFcn* progress, void* user, vplLightTree** treeOut)
{
    vplArena* arena = vplArena_Create(context);
    vplLightTree* tree = vplArena_AllocZero(arena, 1, sizeof *tree);
    vplTreeLight* treeLights = vplArena_Alloc(arena, (size_t)lightCount, sizeof *treeLights);
    vplLightNode* nodes = vplArena_Alloc(arena, (size_t)lightCount, sizeof *nodes);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *tree = (vplLightTree){treeLights, nodes, lightCount, context, arena};
        result = lightCount > 0 ? build(tree, lights, progress, user) : VPL_SUCCESS;
    }
    return vplArena_Deliver(arena, result, tree, treeOut);
}

void vplLightTree_Destroy(vplLightTree* tree)
{
    vplArena_Destroy(tree != NULL ? tree->arena : NULL);
}
