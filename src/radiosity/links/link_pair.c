// SPDX-License-Identifier: MIT
// Decides whether one link may stand for the exchange of two groups, and how much it carries.
// Based on: Hanrahan, Salzman and Aupperle, A Rapid Hierarchical Radiosity Algorithm, SIGGRAPH 1991. Departs:
// the error of a link is not bounded by its size but measured, as the spread of cos cos V / (pi r^2) between
// points of either group.
#include "math/vec.h"
#include "radiosity/factors/analytic.h"
#include "radiosity/links/links.h"

#include <math.h>

// Groups whose normals are farther from their mean than this cosine, 26 degrees, are divided unless the link
// is tiny, since all their sides would receive the same.
static const float TURNED = 0.9f;

// Form factors up to this fraction of the allowed error are tiny.
static const double TINY = 0.25;

// Groups between which all rays are blocked exchange nothing if their unoccluded form factor is below this
// multiple of the allowed error. With 8, rows of a closed room sum to 0.989 before they are corrected, with 2
// to 0.994 (bench/links).
static const double HIDDEN = 4;

// The fraction of a pair's bound, beyond the estimate, that counts as an error, since points miss peaks. With
// 0 there are 0.7 times as many links, whose error is 1.1 times as large (bench/links).
static const double PEAK = 0.05;

// The pair that is judged.
typedef struct Pair {
    const vplLinkWork* work;
    const vplLinkPair* ids;
    const vplLinkNode *p, *q;
    double sent; // the larger area, weighted by brightness, m^2
    vplLinkAnswer* answer;
} Pair;

// The area that would send as much at the mean radiosity.
static double sentArea(const vplLinkNode* node)
{
    return (double)node->area * (double)node->brightness;
}

// The only side of a node, or the first of a group.
static const vplPatchSide* firstSide(const Pair* pair, const vplLinkNode* node)
{
    return &pair->work->sides->sides[pair->work->tree->order[node->first]];
}

static double triangleArea(const vplPatchSide* side)
{
    const vplVec3* c = side->corners;
    const float twice = (float)vplCrossLength(vplCross(vplSub(c[1], c[0]), vplSub(c[2], c[0])));
    return 0.5 * (double)twice;
}

// ---- bounds

// An upper bound of the cosine at `from` towards `to`; 1 where their spheres intersect.
static double cosineBound(const vplLinkNode* from, const vplLinkNode* to)
{
    const vplVec3 way = vplSub(to->centre, from->centre);
    const double distance = (double)vplLength(way), sum = (double)from->radius + (double)to->radius;
    if (distance <= sum) {
        return 1;
    }
    const double sinSize = sum / distance, cosSize = sqrt(1 - sinSize * sinSize);
    const double cosSpread = (double)from->cosSpread, sinSpread = (double)from->sinSpread;
    const double cosAll = cosSpread * cosSize - sinSpread * sinSize;
    const double sinAll = sinSpread * cosSize + cosSpread * sinSize;
    const double cosine = (double)vplDot(way, from->normal) / distance;
    if (sinAll <= 0 || cosine >= cosAll) {
        return 1;
    }
    const double sine = sqrt(cosine * cosine < 1 ? 1 - cosine * cosine : 0);
    const double bound = cosine * cosAll + sine * sinAll;
    return bound > 0 ? bound : 0;
}

// The squared distance of two bounding boxes, m^2; 0 where they intersect.
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

// Tests whether a node lies behind the plane of a flat one, or in it, up to rounding.
static bool isBehind(const Pair* pair, const vplLinkNode* node, const vplLinkNode* plane)
{
    if (!plane->flat) {
        return false;
    }
    const vplVec3 n = firstSide(pair, plane)->normal, from = firstSide(pair, plane)->corners[0];
    float most = -INFINITY;
    if (node->count == 1 && !node->group) {
        for (int k = 0; k < 3; k++) {
            most = fmaxf(most, vplDot(n, vplSub(firstSide(pair, node)->corners[k], from)));
        }
    } else {
        const vplVec3 corner = {n.x > 0 ? node->high.x : node->low.x, n.y > 0 ? node->high.y : node->low.y,
                                n.z > 0 ? node->high.z : node->low.z};
        most = vplDot(n, vplSub(corner, from));
    }
    const float largest = vplLargestOf(from);
    return most <= 0x1p-20f * (largest + node->radius + plane->radius);
}

