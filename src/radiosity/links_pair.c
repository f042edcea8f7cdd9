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
#include <string.h>

// Groups whose normals are further from their mean than this are divided, whatever the spread, unless the link is tiny:
// all their sides would receive the same. 26 degrees.
static const float TURNED = 0.9f;

// Of the allowed error: form factors up to this are tiny.
static const double TINY = 0.25;

// Of the allowed error: groups of which no ray reaches the other exchange nothing if they would exchange less than this
// with nothing between them. With 8 a closed room's rows sum to 0.989 before they are fitted, with 2 to 0.994 (at 0.003).
static const double HIDDEN = 4;

// How much of what a pair may exchange at most, above what its points say, counts as an error: points miss peaks. 0:
// 1.1 times the difference to all pairs, with 0.7 of the links (closed-room, 3,136 patches, error 0.01).
static const double PEAK = 0.05;

// A pair at work.
typedef struct Pair {
    const vplPatchSides* sides;
    const struct vplLinkTree* tree;
    const vplLinkDef* def;
    const vplLinkPair* ids;
    const vplLinkNode *p, *q;
    double sent; // the larger of what their areas send with the mean radiosity, m^2
    vplLinkAnswer* answer;
} Pair;

// As much area of the mean radiosity sends as much.
static double sentArea(const vplLinkNode* node)
{
    return (double)node->area * (double)node->glow;
}

static double triangleArea(const vplPatchSide* side)
{
    const vplVec3* c = side->corners;
    return 0.5 * (double)vplLength(vplCross(vplSub(c[1], c[0]), vplSub(c[2], c[0])));
}

static void readPoints(const vplNodePoints* from, vplLinkPoints* to)
{
    to->count = VPL_JUDGE_POINTS;
    memcpy(to->at, from->at, sizeof from->at);
    memcpy(to->side, from->side, sizeof from->side);
}

// The pair's own points, which measure: of those that judge, those of links that are kept miss peaks, and so light.
static void drawPoints(const Pair* pair, vplLinkPoints* p, vplLinkPoints* q)
{
    int count = VPL_JUDGE_POINTS;
    while (count * count < pair->def->samples) {
        count++;
    }
    vplSampleNode(pair->sides, pair->tree, pair->def->seed, pair->ids->p, pair->ids->q, count, p);
    vplSampleNode(pair->sides, pair->tree, pair->def->seed, pair->ids->q, pair->ids->p, count, q);
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
static double factorBound(const Pair* pair)
{
    const double p = cosineBound(pair->p, pair->q), q = cosineBound(pair->q, pair->p);
    const double square = squareGap(pair->p, pair->q);
    return p * q > 0 ? pair->sent * p * q / (VPL_PI * square) : 0;
}

// ---- measured

typedef struct Spread {
    double mean;
    double p,
        q; // standard deviations of means: over points of p, each with all of q; and the other way round
} Spread;

static Spread spreadOf(const vplLinkKernel* kernel)
{
    const int n = kernel->count;
    double rows[VPL_LINK_POINTS] = {0}, columns[VPL_LINK_POINTS] = {0}, sum = 0;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            const double value = (double)kernel->of[i][k];
            rows[i] += value / n;
            columns[k] += value / n;
            sum += value;
        }
    }
    Spread s = {.mean = sum / (n * n)};
    for (int i = 0; i < n; i++) {
        s.p += (rows[i] - s.mean) * (rows[i] - s.mean) / (n - 1);
        s.q += (columns[i] - s.mean) * (columns[i] - s.mean) / (n - 1);
    }
    s.p = sqrt(s.p);
    s.q = sqrt(s.q);
    return s;
}

// Errors of irradiance, as shares of the mean radiosity, from what either group's extent does. What is received differs
// over a group that receives; and over one that sends, what it sends may.
typedef struct Errors {
    double ofP, ofQ, all;
} Errors;

