// SPDX-License-Identifier: MIT
// Builds the tree of groups: a group is halved by brightness if that is uneven, else by normals if they
// differ, else along its longest axis.
// Based on: Smits, Arvo and Greenberg, A Clustering Algorithm for Radiosity in Complex Environments, SIGGRAPH
// 1994, 3. Departs: groups are divided by normals as well, so that the cosine term applies to groups, too.
#include "math/vec.h"
#include "geometry/triangle.h"
#include "radiosity/links/links.h"
#include "radiosity/sides/side.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Deeper groups are halved by count, which limits the depth to 48 + log2(n).
enum { HALVES_DEPTH = 48 };

// Groups whose normals differ by more than this in one component are halved by that component. 0.3 is 17
// degrees.
static const float TURNED = 0.3f;

// Emission above this fraction of the expected radiosity is uneven if it differs by a factor of two.
// Otherwise the light of an area light that is flush with a ceiling would come from the whole ceiling.
static const double UNEVEN = 0.1;

// Sides of a group lie in one plane if their corners are within this fraction of its radius of it.
static const double FLAT = 1e-5;

// A group is dim if it has less than DIM times the particle hits that the mean over all sides predicts for its area. Groups for which
// fewer than LEAST_HITS are predicted are too small to tell; they have the values of their parent.
static const double DIM = 1.0 / 32, LEAST_HITS = 128;

typedef struct Build {
    const vplPatchSide* sides;
    const vplPatches* patches;
    const int* hits; // of particles, per side
    struct vplLinkTree* tree;
    double mean;     // expected radiosity, W/m^2; 0: nothing emits
    double meanHits; // of particles per m^2; 0: not known
    int* scratch;    // one per side
} Build;

// The keys that groups can be divided by: centre, normal and emission of a side.
enum { KEYS = 7, NORMAL = 3, EMISSION = 6 };

typedef struct Range {
    float low[KEYS], high[KEYS];
} Range;

static float keyOf(const vplPatchSide* side, int k)
{
    return k < NORMAL     ? vplComponent(side->incentre, k)
           : k < EMISSION ? vplComponent(side->normal, k - NORMAL)
                          : (float)vplRgbMean(side->emission);
}

static Range rangeOf(const Build* b, const vplLinkNode* node)
{
    Range range;
    for (int k = 0; k < KEYS; k++) {
        range.low[k] = INFINITY;
        range.high[k] = -INFINITY;
        for (int i = 0; i < node->count; i++) {
            const float key = keyOf(&b->sides[b->tree->order[node->first + i]], k);
            range.low[k] = key < range.low[k] ? key : range.low[k];
            range.high[k] = key > range.high[k] ? key : range.high[k];
        }
    }
    return range;
}

// ---- corners of sides

// A corner of a side or, if it is of a group, of one of its triangles.
typedef struct Corner {
    vplVec3 at, normal;
    int left; // corners that are left with this one
} Corner;

static void nextCorner(const Build* b, const vplPatchSide* side, Corner* c)
{
    c->left--;
    if (c->left > 0) {
        const vplPatchParts parts = vplPatches_GetParts(b->patches, side->patch);
        const int at = 3 * parts.count - c->left, node = parts.nodes[at / 3];
        c->at = parts.count > 1 ? b->patches->positions[b->patches->nodes[node].corners[at % 3]]
                                : side->corners[at];
        if (at % 3 == 0) {
            const vplVec3 n = b->patches->geometry->normals[node];
            c->normal = side->back ? vplNegate(n) : n;
        }
    }
}

static Corner firstCorner(const Build* b, const vplPatchSide* side)
{
    if (!vplPatches_IsGroup(b->patches, side->patch)) {
        return (Corner){side->corners[0], side->normal, 3};
    }
    Corner c = {.left = 3 * vplPatches_GetParts(b->patches, side->patch).count + 1};
    nextCorner(b, side, &c);
    return c;
}

// ---- properties of a node

// The centroid of a side's open cells, of a group's triangles.
static vplVec3 middleOf(const vplPatchSide* side, bool isGroup)
{
    vplVec3 sum = {0, 0, 0};
    if (isGroup) {
        return side->incentre; // the centroid
    }
    if (side->open == VPL_ALL_CELLS) {
        for (int k = 0; k < 3; k++) {
            sum = vplAdd(sum, vplScale(1.0f / 3, side->corners[k]));
        }
        return sum;
    }
    const int count = __builtin_popcount(side->open);
    for (int k = 0; k < count; k++) {
        const vplVec3 at = vplPatchSide_CellCentre(side, vplPatchSide_OpenCell(side, k));
        sum = vplAdd(sum, vplScale(1 / (float)count, at));
    }
    return sum;
}

