// SPDX-License-Identifier: MIT
#include "lights/light_set.h"

#include "base/context.h"

vplResult vplLightSet_Make(vplContext* context, int lightCount, int stepCount, vplLightSet** setOut)
{
    vplLightSet* set = vplAllocZero(context, 1, sizeof *set);
    if (set == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    set->context = context;
    set->lightCount = lightCount;
    set->stepCount = stepCount;
    set->lights = vplAllocZero(context, (size_t)lightCount, sizeof *set->lights);
    set->stepCounts = vplAllocZero(context, (size_t)stepCount, sizeof *set->stepCounts);
    set->lightsInStep = vplAllocZero(context, (size_t)stepCount, sizeof *set->lightsInStep);
    if (set->lights == NULL || set->stepCounts == NULL || set->lightsInStep == NULL) {
        vplLightSet_Destroy(set);
        return VPL_OUT_OF_MEMORY;
    }
    *setOut = set;
    return VPL_SUCCESS;
}

vplResult vplLightSet_Join(const vplLightSet* a, const vplLightSet* b, vplLightSet** setOut)
{
    const int steps = a->stepCount > b->stepCount ? a->stepCount : b->stepCount;
    vplLightSet* set;
    vplResult result = vplLightSet_Make(a->context, a->lightCount + b->lightCount, steps, &set);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplVirtualLight* lights = (vplVirtualLight*)set->lights;
    for (int i = 0; i < set->lightCount; i++) {
        lights[i] = i < a->lightCount ? a->lights[i] : b->lights[i - a->lightCount];
    }
    set->particleCount = a->particleCount > 0 ? a->particleCount : b->particleCount;
    const float factor = b->particleCount > 0 ? (float)set->particleCount / (float)b->particleCount : 1;
    for (int i = a->lightCount; i < set->lightCount; i++) {
        lights[i].weight *= factor;
    }
    for (int i = 0; i < steps; i++) {
        ((int*)set->stepCounts)[i] =
            (i < a->stepCount ? a->stepCounts[i] : 0) + (i < b->stepCount ? b->stepCounts[i] : 0);
        ((int*)set->lightsInStep)[i] =
            (i < a->stepCount ? a->lightsInStep[i] : 0) + (i < b->stepCount ? b->lightsInStep[i] : 0);
    }
    set->escaped = a->escaped + b->escaped;
    set->rays = a->rays + b->rays;
    set->rayObjectTests = a->rayObjectTests + b->rayObjectTests;
    *setOut = set;
    return VPL_SUCCESS;
}
