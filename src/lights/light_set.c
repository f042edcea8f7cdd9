// SPDX-License-Identifier: MIT
#include "lights/light_set.h"

#include "base/arena.h"

#include <string.h>

vplResult vplLightSet_Make(vplContext* context, int capacity, int stepCount, vplLightArrays* arraysOut,
                           vplLightSet** setOut)
{
    vplArena* arena = vplArena_Create(context);
    vplLightSet* set = vplArena_AllocZero(arena, 1, sizeof *set);
    const vplLightArrays arrays = {vplArena_Alloc(arena, (size_t)capacity, sizeof *arrays.lights),
                                   vplArena_AllocZero(arena, (size_t)stepCount, sizeof *arrays.stepCounts),
                                   vplArena_AllocZero(arena, (size_t)stepCount, sizeof *arrays.lightsInStep)};
    const vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *set = (vplLightSet){.lights = arrays.lights,
                             .stepCounts = arrays.stepCounts,
                             .lightsInStep = arrays.lightsInStep,
                             .stepCount = stepCount,
                             .context = context,
                             .arena = arena};
        *arraysOut = arrays;
    }
    return vplArena_Deliver(arena, result, set, setOut);
}

void vplLightSet_Destroy(vplLightSet* set)
{
    vplArena_Destroy(set != NULL ? set->arena : NULL);
}

vplResult vplLightSet_MakeSubset(const vplLightSet* from, int capacity, vplLightArrays* arraysOut,
                                 vplLightSet** setOut)
{
    TRY(vplLightSet_Make(from->context, capacity, from->stepCount, arraysOut, setOut));
    vplLightSet* set = *setOut;
    set->escaped = from->escaped;
    set->rays = from->rays;
    set->rayObjectTests = from->rayObjectTests;
    set->particleCount = from->particleCount;
    memcpy(arraysOut->stepCounts, from->stepCounts, (size_t)from->stepCount * sizeof *from->stepCounts);
    return VPL_SUCCESS;
}

// Adds the lights of `from` to the set, their weights times a factor.
static void append(const vplLightSet* from, float factor, const vplLightArrays* arrays, vplLightSet* set)
{
    for (int i = 0; i < from->lightCount; i++) {
        vplVirtualLight* light = &arrays->lights[set->lightCount++];
        *light = from->lights[i];
        light->weight *= factor;
    }
    for (int i = 0; i < from->stepCount; i++) {
        arrays->stepCounts[i] += from->stepCounts[i];
        arrays->lightsInStep[i] += from->lightsInStep[i];
    }
    set->escaped += from->escaped;
    set->rays += from->rays;
    set->rayObjectTests += from->rayObjectTests;
}

vplResult vplLightSet_Join(const vplLightSet* a, const vplLightSet* b, vplLightSet** setOut)
{
    const int steps = a->stepCount > b->stepCount ? a->stepCount : b->stepCount;
    vplLightArrays arrays;
    vplLightSet* set;
    TRY(vplLightSet_Make(a->context, a->lightCount + b->lightCount, steps, &arrays, &set));
    set->particleCount = a->particleCount > 0 ? a->particleCount : b->particleCount;
    append(a, 1, &arrays, set);
    append(b, b->particleCount > 0 ? (float)set->particleCount / (float)b->particleCount : 1, &arrays, set);
    *setOut = set;
    return VPL_SUCCESS;
}