// An upper bound of both form factors, times the sender's brightness; infinity where the nodes touch.
static double factorBound(const Pair* pair)
{
    const double p = cosineBound(pair->p, pair->q), q = cosineBound(pair->q, pair->p);
    const double square = squareGap(pair->p, pair->q);
    return p * q > 0 ? pair->sent * p * q / (VPL_PI * square) : 0;
}

// ---- measured

typedef struct Spread {
    double mean;
    double p; // standard deviation over points of p of the mean over points of q
    double q; // and the other way round
} Spread;

static Spread spreadOf(const vplLinkTerms* terms)
{
    const int n = terms->count;
    double rows[VPL_LINK_POINTS] = {0}, columns[VPL_LINK_POINTS] = {0}, sum = 0;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            const double value = (double)terms->of[i][k];
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

// ---- division

static vplLinkVerdict divideLarger(const Pair* pair)
{
    const bool p = pair->p->count > 1, q = pair->q->count > 1; // not both are single sides
    return !q || (p && pair->p->radius >= pair->q->radius) ? VPL_LINK_DIVIDE_P : VPL_LINK_DIVIDE_Q;
}

static vplLinkVerdict divideWorse(const Pair* pair, double errorP, double errorQ)
{
    return errorP > errorQ ? VPL_LINK_DIVIDE_P : errorQ > errorP ? VPL_LINK_DIVIDE_Q : divideLarger(pair);
}

static bool isTurned(const vplLinkNode* node)
{
    return node->cosTurn < TURNED;
}

static vplLinkVerdict divideTurned(const Pair* pair)
{
    const bool p = isTurned(pair->p), q = isTurned(pair->q);
    return p && q ? divideLarger(pair) : p ? VPL_LINK_DIVIDE_P : VPL_LINK_DIVIDE_Q;
}

// Sides whose centres are less than this many times the larger radius apart use the contour integral, times
// the visible fraction.
static const float NEAR = 3;

// Points on either of two near sides if one is of a group.
enum { NEAR_POINTS = 8 };

static bool isNear(const Pair* pair)
{
    const float larger = fmaxf(pair->p->radius, pair->q->radius);
    return vplLength(vplSub(pair->q->centre, pair->p->centre)) < NEAR * larger;
}

// The unoccluded mean of cos cos / (pi r^2) over two sides, by the contour integral.
static double exactMean(const Pair* pair)
{
    const vplPatchSide *a = firstSide(pair, pair->p), *b = firstSide(pair, pair->q);
    return vplTriangleExchange(a->corners, b->corners, &vplEdgesQuick) / (triangleArea(a) * triangleArea(b));
}

static void keep(const Pair* pair, double mean)
{
    const double area = (double)fmaxf(pair->p->area, pair->q->area);
    pair->answer->verdict = mean > 0 ? VPL_LINK_KEEP : VPL_LINK_NONE;
    pair->answer->mean = (float)(mean * area < 1 ? mean : 1 / area); // no form factor is above 1
}

// Points on either node. A group of triangles beside another has no integral, and 1 / r^2 varies much between the two.
static int pointsOf(const Pair* pair)
{
    return (pair->p->group || pair->q->group) && isNear(pair) ? NEAR_POINTS : VPL_JUDGE_POINTS;
}

// The unoccluded mean of cos cos / (pi r^2) over points that are drawn for this pair alone: a link is kept if
// the judging points miss peaks, so those would underestimate it. *visibleOut: the fraction of the mean that
// rays find visible.
static double measureMean(const Pair* pair, double* visibleOut)
{
    vplLinkTerms terms;
    vplLinkPoint p[VPL_LINK_POINTS], q[VPL_LINK_POINTS];
    terms.count = pointsOf(pair);
    while (terms.count * terms.count < pair->work->def->samples) {
        terms.count++;
    }
    vplSampleNode(pair->work, pair->ids->p, pair->ids->q, terms.count, p);
    vplSampleNode(pair->work, pair->ids->q, pair->ids->p, terms.count, q);
    vplFindLinkTerms(pair->work, p, q, &terms);
    *visibleOut = vplVisibleFraction(pair->work, p, q, &terms, &pair->answer->rays);
    return spreadOf(&terms).mean;
}

static void measureSides(const Pair* pair)
{
    double visible;
    const double open = measureMean(pair, &visible);
    // Neighbours on a curved surface are near, but exchange next to nothing.
    const bool exact = !pair->p->group && !pair->q->group && isNear(pair) &&
                       pair->sent * open > TINY * pair->work->def->error;
    keep(pair, visible * (exact ? exactMean(pair) : open));
}

// Decides about groups by points and rays.
static void measureGroups(const Pair* pair, double bound)
{
    vplLinkAnswer* answer = pair->answer;
    const double allowed = pair->work->def->error;
    const vplLinkPoint *p = pair->work->points[pair->ids->p], *q = pair->work->points[pair->ids->q];
    vplLinkTerms terms;
    terms.count = VPL_JUDGE_POINTS;
    vplFindLinkTerms(pair->work, p, q, &terms);
    const Spread open = spreadOf(&terms);
    // Errors of irradiance, as fractions of the mean radiosity, caused by the extent of either group:
    // irradiance varies over a receiving group, and radiosity may vary over a sending one.
    const double errorP = pair->p->count > 1 ? pair->sent * open.p : 0,
                 errorQ = pair->q->count > 1 ? pair->sent * open.q : 0;
    const bool rough = errorP + errorQ > allowed || PEAK * (bound - pair->sent * open.mean) > allowed;
    if (!(open.mean > 0)) {
        answer->verdict = bound <= allowed ? VPL_LINK_NONE : divideLarger(pair);
        return;
    }
    if (answer->visible && rough) {
        answer->verdict = divideWorse(pair, errorP, errorQ);
        return;
    }
    double visible;
    const double mean = measureMean(pair, &visible);
    answer->visible = visible > 0;
    if (!answer->visible && pair->sent * open.mean <= HIDDEN * allowed) {
        answer->verdict = VPL_LINK_NONE;
    } else if (rough || pair->sent * mean * sqrt(visible * (1 - visible)) > allowed) {
        answer->verdict = divideWorse(pair, errorP, errorQ);
    } else {
        keep(pair, mean * visible);
    }
}

vplLinkAnswer vplJudgePair(const vplLinkWork* work, const vplLinkPair* ids)
{
    vplLinkAnswer answer = {.verdict = VPL_LINK_NONE, .visible = ids->visible};
    const vplLinkNode *p = &work->tree->nodes[ids->p], *q = &work->tree->nodes[ids->q];
    const Pair pair = {
        .work = work, .ids = ids, .p = p, .q = q, .sent = fmax(sentArea(p), sentArea(q)), .answer = &answer};
    if (isBehind(&pair, p, q) || isBehind(&pair, q, p)) {
        return answer;
    }
    const double bound = factorBound(&pair);
    const bool turned = isTurned(p) || isTurned(q);
    if (!(bound > 0)) {
        return answer;
    }
    if (p->count == 1 && q->count == 1) {
        measureSides(&pair);
    } else if (isinf(bound)) {
        answer.verdict = divideLarger(&pair);
    } else if (turned && bound > TINY * work->def->error) {
        answer.verdict = divideTurned(&pair);
    } else {
        measureGroups(&pair, bound);
    }
    return answer;
}
