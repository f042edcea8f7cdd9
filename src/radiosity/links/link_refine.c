// SPDX-License-Identifier: MIT
// Finds links: divides pairs of nodes, starting with the root and itself, until one link may stand for each
// pair.
#include "math/scalar.h"
#include "radiosity/links/links.h"

#include <string.h>

enum {
    BATCH = VPL_LINK_BATCH, // judged in parallel: the top of the stack, which keeps it small
    TASK = 64
};

typedef struct Refinement {
    vplLinkWork work;
    vplContext* context;
    vplLinkPair* pairs; // a stack
    size_t pairCount, pairCapacity;
    vplLinkPair* batch; // a copy of the batch
    vplLinkAnswer* answers;
    size_t first, count; // of the batch, in `pairs`
} Refinement;

static void judgeTask(void* data, int task, int worker)
{
    (void)worker;
    Refinement* r = data;
    const size_t from = (size_t)task * TASK, to = from + TASK < r->count ? from + TASK : r->count;
    for (size_t i = from; i < to; i++) {
        const vplLinkPair* pair = &r->pairs[r->first + i];
        if (pair->p != pair->q) {
            r->answers[i] = vplJudgePair(&r->work, pair);
        } else { // a node and itself
            const vplLinkNode* node = &r->work.tree->nodes[pair->p];
            r->answers[i] = (vplLinkAnswer){.verdict = node->flat || node->children < 0 ? VPL_LINK_NONE
                                                                                        : VPL_LINK_DIVIDE_P,
                                            .blocker = -1};
        }
    }
}

// Pushes a part of a pair that was divided. `share`: of the pair's work.
static void push(Refinement* r, int p, int q, const vplLinkPair* pair, const vplLinkAnswer* answer,
                 float share)
{
    r->pairs[r->pairCount++] = (vplLinkPair){.p = p,
                                             .q = q,
                                             .visible = answer->visible,
                                             .clear = answer->clear,
                                             .blocker = answer->blocker,
                                             .weight = share * pair->weight};
}

static void divide(Refinement* r, const vplLinkPair* pair, const vplLinkAnswer* answer)
{
    const vplLinkNode* nodes = r->work.tree->nodes;
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

// Takes the batch off the stack, adds its links to the list and pushes the parts of divided pairs. *done
// grows by the work that is finished.
static vplResult finishBatch(Refinement* r, vplLinkList* list, double* done)
{
    memcpy(r->batch, r->pairs + r->first, r->count * sizeof *r->batch);
    r->pairCount = r->first;
    TRY(vplReserve(r->context, &r->pairs, &r->pairCapacity, r->pairCount + 3 * r->count, sizeof *r->pairs));
    TRY(vplReserve(r->context, &list->links, &list->capacity, list->count + r->count, sizeof *list->links));
    for (size_t i = 0; i < r->count; i++) {
        const vplLinkPair* pair = &r->batch[i];
        const vplLinkAnswer* answer = &r->answers[i];
        list->rays += answer->rays;
        if (answer->verdict == VPL_LINK_DIVIDE_P || answer->verdict == VPL_LINK_DIVIDE_Q) {
            divide(r, pair, answer);
            continue;
        }
        *done += (double)pair->weight;
        if (answer->verdict == VPL_LINK_KEEP) {
            list->links[list->count++] = (vplLink){pair->p, pair->q, answer->fit};
        }
    }
    return VPL_SUCCESS;
}

static void drawPointsTask(void* data, int task, int worker)
{
    (void)worker;
    const vplLinkWork* work = &((const Refinement*)data)->work;
    for (int node = task * TASK; node < vplMini((task + 1) * TASK, work->tree->nodeCount); node++) {
        vplLinkPoints_Draw(work, node);
    }
}

static const int* findLeaves(const struct vplLinkTree* tree, int sides, vplArena* scratch)
{
    int* leafAt = vplArena_Alloc(scratch, (size_t)sides, sizeof *leafAt);
    for (int node = 0; leafAt != NULL && node < tree->nodeCount; node++) {
        if (tree->nodes[node].children < 0) {
            leafAt[tree->nodes[node].first] = node;
        }
    }
    return leafAt;
}

static vplResult refine(Refinement* r, vplArena* scratch, vplLinkList* list)
{
    const vplLinkDef* def = r->work.def;
    const int nodes = r->work.tree->nodeCount;
    r->batch = vplArena_Alloc(scratch, BATCH, sizeof *r->batch);
    r->answers = vplArena_Alloc(scratch, BATCH, sizeof *r->answers);
    r->work.points = vplArena_Alloc(scratch, (size_t)nodes, sizeof *r->work.points);
    r->work.leafAt = findLeaves(r->work.tree, r->work.sides->count, scratch);
    TRY(vplArena_Check(scratch));
    TRY(vplReserve(r->context, &r->pairs, &r->pairCapacity, 1, sizeof *r->pairs));
    if (nodes > 0) {
        TRY(vplParallelForAsking(r->context, (nodes + TASK - 1) / TASK, drawPointsTask, r));
        r->pairs[r->pairCount++] = (vplLinkPair){.p = 0, .q = 0, .blocker = -1, .weight = 1};
    }
    double done = 0;
    while (r->pairCount > 0) {
        r->count = r->pairCount < BATCH ? r->pairCount : BATCH;
        r->first = r->pairCount - r->count;
        TRY(vplParallelForProgress(r->context, (int)((r->count + TASK - 1) / TASK), judgeTask, r,
                                   (vplProgressRange){def->progress, def->progressUser,
                                                      VPL_LINKS_PROGRESS * done, VPL_LINKS_PROGRESS * done}));
        TRY(finishBatch(r, list, &done));
    }
    return VPL_SUCCESS;
}

vplResult vplFindLinks(const vplPatchSides* sides, const struct vplLinkTree* tree, const vplLinkDef* def,
                       vplLinkList* list)
{
    Refinement r = {.work = vplLinkWork_Make(sides, tree, def), .context = sides->context};
    vplArena* scratch = vplArena_Create(sides->context);
    const vplResult result = refine(&r, scratch, list);
    vplFree(sides->context, r.pairs);
    vplArena_Destroy(scratch);
    return result;
}
