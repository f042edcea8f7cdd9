// SPDX-License-Identifier: MIT
// Decides whether one link may stand for the exchange of two groups, and how much it carries.
// Based on: Hanrahan, Salzman and Aupperle, A Rapid Hierarchical Radiosity Algorithm, SIGGRAPH 1991. Departs:
// a link stands for a linear function of the place on either group, fitted to cos cos V / (pi r^2) between their
// points, and its error is not bounded by its size but measured, as the distance of the points from the fit.
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/factors/form_factors.h"
#include "radiosity/factors/shaft.h"
#include "radiosity/links/links.h"

#include <math.h>

// Groups whose normals are farther from their mean than this cosine, 26 degrees, are divided unless the link
// is tiny, since all their sides would receive the same.
static const float TURNED = 0.9f;

// Form factors up to this fraction of the allowed error are tiny.
static const double TINY = 0.25;

// A pair of groups of which all rays are blocked counts as hidden after so many, for each time that its unoccluded
// form factor is the allowed error.
static const double HIDING_RAYS = 16;

// The same where rows are scaled to what rays find, and so are not darker for what the test misses: fewer, or two for
// each pair of sides, of which each would cast four. Elsewhere, a room that is lit through a door ajar would lose a
// twentieth of its light.
static const double FEWER_HIDING_RAYS = 4, HIDING_RAYS_OF_SIDES = 2;

// There, pairs of groups of at least so many sides are tested for being hidden even if their parents are not.
static const double MANY_PAIRS = 16;

// The fraction of a pair's bound, beyond the estimate, that counts as an error, since points miss peaks.
static const double PEAK = 0.05;

// The error that is allowed to a link that something blocks in part, as a fraction of that of others: errors of
// shadows have the same sign over many links. Without, a dark room behind a door ajar errs 2.3 times as much.
static const double SHADOWED = 0.5;

// A link is blocked in part if rays let through less than this fraction.
static const double OPEN = 0.98;

// Up to so many sides a link may err by as much as is asked for; beyond by less, as one over the root of their number.
enum { MANY_SIDES = 4000 };

// Where patches are groups of triangles, links may err by so many times what is asked for: their relmse in Sponza,
// Sibenik and Conference is that of all pairs, with a quarter or eight times the error as well.
static const double GROUPED = 4;

// The first rays of a pair of groups: one packet.
enum { FEW_RAYS = VPL_RAY_PACKET };

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

// The error of patches falls with their number, and that of links must fall with it; groups of triangles err by more.
double vplAllowedLinkError(const vplPatchSides* sides, const vplLinkDef* def)
{
    if (sides->patches->groupCount > 0) {
        return GROUPED * def->error;
    }
    return sides->count > MANY_SIDES ? def->error * sqrt((double)MANY_SIDES / sides->count) : def->error;
}