// Area, brightness, bounds and mean normal.
static void sumNode(const Build* b, vplLinkNode* node)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    float least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
    double normal[3] = {0}, middle[3] = {0}, area = 0, emitted = 0;
    for (int i = 0; i < node->count; i++) {
        const vplPatchSide* s = &b->sides[b->tree->order[node->first + i]];
        area += (double)s->area;
        emitted += (double)s->area * vplRgbMean(s->emission);
        const vplVec3 at = middleOf(s, vplPatches_IsGroup(b->patches, s->patch));
        for (int axis = 0; axis < 3; axis++) {
            const float x = vplComponent(at, axis);
            least[axis] = x < least[axis] ? x : least[axis];
            most[axis] = x > most[axis] ? x : most[axis];
            middle[axis] += (double)s->area * (double)x;
            normal[axis] += (double)s->area * (double)vplComponent(s->normal, axis);
        }
        for (Corner c = firstCorner(b, s); c.left > 0; nextCorner(b, s, &c)) {
            for (int axis = 0; axis < 3; axis++) {
                const float x = vplComponent(c.at, axis);
                low[axis] = x < low[axis] ? x : low[axis];
                high[axis] = x > high[axis] ? x : high[axis];
            }
        }
    }
    node->area = (float)area;
    node->brightness = emitted > b->mean * area ? (float)(emitted / (b->mean * area)) : 1;
    node->low = vplVec(low[0], low[1], low[2]);
    node->high = vplVec(high[0], high[1], high[2]);
    node->centre = vplVec(0.5f * low[0] + 0.5f * high[0], 0.5f * low[1] + 0.5f * high[1],
                          0.5f * low[2] + 0.5f * high[2]);
    for (int axis = 0; axis < 3; axis++) {
        middle[axis] /= area;
    }
    node->middle = vplVec((float)middle[0], (float)middle[1], (float)middle[2]);
    node->least = vplSub(vplVec(least[0], least[1], least[2]), node->middle);
    node->most = vplSub(vplVec(most[0], most[1], most[2]), node->middle);
    const double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    node->normal = length > 1e-3 * area ? vplVec((float)(normal[0] / length), (float)(normal[1] / length),
                                                 (float)(normal[2] / length))
                                        : b->sides[b->tree->order[node->first]].normal;
}

// Radius, spread of normals and flatness.
static void measureNode(const Build* b, vplLinkNode* node)
{
    const vplPatchSide* firstSide = &b->sides[b->tree->order[node->first]];
    double radius = 0, cosine = 1, turn = 1, height = 0, turned = 0;
    for (int i = 0; i < node->count; i++) {
        const vplPatchSide* s = &b->sides[b->tree->order[node->first + i]];
        turn = fmin(turn, (double)vplDot(s->normal, node->normal));
        for (Corner c = firstCorner(b, s); c.left > 0; nextCorner(b, s, &c)) {
            const double towards = (double)vplDot(c.normal, node->normal);
            cosine = towards < cosine ? towards : cosine;
            const double off = (double)vplLength(vplSub(c.normal, firstSide->normal));
            turned = off > turned ? off : turned;
            const double r = (double)vplLength(vplSub(c.at, node->centre));
            radius = r > radius ? r : radius;
            const double h = fabs((double)vplDot(vplSub(c.at, firstSide->corners[0]), firstSide->normal));
            height = h > height ? h : height;
        }
    }
    cosine = cosine < -1 ? -1 : cosine;
    node->radius = (float)radius;
    node->least = vplScale(radius > 0 ? 1 / node->radius : 0, node->least);
    node->most = vplScale(radius > 0 ? 1 / node->radius : 0, node->most);
    node->cosSpread = (float)cosine;
    node->cosTurn = (float)turn;
    node->sinSpread = (float)sqrt(1 - cosine * cosine);
    node->group = node->count == 1 && vplPatches_IsGroup(b->patches, firstSide->patch);
    node->flat = (node->count == 1 && !node->group) || (turned <= FLAT && height <= FLAT * radius);
}

// ---- halving

// Partitions a node's sides, stably: those with a key below `middle` first. Returns how many these are.
static int divideAt(const Build* b, const vplLinkNode* node, int key, float middle)
{
    int* order = b->tree->order + node->first;
    int before = 0, after = 0;
    for (int i = 0; i < node->count; i++) {
        if (keyOf(&b->sides[order[i]], key) < middle) {
            order[before++] = order[i];
        } else {
            b->scratch[after++] = order[i];
        }
    }
    memcpy(order + before, b->scratch, (size_t)after * sizeof *order);
    return before;
}

// The key with the widest range among three.
static int longestOf(const Range* range, int first)
{
    int best = first;
    for (int k = first + 1; k < first + 3; k++) {
        best = range->high[k] - range->low[k] > range->high[best] - range->low[best] ? k : best;
    }
    return best;
}

