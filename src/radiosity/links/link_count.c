// SPDX-License-Identifier: MIT
// Estimates how many links there will be, from a sample of the pairs that finding them would judge.
// Based on: Donald Knuth, Estimating the Efficiency of Backtrack Programs, Mathematics of Computation 29,
// 1975: a tree is measured by following some of its branches, each weighted by the number that it stands for.
// Departs: all branches of one level are followed together, and the sample of each level is systematic.
#include "radiosity/links/links.h"

#include "base/rng.h"

#include <math.h>

enum {
    // Pairs of one level. With 1 << 10 the estimate differs by up to 3 times from seed to seed in large scenes.
    MOST = 1 << 13,
    STREAM = 0x4d80 // of random numbers
};

typedef struct Count {
    vplLinkWork work;
    vplLinkPair *pairs, *parts; // of this level, and of the next
    int count, partCount;
    double weight;        // the number of pairs that each of this level stands for
    double links, widest; // the most pairs of a level
} Count;

// Every pair has at most three parts.
static void push(Count* c, int p, int q, const vplLinkAnswer* answer)
{
    c->parts[c->partCount++] = (vplLinkPair){
        .p = p, .q = q, .visible = answer->visible, .clear = answer->clear, .blocker = answer->blocker};
}

// Judges a pair of this level.
static void judge(Count* c, const vplLinkPair* pair)
{
    const vplLinkNode *nodes = c->work.tree->nodes, *p = &nodes[pair->p], *q = &nodes[pair->q];
    if (pair->p == pair->q) {
        for (int k = 0; k < 3 && !p->flat && p->children >= 0; k++) {
            push(c, p->children + k % 2, p->children + (k + 1) / 2, &(vplLinkAnswer){.blocker = -1});
        }
        return;
    }
    vplLinkPoints_Draw(&c->work, pair->p);
    vplLinkPoints_Draw(&c->work, pair->q);
    const vplLinkAnswer answer = vplJudgePair(&c->work, pair);
    c->links += answer.verdict == VPL_LINK_KEEP ? c->weight : 0;
    for (int k = 0; k < 2; k++) {
        if (answer.verdict == VPL_LINK_DIVIDE_P) {
            push(c, p->children + k, pair->q, &answer);
        } else if (answer.verdict == VPL_LINK_DIVIDE_Q) {
            push(c, pair->p, q->children + k, &answer);
        }
    }
}

// The next level: all parts, or MOST of them at equal distances from a random start.
static void descend(Count* c, uint64_t level)
{
    const double step = c->partCount > MOST ? (double)c->partCount / MOST : 1;
    const double start = (double)vplUnitFloat(vplRandomAt(c->work.def->seed, STREAM, level).v[0]);
    c->count = c->partCount < MOST ? c->partCount : MOST;
    for (int i = 0; i < c->count; i++) {
        c->pairs[i] = c->parts[step > 1 ? (int)((i + start) * step) : i];
    }
    c->weight *= step;
    c->partCount = 0;
}

static vplResult count(Count* c, vplArena* scratch, struct vplLinkTree* tree)
{
    c->pairs = vplArena_Alloc(scratch, MOST, sizeof *c->pairs);
    c->parts = vplArena_Alloc(scratch, 3 * MOST, sizeof *c->parts);
    TRY(vplArena_Check(scratch));
    TRY(vplLinkTree_Build(scratch, c->work.sides, tree));
    c->work.tree = tree;
    c->work.points = vplArena_Alloc(scratch, (size_t)tree->nodeCount, sizeof *c->work.points);
    TRY(vplArena_Check(scratch));
    c->pairs[0] = (vplLinkPair){.p = 0, .q = 0, .blocker = -1}; // the root and itself
    c->count = tree->nodeCount > 0;
    for (uint64_t level = 0; c->count > 0; level++) {
        c->widest = fmax(c->widest, c->weight * c->count);
        for (int i = 0; i < c->count; i++) {
            judge(c, &c->pairs[i]);
        }
        descend(c, level);
    }
    return VPL_SUCCESS;
}

vplResult vplLinks_EstimateBytes(const vplPatchSides* sides, const vplLinkDef* def, double* heldOut,
                                 double* scratchOut)
{
    struct vplLinkTree tree = {.nodes = NULL};
    Count c = {.work = {.sides = sides, .def = def, .allowed = vplAllowedLinkError(sides, def)}, .weight = 1};
    vplArena* scratch = vplArena_Create(sides->context);
    vplResult result = vplArena_Check(scratch);
    if (result == VPL_SUCCESS) {
        result = count(&c, scratch, &tree);
    }
    vplArena_Destroy(scratch);
    const double count = sides->count, nodes = 2 * count, batch = fmin(c.widest, VPL_LINK_BATCH);
    const double list = 1.2 * c.links * sizeof(vplLink); // it grows by half
    const double sorted = 2 * c.links * sizeof *tree.ends + nodes * sizeof *tree.firstOf;
    *heldOut = nodes * sizeof *tree.nodes +
               count * (sizeof *tree.order + sizeof *tree.areaUpTo + 2 * sizeof *tree.scale) + sorted;
    // While the list grows, the old one is held, too. The stack has room for all parts of a batch.
    const double finding = 5 / 3.0 * list + 3 * batch * sizeof(vplLinkPair) +
                           VPL_LINK_BATCH * (sizeof(vplLinkPair) + sizeof(vplLinkAnswer)) +
                           nodes * sizeof *c.work.points + count * sizeof *c.work.leafAt - sorted;
    *scratchOut = fmax(finding, list);
    return result;
}
