// SPDX-License-Identifier: MIT
// The stages between patches and light: the sides of patches that light can reach, their mesh, and form factors of all pairs or
// links.
#include "radiosity/sides/side.h"
#include "render/runner.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

// ---- poses
//
// Sides are found once for all frames. So a side counts as reachable if light or a camera reaches it from any
// point of their paths.

// Poses per path, evenly spaced from its first key to its last.
enum { POSES = 9 };

static double frameOf(double first, double last, int i)
{
    return first + (last - first) * i / (POSES - 1);
}

static vplResult poseEmitters(const vplRun* run, vplEmitterDef* emitters, int* countOut)
{
    *countOut = 0;
    for (int e = 0; e < run->plan->emitterCount; e++) {
        int keys;
        const vplEmitterKey* path = vplScene_GetEmitterPath(run->scene, e, &keys);
        for (int i = 0; i < (keys > 1 ? POSES : 1); i++) {
            const double frame = keys > 1 ? frameOf(path[0].frame, path[keys - 1].frame, i) : 0;
            TRY(vplScene_PoseEmitter(run->scene, e, frame, &emitters[(*countOut)++]));
        }
    }
    return VPL_SUCCESS;
}

static vplResult poseEyes(const vplRun* run, vplVec3* eyes, int* countOut)
{
    const int camera = run->plan->options.output.camera;
    int keys;
    const vplCameraKey* path = vplScene_GetCameraPath(run->scene, camera, &keys);
    *countOut = keys > 1 ? POSES : 1;
    for (int i = 0; i < *countOut; i++) {
        vplCameraDef pose;
        const double frame = keys > 1 ? frameOf(path[0].frame, path[keys - 1].frame, i) : 0;
        TRY(vplScene_PoseCamera(run->scene, camera, frame, &pose));
        eyes[i] = pose.eye;
    }
    return VPL_SUCCESS;
}

// ---- sides and their mesh

vplResult vplMakeSides(const vplRun* run, void** resultOut)
{
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    vplPatchSides* sides;
    const size_t poses = POSES * (size_t)run->plan->emitterCount;
    vplEmitterDef* emitters = vplArena_Alloc(run->scratch, poses, sizeof *emitters);
    vplVec3* eyes = vplArena_Alloc(run->scratch, POSES, sizeof *eyes);
    TRY(vplArena_Check(run->scratch));
    TRY(poseEmitters(run, emitters, &def.emitterCount));
    TRY(poseEyes(run, eyes, &def.viewpointCount));
    def.emitters = emitters;
    def.viewpoints = eyes;
    def.wholeTriangles = run->plan->options.radiosity.formFactors == VPL_FORM_FACTORS_INCENTRE;
    def.leaveFaint = run->plan->options.radiosity.faintSides == VPL_FAINT_SIDES_LEAVE;
    def.seed = run->plan->options.seed;
    def.progress = run->progress;
    def.progressUser = run->runner;
    TRY(vplPatchSides_Create(run->results[VPL_STAGE_PATCHES], &def, &sides));
    *resultOut = sides;
    return VPL_SUCCESS;
}

void vplDestroySides(void* result)
{
    vplPatchSides_Destroy(result);
}

void vplReportSides(const vplRun* run)
{
    const vplPatchSides* sides = run->results[VPL_STAGE_SIDES];
    run->stats->patchSides = sides->count;
    run->stats->litPatches = vplPatchSides_CountPatches(sides);
}

vplResult vplMakePatchMesh(const vplRun* run, void** resultOut)
{
    vplPatchMesh* mesh;
    TRY(vplPatchMesh_Create(run->results[VPL_STAGE_SIDES], &mesh));
    *resultOut = mesh;
    return VPL_SUCCESS;
}

void vplDestroyPatchMesh(void* result)
{
    vplPatchMesh_Destroy(result);
}

// ---- form factors

// One pair of points instead of four leaves the pictures' error as it is and takes two thirds of the drafts'
// time (cornell-area, 4000 patches).
enum { DRAFT_SAMPLES = 1 };

vplResult vplMakeFormFactors(const vplRun* run, void** resultOut)
{
    const vplRadiosityOptions* o = &run->plan->options.radiosity;
    const vplPatchSides* sides = run->results[VPL_STAGE_SIDES];
    vplLinkDef links = vplDefaultLinkDef();
    vplFormFactorDef factors = vplDefaultFormFactorDef();
    factors.kind = o->formFactors;
    factors.rowSums = links.rowSums = o->rowSums;
    links.error = o->linkError;
    factors.samples = links.samples = run->draft ? DRAFT_SAMPLES : o->formSamples;
    factors.seed = links.seed = run->plan->options.seed;
    factors.progress = links.progress = run->progress;
    factors.progressUser = links.progressUser = run->runner;
    vplExchangeFactors* f = vplArena_AllocZero(run->arena, 1, sizeof *f);
    TRY(vplArena_Check(run->arena));
    *resultOut = f;
    if (sides->count > run->plan->linkAbove) {
        TRY(vplLinks_Create(sides, &links, &f->links));
        run->stats->rays += f->links->rays;
    } else {
        TRY(vplFormFactors_Create(sides, &factors, &f->factors));
        run->stats->rays += f->factors->rays;
    }
    return VPL_SUCCESS;
}

void vplDestroyFormFactors(void* result)
{
    vplExchangeFactors* f = result;
    vplFormFactors_Destroy(f->factors);
    vplLinks_Destroy(f->links);
}

void vplReportFormFactors(const vplRun* run)
{
    const vplExchangeFactors* f = run->results[VPL_STAGE_FORM_FACTORS];
    run->stats->linked = f->links != NULL;
    run->stats->formFactors =
        f->links != NULL ? f->links->linkCount : (int64_t)f->factors->count * f->factors->count;
}
