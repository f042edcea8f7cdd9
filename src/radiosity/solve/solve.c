// SPDX-License-Identifier: MIT
// Solves B = E + rho F B: sweeps until the solution converges or is found to diverge.
#include "radiosity/solve/solve.h"

#include "base/numbers.h"
#include "radiosity/sides/side.h"

#include <math.h>
#include <stdio.h>

enum { SOLVE_COOKIE = 0x56504cb5 };

// The spectral radius is computed after this many consecutive sweeps with growing changes. The largest change
// may grow for a while even if there is a solution, as light reaches a dark corner.
enum { GROWING = 4 };

// The spectral radius of a closed white room is 1 up to rounding. Its radiosities grow linearly with the
// sweeps, which is no divergence.
static const double DIVERGES = 1 + 1e-4;

// Where a sweep changes little, but the next one hardly less, much light can still be missing: in a closed room
// of reflectance 0.999 a residual of 1e-4 leaves out 5 %. A share above this one and SLOW residuals is a warning.
static const double MISSING = 0.01, SLOW = 10;

// Sweeps go on until the mean relative change is at most this many residuals. The largest change alone is that of the brightest sides:
// the end of a long corridor is ten thousand times darker, and had three quarters of its light.
static const double DARK_RESIDUALS = 50;

vplSolveDef vplDefaultSolveDef(void)
{
    return (vplSolveDef){.solver = VPL_SOLVER_GAUSS_SEIDEL,
                         .iterations = 100,
                         .residual = 1e-4,
                         .spectrum = true,
                         .cookie = SOLVE_COOKIE};
}

// ---- checks

static vplResult checkValues(const vplTransport* t, const vplRgb* values, const char* name)
{
    return vplCheckRgb(t->sides->context, name, values, (size_t)t->sides->count);
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
    if (def->solver == VPL_SOLVER_SHOOTING && t->factors != NULL &&
        vplFormFactors_GetShared(t->factors) != NULL) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "shooting takes a whole row for each shot, and no process of a team has all: "
                       "vplSolveDef.solver must be another");
    }
    return vplTransport_Check(t);
}

// ---- sweeps

enum { NUMBER = 40 };

// Writes a number with its unit, or says in words that it is infinite.
static const char* sayNumber(char out[NUMBER], double value, const char* unit)
{
    if (isfinite(value)) {
        vplFormat(out, NUMBER, "%.4g%s", value, unit);
        return out;
    }
    return "beyond the range of float";
}

static vplResult failDiverging(const vplSolve* s)
{
    vplContext* context = s->exchange.context;
    if (s->stats.spectralRadius <= DIVERGES) {
        return vplFail(context, VPL_LIMIT,
                       "after %d sweeps a radiosity is beyond the range of float; dim what emits",
                       s->stats.iterations);
    }
    char largest[NUMBER], radius[NUMBER];
    return vplFail(context, VPL_LIMIT,
                   "radiosity diverges: after %d sweeps the largest is %s, and grows; the spectral radius "
                   "of reflectance times form factors is %s, must be below 1; clamp the sums of rows "
                   "(--row-sums clamp) or take better form factors (--form-factors monte-carlo)",
                   s->stats.iterations,
                   sayNumber(largest, s->finite ? s->largest : (double)INFINITY, " W/m^2"),
                   sayNumber(radius, s->stats.spectralRadius, ""));
}

static vplResult findSpectrum(vplSolve* s)
{
    if (!s->hasSpectrum) {
        TRY(vplFindSpectrum(&s->exchange, &s->scratch, &s->stats));
        s->hasSpectrum = true;
    }
    return VPL_SUCCESS;
}

