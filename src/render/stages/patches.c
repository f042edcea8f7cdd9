// SPDX-License-Identifier: MIT
// The stage that makes patches, uniform or adaptive.
#include "geometry/triangle.h"
#include "radiosity/sides/side.h"
#include "render/runner.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <string.h>

static vplResult create(const vplRun* run, int count, vplPatches** patchesOut)
{
    const vplRadiosityOptions* o = &run->plan->options.radiosity;
    vplPatchDef def = vplDefaultPatchDef();
    def.size = o->patchSize;
    def.count = count;
    def.rounds = o->subdivisions;
    def.cut = o->cuts == VPL_PATCH_CUTS_ON;
    def.group = o->groups == VPL_PATCH_GROUPS_ON;
    return vplPatches_Create(run->results[VPL_STAGE_GEOMETRY], &def, patchesOut);
}

// ---- patches in the dark
//
// Cuts leave many pieces inside walls. They take no part, so they are not among the patches that a user asks for, and
// are not bisected.

// Marks the nodes of patches that light does not reach. Returns how many there are.
static vplResult markDark(const vplRun* run, const vplPatches* patches, uint8_t* isDark, int* countOut)
{
    vplRun draft = *run;
    draft.results[VPL_STAGE_PATCHES] = patches;
    void* made;
    TRY(vplMakeSides(&draft, &made));
    for (int i = 0; i < patches->patchCount; i++) {
        isDark[patches->patches[i]] = vplSideOf(made, i, 0) < 0 && vplSideOf(made, i, 1) < 0;
    }
    *countOut = patches->patchCount - vplPatchSides_CountPatches(made);
    vplDestroySides(made);
    return VPL_SUCCESS;
}

static vplResult bisectLit(const vplRun* run, int count, const vplPatches* pieces, vplPatches** patchesOut,
                           int* darkOut)
{
    uint8_t* isDark = vplArena_AllocZero(run->scratch, (size_t)pieces->nodeCount, 1);
    TRY(vplArena_Check(run->scratch));
    TRY(markDark(run, pieces, isDark, darkOut));
    const int most = VPL_MAX_PATCHES - *darkOut, rounds = run->plan->options.radiosity.subdivisions;
    return vplPatches_BisectLongest(pieces, isDark, *darkOut + (count < most ? count : most), rounds,
                                    patchesOut);
}

// Makes `count` patches, and *darkOut more that light does not reach.
static vplResult bisect(const vplRun* run, int count, vplPatches** patchesOut, int* darkOut)
{
    const vplRadiosityOptions* o = &run->plan->options.radiosity;
    *darkOut = 0;
    if (o->cuts != VPL_PATCH_CUTS_ON || o->groups == VPL_PATCH_GROUPS_ON || o->patchSize > 0) {
        return create(run, count, patchesOut);
    }
    vplPatches* pieces;
    TRY(create(run, 1, &pieces));
    const vplResult result = bisectLit(run, count, pieces, patchesOut, darkOut);
    vplPatches_Destroy(pieces);
    return result;
}

// ---- adaptive patches

// Rounds begin with a quarter of the patches and grow by half: four drafts and a solution. Doubling leaves
// 1.6 times the squared error; smaller steps gain 3 to 6 % for twice the rounds (cornell-area, room-area; 500
// to 4000 patches).
static const double ADAPTIVE_START = 0.25, ADAPTIVE_GROWTH = 1.5;
enum { ADAPTIVE_ROUNDS = 4 }; // usually

static const vplStageId DRAFT_STAGES[] = {VPL_STAGE_SIDES, VPL_STAGE_PATCH_MESH, VPL_STAGE_FORM_FACTORS,
                                          VPL_STAGE_PATCH_LIGHT, VPL_STAGE_SOLUTION};
enum { DRAFT_STAGE_COUNT = sizeof DRAFT_STAGES / sizeof *DRAFT_STAGES };

// Rays from each vertex. With 64 to 1024 of them the pictures' error differs by less than its noise, a tenth.
enum { GATHER_RAYS = 128 };

