// SPDX-License-Identifier: MIT
// One sweep of each solver.
// Based on: Hemgren, Radiosity in Realtime Rendering, Algorithm 1 (Gauss-Seidel: each side uses the new
// values of those before it); Cohen, Chen, Wallace and Greenberg, A Progressive Refinement Approach to Fast
// Radiosity Image Generation, SIGGRAPH 1988 (shooting); Gortler, Cohen and Slusallek, Radiosity and
// Relaxation Methods, IEEE Computer Graphics and Applications 1994 (from any start value: the unshot
// radiosity is the residual, and may be negative).
#include "math/scalar.h"
#include "radiosity/solve/solve.h"

#include <float.h>
#include <string.h>

// Gauss-Seidel takes the products of this many rows with the old radiosities at once, in parallel where there
// are many sides. The changes by earlier rows of the block are added afterwards, in order: the algorithm's
// sums up to rounding, whose bits do not depend on the number of workers.
enum { BLOCK = VPL_SWEEP_ROWS };

// A relative change is the change over the side's radiosity, or over this fraction of the largest radiosity if the side is darker.
static const double DARK = 1e-6;

// Adds the change of one channel of side i to the sweep's largest and mean changes.
static void recordChange(vplSolve* s, int i, double old, double now)
{
    const double change = fabs(now - old), size = fabs(now);
    const double area = (double)s->exchange.transport->sides->sides[i].area;
    s->change = change > s->change ? change : s->change;
    s->largest = size > s->largest ? size : s->largest;
    s->relative += change > 0 ? area * change / fmax(size, s->dark) : 0;
    s->weight += area;
    s->finite = s->finite && size <= (double)FLT_MAX;
}

// The radiosity of a side that receives `received`. Beyond float it becomes infinite, which `finite` records.
static double reflect(const vplSolve* s, int i, int c, double received)
{
    return (double)s->source.c[c][i] + (double)s->exchange.reflectance.c[c][i] * received;
}

static vplResult sweepJacobi(vplSolve* s)
{
    TRY(vplExchange_Gather(&s->exchange, &s->radiosity));
    for (int i = 0; i < s->exchange.count; i++) {
        for (int c = 0; c < 3; c++) {
            const float now = (float)reflect(s, i, c, s->exchange.sums[i][c]);
            recordChange(s, i, (double)s->radiosity.c[c][i], (double)now);
            s->radiosity.c[c][i] = now;
        }
    }
    return VPL_SUCCESS;
}

// The factors of row i from column `first` on, where the block of rows begins.
static const float* rowFrom(const vplExchange* e, int i, int first)
{
    const vplFormFactors* f = e->transport->factors;
    return e->shared != NULL ? e->shared->nearby + (size_t)i * VPL_SWEEP_ROWS
                             : f->rows + (size_t)i * (size_t)f->count + first;
}

static vplResult sweepBlock(vplSolve* s, int first, int end)
{
    double more[BLOCK][3];
    TRY(vplExchange_GatherRows(&s->exchange, &s->radiosity, first, end));
    for (int i = first; i < end; i++) {
        const float* row = rowFrom(&s->exchange, i, first);
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
            recordChange(s, i, old, (double)now);
            more[i - first][c] = (double)now - old;
            s->radiosity.c[c][i] = now;
        }
    }
    return s->exchange.shared != NULL ? VPL_SUCCESS : vplAsk(s->exchange.context); // a team has asked
}

static vplResult sweepGaussSeidel(vplSolve* s)
{
    for (int first = 0; first < s->exchange.count; first += BLOCK) {
        TRY(sweepBlock(s, first, vplMini(first + BLOCK, s->exchange.count)));
    }
    return VPL_SUCCESS;
}

// ---- shooting

// If the start value is the source, nothing is shot yet. Any other start value counts as shot, and one sweep
// of Jacobi finds its residual.
vplResult vplSolve_BeginShooting(vplSolve* s)
{
    const int count = s->exchange.count;
    const size_t bytes = 3 * vplPaddedSides(count) * sizeof(float);
    if (memcmp(s->radiosity.c[0], s->source.c[0], bytes) == 0) {
        memcpy(s->unshot.c[0], s->source.c[0], bytes);
    } else {
        memcpy(s->shot.c[0], s->radiosity.c[0], bytes);
        TRY(vplExchange_Gather(&s->exchange, &s->radiosity));
        for (int i = 0; i < count; i++) {
            for (int c = 0; c < 3; c++) {
                const double better = reflect(s, i, c, s->exchange.sums[i][c]);
                s->unshot.c[c][i] = (float)(better - (double)s->shot.c[c][i]);
            }
        }
    }
    for (int i = 0; i < count; i++) {
        s->area[i] = s->exchange.transport->sides->sides[i].area;
    }
    // The gains are still 0: this shot sends nothing, it only finds the side with the most unshot power.
    const vplShot none = {
        .row = s->exchange.transport->factors->rows, .gain = s->gain, .unshot = s->unshot, .area = s->area};
    s->next = s->exchange.kernels->shoot(&none, count);
    for (int i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++) {
            s->gain.c[c][i] = s->area[i] > 0 ? s->exchange.reflectance.c[c][i] / s->area[i] : 0;
        }
    }
    return VPL_SUCCESS;
}

// Side j receives F_ji = F_ij A_i / A_j of side i's radiosity, so one row of F serves a shot.
static vplResult sweepShooting(vplSolve* s)
{
    const vplFormFactors* f = s->exchange.transport->factors;
    const int count = s->exchange.count;
    vplShot shot = {.gain = s->gain, .unshot = s->unshot, .area = s->area};
    for (int k = 0; k < count && s->next >= 0; k++) {
        const int i = s->next;
        shot.row = f->rows + (size_t)i * (size_t)count;
        for (int c = 0; c < 3; c++) {
            shot.power[c] = s->area[i] * s->unshot.c[c][i];
            s->shot.c[c][i] += s->unshot.c[c][i];
            s->unshot.c[c][i] = 0;
        }
        s->next = s->exchange.kernels->shoot(&shot, count);
        if (k % BLOCK == 0) {
            TRY(vplAsk(s->exchange.context));
        }
    }
    for (int i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++) {
            const float now = s->shot.c[c][i] + s->unshot.c[c][i];
            recordChange(s, i, (double)s->radiosity.c[c][i], (double)now);
            s->radiosity.c[c][i] = now;
        }
    }
    return VPL_SUCCESS;
}

vplResult vplSolve_Sweep(vplSolve* solve)
{
    solve->dark = DARK * solve->largest;
    solve->change = solve->largest = solve->relative = solve->weight = 0;
    solve->finite = true;
    return solve->stats.solver == VPL_SOLVER_JACOBI     ? sweepJacobi(solve)
           : solve->stats.solver == VPL_SOLVER_SHOOTING ? sweepShooting(solve)
                                                        : sweepGaussSeidel(solve);
}
