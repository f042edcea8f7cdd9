// SPDX-License-Identifier: MIT
// The light that patches exchange, and its values at vertices.
#include "math/vec.h"
#include "radiosity/sides/side.h"
#include "render/runner.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <math.h>
#include <string.h>

void vplFindReflected(const vplPatchSides* sides, const vplRgb* radiosity, vplRgb* reflectedOut)
{
    for (int i = 0; i < sides->count; i++) {
        const vplRgb b = radiosity[i], e = sides->sides[i].emission;
        reflectedOut[i] = (vplRgb){b.r - e.r, b.g - e.g, b.b - e.b};
    }
}

vplResult vplReceive(const vplRun* run, const vplRgb* sent, vplRgb* irradianceOut)
{
    const vplTransport transport = vplTransportOf(run);
    const vplPatchLight* light = run->results[VPL_STAGE_PATCH_LIGHT];
    TRY(vplGatherRadiosity(&transport, sent, irradianceOut));
    for (int i = 0; i < transport.sides->count; i++) {
        irradianceOut[i] = vplRgbAdd(irradianceOut[i], light->direct[i]);
    }
    return VPL_SUCCESS;
}

// Drafts are solved less exactly, which saves a fifth of the time. With 0.01 patches are placed less well.
static const double DRAFT_RESIDUAL = 0.003;

// Finds the spectral radius only in the first solution: it depends on form factors alone, which are kept.
static vplResult solve(const vplRun* run, bool first, vplSolution* s)
{
    const vplRadiosityOptions* o = &run->plan->options.radiosity;
    const vplTransport transport = vplTransportOf(run);
    const vplPatchLight* light = run->results[VPL_STAGE_PATCH_LIGHT];
    const vplSolveStats last = s->stats;
    vplSolveDef def = vplDefaultSolveDef();
    def.solver = transport.links != NULL ? VPL_SOLVER_JACOBI : o->solver;
    def.iterations = o->iterations;
    def.residual = run->draft ? fmax(o->residual, DRAFT_RESIDUAL) : o->residual;
    def.spectrum = first && !run->draft;
    def.continues = run->plan->options.sequence.history != NULL || run->draft;
    def.progress = run->progress;
    def.progressUser = run->runner;
    TRY(vplSolveRadiosity(&transport, &def, light->source, s->radiosity, &s->stats));
    if (!first) {
        s->stats.spectralRadius = last.spectralRadius;
        s->stats.rowSumMin = last.rowSumMin;
        s->stats.rowSumMean = last.rowSumMean;
        s->stats.rowSumMax = last.rowSumMax;
    }
    return VPL_SUCCESS;
}

// Finds the irradiance by light that was reflected at least once. Light of area lights themselves is direct.
static vplResult gather(const vplRun* run, vplSolution* s)
{
    const vplTransport transport = vplTransportOf(run);
    vplRgb* reflected = vplArena_Alloc(run->scratch, (size_t)transport.sides->count, sizeof *reflected);
    TRY(vplArena_Check(run->scratch));
    vplFindReflected(transport.sides, s->radiosity, reflected);
    return vplGatherRadiosity(&transport, reflected, s->irradiance);
}

// The sweeps of a frame begin with the radiosities of the last frame as long as form factors are the same,
// which the document calls a "slight lag".
vplResult vplMakeSolution(const vplRun* run, void** resultOut)
{
    const vplPatchSides* sides = run->results[VPL_STAGE_SIDES];
    const vplPatchLight* light = run->results[VPL_STAGE_PATCH_LIGHT];
    const size_t count = (size_t)sides->count;
    const uint32_t build = run->builds[VPL_STAGE_FORM_FACTORS];
    vplSolution* s = run->before;
    const bool first = s == NULL || s->factorBuild != build;
    if (first) {
        s = vplArena_Alloc(run->arena, 1, sizeof *s);
        vplRgb* radiosity = vplArena_AllocZero(run->arena, count, sizeof *radiosity);
        vplRgb* irradiance = vplArena_AllocZero(run->arena, count, sizeof *irradiance);
        TRY(vplArena_Check(run->arena));
        *s = (vplSolution){.radiosity = radiosity, .irradiance = irradiance, .factorBuild = build};
    }
    *resultOut = s;
    if (first || run->plan->options.sequence.coherence == VPL_COHERENCE_OFF) {
        memcpy(s->radiosity, light->source, count * sizeof *s->radiosity);
    }
    TRY(solve(run, first, s));
    return gather(run, s);
}

void vplReportSolution(const vplRun* run)
{
    const vplSolution* s = run->results[VPL_STAGE_SOLUTION];
    run->stats->solve = s->stats;
}

// ---- at vertices

vplResult vplMakeVertexLight(const vplRun* run, void** resultOut)
{
    const vplRadiosityOptions* o = &run->plan->options.radiosity;
    const vplPatchMesh* mesh = run->results[VPL_STAGE_PATCH_MESH];
    const vplSolution* s = run->results[VPL_STAGE_SOLUTION];
    const bool all = run->plan->gathers; // rays meet light of lamps, too; that of emitters comes from cells
    vplRgb* corners = vplArena_Alloc(run->arena, 2 * (size_t)mesh->vertexCount, sizeof *corners);
    vplRgb* received = vplArena_Alloc(run->scratch, all ? (size_t)mesh->sides->count : 0, sizeof *received);
    TRY(vplArena_Check(run->arena));
    TRY(vplArena_Check(run->scratch));
    *resultOut = corners;
    if (all) {
        const vplTransport transport = vplTransportOf(run);
        TRY(vplGatherRadiosity(&transport, s->radiosity, received));
    }
    const vplRgb* values = all ? received : s->irradiance;
    TRY(vplPatchMesh_Interpolate(mesh, o->vertexWeight, values, corners));
    TRY(vplPatchMesh_Sharpen(mesh, o->vertexWeight, values, o->sharpen, corners));
    // Rays of pixels find the small things at groups themselves.
    return mesh->sides->patches->groupCount > 0 && !all ? vplGatherAtGroups(run, mesh, corners) : VPL_SUCCESS;
}
