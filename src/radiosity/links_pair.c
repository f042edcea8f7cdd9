// SPDX-License-Identifier: MIT
// Whether one link may stand for all that two groups exchange, and how much that is.
// Based on: Hanrahan, Salzman and Aupperle, A Rapid Hierarchical Radiosity Algorithm, SIGGRAPH 1991. Departs: the error
// of a link is measured, as the spread of cos cos V / (pi r^2) between points of either group, not bounded by its size.
#include "base/context.h"
#include "base/rng.h"
#include "geometry/bvh.h"
#include "math/vec.h"
#include "radiosity/links.h"
#include "radiosity/links_points.h"
#include "radiosity/polygon_factor.h"

#include <math.h>

// Groups whose normals are further from their mean than this are divided, whatever the spread, unless the link is tiny:
// all their sides would receive the same. 26 degrees.
static const float TURNED = 0.9f;

// Of the allowed error: form factors up to this are tiny.
static const double TINY = 0.25;

// Of the allowed error: groups of which no ray reaches the other exchange nothing if they would exchange less than this
// with nothing between them.
static const double HIDDEN = 8;

// How much radiosity differs over a group that sends, as a share of its mean: with it the kernel's spread over that
// group is an error of what is received.
static const double UNEVEN = 0.25;

// How much of what a pair may exchange at most, above what its points say, counts as an error: points miss peaks.
static const double PEAK = 0.05;

static const double RECEIVED = 1.0;
static const double NOISE = 1.0;

// A pair at work.
typedef struct Pair {
    const vplPatchSides* sides;
    const struct vplLinkTree* tree;
    const vplLinkDef* def;
    const vplLinkPair* ids;
    const vplLinkNode *p, *q;
    vplLinkAnswer* answer;
} Pair;

static double triangleArea(const vplPatchSide* side)
{
    const vplVec3* c = side->corners;
    return 0.5 * (double)vplLength(vplCross(vplSub(c[1], c[0]), vplSub(c[2], c[0])));
}

static void samplePair(const Pair* pair, int set, vplLinkPoints* p, vplLinkPoints* q)
{
    vplSampleNode(pair->sides, pair->tree, pair->def, pair->ids->p, pair->ids->q, 2 * set, p);
    vplSampleNode(pair->sides, pair->tree, pair->def, pair->ids->q, pair->ids->p, 2 * set + 1, q);
}

// ---- bounds

// The largest cosine at `from` of a direction to `to`; 1 where their spheres meet.
static double cosineBound(const vplLinkNode* from, const vplLinkNode* to)
{
    const vplVec3 way = vplSub(to->centre, from->centre);
    const double distance = (double)vplLength(way), sum = (double)from->radius + (double)to->radius;
    if (distance <= sum) {
        return 1;
    }
    const double sinReach = sum / distance, cosReach = sqrt(1 - sinReach * sinReach);
    const double cosSpread = (double)from->cosSpread, sinSpread = (double)from->sinSpread;
    const double cosAll = cosSpread * cosReach - sinSpread * sinReach;
    const double sinAll = sinSpread * cosReach + cosSpread * sinReach;
    const double cosine = (double)vplDot(way, from->normal) / distance;
    if (sinAll <= 0 || cosine >= cosAll) {
        return 1;
    }
    const double sine = sqrt(cosine * cosine < 1 ? 1 - cosine * cosine : 0);
    const double bound = cosine * cosAll + sine * sinAll;
    return bound > 0 ? bound : 0;
}

// Square metres; 0 where the boxes meet.
static double squareGap(const vplLinkNode* p, const vplLinkNode* q)
{
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double after = (double)vplComponent(q->low, axis) - (double)vplComponent(p->high, axis);
        const double before = (double)vplComponent(p->low, axis) - (double)vplComponent(q->high, axis);
        const double gap = after > before ? after : before;
        square += gap > 0 ? gap * gap : 0;
    }
    return square;
}

// True where nothing of a node is before the plane of a flat one, by more than rounding.
static bool isBehind(const Pair* pair, const vplLinkNode* node, const vplLinkNode* plane)
{
    if (!plane->flat) {
        return false;
    }
    const vplPatchSide* side = &pair->sides->sides[pair->tree->order[plane->first]];
    const vplVec3 n = side->normal, from = side->corners[0];
    float most;
    if (node->count == 1) {
        const vplPatchSide* other = &pair->sides->sides[pair->tree->order[node->first]];
        most = fmaxf(
            vplDot(n, vplSub(other->corners[0], from)),
            fmaxf(vplDot(n, vplSub(other->corners[1], from)), vplDot(n, vplSub(other->corners[2], from))));
    } else {
        const vplVec3 corner = {n.x > 0 ? node->high.x : node->low.x, n.y > 0 ? node->high.y : node->low.y,
                                n.z > 0 ? node->high.z : node->low.z};
        most = vplDot(n, vplSub(corner, from));
    }
    const float largest = fmaxf(fabsf(from.x), fmaxf(fabsf(from.y), fabsf(from.z)));
    return most <= 0x1p-20f * (largest + node->radius + plane->radius);
}