// Says when sweeps ended too early. Changes that go on to shrink by the factor `shrink` add up to a geometric
// series, which is the light that is missing.
static void warnOfMissingLight(const vplSolve* s, bool done, double shrink)
{
    vplContext* context = s->exchange.context;
    const double residual = s->stats.residual, wanted = s->def->residual,
                 missing = shrink < 1 ? residual * shrink / (1 - shrink) : (double)INFINITY;
    if (s->def->continues || s->stats.iterations == 0 || wanted == 0 ||
        (done && !(missing > fmax(MISSING, SLOW * wanted)))) {
        return;
    }
    char share[32] = "light without end";
    if (missing < 100) {
        vplFormat(share, sizeof share, "another %.2g %% of light", 100 * missing);
    }
    if (done) {
        vplLog(context, VPL_LOG_WARNING,
               "radiosity ended with a residual of %.3g, but %s is missing, because reflectance is high; "
               "lower the residual (--residual)",
               residual, share);
        return;
    }
    if (residual <= wanted) {
        vplLog(context, VPL_LOG_WARNING,
               "radiosity ended after %d sweeps, the last of which changed sides by %.2g %% on average; "
               "allow more sweeps (--iterations)",
               s->stats.iterations, 100 * s->relative / s->weight);
        return;
    }
    vplLog(context, VPL_LOG_WARNING,
           "radiosity ended after %d sweeps with a residual of %.3g, not below %g; about %s is missing; "
           "allow more "
           "sweeps (--iterations)",
           s->stats.iterations, residual, wanted, share);
}

static vplResult report(const vplSolve* s, double fraction)
{
    const vplSolveDef* def = s->def;
    const bool goesOn = def->progress == NULL || def->progress(def->progressUser, fraction);
    const vplResult result = goesOn ? VPL_SUCCESS : VPL_CANCELLED;
    return s->exchange.shared != NULL ? vplTeam_Agree(s->exchange.context, result) : result;
}

static bool isDone(const vplSolve* s)
{
    const double residual = s->def->residual;
    return s->change <= residual * s->largest && s->relative <= DARK_RESIDUALS * residual * s->weight;
}

static vplResult sweepAll(vplSolve* s)
{
    const vplSolveDef* def = s->def;
    double last = INFINITY, shrink = 0;
    int growing = 0;
    bool done = false;
    for (int i = 0; i < def->iterations && !done; i++) {
        TRY(report(s, (double)i / def->iterations));
        TRY(vplSolve_Sweep(s));
        s->stats.iterations = i + 1;
        s->stats.residual = s->largest > 0 ? s->change / s->largest : 0;
        done = isDone(s);
        growing = s->change > last ? growing + 1 : 0;
        shrink = last > 0 ? s->change / last : 0;
        last = s->change;
        if (!s->finite || growing == GROWING) {
            TRY(findSpectrum(s));
        }
        if (!s->finite || (growing >= GROWING && s->stats.spectralRadius > DIVERGES)) {
            return failDiverging(s);
        }
    }
    if (def->spectrum) {
        TRY(findSpectrum(s));
    }
    if (growing > 0 && s->hasSpectrum && s->stats.spectralRadius > DIVERGES) {
        return failDiverging(s);
    }
    warnOfMissingLight(s, done, shrink);
    return VPL_SUCCESS;
}

// ---- the whole solution

static vplResult reserve(vplArena* arena, vplSolve* s)
{
    const int count = s->exchange.count;
    s->source = vplPlanes_Alloc(arena, count);
    s->radiosity = vplPlanes_Alloc(arena, count);
    s->scratch = vplPlanes_Alloc(arena, count);
    if (s->stats.solver == VPL_SOLVER_SHOOTING) {
        s->shot = vplPlanes_Alloc(arena, count);
        s->unshot = vplPlanes_Alloc(arena, count);
        s->gain = vplPlanes_Alloc(arena, count);
        s->area = vplArena_AllocZero(arena, vplPaddedSides(count), sizeof *s->area);
    }
    return vplArena_Check(arena);
}

// A member of a team that fails tells the others.
static vplResult agree(const vplTransport* transport, vplResult mine)
{
    const vplFormFactors* f = transport->factors;
    return f != NULL && vplFormFactors_GetShared(f) != NULL ? vplTeam_Agree(f->context, mine) : mine;
}