// Returns how many of the node's sides the first child gets.
static int halve(const Build* b, const vplLinkNode* node, int depth)
{
    const Range range = rangeOf(b, node);
    const bool uneven =
        (double)range.high[EMISSION] > UNEVEN * b->mean && range.high[EMISSION] > 2 * range.low[EMISSION];
    const int turn = longestOf(&range, NORMAL), length = longestOf(&range, 0);
    const int key = uneven ? EMISSION : range.high[turn] - range.low[turn] > TURNED ? turn : length;
    const float middle = 0.5f * range.low[key] + 0.5f * range.high[key];
    const int before = depth < HALVES_DEPTH ? divideAt(b, node, key, middle) : 0;
    return before > 0 && before < node->count ? before : node->count / 2;
}

// Finds node->lit and node->dim. Before the call they have its parent's values, which a node that is too small to tell keeps.
static void findLit(const Build* b, vplLinkNode* node)
{
    const double expected = b->meanHits * (double)node->area;
    double hits = 0;
    for (int i = 0; i < node->count && expected >= LEAST_HITS; i++) {
        hits += b->hits[b->tree->order[node->first + i]];
    }
    if (expected >= LEAST_HITS) {
        node->lit = (float)(hits / expected);
        node->dim = node->dim || hits < DIM * expected;
    }
}

// Builds the tree below a node, which has its range of sides and the `lit` and `dim` of its parent.
static void buildNode(const Build* b, int index, int depth)
{
    struct vplLinkTree* tree = b->tree;
    vplLinkNode* node = &tree->nodes[index];
    sumNode(b, node);
    measureNode(b, node);
    findLit(b, node);
    if (node->count == 1) {
        return;
    }
    const int before = halve(b, node, depth), child = tree->nodeCount;
    node->children = child;
    tree->nodeCount += 2;
    vplLinkNode part = {
        .children = -1, .first = node->first, .count = before, .lit = node->lit, .dim = node->dim};
    tree->nodes[child] = part;
    part.first += before;
    part.count = node->count - before;
    tree->nodes[child + 1] = part;
    buildNode(b, child, depth + 1);
    buildNode(b, child + 1, depth + 1);
}

// The radiosity of a closed room in which reflectance and light are even.
static double expectedRadiosity(const vplPatchSides* sides)
{
    double emitted = 0, kept = 0, area = 0;
    for (int i = 0; i < sides->count; i++) {
        const vplPatchSide* s = &sides->sides[i];
        emitted += (double)s->area * vplRgbMean(s->emission);
        kept += (double)s->area * vplRgbMean(s->reflectance);
        area += (double)s->area;
    }
    const double lost = area - kept;
    return emitted > 0 ? emitted / (lost > 0.1 * area ? lost : 0.1 * area) : 0;
}

// The number of particle hits per m^2, as a mean over all sides.
static double meanHits(const vplPatchSides* sides)
{
    double hits = 0, area = 0;
    for (int i = 0; i < sides->count && sides->hits != NULL; i++) {
        hits += sides->hits[i];
        area += (double)sides->sides[i].area;
    }
    return area > 0 ? hits / area : 0;
}

vplResult vplLinkTree_Build(vplArena* arena, const vplPatchSides* sides, struct vplLinkTree* tree)
{
    vplContext* context = sides->context;
    const size_t count = (size_t)sides->count, nodes = count > 0 ? 2 * count - 1 : 0;
    tree->nodes = vplArena_Alloc(arena, nodes, sizeof *tree->nodes);
    tree->order = vplArena_Alloc(arena, count, sizeof *tree->order);
    tree->areaUpTo = vplArena_Alloc(arena, count + 1, sizeof *tree->areaUpTo);
    tree->scale = vplArena_Alloc(arena, count, sizeof *tree->scale);
    TRY(vplArena_Check(arena));
    int* scratch = vplAlloc(context, count, sizeof *scratch);
    if (scratch == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < sides->count; i++) {
        tree->order[i] = i;
    }
    if (sides->count > 0) {
        tree->nodes[0] = (vplLinkNode){.children = -1, .first = 0, .count = sides->count, .lit = 1};
        tree->nodeCount = 1;
        const Build build = {sides->sides,    sides->patches, sides->hits, tree, expectedRadiosity(sides),
                             meanHits(sides), scratch};
        buildNode(&build, 0, 0);
    }
    tree->areaUpTo[0] = 0;
    for (int i = 0; i < sides->count; i++) {
        tree->areaUpTo[i + 1] = tree->areaUpTo[i] + (double)sides->sides[tree->order[i]].area;
    }
    vplFree(context, scratch);
    return VPL_SUCCESS;
}
