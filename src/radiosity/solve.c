// SPDX-License-Identifier: MIT
// Solvers of B = E + rho F B: when to end, and when there is no end.
#include "radiosity/solve.h"

#include "base/context.h"

#include <float.h>
#include <math.h>

enum { SOLVE_COOKIE = 0x56504cb5 };

// Sweeps whose change grows, one after another, before the spectral radius is asked. Where there is a solution, too,
// the largest change may grow for a while: light that a dark corner catches.
enum { GROWING = 4 };

// The radius of a closed white room is 1 to rounding; its radiosities grow as the number of sweeps, and are kept.
static const double DIVERGES = 1 + 1e-4;

vplSolveDef vplDefaultSolveDef(void)
{
    return (vplSolveDef){.solver = VPL_SOLVER_GAUSS_SEIDEL,
                         .iterations = 100,
                         .residual = 1e-4,
                         .spectrum = true,
                         .cookie = SOLVE_COOKIE};
}

// ---- checks

static vplResult checkTransport(const vplTransport* t)
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
    return VPL_SUCCESS;
}

static vplResult checkValues(const vplTransport* t, const vplRgb* values, const char* name)
{
    for (int i = 0; i < t->sides->count; i++) {
        if (!(isfinite(values[i].r) && isfinite(values[i].g) && isfinite(values[i].b))) {
            return vplFail(t->sides->context, VPL_INVALID_ARGUMENT,
                           "%s of side %d is (%g, %g, %g), must be finite", name, i, (double)values[i].r,
                           (double)values[i].g, (double)values[i].b);
        }
    }
    return VPL_SUCCESS;
}

static vplResult checkDef(const vplTransport* t, const vplSolveDef* def)
{
    vplContext* context = t->sides->context;
    if (def->cookie != SOLVE_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplSolveDef was not made by vplDefaultSolveDef");
    }
    if ((int)def->solver < 0 || def->solver > VPL_SOLVER_SHOOTING) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplSolveDef.solver is %d, must be a vplSolver",
                       (int)def->solver);
    }
    if (def->iterations < 0 || def->iterations > VPL_MAX_SWEEPS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplSolveDef.iterations is %d, must be in [0, %d]",
                       def->iterations, (int)VPL_MAX_SWEEPS);
    }
    if (!(def->residual >= 0 && def->residual <= 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplSolveDef.residual is %g, must be in [0, 1]",
                       def->residual);
    }
    return checkTransport(t);
}

// ---- sweeps

static vplResult diverges(const vplSolve* s, int iterations, const vplSolveStats* stats)
{
    if (stats->spectralRadius <= DIVERGES) {
        return vplFail(s->exchange.context, VPL_LIMIT,
                       "after %d sweeps a radiosity is beyond the range of float; dim what emits",
                       iterations);
    }
    return vplFail(
        s->exchange.context, VPL_LIMIT,
        "radiosity diverges: after %d sweeps the largest is %g W/m^2, and grows; the spectral radius "
        "of reflectance times form factors is %.4g, must be below 1; clamp the sums of rows "
        "(--row-sums clamp) or take better form factors (--form-factors monte-carlo)",
        iterations, s->largest, stats->spectralRadius);
}

typedef struct Ending {
    vplSolveStats stats;
    bool known; // spectral radius and sums of rows are
} Ending;

static void findSpectrum(vplSolve* s, vplPlanes* scratch, Ending* end)
{
    if (!end->known) {
        vplFindSpectrum(&s->exchange, scratch, &end->stats);
        end->known = true;
    }
}

// The sweeps until one of the ends.
static vplResult sweep(vplSolve* s, vplPlanes* scratch, Ending* end)
{
    const vplSolveDef* def = s->def;
    double last = INFINITY;
    int growing = 0;
    bool done = false;
    for (int i = 0; i < def->iterations && !done; i++) {
        if (def->progress != NULL && !def->progress(def->progressUser, (double)i / def->iterations)) {
            return VPL_CANCELLED;
        }
        vplSolve_Sweep(s);
        end->stats.iterations = i + 1;
        end->stats.residual = s->largest > 0 ? s->change / s->largest : 0;
        done = s->change <= def->residual * s->largest;
        growing = s->change > last ? growing + 1 : 0;
        last = s->change;
        if (!s->finite || growing == GROWING) {
            findSpectrum(s, scratch, end);
        }
        if (!s->finite || (growing >= GROWING && end->stats.spectralRadius > DIVERGES)) {
            return diverges(s, i + 1, &end->stats);
        }
    }
    if (def->spectrum) {
        findSpectrum(s, scratch, end);
    }
    if (growing > 0 && end->known && end->stats.spectralRadius > DIVERGES) {
        return diverges(s, end->stats.iterations, &end->stats);
    }
    if (!done && !def->relaxes && def->iterations > 0 && def->residual > 0) {
        vplLog(s->exchange.context, VPL_LOG_WARNING,
               "radiosity ended after %d sweeps with a residual of %.3g, not below %g", end->stats.iterations,
               end->stats.residual, def->residual);
    }
    return VPL_SUCCESS;
}

// ---- all of it

