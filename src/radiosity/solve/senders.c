// SPDX-License-Identifier: MIT
#include "radiosity/solve/senders.h"

#include "base/context.h"
#include "math/scalar.h"

enum { BLOCK = 32, ROWS = 16 }; // sides of a block, and rows per task

static const float* rowOf(const vplSenders* s, int side)
{
    return s->factors->rows + (size_t)side * (size_t)s->count;
}

static double received(const vplSenders* s, const float* row, int sender)
{
    return (double)row[sender] * (double)s->light[sender];
}

static void sumRows(void* data, int task, int worker)
{
    (void)worker;
    const vplSenders* s = data;
    for (int i = task * ROWS; i < vplMini((task + 1) * ROWS, s->count); i++) {
        const float* row = rowOf(s, i);
        float* upTo = s->upTo + (size_t)i * (size_t)s->blockCount;
        double sum = 0;
        for (int b = 0; b < s->blockCount; b++) {
            for (int j = b * BLOCK; j < vplMini((b + 1) * BLOCK, s->count); j++) {
                sum += received(s, row, j);
            }
            upTo[b] = (float)sum;
        }
    }
}

vplResult vplSenders_Create(vplArena* arena, const vplTransport* transport, const vplRgb* sent,
                            vplSenders* sendersOut)
{
    const int count = transport->sides->count, blocks = (count + BLOCK - 1) / BLOCK;
    float* light = vplArena_Alloc(arena, (size_t)count, sizeof *light);
    float* upTo = vplArena_Alloc(arena, (size_t)count * (size_t)blocks, sizeof *upTo);
    TRY(vplArena_Check(arena));
    for (int i = 0; i < count; i++) {
        light[i] = (float)fmax(0, vplRgbMean(sent[i]));
    }
    *sendersOut = (vplSenders){transport->factors, count, blocks, light, upTo};
    return vplParallelForAsking(transport->sides->context, (count + ROWS - 1) / ROWS, sumRows, sendersOut);
}

// The first block whose sum is above `target`.
static int findBlock(const vplSenders* s, const float* upTo, double target)
{
    int low = 0, high = s->blockCount - 1;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if ((double)upTo[middle] > target) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

int vplSenders_Choose(const vplSenders* s, int side, double u)
{
    const float *row = rowOf(s, side), *upTo = s->upTo + (size_t)side * (size_t)s->blockCount;
    const double target = u * vplSenders_Total(s, side);
    const int block = findBlock(s, upTo, target);
    double left = target - (block > 0 ? (double)upTo[block - 1] : 0);
    int last = block * BLOCK;
    for (int j = block * BLOCK; j < vplMini((block + 1) * BLOCK, s->count); j++) {
        const double light = received(s, row, j);
        if (light > left) {
            return j;
        }
        left -= light;
        last = light > 0 ? j : last; // rounding may leave a little at the end
    }
    return last;
}

double vplSenders_Probability(const vplSenders* s, int side, int sender)
{
    return received(s, rowOf(s, side), sender) / vplSenders_Total(s, side);
}
