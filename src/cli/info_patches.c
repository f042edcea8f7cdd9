// SPDX-License-Identifier: MIT
#include "cli/info_patches.h"

#include <stdlib.h>

static vplResult findSides(const vplScene* scene, const vplPatches* patches, vplPatchSides** sidesOut)
{
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    const int count = vplScene_GetEmitterCount(scene);
    vplEmitterDef* emitters = malloc(((size_t)count + 1) * sizeof *emitters);
    if (emitters == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < count; i++) {
        emitters[i] = *vplScene_GetEmitter(scene, i);
    }
    def.emitters = emitters;
    def.emitterCount = count;
    if (vplScene_GetCameraCount(scene) > 0) {
        def.viewpoints = &vplScene_GetCamera(scene, 0)->eye;
        def.viewpointCount = 1;
    }
    vplResult result = vplPatchSides_Create(patches, &def, sidesOut);
    free(emitters);
    return result;
}

vplResult measurePatches(const vplScene* scene, const vplRenderOptions* o, const vplGeometry* geometry,
                         PatchInfo* infoOut)
{
    vplPatchDef def = vplDefaultPatchDef();
    vplPatches* patches = NULL;
    vplPatchSides* sides = NULL;
    def.size = o->radiosity.patchSize;
    def.count = o->radiosity.patches;
    def.rounds = o->radiosity.subdivisions;
    vplResult result = vplPatches_Create(geometry, &def, &patches);
    if (result == VPL_SUCCESS) {
        result = findSides(scene, patches, &sides);
    }
    if (result == VPL_SUCCESS) {
        const int64_t count = sides->count;
        const bool many = o->radiosity.hierarchy == VPL_HIERARCHY_AUTO && count > VPL_ALL_PAIRS;
        *infoOut = (PatchInfo){.patches = patches->patchCount,
                               .sides = sides->count,
                               .longestEdge = (double)patches->longestEdge,
                               .linked = many || o->radiosity.hierarchy == VPL_HIERARCHY_ON,
                               .formFactorBytes = count * count * (int64_t)sizeof(float)};
    }
    vplPatchSides_Destroy(sides);
    vplPatches_Destroy(patches);
    return result;
}
