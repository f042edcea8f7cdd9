// SPDX-License-Identifier: MIT
// Placement of virtual lights for a view: many more particles are simulated than were asked for, and lights
// are chosen by their contribution to the picture.
// Based on: Franchi and Ferrante, Virtual Point Lights, "Considerations and Future Work", the first route.
#include "lights/placement.h"

#include <math.h>

enum { PLACEMENT_COOKIE = 0x56504c61, MAX_CANDIDATES = 1 << 22 };

// 256 points and 10 % by flux: errors of 0.052 in room and 0.048 in sponza-sun with 300 particles, 0.067 and
// 0.065 with 64 points (bench/placement).
vplPlacementDef vplDefaultPlacementDef(void)
{
    vplPlacementDef def = {0};
    def.camera = vplDefaultCameraDef();
    def.width = 1280;
    def.height = 720;
    def.pointCount = 256;
    def.oversampling = 32;
    def.shadows = true;
    def.fluxShare = 0.1f;
    def.cookie = PLACEMENT_COOKIE;
    return def;
}

vplResult vplPlacementDef_Check(const vplContext* context, const vplPlacementDef* def)
{
    if (def->cookie != PLACEMENT_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplPlacementDef was not made by vplDefaultPlacementDef");
    }
    const struct {
        const char* name;
        int value, high;
    } ints[] = {{"width", def->width, VPL_MAX_IMAGE_SIZE},
                {"height", def->height, VPL_MAX_IMAGE_SIZE},
                {"pointCount", def->pointCount, 1 << 20},
                {"oversampling", def->oversampling, 4096}};
    for (int i = 0; i < 4; i++) {
        if (ints[i].value < 1 || ints[i].value > ints[i].high) {
            return vplFail(context, VPL_INVALID_ARGUMENT, "vplPlacementDef.%s is %d, must be in [1, %d]",
                           ints[i].name, ints[i].value, ints[i].high);
        }
    }
    if (!(def->fluxShare > 0 && def->fluxShare <= 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPlacementDef.fluxShare is %g, must be in (0, 1]",
                       (double)def->fluxShare);
    }
    if (!(def->minDistance >= 0 && isfinite(def->minDistance))) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplPlacementDef.minDistance is %g, must be finite and >= 0",
                       (double)def->minDistance);
    }
    return VPL_SUCCESS;
}

// Returns by how many times the particles may be multiplied.
static int oversample(const vplPlacementDef* def, int particles, int64_t lights)
{
    int64_t times = lights > 0 ? MAX_CANDIDATES / lights : 1;
    times = times < def->oversampling ? times : def->oversampling;
    times = particles > 0 && times > VPL_MAX_LIGHTS / particles ? VPL_MAX_LIGHTS / particles : times;
    return times > 1 ? (int)times : 1;
}

// Estimates, from many more particles, how many lights the particles that were asked for would leave.
static double countPlain(const vplLightSet* candidates, const int* counts, int stepCount)
{
    double sum = 0;
    for (int i = 0, at = 0; i < stepCount; i++) {
        int drawn = 0;
        for (int k = 0; k < candidates->lightsInStep[i]; k++) {
            drawn += candidates->lights[at++].object >= 0;
        }
        sum += (double)counts[i] * drawn / candidates->stepCounts[i];
    }
    return rint(sum);
}

// Measures the candidates and chooses among them.
static vplResult choose(const vplGeometry* geometry, const vplParticlePass* plain, const vplPlacementDef* def,
                        vplArena* scratch, vplLightSet* candidates, vplLightSet** setOut)
{
    vplStepTotals totals;
    int64_t rays;
    int* counts = vplArena_Alloc(scratch, (size_t)candidates->stepCount, sizeof *counts);
    float* contributions = vplArena_Alloc(scratch, (size_t)candidates->lightCount, sizeof *contributions);
    TRY(vplArena_Check(scratch));
    TRY(vplCountParticles(geometry->context, plain, counts, candidates->stepCount, &totals));
    TRY(vplMeasureLights(geometry, candidates, def, contributions, &rays));
    candidates->rays += rays;
    const double count = countPlain(candidates, counts, totals.stepCount);
    return vplChooseLights(candidates, contributions, count, def, setOut);
}

vplResult vplPlaceLights(const vplGeometry* geometry, const vplEmitterDef* emitters, int emitterCount,
                         const vplParticleDef* particles, const vplPlacementDef* def, vplLightSet** setOut)
{
    REQUIRE(CONTEXT_OF(geometry), geometry, particles, def, setOut);
    REQUIRE_ARRAY(CONTEXT_OF(geometry), emitters, emitterCount);
    vplContext* context = geometry->context;
    const vplParticlePass plain = {0, particles->particleCount, particles->reflectivity};
    vplStepTotals totals;
    TRY(vplPlacementDef_Check(context, def));
    TRY(vplCountParticles(context, &plain, NULL, 0, &totals));
    vplParticleDef many = *particles;
    const int times = oversample(def, plain.count, totals.lightCount);
    many.particleCount *= times;
    many.firstParticle *= times;
    vplLightSet* candidates;
    TRY(vplSimulateParticles(geometry, emitters, emitterCount, &many, &candidates));
    vplArena* scratch = vplArena_Create(context);
    const vplResult result = choose(geometry, &plain, def, scratch, candidates, setOut);
    vplArena_Destroy(scratch);
    vplLightSet_Destroy(candidates);
    return result;
}
