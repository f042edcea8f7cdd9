// SPDX-License-Identifier: MIT
// Decides whether one link may stand for the exchange of two groups, and how much it carries.
// Based on: Hanrahan, Salzman and Aupperle, A Rapid Hierarchical Radiosity Algorithm, SIGGRAPH 1991. Departs:
// a link stands for a linear function of the place on either group, fitted to cos cos V / (pi r^2) between their
// points, and its error is not bounded by its size but measured, as the distance of the points from the fit.
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/factors/form_factors.h"
#include "radiosity/links/link_pair.h"

#include <math.h>

// Groups whose normals are farther from their mean than this cosine, 26 degrees, are divided unless the link
// is tiny, since all their sides would receive the same.
static const float TURNED = 0.9f;

// Form factors up to this fraction of the allowed error are tiny.
static const double TINY = 0.25;

// Where rows are scaled, pairs of groups of at least so many pairs of sides are tested for being hidden even if their
// parents are not.
static const double MANY_PAIRS = 16;

// The fraction of a pair's bound, beyond the estimate, that counts as an error, since points miss peaks.
static const double PEAK = 0.05;

// Each dim side casts about RAYS_OF_DIM_SIDE rays to search for light from sides that are not dim; all together at most MOST_DIM_RAYS.
static const double RAYS_OF_DIM_SIDE = 16384, MOST_DIM_RAYS = 0x1p26;

// If at most this fraction of the rays between a dim group and a brighter one is unoccluded, the opening between them is small.
static const double SMALL_OPENING = 0.25;

// Up to so many sides a link may err by as much as is asked for; beyond by less, as one over the root of their number.
enum { MANY_SIDES = 4000 };

// Where patches are groups of triangles, links may err by so many times what is asked for: their relmse in Sponza,
// Sibenik and Conference is that of all pairs to 2 %. With eight times it was to 5 %.
static const double GROUPED = 4;

// The area that would send as much at the mean radiosity.
static double sentArea(const vplLinkNode* node)
{
    return (double)node->area * (double)node->brightness;
}

// The error of patches falls with their number, and that of links must fall with it; groups of triangles err by more.
static double allowedError(const vplPatchSides* sides, const vplLinkDef* def)
{
    if (sides->patches->groupCount > 0) {
        return GROUPED * def->error;
    }
    return sides->count > MANY_SIDES ? def->error * sqrt((double)MANY_SIDES / sides->count) : def->error;
}