static vplResult reserve(vplSolve* s, vplPlanes* scratch)
{
    vplContext* context = s->exchange.context;
    const int count = s->exchange.count;
    vplPlanes* planes[] = {&s->source, &s->radiosity, scratch, &s->shot, &s->unshot, &s->gain};
    const int needed = s->solver == VPL_SOLVER_SHOOTING ? 6 : 3;
    for (int i = 0; i < needed; i++) {
        if (vplPlanes_Create(context, count, planes[i]) != VPL_SUCCESS) {
            return VPL_OUT_OF_MEMORY;
        }
    }
    if (s->solver == VPL_SOLVER_SHOOTING) {
        s->area = vplAllocZero(context, vplPaddedSides(count), sizeof *s->area);
        return s->area ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    }
    return VPL_SUCCESS;
}

static void release(vplSolve* s, vplPlanes* scratch)
{
    vplContext* context = s->exchange.context;
    vplPlanes* planes[] = {&s->source, &s->radiosity, scratch, &s->shot, &s->unshot, &s->gain};
    for (int i = 0; i < 6; i++) {
        vplPlanes_Destroy(context, planes[i]);
    }
    vplFree(context, s->area);
}

vplResult vplSolveRadiosity(const vplTransport* transport, const vplSolveDef* def, const vplRgb* source,
                            vplRgb* radiosity, vplSolveStats* statsOut)
{
    vplResult result = checkDef(transport, def);
    if (result == VPL_SUCCESS) {
        result = checkValues(transport, source, "source");
    }
    if (result == VPL_SUCCESS) {
        result = checkValues(transport, radiosity, "radiosity");
    }
    vplSolve s = {.def = def, .solver = transport->factors ? def->solver : VPL_SOLVER_JACOBI};
    vplPlanes scratch = {{NULL, NULL, NULL}};
    Ending end = {.known = false};
    if (result == VPL_SUCCESS) {
        result = vplExchange_Create(transport, &s.exchange);
    }
    if (result != VPL_SUCCESS) {
        return result;
    }
    result = reserve(&s, &scratch);
    if (result == VPL_SUCCESS) {
        vplPlanes_Read(&s.source, source, s.exchange.count);
        vplPlanes_Read(&s.radiosity, radiosity, s.exchange.count);
        if (s.solver == VPL_SOLVER_SHOOTING) {
            vplSolve_BeginShooting(&s);
        }
        result = sweep(&s, &scratch, &end);
    }
    if (result == VPL_SUCCESS) {
        vplPlanes_Write(&s.radiosity, s.exchange.count, radiosity);
        end.stats.solver = s.solver;
        if (statsOut != NULL) {
            *statsOut = end.stats;
        }
    }
    release(&s, &scratch);
    vplExchange_Destroy(&s.exchange);
    return result;
}

// ---- F B alone

static float toFloat(double x)
{
    return x > (double)FLT_MAX ? FLT_MAX : x < -(double)FLT_MAX ? -FLT_MAX : (float)x;
}

// Sums of F times radiosity; on success the caller destroys the exchange.
static vplResult gather(const vplTransport* transport, const vplRgb* radiosity, vplExchange* exchange)
{
    vplPlanes planes = {{NULL, NULL, NULL}};
    vplResult result = checkTransport(transport);
    if (result == VPL_SUCCESS) {
        result = checkValues(transport, radiosity, "radiosity");
    }
    if (result == VPL_SUCCESS) {
        result = vplExchange_Create(transport, exchange);
    }
    if (result != VPL_SUCCESS) {
        return result;
    }
    result = vplPlanes_Create(exchange->context, exchange->count, &planes);
    if (result != VPL_SUCCESS) {
        vplExchange_Destroy(exchange);
        return result;
    }
    vplPlanes_Read(&planes, radiosity, exchange->count);
    vplExchange_Gather(exchange, &planes);
    vplPlanes_Destroy(exchange->context, &planes);
    return VPL_SUCCESS;
}

vplResult vplGatherRadiosity(const vplTransport* transport, const vplRgb* radiosity, vplRgb* irradianceOut)
{
    vplExchange e;
    vplResult result = gather(transport, radiosity, &e);
    if (result == VPL_SUCCESS) {
        for (int i = 0; i < e.count; i++) {
            irradianceOut[i] = (vplRgb){toFloat(e.sums[i][0]), toFloat(e.sums[i][1]), toFloat(e.sums[i][2])};
        }
        vplExchange_Destroy(&e);
    }
    return result;
}

vplResult vplRadiosityResidual(const vplTransport* transport, const vplRgb* source, const vplRgb* radiosity,
                               vplRgb* residualOut)
{
    vplExchange e;
    vplResult result = checkTransport(transport);
    if (result == VPL_SUCCESS) {
        result = checkValues(transport, source, "source");
    }
    if (result == VPL_SUCCESS) {
        result = gather(transport, radiosity, &e);
    }
    if (result == VPL_SUCCESS) {
        for (int i = 0; i < e.count; i++) {
            const double r = (double)e.reflectance.c[0][i] * e.sums[i][0];
            const double g = (double)e.reflectance.c[1][i] * e.sums[i][1];
            const double b = (double)e.reflectance.c[2][i] * e.sums[i][2];
            residualOut[i] = (vplRgb){toFloat((double)source[i].r + r - (double)radiosity[i].r),
                                      toFloat((double)source[i].g + g - (double)radiosity[i].g),
                                      toFloat((double)source[i].b + b - (double)radiosity[i].b)};
        }
        vplExchange_Destroy(&e);
    }
    return result;
}