// The larger of both form factors, times the sender's glow, is not above this; infinity where the nodes touch.
static double factorBound(const Pair* pair, double larger)
{
    const double p = cosineBound(pair->p, pair->q), q = cosineBound(pair->q, pair->p);
    const double square = squareGap(pair->p, pair->q);
    return p * q > 0 ? larger * p * q / (VPL_PI * square) : 0;
}

// ---- measured

// What its sides would have to be like to send as much with the mean radiosity.
static double sentArea(const vplLinkNode* node)
{
    return (double)node->area * (double)node->glow;
}

typedef struct Spread {
    double mean;
    double p,
        q; // standard deviations of means: over points of p, each with all of q; and the other way round
    double noise; // standard error of the mean
} Spread;

static Spread spreadOf(const float kernel[VPL_LINK_POINTS][VPL_LINK_POINTS], int n)
{
    double rows[VPL_LINK_POINTS] = {0}, columns[VPL_LINK_POINTS] = {0}, sum = 0, squares = 0;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            const double value = (double)kernel[i][k];
            rows[i] += value / n;
            columns[k] += value / n;
            sum += value;
            squares += value * value;
        }
    }
    Spread s = {.mean = sum / (n * n)};
    for (int i = 0; i < n; i++) {
        s.p += (rows[i] - s.mean) * (rows[i] - s.mean);
        s.q += (columns[i] - s.mean) * (columns[i] - s.mean);
    }
    const double all = squares / (n * n) - s.mean * s.mean;
    s.p = n > 1 ? sqrt(s.p / (n - 1)) : s.mean;
    s.q = n > 1 ? sqrt(s.q / (n - 1)) : s.mean;
    s.noise = sqrt(all > 0 ? all : 0) / n;
    return s;
}

// Errors of both irradiances, as shares of the sender's radiosity, from what either group's extent does.
typedef struct Errors {
    double ofP, ofQ, all;
} Errors;

static Errors errorsOf(const Pair* pair, const Spread* s)
{
    const double areaP = sentArea(pair->p), areaQ = sentArea(pair->q);
    const bool groupP = pair->p->count > 1, groupQ = pair->q->count > 1;
    const double p = groupP ? s->p : 0, q = groupQ ? s->q : 0;
    const double atP = areaQ * (RECEIVED * p + UNEVEN * q), atQ = areaP * (RECEIVED * q + UNEVEN * p);
    const double noise = groupP || groupQ ? NOISE * (areaP > areaQ ? areaP : areaQ) * s->noise : 0;
    const double more = atP > atQ ? atP : atQ;
    return (Errors){.ofP = p * (RECEIVED * areaQ + UNEVEN * areaP),
                    .ofQ = q * (RECEIVED * areaP + UNEVEN * areaQ),
                    .all = more > noise ? more : noise};
}

// ---- division

static vplLinkVerdict divideLarger(const Pair* pair)
{
    const bool p = pair->p->count > 1, q = pair->q->count > 1;
    return !p && !q                                          ? VPL_LINK_NONE
           : !q || (p && pair->p->radius >= pair->q->radius) ? VPL_LINK_DIVIDE_P
                                                             : VPL_LINK_DIVIDE_Q;
}

static vplLinkVerdict divideWorse(const Pair* pair, const Errors* errors)
{
    return errors->ofP > errors->ofQ   ? VPL_LINK_DIVIDE_P
           : errors->ofQ > errors->ofP ? VPL_LINK_DIVIDE_Q
                                       : divideLarger(pair);
}

static vplLinkVerdict divideTurned(const Pair* pair)
{
    const bool p = pair->p->cosSpread < TURNED, q = pair->q->cosSpread < TURNED;
    return p && q ? divideLarger(pair) : p ? VPL_LINK_DIVIDE_P : VPL_LINK_DIVIDE_Q;
}

// Sides as near as this, in radii of the larger, take the integral along their edges, of which rays see a share.
static const float NEAR = 3;

static bool isNear(const Pair* pair)
{
    const float larger = fmaxf(pair->p->radius, pair->q->radius);
    return vplLength(vplSub(pair->q->centre, pair->p->centre)) < NEAR * larger;
}

