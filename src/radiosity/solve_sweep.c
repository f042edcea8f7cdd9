// SPDX-License-Identifier: MIT
// One sweep of each solver.
// Based on: Hemgren, Radiosity in Realtime Rendering, Algorithm 1 (Gauss-Seidel: sides in their order, each with what
// those before it have just got); Cohen, Chen, Wallace and Greenberg, A Progressive Refinement Approach to Fast
// Radiosity Image Generation, SIGGRAPH 1988 (shooting); Gortler, Cohen and Slusallek, Radiosity and Relaxation Methods,
// IEEE Computer Graphics and Applications 1994 (from any start: what is unshot is the residual, and may be negative).
#include "base/context.h"
#include "radiosity/solve.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Rows of Gauss-Seidel whose products with all old radiosities are taken at once, by all workers where there are many
// sides; what the rows before in the block have changed is added after, in order. The sum is that of the algorithm to
// rounding, and its bits do not depend on the workers.
enum { BLOCK = 64 };

static void note(vplSolve* s, double old, double now)
{
    const double change = fabs(now - old), size = fabs(now);
    s->change = change > s->change ? change : s->change;
    s->largest = size > s->largest ? size : s->largest;
    s->finite = s->finite && size <= (double)FLT_MAX;
}

// Beyond float is infinity, which `finite` tells.
static double reflect(const vplSolve* s, int i, int c, double received)
{
    return (double)s->source.c[c][i] + (double)s->exchange.reflectance.c[c][i] * received;
}

static void sweepJacobi(vplSolve* s)
{
    vplExchange_Gather(&s->exchange, &s->radiosity);
    for (int i = 0; i < s->exchange.count; i++) {
        for (int c = 0; c < 3; c++) {
            const float now = (float)reflect(s, i, c, s->exchange.sums[i][c]);
            note(s, (double)s->radiosity.c[c][i], (double)now);
            s->radiosity.c[c][i] = now;
        }
    }
}

static void sweepBlock(vplSolve* s, int first, int end)
{
    const vplFormFactors* f = s->exchange.transport->factors;
    double more[BLOCK][3];
    vplExchange_GatherRows(&s->exchange, &s->radiosity, first, end);
    for (int i = first; i < end; i++) {
        const float* row = f->rows + (size_t)i * (size_t)f->count + first;
        double sum[3] = {s->exchange.sums[i][0], s->exchange.sums[i][1], s->exchange.sums[i][2]};
        for (int k = 0; k < i - first; k++) {
            const double factor = (double)row[k];
            for (int c = 0; c < 3; c++) {
                sum[c] += factor * more[k][c];
            }
        }
        for (int c = 0; c < 3; c++) {
            const double old = (double)s->radiosity.c[c][i];
            const float now = (float)reflect(s, i, c, sum[c]);
            note(s, old, (double)now);
            more[i - first][c] = (double)now - old;
            s->radiosity.c[c][i] = now;
        }
    }
}

static void sweepGaussSeidel(vplSolve* s)
{
    for (int first = 0; first < s->exchange.count; first += BLOCK) {
        const int end = first + BLOCK < s->exchange.count ? first + BLOCK : s->exchange.count;
        sweepBlock(s, first, end);
    }
}

// ---- shooting

static int mostPower(const vplSolve* s)
{
    int next = -1;
    float most = 0;
    for (int i = 0; i < s->exchange.count; i++) {
        float power = 0;
        for (int c = 0; c < 3; c++) {
            power += s->area[i] * fabsf(s->unshot.c[c][i]);
        }
        if (power > most) {
            most = power;
            next = i;
        }
    }
    return next;
}

// From the source alone nothing is shot yet. From elsewhere, that is what was shot, and one sweep of Jacobi's finds what
// is wrong with it.
void vplSolve_BeginShooting(vplSolve* s)
{
    const int count = s->exchange.count;
    const size_t bytes = 3 * vplPaddedSides(count) * sizeof(float);
    if (memcmp(s->radiosity.c[0], s->source.c[0], bytes) == 0) {
        memcpy(s->unshot.c[0], s->source.c[0], bytes);
    } else {
        memcpy(s->shot.c[0], s->radiosity.c[0], bytes);
        vplExchange_Gather(&s->exchange, &s->radiosity);
        for (int i = 0; i < count; i++) {
            for (int c = 0; c < 3; c++) {
                const double better = reflect(s, i, c, s->exchange.sums[i][c]);
                s->unshot.c[c][i] = (float)(better - (double)s->shot.c[c][i]);
            }
        }
    }
    for (int i = 0; i < count; i++) {
        s->area[i] = s->exchange.transport->sides->sides[i].area;
        for (int c = 0; c < 3; c++) {
            s->gain.c[c][i] = s->area[i] > 0 ? s->exchange.reflectance.c[c][i] / s->area[i] : 0;
        }
    }
    s->next = mostPower(s);
}

// What side j gets of side i is F_ji = F_ij A_i / A_j, so that one row serves.
static void sweepShooting(vplSolve* s)
{
    const vplFormFactors* f = s->exchange.transport->factors;
    const int count = s->exchange.count;
    vplShootFcn* shoot = vplGetShoot(s->exchange.context->isa);
    vplShot shot = {.gain = s->gain, .unshot = s->unshot, .area = s->area};
    for (int k = 0; k < count && s->next >= 0; k++) {
        const int i = s->next;
        shot.row = f->rows + (size_t)i * (size_t)count;
        for (int c = 0; c < 3; c++) {
            shot.power[c] = s->area[i] * s->unshot.c[c][i];
            s->shot.c[c][i] += s->unshot.c[c][i];
            s->unshot.c[c][i] = 0;
        }
        s->next = shoot(&shot, count);
    }
    for (int i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++) {
            const float now = s->shot.c[c][i] + s->unshot.c[c][i];
            note(s, (double)s->radiosity.c[c][i], (double)now);
            s->radiosity.c[c][i] = now;
        }
    }
}

void vplSolve_Sweep(vplSolve* solve)
{
    solve->change = solve->largest = 0;
    solve->finite = true;
    switch (solve->solver) {
    case VPL_SOLVER_JACOBI:
        sweepJacobi(solve);
        break;
    case VPL_SOLVER_GAUSS_SEIDEL:
        sweepGaussSeidel(solve);
        break;
    case VPL_SOLVER_SHOOTING:
        sweepShooting(solve);
        break;
    }
}
