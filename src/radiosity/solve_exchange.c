// SPDX-License-Identifier: MIT
// What sides receive of each other, and how fast light dies away in it.
// Based on: Golub and Van Loan, Matrix Computations, 4th edition, 8.2 (the power method and Rayleigh's quotient).
#include "base/context.h"
#include "base/isa.h"
#include "radiosity/links.h"
#include "radiosity/solve.h"

#include <math.h>
#include <string.h>

VPL_KERNEL_TABLE(rowDots, vplRowDotFcn, vplRowDot);
VPL_KERNEL_TABLE(shoots, vplShootFcn, vplShoot);

vplRowDotFcn* vplGetRowDot(vplIsa isa)
{
    return rowDots[isa];
}

vplShootFcn* vplGetShoot(vplIsa isa)
{
    return shoots[isa];
}

// ---- planes

size_t vplPaddedSides(int count)
{
    return ((size_t)count + VPL_SIDE_LANES - 1) / VPL_SIDE_LANES * VPL_SIDE_LANES;
}

vplResult vplPlanes_Create(vplContext* context, int count, vplPlanes* planesOut)
{
    const size_t stride = vplPaddedSides(count);
    float* values = vplAllocZero(context, 3 * stride, sizeof *values);
    if (values == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    *planesOut = (vplPlanes){{values, values + stride, values + 2 * stride}};
    return VPL_SUCCESS;
}

void vplPlanes_Destroy(vplContext* context, vplPlanes* planes)
{
    vplFree(context, planes->c[0]);
}

void vplPlanes_Read(vplPlanes* planes, const vplRgb* values, int count)
{
    for (int i = 0; i < count; i++) {
        planes->c[0][i] = values[i].r;
        planes->c[1][i] = values[i].g;
        planes->c[2][i] = values[i].b;
    }
}

void vplPlanes_Write(const vplPlanes* planes, int count, vplRgb* valuesOut)
{
    for (int i = 0; i < count; i++) {
        valuesOut[i] = (vplRgb){planes->c[0][i], planes->c[1][i], planes->c[2][i]};
    }
}

// ---- F x

vplResult vplExchange_Create(const vplTransport* transport, vplExchange* exchangeOut)
{
    vplExchange e = {
        .transport = transport, .context = transport->sides->context, .count = transport->sides->count};
    const size_t nodes = transport->factors == NULL ? vplLinks_ScratchSize(transport->links) : 0;
    vplResult result = vplPlanes_Create(e.context, e.count, &e.reflectance);
    if (result == VPL_SUCCESS) {
        e.sums = vplAllocZero(e.context, (size_t)e.count, sizeof *e.sums);
        e.nodes = e.sums ? vplAlloc(e.context, nodes, sizeof *e.nodes) : NULL;
        result = e.nodes ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    }
    if (result != VPL_SUCCESS) {
        vplExchange_Destroy(&e);
        return result;
    }
    for (int i = 0; i < e.count; i++) {
        const vplRgb rho = transport->sides->sides[i].reflectance;
        e.reflectance.c[0][i] = rho.r;
        e.reflectance.c[1][i] = rho.g;
        e.reflectance.c[2][i] = rho.b;
    }
    *exchangeOut = e;
    return VPL_SUCCESS;
}

void vplExchange_Destroy(vplExchange* exchange)
{
    vplPlanes_Destroy(exchange->context, &exchange->reflectance);
    vplFree(exchange->context, exchange->sums);
    vplFree(exchange->context, exchange->nodes);
}

typedef struct Rows {
    vplExchange* exchange;
    const vplPlanes* x;
    vplRowDotFcn* dot;
    int first, end;
} Rows;

static void gatherTask(void* data, int task, int worker)
{
    (void)worker;
    const Rows* r = data;
    const vplFormFactors* f = r->exchange->transport->factors;
    const int from = r->first + task * VPL_EXCHANGE_ROWS;
    const int to = from + VPL_EXCHANGE_ROWS < r->end ? from + VPL_EXCHANGE_ROWS : r->end;
    for (int i = from; i < to; i++) {
        r->dot(f->rows + (size_t)i * (size_t)f->count, r->x, f->count, r->exchange->sums[i]);
    }
}

void vplExchange_GatherRows(vplExchange* exchange, const vplPlanes* x, int first, int end)
{
    Rows rows = {exchange, x, vplGetRowDot(exchange->context->isa), first, end};
    const int tasks = (end - first + VPL_EXCHANGE_ROWS - 1) / VPL_EXCHANGE_ROWS;
    // One thread multiplies 2^20 factors in about 0.3 ms. With less, blocks of Gauss-Seidel's waited for busy processors:
    // a sweep of 3,584 sides took 33 ms instead of 14 while other programs ran.
    if ((int64_t)(end - first) * exchange->count < 1 << 20) {
        for (int task = 0; task < tasks; task++) {
            gatherTask(&rows, task, 0);
        }
    } else {
        vplParallelFor(exchange->context, tasks, gatherTask, &rows);
    }
}

void vplExchange_Gather(vplExchange* exchange, const vplPlanes* x)
{
    if (exchange->transport->factors != NULL) {
        vplExchange_GatherRows(exchange, x, 0, exchange->count);
    } else {
        vplLinks_Gather(exchange->transport->links, x, exchange->nodes, exchange->sums);
    }
}

// ---- how fast light dies away

enum { MOST_ROUNDS = 64 };

static void measureRows(const vplExchange* e, vplSolveStats* stats)
{
    double sum = 0, area = 0, least = INFINITY, most = 0;
    for (int i = 0; i < e->count; i++) {
        const double row = e->sums[i][0], a = (double)e->transport->sides->sides[i].area;
        sum += a * row;
        area += a;
        least = row < least ? row : least;
        most = row > most ? row : most;
    }
    stats->rowSumMin = e->count > 0 ? least : 0;
    stats->rowSumMean = area > 0 ? sum / area : 0;
    stats->rowSumMax = most;
}

// x = rho times sums, scaled such that its largest is 1, and its norm before that. By area / rho the matrix rho F is
// symmetric, so that the ratio of norms never exceeds the radius, and nears it twice as fast as the vectors their limit.
static double reflectAndMeasure(const vplExchange* e, int channel, float* x)
{
    double largest = 0, norm = 0;
    for (int i = 0; i < e->count; i++) {
        const double y = (double)e->reflectance.c[channel][i] * e->sums[i][channel];
        largest = y > largest ? y : largest;
    }
    for (int i = 0; i < e->count; i++) {
        const double rho = (double)e->reflectance.c[channel][i];
        const double y = rho * e->sums[i][channel];
        norm += rho > 0 ? (double)e->transport->sides->sides[i].area / rho * (y * y) : 0;
        x[i] = largest > 0 ? (float)(y / largest) : 0.0f;
    }
    return norm;
}

static double normOf(const vplExchange* e, int channel, const float* x)
{
    double norm = 0;
    for (int i = 0; i < e->count; i++) {
        const double rho = (double)e->reflectance.c[channel][i], value = (double)x[i];
        norm += rho > 0 ? (double)e->transport->sides->sides[i].area / rho * (value * value) : 0;
    }
    return norm;
}

void vplFindSpectrum(vplExchange* exchange, vplPlanes* x, vplSolveStats* stats)
{
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < exchange->count; i++) {
            x->c[c][i] = 1;
        }
    }
    vplExchange_Gather(exchange, x);
    measureRows(exchange, stats);
    for (int c = 0; c < 3; c++) {
        reflectAndMeasure(exchange, c, x->c[c]);
    }
    double radius = 0, last = -1;
    for (int round = 0; round < MOST_ROUNDS && fabs(radius - last) > 1e-6 * radius; round++) {
        last = radius;
        vplExchange_Gather(exchange, x);
        radius = 0;
        for (int c = 0; c < 3; c++) {
            const double before = normOf(exchange, c, x->c[c]);
            const double after = reflectAndMeasure(exchange, c, x->c[c]);
            const double ratio = before > 0 ? sqrt(after / before) : 0;
            radius = ratio > radius ? ratio : radius;
        }
    }
    stats->spectralRadius = radius;
}
