// SPDX-License-Identifier: MIT
// Based on: Alejandro Conty Estevez and Christopher Kulla, Importance Sampling of Many Lights with Adaptive Tree
// Splitting, HPG 2018, for the importance of a node by power, distance and orientation; Matt Pharr, Wenzel Jakob and
// Greg Humphreys, Physically Based Rendering, 4th edition 2023, section 12.6.3, for its bounds without angles. Departs:
// nodes are halved at the middle of the longest side of the boxes of centres and axes, as those of the light tree of
// Lightcuts are (src/lights/light_tree.c), whose nodes bound points with one lobe and carry representatives.
#include "geometry/emitter_nodes.h"
#include "base/arena.h"
#include "geometry/emission.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "math/vec.h"

#include <float.h>

enum { MAX_HALVINGS = 64 }; // deeper nodes are split into halves of equal count

// Weight of axes: a difference of 1 counts as much as this share of the diagonal of all sources.
static const double TURN = 0.25;

// A source while the tree is built, or a node with the sources that it bounds.
typedef struct Bound {
    double low[3], high[3]; // box
    vplVec3 axis;
    double cosSpread,
        sinSpread;   // of the cone around the axis that holds all axes; a point light's is a full turn
    double cosReach; // light leaves in directions up to this angle off some axis in the cone
    double strength; // intensity on the axis, W/sr, mean of the channels
} Bound;

// ---- sources

static Bound boundTriangle(const vplGeometry* g, int triangle)
{
    const vplTriangleCorners t = vplGeometry_Corners(g, triangle);
    const vplRgb radiance = g->materials[g->triangleMaterials[triangle]].emission;
    Bound b = {.axis = g->normals[triangle], .cosSpread = 1};
    for (int k = 0; k < 3; k++) {
        const vplVec3 p = t.corner[k];
        const double at[3] = {p.x, p.y, p.z};
        for (int i = 0; i < 3; i++) {
            b.low[i] = k == 0 || at[i] < b.low[i] ? at[i] : b.low[i];
            b.high[i] = k == 0 || at[i] > b.high[i] ? at[i] : b.high[i];
        }
    }
    b.strength = vplRgbMean(radiance) * vplGeometry_TriangleArea(g, triangle);
    return b;
}

static Bound boundEmitter(const vplEmitterDef* e)
{
    Bound b = {.low = {e->position.x, e->position.y, e->position.z},
               .high = {e->position.x, e->position.y, e->position.z},
               .axis = {0, 0, 1},
               .cosSpread = -1,
               .strength = vplRgbMean(e->intensity)};
    if (e->type == VPL_EMITTER_SPOT) { // full strength up to the inner angle, none from the outer one on
        double sinReach;
        b.axis = e->direction;
        vplSinCos(e->innerAngle, &b.sinSpread, &b.cosSpread);
        vplSinCos(e->outerAngle - e->innerAngle, &sinReach, &b.cosReach);
    }
    return b;
}

static bool hasPlace(const vplEmission* e, int source)
{
    const vplEmissionSource* s = &e->sources[source];
    return s->triangle >= 0 || (s->emitter >= 0 && e->emitters[s->emitter].type != VPL_EMITTER_DIRECTIONAL);
}

static Bound boundSource(const vplEmission* e, int source)
{
    const vplEmissionSource* s = &e->sources[source];
    return s->triangle >= 0 ? boundTriangle(e->geometry, s->triangle)
                            : boundEmitter(&e->emitters[s->emitter]);
}

// ---- building

typedef struct Build {
    vplEmitterTree* tree;
    Bound* bounds; // by source - first
    double turn;   // metres per unit of an axis
} Build;

static const Bound* boundAt(const Build* b, int position)
{
    return &b->bounds[b->tree->sources[position] - b->tree->first];
}

static double columnOf(const Bound* b, int column)
{
    const double axis[3] = {b->axis.x, b->axis.y, b->axis.z};
    return column < 3 ? b->low[column] + 0.5 * (b->high[column] - b->low[column]) : axis[column - 3];
}

