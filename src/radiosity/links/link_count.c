// SPDX-License-Identifier: MIT
// Estimates how many links there will be, from a sample of the pairs that finding them would judge.
// Based on: Donald Knuth, Estimating the Efficiency of Backtrack Programs, Mathematics of Computation 29,
// 1975: a tree is measured by following some of its branches, each weighted by the number that it stands for.
// Departs: all branches of one level are followed together. Each level is sampled systematically, and the probability of a pair is in
// proportion to the number of its sides, because most links come from large groups.
#include "radiosity/links/links.h"

#include "base/rng.h"

#include <math.h>

enum {
    // Pairs of one level. Estimates of memory by five seeds differ by 11 % in Conference with 20,000 patches.
    MOST = 1 << 13,
    STREAM = 0x4d80 // of random numbers
};

typedef struct Count {
    vplLinkWork work;
    vplLinkPair *pairs, *parts;    // of this level, and of the next
    double *weights, *partWeights; // how many pairs of the whole tree each stands for
    int count, partCount;
    double links, widest; // the most pairs of a level
} Count;

// Adds a part of a pair to the next level. A pair has at most three parts, each with the weight of the pair.
static void push(Count* c, int p, int q, double weight, const vplLinkAnswer* answer)
{
    c->partWeights[c->partCount] = weight;
    c->parts[c->partCount++] = (vplLinkPair){
        .p = p, .q = q, .visible = answer->visible, .clear = answer->clear, .blocker = answer->blocker};
}

// Judges pair i of this level.
static void judge(Count* c, int i)
{
    const vplLinkPair* pair = &c->pairs[i];
    const double weight = c->weights[i];
    const vplLinkNode *nodes = c->work.tree->nodes, *p = &nodes[pair->p], *q = &nodes[pair->q];
    if (pair->p == pair->q) {
        for (int k = 0; k < 3 && !p->flat && p->children >= 0; k++) {
            push(c, p->children + k % 2, p->children + (k + 1) / 2, weight, &(vplLinkAnswer){.blocker = -1});
        }
        return;
    }
    vplLinkPoints_Draw(&c->work, pair->p);
    vplLinkPoints_Draw(&c->work, pair->q);
    const vplLinkAnswer answer = vplJudgePair(&c->work, pair);
    c->links += answer.verdict == VPL_LINK_KEEP ? weight : 0;
    for (int k = 0; k < 2; k++) {
        if (answer.verdict == VPL_LINK_DIVIDE_P) {
            push(c, p->children + k, pair->q, weight, &answer);
        } else if (answer.verdict == VPL_LINK_DIVIDE_Q) {
            push(c, pair->p, q->children + k, weight, &answer);
        }
    }
}

// The expected number of links of a part is about in proportion to this: its weight times its number of sides.
static double sizeOf(const Count* c, int i)
{
    const vplLinkNode* nodes = c->work.tree->nodes;
    const vplLinkPair* pair = &c->parts[i];
    return c->partWeights[i] * ((double)nodes[pair->p].count + nodes[pair->q].count);
}

// Goes on with the next level. At most MOST parts are all kept. Of more, a systematic sample is kept: the probability of a part
// is in proportion to sizeOf.
static void descend(Count* c, uint64_t level)
{
    const double start = (double)vplUnitFloat(vplRandomAt(c->work.def->seed, STREAM, level).v[0]);
    double total = 0, upTo = 0;
    for (int i = 0; i < c->partCount; i++) {
        total += sizeOf(c, i);
    }
    const double step = total / MOST;
    c->count = 0;
    for (int i = 0; i < c->partCount; i++) {
        const double before = upTo, size = sizeOf(c, i);
        upTo += size;
        // How many sample points, at equal distances along the summed sizes, lie in this part.
        const double times = floor(upTo / step - (double)start) - floor(before / step - (double)start);
        const double weight = c->partCount <= MOST ? c->partWeights[i]
                              : times > 0          ? c->partWeights[i] * times * step / size
                                                   : 0;
        if (weight > 0 && c->count < MOST) {
            c->pairs[c->count] = c->parts[i];
            c->weights[c->count++] = weight;
        }
    }
    c->partCount = 0;
}

static vplResult count(Count* c, const vplPatchSides* sides, const vplLinkDef* def, vplArena* scratch,
                       struct vplLinkTree* tree)
{
    c->pairs = vplArena_Alloc(scratch, MOST, sizeof *c->pairs);
    c->parts = vplArena_Alloc(scratch, 3 * MOST, sizeof *c->parts);
    c->weights = vplArena_Alloc(scratch, MOST, sizeof *c->weights);
    c->partWeights = vplArena_Alloc(scratch, 3 * MOST, sizeof *c->partWeights);
    TRY(vplArena_Check(scratch));
    TRY(vplLinkTree_Build(scratch, sides, tree));
    c->work = vplLinkWork_Make(sides, tree, def);
    c->work.points = vplArena_Alloc(scratch, (size_t)tree->nodeCount, sizeof *c->work.points);
    TRY(vplArena_Check(scratch));
    c->pairs[0] = (vplLinkPair){.p = 0, .q = 0, .blocker = -1}; // the root and itself
    c->weights[0] = 1;
    c->count = tree->nodeCount > 0;
    for (uint64_t level = 0; c->count > 0; level++) {
        double wide = 0;
        for (int i = 0; i < c->count; i++) {
            wide += c->weights[i];
            judge(c, i);
        }
        c->widest = fmax(c->widest, wide);
        descend(c, level);
    }
    return VPL_SUCCESS;
}

vplResult vplLinks_EstimateBytes(const vplPatchSides* sides, const vplLinkDef* def, double* heldOut,
                                 double* scratchOut)
{
    struct vplLinkTree tree = {.nodes = NULL};
    Count c = {.links = 0};
    vplArena* scratch = vplArena_Create(sides->context);
    vplResult result = vplArena_Check(scratch);
    if (result == VPL_SUCCESS) {
        result = count(&c, sides, def, scratch, &tree);
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