static Errors errorsOf(const Pair* pair, const Spread* s)
{
    const double p = pair->p->count > 1 ? pair->sent * s->p : 0;
    const double q = pair->q->count > 1 ? pair->sent * s->q : 0;
    return (Errors){.ofP = p, .ofQ = q, .all = p + q};
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

// The share of its kernel that rays see. The first pairs of points are tested: each point once, then each once more.
static double seenShare(const Pair* pair, const vplLinkPoints* p, const vplLinkPoints* q,
                        const vplLinkKernel* kernel)
{
    return vplSeeShare(pair->sides, p, q, kernel, pair->def->samples, &pair->answer->rays);
}

static void measureSides(const Pair* pair)
{
    vplLinkKernel kernel;
    vplLinkPoints p, q;
    drawPoints(pair, &p, &q);
    vplPairPoints(pair->sides, &p, &q, &kernel);
    const double open = spreadOf(&kernel).mean, seen = seenShare(pair, &p, &q, &kernel);
    // Neighbours on a curved surface are near, and exchange next to nothing.
    const bool exact = isNear(pair) && pair->sent * open > TINY * pair->def->error;
    keep(pair, seen * (exact ? exactMean(pair) : open));
}

// By points and rays.
static void measure(const Pair* pair, double bound)
{
    vplLinkAnswer* answer = pair->answer;
    const double allowed = pair->def->error;
    vplLinkKernel kernel;
    vplLinkPoints p, q;
    readPoints(&pair->tree->points[pair->ids->p], &p);
    readPoints(&pair->tree->points[pair->ids->q], &q);
    vplPairPoints(pair->sides, &p, &q, &kernel);
    const Spread open = spreadOf(&kernel);
    const Errors errors = errorsOf(pair, &open);
    const bool rough = errors.all > allowed || PEAK * (bound - pair->sent * open.mean) > allowed;
    if (!(open.mean > 0)) {
        answer->verdict = bound <= allowed ? VPL_LINK_NONE : divideLarger(pair);
        return;
    }
    if (answer->seen && rough) {
        answer->verdict = divideWorse(pair, &errors);
        return;
    }
    drawPoints(pair, &p, &q);
    vplPairPoints(pair->sides, &p, &q, &kernel);
    const double mean = spreadOf(&kernel).mean, share = seenShare(pair, &p, &q, &kernel);
    answer->seen = share > 0;
    if (!answer->seen && pair->sent * open.mean <= HIDDEN * allowed) {
        answer->verdict = VPL_LINK_NONE;
    } else if (rough || pair->sent * mean * sqrt(share * (1 - share)) > allowed) {
        answer->verdict = divideWorse(pair, &errors);
    } else {
        keep(pair, mean * share);
    }
}

vplLinkAnswer vplJudgePair(const vplPatchSides* sides, const struct vplLinkTree* tree, const vplLinkDef* def,
                           const vplLinkPair* pair)
{
    vplLinkAnswer answer = {.verdict = VPL_LINK_NONE, .seen = pair->seen};
    Pair work = {.sides = sides,
                 .tree = tree,
                 .def = def,
                 .ids = pair,
                 .p = &tree->nodes[pair->p],
                 .q = &tree->nodes[pair->q],
                 .answer = &answer};
    work.sent = fmax(sentArea(work.p), sentArea(work.q));
    if (isBehind(&work, work.p, work.q) || isBehind(&work, work.q, work.p)) {
        return answer;
    }
    const double bound = factorBound(&work);
    const bool turned = work.p->cosSpread < TURNED || work.q->cosSpread < TURNED;
    if (!(bound > 0)) {
        return answer;
    }
    if (work.p->count == 1 && work.q->count == 1) {
        measureSides(&work);
    } else if (isinf(bound)) {
        answer.verdict = divideLarger(&work);
    } else if (turned && bound > TINY * def->error) {
        answer.verdict = divideTurned(&work);
    } else {
        measure(&work, bound);
    }
    return answer;
}