// The mean of cos cos / (pi r^2) over two sides.
static double exactMean(const Pair* pair)
{
    const vplPatchSide* a = &pair->sides->sides[pair->tree->order[pair->p->first]];
    const vplPatchSide* b = &pair->sides->sides[pair->tree->order[pair->q->first]];
    const double areaA = triangleArea(a), areaB = triangleArea(b);
    return vplTriangleExchange(a->corners, b->corners, &vplEdgesQuick) / (areaA * areaB);
}

static void keep(const Pair* pair, double kernel)
{
    const double area = (double)fmaxf(pair->p->area, pair->q->area);
    pair->answer->verdict = kernel > 0 ? VPL_LINK_KEEP : VPL_LINK_NONE;
    pair->answer->kernel = (float)(kernel * area < 1 ? kernel : 1 / area); // no form factor is above 1 (X095)
}

static void measureSides(const Pair* pair)
{
    const int n = pair->def->samples;
    float kernel[VPL_LINK_POINTS][VPL_LINK_POINTS];
    vplLinkPoints p, q;
    samplePair(pair, 1, &p, &q);
    vplPairPoints(pair->sides, &p, &q, n, kernel);
    const double open = spreadOf(kernel, n).mean;
    if (!(open > 0)) {
        return;
    }
    pair->answer->rays = vplShadowPairs(pair->sides, &p, &q, n, kernel);
    const double seen = spreadOf(kernel, n).mean;
    keep(pair, isNear(pair) ? exactMean(pair) * (seen / open) : seen);
}

// By points and rays.
static void measure(const Pair* pair, double larger, double bound)
{
    vplLinkAnswer* answer = pair->answer;
    const double allowed = pair->def->error;
    const int n = pair->def->samples;
    float kernel[VPL_LINK_POINTS][VPL_LINK_POINTS];
    vplLinkPoints p, q;
    samplePair(pair, 0, &p, &q);
    vplPairPoints(pair->sides, &p, &q, n, kernel);
    const Spread open = spreadOf(kernel, n);
    const Errors before = errorsOf(pair, &open);
    const double peak = PEAK * (bound - larger * open.mean);
    const bool rough = before.all > allowed || peak > allowed;
    if (!(open.mean > 0)) {
        answer->verdict = bound <= allowed ? VPL_LINK_NONE : divideLarger(pair);
        return;
    }
    if (answer->seen && rough) {
        answer->verdict = before.all > allowed ? divideWorse(pair, &before) : divideLarger(pair);
        return;
    }
    // Others than those that said it is smooth: from these, links that miss a peak would be kept, and light be lost.
    samplePair(pair, 1, &p, &q);
    vplPairPoints(pair->sides, &p, &q, n, kernel);
    answer->rays = vplShadowPairs(pair->sides, &p, &q, n, kernel);
    const Spread seen = spreadOf(kernel, n);
    answer->seen = seen.mean > 0;
    if (!answer->seen) {
        answer->verdict = larger * open.mean <= HIDDEN * allowed ? VPL_LINK_NONE : divideLarger(pair);
        return;
    }
    const Errors errors = errorsOf(pair, &seen);
    if (errors.all > allowed) {
        answer->verdict = divideWorse(pair, &errors);
    } else if (rough) {
        answer->verdict = divideLarger(pair);
    } else {
        keep(pair, seen.mean);
    }
}

vplLinkAnswer vplJudgePair(const vplPatchSides* sides, const struct vplLinkTree* tree, const vplLinkDef* def,
                           const vplLinkPair* pair)
{
    vplLinkAnswer answer = {.verdict = VPL_LINK_NONE, .seen = pair->seen};
    const Pair work = {.sides = sides,
                       .tree = tree,
                       .def = def,
                       .ids = pair,
                       .p = &tree->nodes[pair->p],
                       .q = &tree->nodes[pair->q],
                       .answer = &answer};
    if (isBehind(&work, work.p, work.q) || isBehind(&work, work.q, work.p)) {
        return answer;
    }
    const double larger = fmax(sentArea(work.p), sentArea(work.q));
    const double bound = factorBound(&work, larger);
    const bool leaves = work.p->count == 1 && work.q->count == 1;
    const bool turned = work.p->cosSpread < TURNED || work.q->cosSpread < TURNED;
    if (!(bound > 0)) {
        return answer;
    }
    if (leaves) {
        measureSides(&work);
    } else if (isinf(bound)) {
        answer.verdict = divideLarger(&work);
    } else if (turned && bound > TINY * def->error) {
        answer.verdict = divideTurned(&work);
    } else {
        measure(&work, larger, bound);
    }
    return answer;
}