// Widens the node's cone by a source's. The cosine of the sum of two angles, of which neither is more than half a turn.
static void widenCone(Bound* node, const Bound* source)
{
    const double cosine = vplDot(node->axis, source->axis);
    const double c = cosine < 1 ? (cosine > -1 ? cosine : -1) : 1, s = sqrt(1 - c * c);
    const bool over = source->sinSpread * c + source->cosSpread * s < 0 || source->cosSpread <= -1;
    const double sum = over ? -1 : c * source->cosSpread - s * source->sinSpread;
    node->cosSpread = sum < node->cosSpread ? sum : node->cosSpread;
    node->cosReach = source->cosReach < node->cosReach ? source->cosReach : node->cosReach;
}

static Bound boundRange(const Build* build, int first, int count)
{
    if (count == 1) {
        return *boundAt(build, first);
    }
    Bound all = *boundAt(build, first);
    double sum[3] = {0, 0, 0}, strength = 0;
    for (int i = 0; i < count; i++) {
        const Bound* b = boundAt(build, first + i);
        for (int k = 0; k < 3; k++) {
            all.low[k] = b->low[k] < all.low[k] ? b->low[k] : all.low[k];
            all.high[k] = b->high[k] > all.high[k] ? b->high[k] : all.high[k];
            sum[k] += columnOf(b, 3 + k);
        }
        strength += b->strength;
    }
    all.strength = strength;
    all.axis = vplNormalize(vplVec((float)sum[0], (float)sum[1], (float)sum[2]));
    all.cosSpread = vplDot(all.axis, all.axis) > 0 ? 1 : -1;
    for (int i = 0; i < count; i++) {
        widenCone(&all, boundAt(build, first + i));
    }
    all.cosSpread = all.cosSpread < -1 + 2 * VPL_CONE_MARGIN ? -1 : all.cosSpread - VPL_CONE_MARGIN;
    all.sinSpread = sqrt(1 - all.cosSpread * all.cosSpread);
    return all;
}

// The sphere's radius is rounded up, because its centre is rounded; that of one point stays 0.
static void fillNode(vplEmitterNode* node, const Bound* b)
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        node->centre[k] = (float)(b->low[k] + 0.5 * (b->high[k] - b->low[k]));
        const double below = (double)node->centre[k] - b->low[k],
                     above = b->high[k] - (double)node->centre[k];
        const double farther = below > above ? below : above;
        square += farther * farther;
    }
    node->radius = (float)(sqrt(square) * (1 + VPL_CONE_MARGIN));
    node->axis[0] = b->axis.x;
    node->axis[1] = b->axis.y;
    node->axis[2] = b->axis.z;
    node->cosSpread = (float)b->cosSpread;
    node->sinSpread = (float)b->sinSpread;
    node->cosReach = (float)b->cosReach;
    node->strength = b->strength;
}

// Puts the sources below the middle of the longest column first and returns how many they are.
static int partition(const Build* b, int first, int count)
{
    double low[6], high[6], length = -1;
    int longest = 0;
    for (int k = 0; k < 6; k++) {
        low[k] = high[k] = columnOf(boundAt(b, first), k);
        for (int i = 1; i < count; i++) {
            const double v = columnOf(boundAt(b, first + i), k);
            low[k] = v < low[k] ? v : low[k];
            high[k] = v > high[k] ? v : high[k];
        }
        const double extent = (high[k] - low[k]) * (k < 3 ? 1 : b->turn);
        longest = extent > length ? k : longest;
        length = extent > length ? extent : length;
    }
    const double at = low[longest] + 0.5 * (high[longest] - low[longest]);
    int* sources = b->tree->sources + first;
    int below = 0;
    for (int i = 0; i < count; i++) {
        if (columnOf(&b->bounds[sources[i] - b->tree->first], longest) < at) {
            const int kept = sources[below];
            sources[below++] = sources[i];
            sources[i] = kept;
        }
    }
    return below;
}

