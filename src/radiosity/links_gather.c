// SPDX-License-Identifier: MIT
// Light over links: radiosities go up the tree, over the links, and what is received goes down.
// Based on: Hanrahan, Salzman and Aupperle, A Rapid Hierarchical Radiosity Algorithm, SIGGRAPH 1991 (gather, push, pull).
#include "base/context.h"
#include "radiosity/links.h"

#include <math.h>
#include <string.h>

enum { TASK = 256 }; // receivers

typedef struct Radiosity {
    float c[4]; // the last is 0: four are loaded at once
} Radiosity;

typedef struct Gathering {
    const struct vplLinkTree* tree;
    Radiosity* sent;
    double (*received)[3];
} Gathering;

size_t vplLinks_ScratchSize(const vplLinks* links)
{
    return (size_t)links->tree->nodeCount * (sizeof(Radiosity) / sizeof(double) + 3);
}

static void receiveTask(void* data, int task, int worker)
{
    (void)worker;
    const Gathering* g = data;
    const struct vplLinkTree* t = g->tree;
    const int end = (task + 1) * TASK < t->nodeCount ? (task + 1) * TASK : t->nodeCount;
    for (int node = task * TASK; node < end; node++) {
        double sum[3] = {0};
        for (int64_t i = t->firstOf[node]; i < t->firstOf[node + 1]; i++) {
            const double factor = (double)t->factors[i];
            const Radiosity* sent = &g->sent[t->senders[i]];
            for (int c = 0; c < 3; c++) {
                sum[c] += factor * (double)sent->c[c];
            }
        }
        memcpy(g->received[node], sum, sizeof sum);
    }
}

// Means over area.
static void pull(const Gathering* g, const vplPlanes* x)
{
    const struct vplLinkTree* t = g->tree;
    for (int node = t->nodeCount - 1; node >= 0; node--) {
        const vplLinkNode* n = &t->nodes[node];
        Radiosity* to = &g->sent[node];
        to->c[3] = 0;
        if (n->children < 0) {
            const int side = t->order[n->first];
            for (int c = 0; c < 3; c++) {
                to->c[c] = t->scale[side] * x->c[c][side];
            }
            continue;
        }
        const Radiosity *a = &g->sent[n->children], *b = &g->sent[n->children + 1];
        const double areaA = (double)t->nodes[n->children].area,
                     areaB = (double)t->nodes[n->children + 1].area;
        const double share = areaA + areaB > 0 ? areaA / (areaA + areaB) : 0;
        for (int c = 0; c < 3; c++) {
            to->c[c] = (float)((double)b->c[c] + share * ((double)a->c[c] - (double)b->c[c]));
        }
    }
}

static void pushDown(const Gathering* g, double (*sums)[3])
{
    const struct vplLinkTree* t = g->tree;
    for (int node = 0; node < t->nodeCount; node++) {
        const vplLinkNode* n = &t->nodes[node];
        if (n->children < 0) {
            const int side = t->order[n->first];
            for (int c = 0; c < 3; c++) {
                sums[side][c] = (double)t->scale[side] * g->received[node][c];
            }
            continue;
        }
        for (int k = 0; k < 2; k++) {
            for (int c = 0; c < 3; c++) {
                g->received[n->children + k][c] += g->received[node][c];
            }
        }
    }
}

void vplLinks_Gather(const vplLinks* links, const vplPlanes* x, double* scratch, double (*sums)[3])
{
    const struct vplLinkTree* t = links->tree;
    Gathering g = {.tree = t,
                   .received = (double(*)[3])scratch,
                   .sent = (Radiosity*)(void*)(scratch + 3 * (size_t)t->nodeCount)};
    pull(&g, x);
    vplParallelFor(links->context, (t->nodeCount + TASK - 1) / TASK, receiveTask, &g);
    pushDown(&g, sums);
}

// ---- from links to rows

vplResult vplLinkTree_Connect(vplContext* context, struct vplLinkTree* tree, const vplLinkList* list)
{
    const size_t nodes = (size_t)tree->nodeCount;
    tree->firstOf = vplAllocZero(context, nodes + 2, sizeof *tree->firstOf);
    tree->senders = tree->firstOf ? vplAlloc(context, 2 * list->count, sizeof *tree->senders) : NULL;
    tree->factors = tree->senders ? vplAlloc(context, 2 * list->count, sizeof *tree->factors) : NULL;
    if (tree->factors == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    int64_t* next = tree->firstOf + 2; // shifted by two: counts become starts, starts become ends
    for (size_t i = 0; i < list->count; i++) {
        next[list->links[i].p]++;
        next[list->links[i].q]++;
    }
    for (size_t i = 1; i < nodes; i++) {
        next[i] += next[i - 1];
    }
    next--;
    for (size_t i = 0; i < list->count; i++) {
        const vplLink* link = &list->links[i];
        for (int k = 0; k < 2; k++) {
            const int32_t receiver = k ? link->q : link->p, sender = k ? link->p : link->q;
            const int64_t at = next[receiver]++;
            tree->senders[at] = sender;
            tree->factors[at] = tree->nodes[sender].area * link->kernel;
        }
    }
    return VPL_SUCCESS;
}

// ---- sums of rows: Sinkhorn and Knopp, 1967, as in row_sums.c

// As row_sums.c's, but as many each time: a gather over links costs little.
enum { ROUNDS = 10 };

// Room for the rounding of scales and sums, so that none is above 1.
static const double MARGIN = 1 - 0x1p-21;

// One round: towards 1 by half the way; what is not closed only while it is above. The last takes the whole step down,
// which leaves none above 1, since no factor grows.
static void fitScales(struct vplLinkTree* tree, const double (*sums)[3], int count, const bool* closed,
                      bool last)
{
    for (int i = 0; i < count; i++) {
        const double sum = sums[i][0], scale = (double)tree->scale[i];
        if (last) {
            tree->scale[i] = (float)(sum > MARGIN ? scale * MARGIN / sum : scale);
        } else if (sum > 0) {
            const double wanted = scale / sqrt(sum);
            tree->scale[i] = (float)(!closed[i] && wanted > 1 ? 1 : wanted);
        }
    }
}

// Every factor is multiplied by the scales of both its sides.
vplResult vplLinks_FitRows(vplLinks* links, vplRowSums rows, const bool* closed, float* rowSums)
{
    vplContext* context = links->context;
    const int count = links->sideCount, rounds = rows == VPL_ROW_SUMS_KEEP ? 0 : ROUNDS;
    vplPlanes ones = {{NULL, NULL, NULL}};
    double(*sums)[3] = vplAlloc(context, (size_t)count, sizeof *sums);
    double* scratch = sums ? vplAlloc(context, vplLinks_ScratchSize(links), sizeof *scratch) : NULL;
    const vplResult result = scratch ? vplPlanes_Create(context, count, &ones) : VPL_OUT_OF_MEMORY;
    for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
        ones.c[0][i] = 1;
        links->tree->scale[i] = 1;
    }
    for (int round = 0; round <= rounds && result == VPL_SUCCESS; round++) {
        vplLinks_Gather(links, &ones, scratch, sums);
        for (int i = 0; i < count && round == 0; i++) {
            rowSums[i] = (float)sums[i][0];
        }
        if (rounds > 0) {
            fitScales(links->tree, (const double(*)[3])sums, count, closed, round == rounds);
        }
    }
    vplPlanes_Destroy(context, &ones);
    vplFree(context, scratch);
    vplFree(context, sums);
    return result;
}
