// SPDX-License-Identifier: MIT
// A pair of nodes while it is judged. Only the files that judge pairs include this.
#ifndef VPL_RADIOSITY_LINK_PAIR_H
#define VPL_RADIOSITY_LINK_PAIR_H

#include "radiosity/links/links.h"

typedef struct vplJudgedPair {
    const vplLinkWork* work;
    const vplLinkPair* ids;
    const vplLinkNode *p, *q;
    double sent; // the larger area, weighted by brightness, m^2
    vplLinkAnswer* answer;
} vplJudgedPair;

// The only side of a node, or the first of a group.
static inline const vplPatchSide* vplFirstSide(const vplJudgedPair* pair, const vplLinkNode* node)
{
    return &pair->work->sides->sides[pair->work->tree->order[node->first]];
}

static inline double vplPairsOfSides(const vplJudgedPair* pair)
{
    return (double)pair->p->count * (double)pair->q->count;
}

// Rows are scaled to the share of light that rays find (link_rows.c), and are not darker for what links miss.
static inline bool vplRowsAreScaled(const vplJudgedPair* pair)
{
    return pair->work->sides->patches->groupCount > 0 && pair->work->def->rowSums == VPL_ROW_SUMS_USUAL;
}

// ---- bounds (link_bound.c)

// Tests whether a node lies behind the plane of a flat one, or in it, up to rounding.
bool vplNode_IsBehind(const vplJudgedPair* pair, const vplLinkNode* node, const vplLinkNode* plane);

// An upper bound of both form factors, times the sender's brightness; infinity where the nodes touch.
double vplFactorBound(const vplJudgedPair* pair);

// ---- what is between two nodes (link_view.c)

// The error that is allowed to a link that something blocks in part, as a fraction of that of others: errors of
// shadows have the same sign over many links. Without, a dark room behind a door ajar errs 2.3 times as much.
#define VPL_LINK_SHADOWED 0.5

// A link counts as partly blocked if less than this fraction of its light passes.
#define VPL_LINK_OPEN 0.98

// Casts rays number `from` to `to` - 1.
void vplCastPairRays(const vplJudgedPair* pair, const vplLinkTerms* terms, int from, int to,
                     vplLinkSeen* seen);

// What stands between two groups, as far as rays and the shaft tell.
typedef enum vplLinkView {
    VPL_VIEW_CLEAR,   // nothing
    VPL_VIEW_HIDDEN,  // something everywhere
    VPL_VIEW_BLOCKED, // something, which `seen` knows
    VPL_VIEW_DIVIDED  // too much varies, or too few rays may be cast, to tell for such a pair
} vplLinkView;

// Finds what is between two groups that exchange `open` where nothing is. A rough pair will be divided, and needs no
// more rays than tell whether it is hidden.
vplLinkView vplFindBetween(const vplJudgedPair* pair, const vplLinkTerms* terms, bool rough, double open,
                           vplLinkSeen* seen);

#endif