static vplResult solveWith(vplArena* arena, const vplTransport* transport, vplSolve* s, const vplRgb* source,
                           vplRgb* radiosity)
{
    const vplResult opened = vplExchange_Open(arena, transport, &s->exchange);
    TRY(agree(transport, opened == VPL_SUCCESS ? reserve(arena, s) : opened));
    vplPlanes_Read(&s->source, source, s->exchange.count);
    vplPlanes_Read(&s->radiosity, radiosity, s->exchange.count);
    if (s->stats.solver == VPL_SOLVER_SHOOTING) {
        TRY(vplSolve_BeginShooting(s));
    }
    TRY(sweepAll(s));
    vplPlanes_Write(&s->radiosity, s->exchange.count, radiosity);
    return VPL_SUCCESS;
}

static vplContext* contextOf(const vplTransport* transport)
{
    return transport != NULL ? CONTEXT_OF(transport->sides) : NULL;
}

vplResult vplSolveRadiosity(const vplTransport* transport, const vplSolveDef* def, const vplRgb* source,
                            vplRgb* radiosity, vplSolveStats* statsOut)
{
    REQUIRE(contextOf(transport), transport, def, source, radiosity);
    TRY(checkDef(transport, def));
    TRY(checkValues(transport, source, "source"));
    TRY(checkValues(transport, radiosity, "radiosity"));
    const vplSolver solver = transport->factors != NULL ? def->solver : VPL_SOLVER_JACOBI;
    vplSolve s = {.def = def, .stats = {.solver = solver}};
    vplArena* arena = vplArena_Create(transport->sides->context);
    const vplResult result = agree(transport, solveWith(arena, transport, &s, source, radiosity));
    vplArena_Destroy(arena);
    if (result == VPL_SUCCESS && statsOut != NULL) {
        *statsOut = s.stats;
    }
    return result;
}

// ---- F B alone

// Writes the irradiance of each side, or its residual where there is a source.
static vplResult gather(vplArena* scratch, const vplTransport* transport, const vplRgb* source,
                        const vplRgb* radiosity, vplRgb* out)
{
    vplExchange e;
    TRY(vplExchange_Open(scratch, transport, &e));
    vplPlanes planes = vplPlanes_Alloc(scratch, e.count);
    TRY(agree(transport, vplArena_Check(scratch)));
    vplPlanes_Read(&planes, radiosity, e.count);
    TRY(vplExchange_Gather(&e, &planes));
    for (int i = 0; i < e.count; i++) {
        double* v = e.sums[i];
        if (source != NULL) {
            const vplRgb s = source[i], b = radiosity[i];
            v[0] = (double)s.r + (double)e.reflectance.c[0][i] * v[0] - (double)b.r;
            v[1] = (double)s.g + (double)e.reflectance.c[1][i] * v[1] - (double)b.g;
            v[2] = (double)s.b + (double)e.reflectance.c[2][i] * v[2] - (double)b.b;
        }
        out[i] = (vplRgb){vplClampToFloat(v[0]), vplClampToFloat(v[1]), vplClampToFloat(v[2])};
    }
    return VPL_SUCCESS;
}

static vplResult checkAndGather(const vplTransport* transport, const vplRgb* source, const vplRgb* radiosity,
                                vplRgb* out)
{
    TRY(vplTransport_Check(transport));
    if (source != NULL) {
        TRY(checkValues(transport, source, "source"));
    }
    TRY(checkValues(transport, radiosity, "radiosity"));
    vplArena* scratch = vplArena_Create(transport->sides->context);
    const vplResult result = agree(transport, gather(scratch, transport, source, radiosity, out));
    vplArena_Destroy(scratch);
    return result;
}

vplResult vplGatherRadiosity(const vplTransport* transport, const vplRgb* radiosity, vplRgb* irradianceOut)
{
    REQUIRE(contextOf(transport), transport, radiosity, irradianceOut);
    return checkAndGather(transport, NULL, radiosity, irradianceOut);
}

vplResult vplRadiosityResidual(const vplTransport* transport, const vplRgb* source, const vplRgb* radiosity,
                               vplRgb* residualOut)
{
    REQUIRE(contextOf(transport), transport, source, radiosity, residualOut);
    return checkAndGather(transport, source, radiosity, residualOut);
}
