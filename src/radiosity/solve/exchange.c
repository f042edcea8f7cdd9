// SPDX-License-Identifier: MIT
// The irradiance that sides receive from each other, and how fast light decays in that exchange.
// Based on: Golub and Van Loan, Matrix Computations, 4th edition, 8.2 (the power method and the Rayleigh
// quotient).
#include "math/scalar.h"
#include "radiosity/solve/solve.h"

enum {
    ROWS = 16,       // per task
    OWN_ROWS = 4,    // per task, of a team; 1 where there are only the rows of a block of Gauss-Seidel
    MOST_ROUNDS = 64 // of the power method
};

vplResult vplTransport_Check(const vplTransport* t)
{
    vplContext* context = t->sides->context;
    if ((t->factors == NULL) == (t->links == NULL)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplTransport has %s, must have factors or links",
                       t->factors ? "both factors and links" : "neither factors nor links");
    }
    const int count = t->factors ? t->factors->count : t->links->sideCount;
    if (count != t->sides->count) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplTransport has %d sides, but its %s were made for %d", t->sides->count,
                       t->factors ? "form factors" : "links", count);
    }
    const vplSharedRows* shared = t->factors ? vplFormFactors_GetShared(t->factors) : NULL;
    if (shared != NULL && (context->team.count != shared->members || context->team.index != shared->member)) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "form factors that %d processes share are of no use without that team",
                       shared->members);
    }
    return VPL_SUCCESS;
}

vplResult vplExchange_Open(vplArena* scratch, const vplTransport* transport, vplExchange* e)
{
    vplContext* context = transport->sides->context;
    *e = (vplExchange){.transport = transport,
                       .context = context,
                       .kernels = vplGetRadiosityKernels(context->isa),
                       .count = transport->sides->count};
    e->reflectance = vplPlanes_Alloc(scratch, e->count);
    e->sums = vplArena_AllocZero(scratch, (size_t)e->count, sizeof *e->sums);
    if (transport->factors == NULL) {
        e->nodes = vplLinkScratch_Alloc(scratch, transport->links);
    } else if (vplFormFactors_GetShared(transport->factors) != NULL) {
        e->shared = vplFormFactors_GetShared(transport->factors);
        e->rooms = vplArena_Alloc(scratch, (size_t)context->workerCount * vplSharedRows_Columns(e->shared),
                                  sizeof *e->rooms);
        e->mail = vplTeamMail_Alloc(context, scratch, e->count, sizeof *e->sums);
    }
    TRY(vplArena_Check(scratch));
    for (int i = 0; i < e->count; i++) {
        const vplRgb rho = transport->sides->sides[i].reflectance;
        e->reflectance.c[0][i] = rho.r;
        e->reflectance.c[1][i] = rho.g;
        e->reflectance.c[2][i] = rho.b;
    }
    return VPL_SUCCESS;
}

// ---- F x

typedef struct Rows {
    vplExchange* exchange;
    const vplPlanes* x;
    int first, end;
    int step; // rows of all members of a team while one does a task
} Rows;

static void gatherTask(void* data, int task, int worker)
{
    (void)worker;
    const Rows* r = data;
    const vplExchange* e = r->exchange;
    const vplFormFactors* f = e->transport->factors;
    const int from = r->first + task * ROWS;
    for (int i = from; i < vplMini(from + ROWS, r->end); i++) {
        e->kernels->rowDot(f->rows + (size_t)i * (size_t)f->count, r->x, f->count, e->sums[i]);
    }
}

// Multiplies own rows of a team.
static void gatherOwnTask(void* data, int task, int worker)
{
    const Rows* r = data;
    const vplExchange* e = r->exchange;
    const vplSharedRows* s = e->shared;
    const int from = vplTeam_FirstRow(r->first, s->member, s->members) + task * r->step;
    float* room = e->rooms + (size_t)worker * vplSharedRows_Columns(s);
    for (int i = from; i < vplMini(from + r->step, r->end); i += s->members) {
        vplSharedRows_Decode(s, i, room);
        e->kernels->rowDot(room, r->x, e->count, e->sums[i]);
    }
}

