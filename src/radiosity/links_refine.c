// SPDX-License-Identifier: MIT
// From the root linked to itself down: pairs are divided until a link may stand for each.
#include "base/context.h"
#include "radiosity/links.h"
#include "radiosity/links_points.h"

#include <string.h>

enum {
    BATCH = 1 << 14, // pairs judged side by side: the last of the stack, so that it stays short
    TASK = 64
};

typedef struct Refinement {
    const vplPatchSides* sides;
    const struct vplLinkTree* tree;
    const vplLinkDef* def;
    vplLinkPair* pairs; // a stack
    size_t pairCount, pairCapacity;
    vplLinkAnswer* answers;
    size_t first, count; // the batch
} Refinement;

// A node with itself: answered without rays.
static vplLinkAnswer judgeSelf(const struct vplLinkTree* tree, int node)
{
    return (vplLinkAnswer){.verdict = tree->nodes[node].flat ? VPL_LINK_NONE : VPL_LINK_DIVIDE_P};
}

static void judgeTask(void* data, int task, int worker)
{
    (void)worker;
    Refinement* r = data;
    const size_t from = (size_t)task * TASK, to = from + TASK < r->count ? from + TASK : r->count;
    for (size_t i = from; i < to; i++) {
        const vplLinkPair* pair = &r->pairs[r->first + i];
        r->answers[i] =
            pair->p == pair->q ? judgeSelf(r->tree, pair->p) : vplJudgePair(r->sides, r->tree, r->def, pair);
    }
}

static void push(Refinement* r, int p, int q, const vplLinkPair* parent, const vplLinkAnswer* answer,
                 float share)
{
    r->pairs[r->pairCount++] =
        (vplLinkPair){.p = p, .q = q, .seen = answer->seen, .weight = share * parent->weight};
}

static void divide(Refinement* r, const vplLinkPair* pair, const vplLinkAnswer* answer)
{
    const vplLinkNode* nodes = r->tree->nodes;
    if (pair->p == pair->q) {
        const int child = nodes[pair->p].children;
        push(r, child, child, pair, answer, 0.25f);
        push(r, child + 1, child + 1, pair, answer, 0.25f);
        push(r, child, child + 1, pair, answer, 0.5f);
        return;
    }
    for (int k = 0; k < 2; k++) {
        const bool first = answer->verdict == VPL_LINK_DIVIDE_P;
        push(r, first ? nodes[pair->p].children + k : pair->p, first ? pair->q : nodes[pair->q].children + k,
             pair, answer, 0.5f);
    }
}

// Takes the batch off the stack; links go to the list, halves back. `scratch` holds the batch's pairs.
static vplResult settle(Refinement* r, vplLinkPair* scratch, vplLinkList* list, double* done)
{
    vplContext* context = r->sides->context;
    memcpy(scratch, r->pairs + r->first, r->count * sizeof *scratch);
    r->pairCount = r->first;
    vplResult result =
        vplReserve(context, &r->pairs, &r->pairCapacity, r->pairCount + 3 * r->count, sizeof *r->pairs);
    if (result == VPL_SUCCESS) {
        result =
            vplReserve(context, &list->links, &list->capacity, list->count + r->count, sizeof *list->links);
    }
    for (size_t i = 0; i < r->count && result == VPL_SUCCESS; i++) {
        const vplLinkPair* pair = &scratch[i];
        const vplLinkAnswer* answer = &r->answers[i];
        list->rays += answer->rays;
        if (answer->verdict == VPL_LINK_DIVIDE_P || answer->verdict == VPL_LINK_DIVIDE_Q) {
            divide(r, pair, answer);
            continue;
        }
        *done += (double)pair->weight;
        if (answer->verdict == VPL_LINK_KEEP) {
            list->links[list->count++] = (vplLink){pair->p, pair->q, answer->kernel};
        }
    }
    return result;
}

static vplResult refineAll(Refinement* r, vplLinkPair* scratch, vplLinkList* list)
{
    double done = 0;
    vplResult result = VPL_SUCCESS;
    while (r->pairCount > 0 && result == VPL_SUCCESS) {
        r->count = r->pairCount < BATCH ? r->pairCount : BATCH;
        r->first = r->pairCount - r->count;
        result = vplParallelForProgress(r->sides->context, (int)((r->count + TASK - 1) / TASK), judgeTask, r,
                                        r->def->progress, r->def->progressUser, VPL_LINKS_SHARE * done,
                                        VPL_LINKS_SHARE * done);
        if (result == VPL_SUCCESS) {
            result = settle(r, scratch, list, &done);
        }
    }
    return result;
}

static void drawTask(void* data, int task, int worker)
{
    (void)worker;
    const Refinement* r = data;
    const int end = (task + 1) * TASK < r->tree->nodeCount ? (task + 1) * TASK : r->tree->nodeCount;
    for (int node = task * TASK; node < end; node++) {
        vplLinkPoints points;
        vplSampleNode(r->sides, r->tree, r->def->seed, node, node, VPL_JUDGE_POINTS, &points);
        memcpy(r->tree->points[node].at, points.at, sizeof r->tree->points[node].at);
        memcpy(r->tree->points[node].side, points.side, sizeof r->tree->points[node].side);
    }
}

vplResult vplFindLinks(const vplPatchSides* sides, struct vplLinkTree* tree, const vplLinkDef* def,
                       vplLinkList* list)
{
    vplContext* context = sides->context;
    Refinement r = {.sides = sides, .tree = tree, .def = def};
    vplLinkPair* scratch = vplAlloc(context, BATCH, sizeof *scratch);
    r.answers = scratch ? vplAlloc(context, BATCH, sizeof *r.answers) : NULL;
    tree->points = r.answers ? vplAlloc(context, (size_t)tree->nodeCount, sizeof *tree->points) : NULL;
    vplResult result =
        tree->points ? vplReserve(context, &r.pairs, &r.pairCapacity, 1, sizeof *r.pairs) : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS && tree->nodeCount > 0) {
        vplParallelFor(context, (tree->nodeCount + TASK - 1) / TASK, drawTask, &r);
        r.pairs[r.pairCount++] = (vplLinkPair){.p = 0, .q = 0, .seen = false, .weight = 1};
        result = refineAll(&r, scratch, list);
    }
    vplFree(context, scratch);
    vplFree(context, r.answers);
    vplFree(context, r.pairs);
    vplFree(context, tree->points);
    tree->points = NULL;
    return result;
}