// Recurses at most MAX_HALVINGS + 31 calls deep.
static void build(const Build* b, int node, int first, int count, int depth)
{
    const Bound bound = boundRange(b, first, count);
    vplEmitterNode* n = &b->tree->nodes[node];
    fillNode(n, &bound);
    n->left = 0;
    if (count == 1) {
        b->tree->positions[b->tree->sources[first] - b->tree->first] = first;
        return;
    }
    n->left = depth < MAX_HALVINGS ? partition(b, first, count) : 0;
    n->left = n->left == 0 || n->left == count ? count / 2 : n->left;
    build(b, node + 1, first, n->left, depth + 1);
    build(b, node + 2 * n->left, first + n->left, count - n->left, depth + 1);
}

static double diagonalOf(const Build* b)
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < b->tree->count; i++) {
            const Bound* bound = boundAt(b, i);
            low = bound->low[k] < low ? bound->low[k] : low;
            high = bound->high[k] > high ? bound->high[k] : high;
        }
        square += (high - low) * (high - low);
    }
    return sqrt(square);
}

static vplResult fill(vplEmitterTree* t, const vplEmission* emission, vplArena* arena)
{
    const size_t count = (size_t)t->count, range = (size_t)(t->end - t->first);
    t->nodes = vplArena_Alloc(arena, 2 * count - 1, sizeof *t->nodes);
    t->sources = vplArena_Alloc(arena, count, sizeof *t->sources);
    t->positions = vplArena_Alloc(arena, range, sizeof *t->positions);
    Bound* bounds = vplArena_Alloc(arena, range, sizeof *bounds);
    TRY(vplArena_Check(arena));
    for (int i = t->first, at = 0; i < t->end; i++) {
        if (hasPlace(emission, i)) {
            bounds[i - t->first] = boundSource(emission, i);
            t->cones = t->cones || bounds[i - t->first].cosSpread > -1;
            t->sources[at++] = i;
        }
    }
    Build b = {t, bounds, 0};
    b.turn = TURN * diagonalOf(&b);
    build(&b, 0, 0, t->count, 0);
    vplArena_Free(arena, bounds);
    return VPL_SUCCESS;
}

vplResult vplEmitterTree_Create(vplArena* arena, const vplEmission* emission, int first, int end,
                                vplEmitterTree** treeOut)
{
    int count = 0;
    for (int i = first; i < end; i++) {
        count += hasPlace(emission, i);
    }
    if (count == 0) {
        *treeOut = NULL;
        return VPL_SUCCESS;
    }
    vplEmitterTree* t = vplArena_AllocZero(arena, 1, sizeof *t);
    TRY(vplArena_Check(arena));
    t->first = first;
    t->end = end;
    t->count = count;
    TRY(fill(t, emission, arena));
    *treeOut = t;
    return VPL_SUCCESS;
}

void vplEmitterTree_ForgetPlaces(vplEmitterTree* t)
{
    for (int i = 0; i < 2 * t->count - 1; i++) {
        t->nodes[i].radius = 0x1p60f; // every point is inside, where only strength counts
    }
}

// ---- choosing

VPL_STEP double leftShare(const vplEmitterTree* t, int node, int left, vplVec3 position, vplVec3 normal)
{
    return vplEmitterTree_LeftShare(t, node + 1, node + 2 * left, position, normal, t->cones, true);
}

vplChosenSource vplEmitterTree_Choose(const vplEmitterTree* t, vplVec3 position, vplVec3 normal,
                                      double choice)
{
    vplDescent d = vplDescent_Start(choice);
    for (int left; (left = t->nodes[d.node].left) > 0 && !d.ended;) {
        d = vplDescent_Step(d, left, leftShare(t, d.node, left, position, normal));
    }
    return (vplChosenSource){d.ended ? -1 : t->sources[d.first], d.probability, d.rest};
}

double vplEmitterTree_Probability(const vplEmitterTree* t, vplVec3 position, vplVec3 normal, int source)
{
    const int position0 = t->positions[source - t->first];
    double probability = 1;
    for (int node = 0, first = 0; t->nodes[node].left > 0 && probability > 0;) {
        const int left = t->nodes[node].left;
        const double share = leftShare(t, node, left, position, normal);
        const bool goesLeft = position0 < first + left;
        probability *= share < 0 ? 0 : goesLeft ? share : 1 - share;
        first += goesLeft ? 0 : left;
        node += goesLeft ? 1 : 2 * left;
    }
    return probability;
}
