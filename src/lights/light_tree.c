// SPDX-License-Identifier: MIT
// Based on: Walter, Fernandez, Arbree, Bala, Donikian and Greenberg, Lightcuts: A Scalable Approach to Illumination,
// SIGGRAPH 2005, section 3. Departs: built from the top, in time that a million lights allow, by halving what is
// longest among the sides of the box of positions and those of the box of normals, instead of by merging the pair of
// clusters whose size and cone are smallest.
#include "lights/light_tree.h"
#include "base/context.h"
#include "base/hash.h"
#include "base/rng.h"
#include "math/vec.h"

#include <string.h>

// Normals as far apart as two opposite ones count as much as places this share of the scene's diagonal apart.
static const float TURN = 0.5f;

enum {
    STREAM = 0x4c43,   // of random numbers
    MAX_HALVINGS = 64, // lights in a geometric series would make a list of a tree: then halves of equal count
    SUBTREES = 128,    // tasks, about
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

// Column k of six: position, then normal.
static inline float columnOf(const vplTreeLight* light, int k)
{
    float value;
    memcpy(&value, (const char*)&light->light + (size_t)k * sizeof value, sizeof value);
    return value;
}

_Static_assert(offsetof(vplShadeLight, nz) == 5 * sizeof(float), "a light begins with its six columns");

// The cone around the mean normal. Cosines of rounded unit vectors are off by up to 4e-7.
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
        low[k] = high[k] = columnOf(&lights[0], k);
    }
    for (int i = 0; i < c.count; i++) {
        for (int k = 0; k < 6; k++) {
            const float v = columnOf(&lights[i], k);
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
        while (i <= j && columnOf(&lights[i], column) < at) {
            i++;
        }
        while (i <= j && !(columnOf(&lights[j], column) < at)) {
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

// Intensity, and a representative: that of one of the halves, with a probability that is its share of the
// intensity, so that what a cluster is expected to give is what its lights give.
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

// MAX_HALVINGS + 24 calls deep at most.
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
    const vplResult result =
        vplReserve(b->tree->context, &b->ranges, &b->capacity, (size_t)b->rangeCount + 1, sizeof *b->ranges);
    if (result == VPL_SUCCESS) {
        b->ranges[b->rangeCount++] = (Range){cluster, depth, false};
    }
    return result;
}

// Which clusters are halved depends on counts alone, so it does not on workers.
static vplResult buildTop(Build* b)
{
    const int share = b->tree->lightCount / SUBTREES, grain = share > MIN_SUBTREE ? share : MIN_SUBTREE;
    vplResult result = pushRange(b, vplLightTree_Root(b->tree), 0);
    for (int i = 0; i < b->rangeCount && result == VPL_SUCCESS; i++) {
        const Range range = b->ranges[i];
        if (range.cluster.count <= grain) {
            continue;
        }
        vplCluster halves[2];
        halve(b, range.cluster, range.depth);
        vplLightTree_Halves(b->tree, range.cluster, halves);
        b->ranges[i].halved = true;
        result = pushRange(b, halves[0], range.depth + 1);
        if (result == VPL_SUCCESS) {
            result = pushRange(b, halves[1], range.depth + 1);
        }
    }
    return result;
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

// Other lights draw other representatives, so that errors of pictures by several passes do not agree.
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
        result = vplParallelForProgress(tree->context, b.rangeCount, subtreeTask, &b, progress, user, 0, 1);
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
    vplLightTree* tree = vplAllocZero(context, 1, sizeof *tree);
    vplResult result = tree ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS) {
        tree->context = context;
        tree->lightCount = lightCount;
        tree->lights = vplAlloc(context, (size_t)lightCount, sizeof *tree->lights);
        tree->nodes = vplAlloc(context, (size_t)lightCount, sizeof *tree->nodes);
        result = tree->lights && tree->nodes ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    }
    if (result == VPL_SUCCESS && lightCount > 0) {
        result = build(tree, lights, progress, user);
    }
    if (result != VPL_SUCCESS) {
        vplLightTree_Destroy(tree);
        return result;
    }
    *treeOut = tree;
    return VPL_SUCCESS;
}

void vplLightTree_Destroy(vplLightTree* tree)
{
    if (tree != NULL) {
        vplFree(tree->context, tree->lights);
        vplFree(tree->context, tree->nodes);
        vplFree(tree->context, tree);
    }
}