// Finds the priority of each patch from how much light differs between its vertices, where means over patches
// would hide how dark a corner is, and from how much direct light differs within it.
static vplResult findPriorities(const vplRun* run, vplArena* scratch, float* priorityOut)
{
    const vplRenderOptions* o = &run->plan->options;
    const vplPatchSides* sides = run->results[VPL_STAGE_SIDES];
    const vplPatchMesh* mesh = run->results[VPL_STAGE_PATCH_MESH];
    const vplPatchLight* light = run->results[VPL_STAGE_PATCH_LIGHT];
    const vplSolution* solution = run->results[VPL_STAGE_SOLUTION];
    const size_t count = (size_t)sides->count, corners = 2 * (size_t)mesh->vertexCount;
    vplRgb* reflected = vplArena_Alloc(scratch, count, sizeof *reflected);
    vplRgb* emission = vplArena_Alloc(scratch, count, sizeof *emission);
    vplRgb* direct = vplArena_Alloc(scratch, count, sizeof *direct); // of area lights as well as of emitters
    vplRgb* vertexIrradiance = vplArena_Alloc(scratch, corners, sizeof *vertexIrradiance);
    vplRgb* vertexDirect = vplArena_Alloc(scratch, corners, sizeof *vertexDirect);
    TRY(vplArena_Check(scratch));
    vplFindReflected(sides, solution->radiosity, reflected);
    const vplVertexGather gather = {.radiosity = reflected,
                                    .rays = GATHER_RAYS,
                                    .seed = o->seed,
                                    .progress = run->progress,
                                    .progressUser = run->runner};
    TRY(vplPatchMesh_Gather(mesh, &gather, vertexIrradiance, &run->stats->rays));
    for (size_t i = 0; i < count; i++) {
        emission[i] = sides->sides[i].emission;
    }
    TRY(vplReceive(run, emission, direct));
    TRY(vplPatchMesh_Interpolate(mesh, o->radiosity.vertexWeight, direct, vertexDirect));
    vplPatchPriorityDef def = vplDefaultPatchPriorityDef();
    def.irradiance = solution->irradiance;
    def.vertexIrradiance = vertexIrradiance;
    def.vertexDirect = vertexDirect;
    def.directSpread = light->spread;
    return vplFindPatchPriority(mesh, &def, priorityOut);
}

// Solves a draft and divides the patches where the solution asks for it, until there are `count`.
static vplResult refine(vplRunner* draft, vplPatches* patches, int count, vplPatches** patchesOut)
{
    draft->run.results[VPL_STAGE_PATCHES] = patches;
    draft->stageTo = 0;
    if (draft->run.plan->hasSky) { // whose light patches receive
        TRY(vplRunner_RunStage(draft, VPL_STAGE_AREA_LIGHTS));
    }
    for (int i = 0; i < DRAFT_STAGE_COUNT; i++) {
        TRY(vplRunner_RunStage(draft, DRAFT_STAGES[i]));
    }
    vplArena* scratch = vplArena_Create(draft->run.context);
    float* priority = vplArena_Alloc(scratch, (size_t)patches->patchCount, sizeof *priority);
    vplResult result = vplArena_Check(scratch);
    if (result == VPL_SUCCESS) {
        result = findPriorities(&draft->run, scratch, priority);
    }
    if (result == VPL_SUCCESS) {
        result = vplPatches_Refine(patches, priority, count, patchesOut);
    }
    vplArena_Destroy(scratch);
    return result;
}

// Each round runs its stages with a history of its own.
static vplResult runDraft(const vplRun* run, vplPatches* patches, int count, vplPatches** patchesOut)
{
    vplRunner draft = vplRunner_Nest(run);
    TRY(vplHistory_Create(run->context, &draft.history));
    draft.run.draft = true;
    const vplResult result = refine(&draft, patches, count, patchesOut);
    vplHistory_Destroy(draft.history);
    vplRunner_Unnest(run, &draft);
    return result;
}

static vplResult adapt(const vplRun* run, vplPatches** patchesOut)
{
    const int asked = run->plan->options.radiosity.patches;
    double count = asked * ADAPTIVE_START;
    vplPatches* patches;
    int dark;
    TRY(bisect(run, count >= 1 ? (int)count : 1, &patches, &dark));
    const int wanted = dark < VPL_MAX_PATCHES - asked ? asked + dark : VPL_MAX_PATCHES;
    for (int round = 0; patches->patchCount < wanted; round++) {
        vplRun_BeginPart(run, round < ADAPTIVE_ROUNDS ? round : ADAPTIVE_ROUNDS - 1, ADAPTIVE_ROUNDS);
        const int before = patches->patchCount;
        vplPatches* finer = NULL;
        count = (before - dark) * ADAPTIVE_GROWTH + 1 + dark;
        const vplResult result = runDraft(run, patches, count < wanted ? (int)count : wanted, &finer);
        vplPatches_Destroy(patches);
        if (result != VPL_SUCCESS) {
            return result;
        }
        patches = finer;
        if (patches->patchCount == before) {
            break; // nothing is worth dividing
        }
    }
    *patchesOut = patches;
    return VPL_SUCCESS;
}

vplResult vplMakePatches(const vplRun* run, void** resultOut)
{
    vplPatches* patches;
    const vplRadiosityOptions* o = &run->plan->options.radiosity;
    int dark;
    TRY(o->placement == VPL_PATCHES_ADAPTIVE ? adapt(run, &patches)
                                             : bisect(run, o->patches, &patches, &dark));
    *resultOut = patches;
    return VPL_SUCCESS;
}

void vplDestroyPatches(void* result)
{
    vplPatches_Destroy(result);
}

void vplReportPatches(const vplRun* run)
{
    const vplPatches* patches = run->results[VPL_STAGE_PATCHES];
    run->stats->patches = patches->patchCount;
    run->stats->patchGroups = patches->groupCount;
    run->stats->groupedTriangles = vplPatches_CountGrouped(patches);
}