vplLinkWork vplLinkWork_Make(const vplPatchSides* sides, const struct vplLinkTree* tree,
                             const vplLinkDef* def)
{
    double area = 0;
    int dim = 0;
    for (int i = 0; i < tree->nodeCount; i++) {
        const vplLinkNode* node = &tree->nodes[i];
        if (node->dim && node->children < 0) {
            area += (double)node->area;
            dim++;
        }
    }
    return (vplLinkWork){.sides = sides,
                         .tree = tree,
                         .def = def,
                         .allowed = allowedError(sides, def),
                         .dimRays = dim > 0 ? fmin(RAYS_OF_DIM_SIDE * dim, MOST_DIM_RAYS) / area : 0};
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

static Measure measureOf(const vplJudgedPair* pair, const vplLinkTerms* terms)
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

static vplLinkVerdict divideLarger(const vplJudgedPair* pair)
{
    const bool p = pair->p->count > 1, q = pair->q->count > 1; // not both are single sides
    return !q || (p && pair->p->radius >= pair->q->radius) ? VPL_LINK_DIVIDE_P : VPL_LINK_DIVIDE_Q;
}

static vplLinkVerdict divideWorse(const vplJudgedPair* pair, double errorP, double errorQ)
{
    return errorP > errorQ ? VPL_LINK_DIVIDE_P : errorQ > errorP ? VPL_LINK_DIVIDE_Q : divideLarger(pair);
}

static bool isTurned(const vplLinkNode* node)
{
    return node->cosTurn < TURNED;
}

static vplLinkVerdict divideTurned(const vplJudgedPair* pair)
{
    const bool p = isTurned(pair->p), q = isTurned(pair->q);
    return p && q ? divideLarger(pair) : p ? VPL_LINK_DIVIDE_P : VPL_LINK_DIVIDE_Q;
}

// Sides whose centres are less than this many times the larger radius apart use the contour integral, times
// the visible fraction.
static const float NEAR = 3;

static bool isNear(const vplJudgedPair* pair)
{
    const float larger = fmaxf(pair->p->radius, pair->q->radius);
    return vplLength(vplSub(pair->q->centre, pair->p->centre)) < NEAR * larger;
}

// The largest decrease of a linear function with this slope between the centre of a node and its sides.
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
static void keep(const vplJudgedPair* pair, const Measure* m)
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

// The number of rays between a dim node and one that is not dim, in proportion to their form factor and to the area of the dim node. 0
// if both are dim, or neither is. `mean`: of the terms of all pairs of points, 1/m^2.
static double dimRays(const vplJudgedPair* pair, double mean)
{
    const double areas = (double)pair->p->area * (double)pair->q->area;
    return pair->p->dim != pair->q->dim ? pair->work->dimRays * areas * mean : 0;
}

// Decides about a dim group and one that is not dim, if only a small opening is between them; returns false otherwise. The number of rays
// is fixed before the first is cast, and the link carries what they find. Rays must not choose which pairs are divided and measured
// again: pairs that no ray passes are dropped, most rays of the others' parts are blocked, and half of the light behind
// a keyhole was lost in this way.
static bool measureDim(const vplJudgedPair* pair, double rays, vplLinkTerms* terms)
{
    const int few = VPL_RAY_PACKET;
    if (rays > VPL_MOST_LINK_RAYS - few) {
        pair->answer->verdict = divideLarger(pair);
        return true;
    }
    const int count = vplMaxi(few, (int)rays);
    vplLinkSeen first = {.open = 0}, seen = {.open = 0};
    vplCastPairRays(pair, terms, 0, few, &first);
    if (first.visible > SMALL_OPENING * first.open) {
        return false;
    }
    vplCastPairRays(pair, terms, few, few + count, &seen); // new rays: the first ones chose
    vplDarkenTerms(&seen, terms);
    Measure m = measureOf(pair, terms);
    const double mean = seen.visible / count, scale = m.mean > 0 ? mean / m.mean : 0;
    m.mean = mean;
    for (int axis = 0; axis < 3; axis++) {
        m.p[axis] *= scale;
        m.q[axis] *= scale;
    }
    keep(pair, &m);
    return true;
}

static void measureSides(const vplJudgedPair* pair, const vplLinkTerms* terms)
{
    vplLinkSeen seen = {.open = 0};
    const bool clear = pair->answer->clear; // a search would take longer than the rays
    Measure m = measureOf(pair, terms);
    const double rays = fmax(pair->work->def->samples, dimRays(pair, m.mean));
    vplCastPairRays(pair, terms, 0, clear ? 0 : (int)fmin(rays, VPL_MOST_LINK_RAYS), &seen);
    // Neighbours on a curved surface are near, but exchange next to nothing.
    if (!pair->p->group && !pair->q->group && isNear(pair) &&
        pair->sent * m.mean > TINY * pair->work->allowed) {
        m.mean = (double)vplSideExchange(vplFirstSide(pair, pair->p), vplFirstSide(pair, pair->q));
    }
    m.mean *= clear ? 1 : seen.open > 0 ? seen.visible / seen.open : 0;
    keep(pair, &m);
}

// Errors of irradiance, as fractions of the mean radiosity, caused by the extent of either group: irradiance
// varies over a receiving group, and radiosity may vary over a sending one.
static void findErrors(const vplJudgedPair* pair, Measure* m)
{
    m->errorP *= pair->p->count > 1 ? pair->sent : 0;
    m->errorQ *= pair->q->count > 1 ? pair->sent : 0;
}

// Decides about groups by points and rays.
static void measureGroups(const vplJudgedPair* pair, double bound, vplLinkTerms* terms)
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
    const double rays = dimRays(pair, m.mean);
    if (rays > 0 && measureDim(pair, rays, terms)) {
        return;
    }
    vplLinkSeen seen = {.open = 0};
    const bool look =
        !answer->visible || !rough || (vplRowsAreScaled(pair) && vplPairsOfSides(pair) >= MANY_PAIRS);
    const vplLinkView sight = look ? vplFindBetween(pair, terms, rough, open, &seen) : VPL_VIEW_DIVIDED;
    if (sight == VPL_VIEW_BLOCKED && seen.visible < seen.open) {
        vplDarkenTerms(&seen, terms);
        m = measureOf(pair, terms);
        findErrors(pair, &m);
    }
    const double limit = pair->sent * m.mean < VPL_LINK_OPEN * open ? VPL_LINK_SHADOWED * allowed : allowed;
    if (sight == VPL_VIEW_HIDDEN) {
        answer->verdict = VPL_LINK_NONE;
    } else if (rough || sight == VPL_VIEW_DIVIDED || m.errorP + m.errorQ > limit) {
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
    const vplJudgedPair pair = {
        .work = work, .ids = ids, .p = p, .q = q, .sent = fmax(sentArea(p), sentArea(q)), .answer = &answer};
    if (vplNode_IsBehind(&pair, p, q) || vplNode_IsBehind(&pair, q, p)) {
        return answer;
    }
    const double bound = vplFactorBound(&pair);
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
