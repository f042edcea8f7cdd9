// SPDX-License-Identifier: MIT
// Light over links: radiosities are pulled up the tree and sent over the links, and irradiance is pushed
// down.
// Based on: Hanrahan, Salzman and Aupperle, A Rapid Hierarchical Radiosity Algorithm, SIGGRAPH 1991 (gather,
// push, pull).
#include "base/arena.h"
#include "math/scalar.h"
#include "radiosity/links/links.h"

#include <string.h>

enum { TASK = 256 }; // receivers

typedef struct Gathering {
    const struct vplLinkTree* tree;
    const vplLinkScratch* scratch;
} Gathering;

vplLinkScratch vplLinkScratch_Alloc(vplArena* arena, const vplLinks* links)
{
    const size_t nodes = (size_t)links->tree->nodeCount;
    vplLinkScratch s;
    s.received = vplArena_Alloc(arena, nodes, sizeof *s.received);
    s.sent = vplArena_Alloc(arena, nodes, sizeof *s.sent);
    return s;
}

static void receiveTask(void* data, int task, int worker)
{
    (void)worker;
    const Gathering* g = data;
    const struct vplLinkTree* t = g->tree;
    for (int node = task * TASK; node < vplMini((task + 1) * TASK, t->nodeCount); node++) {
        double sum[3] = {0};
        for (int64_t i = t->firstOf[node]; i < t->firstOf[node + 1]; i++) {
            const double factor = (double)t->factors[i];
            const float* sent = g->scratch->sent[t->senders[i]];
            for (int c = 0; c < 3; c++) {
                sum[c] += factor * (double)sent[c];
            }
        }
        memcpy(g->scratch->received[node], sum, sizeof sum);
    }
}

// Fills `sent`: the mean over a node's area.
static void pullUp(const Gathering* g, const vplPlanes* x)
{
    const struct vplLinkTree* t = g->tree;
    for (int node = t->nodeCount - 1; node >= 0; node--) {
        const vplLinkNode* n = &t->nodes[node];
        float* to = g->scratch->sent[node];
        to[3] = 0;
        if (n->children < 0) {
            const int side = t->order[n->first];
            for (int c = 0; c < 3; c++) {
                to[c] = t->scale[side] * x->c[c][side];
            }
            continue;
        }
        const float *a = g->scratch->sent[n->children], *b = g->scratch->sent[n->children + 1];
        const double areaA = (double)t->nodes[n->children].area,
                     areaB = (double)t->nodes[n->children + 1].area;
        const double share = areaA + areaB > 0 ? areaA / (areaA + areaB) : 0;
        for (int c = 0; c < 3; c++) {
            to[c] = (float)((double)b[c] + share * ((double)a[c] - (double)b[c]));
        }
    }
}

static void pushDown(const Gathering* g, double (*sums)[3])
{
    const struct vplLinkTree* t = g->tree;
    double(*received)[3] = g->scratch->received;
    for (int node = 0; node < t->nodeCount; node++) {
        const vplLinkNode* n = &t->nodes[node];
        if (n->children < 0) {
            const int side = t->order[n->first];
            for (int c = 0; c < 3; c++) {
                sums[side][c] = (double)t->scale[side] * received[node][c];
            }
            continue;
        }
        for (int k = 0; k < 2; k++) {
            for (int c = 0; c < 3; c++) {
                received[n->children + k][c] += received[node][c];
            }
        }
    }
}

vplResult vplLinks_Gather(const vplLinks* links, const vplPlanes* x, const vplLinkScratch* scratch,
                          double (*sums)[3])
{
    Gathering g = {links->tree, scratch};
    pullUp(&g, x);
    TRY(vplParallelForAsking(links->context, (links->tree->nodeCount + TASK - 1) / TASK, receiveTask, &g));
    pushDown(&g, sums);
    return vplAsk(links->context);
}