static vplResult gatherShared(Rows* r)
{
    vplExchange* e = r->exchange;
    const int count = r->end - r->first;
    const vplTeamRows rows = {e->sums, sizeof *e->sums, r->first, r->end};
    r->step = e->shared->members * (count > VPL_SWEEP_ROWS ? OWN_ROWS : 1);
    return vplTeam_ShareRows(
        e->context, vplParallelForAsking(e->context, (count + r->step - 1) / r->step, gatherOwnTask, r),
        &e->mail, &rows);
}

vplResult vplExchange_GatherRows(vplExchange* exchange, const vplPlanes* x, int first, int end)
{
    Rows rows = {exchange, x, first, end, ROWS};
    if (exchange->shared != NULL) {
        return gatherShared(&rows);
    }
    const int tasks = (end - first + ROWS - 1) / ROWS;
    // One thread multiplies 2^20 factors in about 0.3 ms. Parallel tasks do not pay below that: a sweep of
    // Gauss-Seidel over 3,584 sides took 33 ms instead of 14 on a busy machine.
    if ((int64_t)(end - first) * exchange->count < 1 << 20) {
        for (int task = 0; task < tasks; task++) {
            gatherTask(&rows, task, 0);
        }
        return VPL_SUCCESS;
    }
    return vplParallelForAsking(exchange->context, tasks, gatherTask, &rows);
}

vplResult vplExchange_Gather(vplExchange* exchange, const vplPlanes* x)
{
    return exchange->transport->factors != NULL
               ? vplExchange_GatherRows(exchange, x, 0, exchange->count)
               : vplLinks_Gather(exchange->transport->links, x, &exchange->nodes, exchange->sums);
}

// ---- the spectrum

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

// The weight area / rho, in whose norm the matrix rho F is symmetric.
static double weightOf(const vplExchange* e, int channel, int i)
{
    const double rho = (double)e->reflectance.c[channel][i];
    return rho > 0 ? (double)e->transport->sides->sides[i].area / rho : 0;
}

// x = rho times sums, scaled so that the largest is 1. Returns the squared norm before scaling. Because rho F
// is symmetric in this norm, the ratio of norms never exceeds the spectral radius and converges twice as fast
// as the vector.
static double reflectAndMeasure(const vplExchange* e, int channel, float* x)
{
    double largest = 0, norm = 0;
    for (int i = 0; i < e->count; i++) {
        const double y = (double)e->reflectance.c[channel][i] * e->sums[i][channel];
        largest = y > largest ? y : largest;
    }
    for (int i = 0; i < e->count; i++) {
        const double y = (double)e->reflectance.c[channel][i] * e->sums[i][channel];
        norm += weightOf(e, channel, i) * (y * y);
        x[i] = largest > 0 ? (float)(y / largest) : 0.0f;
    }
    return norm;
}

static double squaredNorm(const vplExchange* e, int channel, const float* x)
{
    double norm = 0;
    for (int i = 0; i < e->count; i++) {
        const double value = (double)x[i];
        norm += weightOf(e, channel, i) * (value * value);
    }
    return norm;
}

vplResult vplFindSpectrum(vplExchange* exchange, vplPlanes* x, vplSolveStats* stats)
{
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < exchange->count; i++) {
            x->c[c][i] = 1;
        }
    }
    TRY(vplExchange_Gather(exchange, x));
    measureRows(exchange, stats);
    if (!isfinite(stats->rowSumMean)) { // a sum of a row is beyond float
        stats->spectralRadius = INFINITY;
        return VPL_SUCCESS;
    }
    for (int c = 0; c < 3; c++) {
        reflectAndMeasure(exchange, c, x->c[c]);
    }
    double radius = 0, last = -1;
    for (int round = 0; round < MOST_ROUNDS && fabs(radius - last) > 1e-6 * radius; round++) {
        last = radius;
        TRY(vplExchange_Gather(exchange, x));
        radius = 0;
        for (int c = 0; c < 3; c++) {
            const double before = squaredNorm(exchange, c, x->c[c]);
            const double after = reflectAndMeasure(exchange, c, x->c[c]);
            const double ratio = before > 0 ? sqrt(after / before) : 0;
            radius = ratio > radius ? ratio : radius;
        }
    }
    stats->spectralRadius = radius;
    return VPL_SUCCESS;
}