// Rows are scaled to the share of light that rays find (link_rows.c).
static bool isScaled(const Pair* pair)
{
    return pair->work->sides->patches->groupCount > 0 && pair->work->def->rowSums == VPL_ROW_SUMS_USUAL;
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

// The exchange of two nodes as a linear function, and its error.
typedef struct Measure {
    double mean, p[3], q[3]; // as in vplLinkFit
    double errorP, errorQ;   // standard deviation of means over q at points of p, and the other way round
} Measure;

// Fits a linear function to values at points. Returns the standard deviation from it.
static double fitValues(const vplLinkPoints* points, const float values[VPL_LINK_POINTS], double* mean,
                        double slope[3])
{
    double squares = 0;
    *mean = slope[0] = slope[1] = slope[2] = 0;
    for (int i = 0; i < VPL_LINK_POINTS; i++) {
        const double value = (double)values[i];
        *mean += (double)points->weight[i] * value;
        for (int axis = 0; axis < 3; axis++) {
            slope[axis] += (double)points->slope[axis][i] * value;
        }
    }
    for (int i = 0; i < VPL_LINK_POINTS; i++) {
        double off = (double)values[i] - *mean;
        for (int axis = 0; axis < 3; axis++) {
            off -= slope[axis] * (double)points->place[axis][i];
        }
        squares += off * off;
    }
    return sqrt(squares / (VPL_LINK_POINTS - 3)); // three values of eight are fitted on a plane
}

static Measure measureOf(const Pair* pair, const vplLinkTerms* terms)
{
    const vplLinkPoints* points = pair->work->points;
    Measure m;
    double there, back;
    m.errorP = fitValues(&points[pair->ids->p], terms->rows, &there, m.p);
    m.errorQ = fitValues(&points[pair->ids->q], terms->columns, &back, m.q);
    m.mean = 0.5 * (there + back);
    return m;
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

static bool isNear(const Pair* pair)
{
    const float larger = fmaxf(pair->p->radius, pair->q->radius);
    return vplLength(vplSub(pair->q->centre, pair->p->centre)) < NEAR * larger;
}

// How far a function with this slope falls from the middle of a node to any of its sides.
static double fallOver(const vplLinkNode* node, const double slope[3])
{
    double fall = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double a = slope[axis] * (double)vplComponent(node->least, axis),
                     b = slope[axis] * (double)vplComponent(node->most, axis);
        fall -= a < b ? a : b;
    }
    return fall;
}

// Slopes of a group stay, those of a side, which has one value, do not. Slopes are lowered where the function
// would be negative at some pair of sides.
static void keep(const Pair* pair, const Measure* m)
{
    const double area = (double)fmaxf(pair->p->area, pair->q->area);
    const double mean = m->mean * area < 1 ? m->mean : 1 / area; // no form factor is above 1
    pair->answer->verdict = mean > 0 ? VPL_LINK_KEEP : VPL_LINK_NONE;
    pair->answer->fit.mean = (float)(area * mean);
    const vplLinkNode* nodes[2] = {pair->p, pair->q};
    const double* slopes[2] = {m->p, m->q};
    double fall = 0;
    for (int k = 0; k < 2; k++) {
        fall += nodes[k]->count > 1 ? fallOver(nodes[k], slopes[k]) : 0;
    }
    const double scale = area * (fall > mean ? mean / fall : 1);
    for (int axis = 0; axis < 3; axis++) {
        pair->answer->fit.p[axis] = pair->p->count > 1 ? (float)(scale * m->p[axis]) : 0;
        pair->answer->fit.q[axis] = pair->q->count > 1 ? (float)(scale * m->q[axis]) : 0;
    }
}

// A number that looks random.
static unsigned startOf(int32_t p, int32_t q)
{
    const uint32_t mixed = ((uint32_t)p * 0x9e3779b1u ^ (uint32_t)q * 0x85ebca77u) * 0xc2b2ae3du;
    return mixed >> 26;
}

static vplShaftEnd endOf(const Pair* pair, const vplLinkNode* node)
{
    const vplPatchSide* side = firstSide(pair, node);
    return (vplShaftEnd){.low = {node->low.x, node->low.y, node->low.z},
                         .high = {node->high.x, node->high.y, node->high.z},
                         .flat = node->flat,
                         .normal = side->normal,
                         .at = side->corners[0]};
}

// Tests whether nothing is between the nodes, and remembers it for their parts.
static bool isClear(const Pair* pair)
{
    if (!pair->answer->clear) {
        const vplShaftEnd p = endOf(pair, pair->p), q = endOf(pair, pair->q);
        const float largest = fmaxf(fmaxf(vplLargestOf(pair->p->low), vplLargestOf(pair->p->high)),
                                    fmaxf(vplLargestOf(pair->q->low), vplLargestOf(pair->q->high)));
        pair->answer->clear = vplShaft_IsClear(pair->work->sides->patches->geometry, &p, &q,
                                               largest * 0x1p-21f, &pair->answer->blocker);
    }
    return pair->answer->clear;
}

// Casts rays number `from` to `to` - 1.
static void cast(const Pair* pair, const vplLinkTerms* terms, int from, int to, vplLinkSeen* seen)
{
    const vplLinkSight sight = {.p = &pair->work->points[pair->ids->p],
                                .q = &pair->work->points[pair->ids->q],
                                .terms = terms,
                                .start = startOf(pair->ids->p, pair->ids->q),
                                .from = from,
                                .to = to};
    vplCastLinkRays(pair->work, &sight, seen, &pair->answer->rays);
}

static void measureSides(const Pair* pair, const vplLinkTerms* terms)
{
    vplLinkSeen seen = {.open = 0};
    const bool clear = pair->answer->clear; // a search would take longer than the rays
    cast(pair, terms, 0, clear ? 0 : vplMini(pair->work->def->samples, VPL_MOST_LINK_RAYS), &seen);
    Measure m = measureOf(pair, terms);
    // Neighbours on a curved surface are near, but exchange next to nothing.
    if (!pair->p->group && !pair->q->group && isNear(pair) &&
        pair->sent * m.mean > TINY * pair->work->allowed) {
        m.mean = (double)vplSideExchange(firstSide(pair, pair->p), firstSide(pair, pair->q));
    }
    m.mean *= clear ? 1 : seen.open > 0 ? seen.visible / seen.open : 0;
    keep(pair, &m);
}

// Errors of irradiance, as fractions of the mean radiosity, caused by the extent of either group: irradiance
// varies over a receiving group, and radiosity may vary over a sending one.
static void findErrors(const Pair* pair, Measure* m)
{
    m->errorP *= pair->p->count > 1 ? pair->sent : 0;
    m->errorQ *= pair->q->count > 1 ? pair->sent : 0;
}

// ---- what is between groups

static double pairsOfSides(const Pair* pair)
{
    return (double)pair->p->count * (double)pair->q->count;
}

// The rays after which a pair counts as hidden if all were blocked.
static double raysToHide(const Pair* pair, double open)
{
    const double times = open / pair->work->allowed;
    return isScaled(pair) ? fmin(FEWER_HIDING_RAYS * times, HIDING_RAYS_OF_SIDES * pairsOfSides(pair))
                          : HIDING_RAYS * times;
}

// The error of a pair of groups that comes from chance alone, with all rays, where these let through a fraction `v`:
// each point casts some of them.
static double chanceError(double open, double v)
{
    return 2 * open * sqrt(v * (1 - v) * VPL_LINK_POINTS / VPL_MOST_LINK_RAYS);
}

// What was found between two groups.
typedef enum Sight {
    CLEAR,   // nothing
    HIDDEN,  // something everywhere
    BLOCKED, // something, which `seen` knows
    DIVIDED  // there are not enough rays to tell, for such a pair
} Sight;

// The first rays, and more while all are blocked and the pair does not count as hidden. A search of what is in the way
// follows only if these find nothing. Returns the number of rays.
static int lookBetween(const Pair* pair, const vplLinkTerms* terms, double hide, vplLinkSeen* seen)
{
    cast(pair, terms, 0, FEW_RAYS, seen);
    int rays = FEW_RAYS;
    for (; rays < VPL_MOST_LINK_RAYS && !(seen->visible > 0) && (rays < hide || !(seen->open > 0));
         rays += FEW_RAYS) {
        cast(pair, terms, rays, rays + FEW_RAYS, seen);
    }
    return rays;
}

// Finds what is between two groups. A rough pair will be divided, and needs no more rays than tell whether it is hidden.
static Sight findBetween(const Pair* pair, const vplLinkTerms* terms, bool rough, double open,
                         vplLinkSeen* seen)
{
    vplLinkAnswer* answer = pair->answer;
    const double allowed = pair->work->allowed, hide = raysToHide(pair, open);
    if (answer->clear || (rough && hide > VPL_MOST_LINK_RAYS)) {
        answer->visible = isClear(pair);
        return answer->visible ? CLEAR : DIVIDED;
    }
    const int rays = lookBetween(pair, terms, hide, seen);
    answer->visible = seen->visible > 0;
    if (answer->visible && seen->visible == seen->open && isClear(pair)) {
        return CLEAR;
    }
    if (!answer->visible) {
        return HIDDEN;
    }
    const double v = seen->visible / seen->open;
    if (rough || (isScaled(pair) && v < OPEN && chanceError(open, v) > SHADOWED * allowed)) {
        return DIVIDED;
    }
    const int wanted = isScaled(pair) ? FEW_RAYS * (int)fmin(ceil(open / allowed), 4) : VPL_MOST_LINK_RAYS;
    cast(pair, terms, rays, open > allowed ? wanted : rays, seen);
    return BLOCKED;
}

// Decides about groups by points and rays.
static void measureGroups(const Pair* pair, double bound, vplLinkTerms* terms)
{
    vplLinkAnswer* answer = pair->answer;
    const double allowed = pair->work->allowed;
    Measure m = measureOf(pair, terms);
    findErrors(pair, &m);
    const double open = pair->sent * m.mean;
    const bool rough = m.errorP + m.errorQ > allowed || PEAK * (bound - open) > allowed;
    if (!(open > 0)) {
        answer->verdict = bound <= TINY * allowed ? VPL_LINK_NONE : divideLarger(pair);
        return;
    }
    vplLinkSeen seen = {.open = 0};
    const bool look = !answer->visible || !rough || (isScaled(pair) && pairsOfSides(pair) >= MANY_PAIRS);
    const Sight sight = look ? findBetween(pair, terms, rough, open, &seen) : DIVIDED;
    if (sight == BLOCKED && seen.visible < seen.open) {
        vplDarkenTerms(&seen, terms);
        m = measureOf(pair, terms);
        findErrors(pair, &m);
    }
    const double limit = pair->sent * m.mean < OPEN * open ? SHADOWED * allowed : allowed;
    if (sight == HIDDEN) {
        answer->verdict = VPL_LINK_NONE;
    } else if (rough || sight == DIVIDED || m.errorP + m.errorQ > limit) {
        answer->verdict = divideWorse(pair, m.errorP, m.errorQ);
    } else {
        keep(pair, &m);
    }
}

vplLinkAnswer vplJudgePair(const vplLinkWork* work, const vplLinkPair* ids)
{
    vplLinkAnswer answer = {
        .verdict = VPL_LINK_NONE, .visible = ids->visible, .clear = ids->clear, .blocker = ids->blocker};
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
    const bool single = p->count == 1 && q->count == 1;
    if (!single && isinf(bound)) {
        answer.verdict = divideLarger(&pair);
        return answer;
    }
    if (!single && turned && bound > TINY * work->allowed) {
        answer.verdict = divideTurned(&pair);
        return answer;
    }
    vplLinkTerms terms;
    vplGetRadiosityKernels(work->sides->context->isa)
        ->linkTerms(&work->points[ids->p], &work->points[ids->q], &terms);
    if (single) {
        measureSides(&pair, &terms);
    } else {
        measureGroups(&pair, bound, &terms);
    }
    return answer;
}
