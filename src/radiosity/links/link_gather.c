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
        double sum[4][3] = {{0}};
        for (int64_t i = t->firstOf[node]; i < t->firstOf[node + 1]; i++) {
            const vplLinkEnd* end = &t->ends[i];
            const float(*sent)[4] = g->scratch->sent[end->sender];
            for (int c = 0; c < 3; c++) {
                sum[0][c] += (double)(end->factor * sent[0][c] + end->senderSlope[0] * sent[1][c] +
                                      end->senderSlope[1] * sent[2][c] + end->senderSlope[2] * sent[3][c]);
                for (int axis = 0; axis < 3; axis++) {
                    sum[1 + axis][c] += (double)end->receiverSlope[axis] * (double)sent[0][c];
                }
            }
        }
        memcpy(g->scratch->received[node], sum, sizeof sum);
    }
}

// The way between the middles of a node and of its child, in radii of the node.
static void stepTo(const vplLinkNode* n, const vplLinkNode* child, double step[3])
{
    for (int axis = 0; axis < 3; axis++) {
        const double way = (double)vplComponent(child->middle, axis) - (double)vplComponent(n->middle, axis);
        step[axis] = n->radius > 0 ? way / (double)n->radius : 0;
    }
}

// Fills `sent`.
static void pullUp(const Gathering* g, const vplPlanes* x)
{
    const struct vplLinkTree* t = g->tree;
    for (int node = t->nodeCount - 1; node >= 0; node--) {
        const vplLinkNode* n = &t->nodes[node];
        float(*to)[4] = g->scratch->sent[node];
        memset(to, 0, sizeof *g->scratch->sent);
        if (n->children < 0) {
            const int side = t->order[n->first];
            for (int c = 0; c < 3; c++) {
                to[0][c] = t->scale[side] * x->c[c][side];
            }
            continue;
        }
        const double areas = (double)t->nodes[n->children].area + (double)t->nodes[n->children + 1].area;
        double sum[4][3] = {{0}};
        for (int k = 0; k < 2; k++) {
            const vplLinkNode* child = &t->nodes[n->children + k];
            const float(*from)[4] = g->scratch->sent[n->children + k];
            const double share = areas > 0 ? (double)child->area / areas : 0;
            const double shrink = n->radius > 0 ? (double)child->radius / (double)n->radius : 0;
            double step[3];
            stepTo(n, child, step);
            for (int c = 0; c < 3; c++) {
                sum[0][c] += share * (double)from[0][c];
                for (int axis = 0; axis < 3; axis++) {
                    sum[1 + axis][c] +=
                        share * (shrink * (double)from[1 + axis][c] + step[axis] * (double)from[0][c]);
                }
            }
        }
        for (int i = 0; i < 12; i++) {
            to[i / 3][i % 3] = (float)sum[i / 3][i % 3];
        }
    }
}

static void pushDown(const Gathering* g, double (*sums)[3])
{
    const struct vplLinkTree* t = g->tree;
    double(*received)[4][3] = g->scratch->received;
    for (int node = 0; node < t->nodeCount; node++) {
        const vplLinkNode* n = &t->nodes[node];
        if (n->children < 0) {
            const int side = t->order[n->first];
            for (int c = 0; c < 3; c++) {
                sums[side][c] = (double)t->scale[side] * received[node][0][c];
            }
            continue;
        }
        for (int k = 0; k < 2; k++) {
            const vplLinkNode* child = &t->nodes[n->children + k];
            const double shrink = n->radius > 0 ? (double)child->radius / (double)n->radius : 0;
            double step[3];
            stepTo(n, child, step);
            for (int c = 0; c < 3; c++) {
                double more = received[node][0][c];
                for (int axis = 0; axis < 3; axis++) {
                    more += step[axis] * received[node][1 + axis][c];
                    received[n->children + k][1 + axis][c] += shrink * received[node][1 + axis][c];
                }
                received[n->children + k][0][c] += more;
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
