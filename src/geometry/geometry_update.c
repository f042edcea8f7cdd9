// SPDX-License-Identifier: MIT
// Makes the geometry of a scene that was edited: only objects that were changed are made anew.
#include "geometry/cut_outs.h"
#include "geometry/object_build.h"
#include "geometry/paint_data.h"

#include <string.h>

// The arrays of a finished geometry, which belong to it and are filled again.
static vplGeometryBuilder reopen(const vplGeometry* g, const vplScene* scene)
{
    return (vplGeometryBuilder){.scene = scene,
                                .objects = (vplGeometryObject*)g->objects,
                                .positions = (vplVec3*)g->positions,
                                .shadingNormals = (vplVec3*)g->shadingNormals,
                                .indices = (uint32_t*)g->indices,
                                .normals = (vplVec3*)g->normals,
                                .owners = (int*)g->owners,
                                .triangleMaterials = (int*)g->triangleMaterials,
                                .formulaObjects = (int*)g->formulaObjects,
                                .materials = (vplMaterialDef*)g->materials};
}

bool vplGeometry_CanUpdate(const vplGeometry* g, const vplScene* scene)
{
    return g != NULL && scene != NULL && g->scene == scene->identity &&
           g->objectCount == scene->objectCount && memcmp(g->origin, scene->origin, sizeof g->origin) == 0;
}

static bool isSameMaterial(const vplMaterialDef* before, const vplMaterialDef* now)
{
    vplMaterialDef unnamed = *now;
    unnamed.name = NULL;
    return memcmp(before, &unnamed, sizeof unnamed) == 0;
}

// True if an object has another material, or one of its materials was changed.
static bool isRecoloured(const vplGeometryBuilder* b, int index)
{
    const vplGeometryObject* object = &b->objects[index];
    const vplObjectDef* def = &b->scene->objects[index];
    bool same = object->material == def->material;
    int last = -1; // that was compared: neighbours often have the same
    for (int i = object->firstTriangle; same && i < object->firstTriangle + object->triangleCount; i++) {
        const int material = b->triangleMaterials[i];
        same = material == last || isSameMaterial(&b->materials[material], &b->scene->materials[material]);
        last = material;
    }
    return !same;
}

// Makes room for materials that were added. The first ones stay.
static vplResult growMaterials(vplGeometry* g, const vplScene* scene)
{
    if (scene->materialCount == g->materialCount) {
        return VPL_SUCCESS;
    }
    vplMaterialDef* materials = vplArena_AllocZero(g->arena, (size_t)scene->materialCount, sizeof *materials);
    if (materials == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    memcpy(materials, g->materials, (size_t)g->materialCount * sizeof *materials);
    vplArena_Free(g->arena, (void*)g->materials);
    g->materials = materials;
    g->materialCount = scene->materialCount;
    return VPL_SUCCESS;
}

// Finds what happened to an object, whose placement becomes the new one.
static vplResult findChanges(const vplGeometry* g, const vplGeometryBuilder* b, int index,
                             uint8_t* changesOut)
{
    vplPlacement* placement = &b->objects[index].placement;
    const vplPlacement before = *placement;
    TRY(vplPlacement_Create(g->context, &b->scene->objects[index].transform, placement));
    const bool moved = memcmp(&before, placement, sizeof before) != 0;
    *changesOut =
        (uint8_t)((moved ? VPL_OBJECT_MOVED : 0) | (isRecoloured(b, index) ? VPL_OBJECT_RECOLOURED : 0));
    return VPL_SUCCESS;
}

// Makes the triangles of changed objects anew; those of all objects if the paint does not fit.
static vplResult updateObjects(vplGeometry* g, const vplScene* scene, uint8_t* changes)
{
    const bool fits = vplPaintFits(g, scene);
    TRY(growMaterials(g, scene));
    const vplGeometryBuilder b = reopen(g, scene);
    for (int i = 0; i < g->objectCount; i++) {
        TRY(findChanges(g, &b, i, &changes[i]));
        changes[i] |= fits ? 0 : VPL_OBJECT_RECOLOURED;
    }
    vplFillMaterials(g, &b);
    for (int i = 0; i < g->objectCount; i++) {
        if (changes[i] != 0) {
            b.objects[i].material = scene->objects[i].material;
            TRY(vplFinishObject(&b, i));
        }
    }
    vplListFormulaObjects(g, &b);
    if (fits) {
        return g->paint != NULL ? vplUpdatePaint(scene, g, b.objects, changes) : VPL_SUCCESS;
    }
    vplPaint_Destroy(g->paint);
    g->paint = NULL;
    return vplBuildPaint(scene, g, b.objects);
}

static vplResult updateTrees(vplGeometry* g, const uint8_t* changes)
{
    bool solid, moved = false;
    for (int i = 0; i < g->objectCount; i++) {
        moved = moved || (changes[i] & VPL_OBJECT_MOVED) != 0;
    }
    TRY(vplUpdateCutOuts(g, changes, &solid));
    if (g->rayTree == NULL || (!moved && !solid) || (!solid && vplBvh_Refit(g->rayTree, g, changes))) {
        return VPL_SUCCESS;
    }
    const bool quick = g->rayTree->quick;
    vplBvh_Destroy(g->rayTree);
    g->rayTree = NULL;
    return vplGeometry_BuildTree(g, quick);
}

static vplResult update(vplGeometry* g, const vplScene* scene, uint8_t* changes)
{
    TRY(updateObjects(g, scene, changes));
    TRY(vplSummarise(g));
    TRY(vplMarkCoplanar(g, (vplGeometryObject*)g->objects));
    TRY(updateTrees(g, changes));
    if (vplEnvironment_IsOf(g->environment, scene)) {
        return VPL_SUCCESS;
    }
    vplEnvironment_Destroy(g->environment);
    g->environment = NULL;
    return vplEnvironment_Create(scene, &g->environment);
}

vplResult vplGeometry_Update(vplGeometry* geometry, const vplScene* scene)
{
    REQUIRE(CONTEXT_OF(geometry) ?: vplScene_GetContext(scene), geometry, scene);
    uint8_t* changes = vplAlloc(geometry->context, (size_t)geometry->objectCount, 1);
    if (changes == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const vplResult result = update(geometry, scene, changes);
    vplFree(geometry->context, changes);
    return result;
}
