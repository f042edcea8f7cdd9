// SPDX-License-Identifier: MIT
// Reads model files by their endings.
#include "scene/model.h"

#include "base/file.h"
#include "scene/gltf.h"

#include <string.h>
#include <strings.h>

static bool endsIn(const char* path, const char* ending)
{
    const size_t length = strlen(path), part = strlen(ending);
    return length >= part && strcasecmp(path + length - part, ending) == 0;
}

vplModelKind vplModelKindOf(const char* path)
{
    static const char* const endings[] = {".obj", ".ply", ".stl", ".gltf"};
    for (int i = 0; i < 4; i++) {
        if (endsIn(path, endings[i])) {
            return (vplModelKind)(VPL_MODEL_OBJ + i);
        }
    }
    return endsIn(path, ".glb") ? VPL_MODEL_GLTF : VPL_MODEL_NONE;
}

bool vplIsModelPath(const char* path)
{
    if (path == NULL) {
        return false;
    }
    return vplModelKindOf(path) != VPL_MODEL_NONE;
}

const char* vplForeignEnding(const char* path)
{
    static const char* const endings[] = {".fbx",  ".dae",  ".blend", ".3ds", ".usd", ".usda", ".usdc",
                                          ".usdz", ".x3d",  ".wrl",   ".3mf", ".off", ".step", ".stp",
                                          ".abc",  ".pbrt", ".max",   ".skp", ".lwo", ".vrm",  NULL};
    for (int i = 0; endings[i] != NULL; i++) {
        if (endsIn(path, endings[i])) {
            return endings[i];
        }
    }
    return NULL;
}

// ---- files of one mesh

// Reads the mesh, and adds it with its material.
static vplResult readMesh(vplScene* scene, vplText* bytes, vplReadMeshFcn* read, int* indexOut)
{
    vplMaterialDef material = vplDefaultMaterialDef(); // unnamed
    vplRawMesh raw = {.file = bytes->file, .arena = vplArena_Create(scene->context)};
    vplArena* scratch = vplArena_Create(scene->context);
    vplResult result = vplArena_Check(scratch);
    result = result == VPL_SUCCESS ? read(bytes, scratch, scene->materialCount, &raw) : result;
    vplArena_Destroy(scratch);
    material.diffuse = raw.colors != NULL ? (vplRgb){1, 1, 1} : material.diffuse;
    result = result == VPL_SUCCESS ? vplScene_AdoptMaterial(scene, &material, NULL) : result;
    result = result == VPL_SUCCESS ? vplScene_AddRawMesh(scene, &raw, indexOut) : result;
    vplArena_Destroy(raw.arena);
    return result != VPL_SUCCESS || *indexOut >= 0
               ? result
               : vplText_FailAt(bytes, bytes->bytes,
                                "found only faces without area, expected one that has some");
}

static vplResult loadMesh(vplScene* scene, const char* path, vplReadMeshFcn* read, int* indexOut)
{
    vplText bytes = {.context = scene->context, .file = path};
    TRY(vplReadFile(scene->context, path, &bytes.bytes, &bytes.size));
    const int materialCount = scene->materialCount;
    int mesh = -1;
    const vplResult result = readMesh(scene, &bytes, read, &mesh);
    vplText_Close(&bytes);
    if (result != VPL_SUCCESS) {
        scene->materialCount = materialCount;
    } else if (indexOut != NULL) {
        *indexOut = mesh;
    }
    return result;
}

vplResult vplScene_LoadMesh(vplScene* scene, const char* path, int* indexOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, path);
    switch (vplModelKindOf(path)) {
    case VPL_MODEL_OBJ:
        return vplScene_LoadObj(scene, path, indexOut);
    case VPL_MODEL_PLY:
        return loadMesh(scene, path, vplReadPly, indexOut);
    case VPL_MODEL_STL:
        return loadMesh(scene, path, vplReadStl, indexOut);
    default:
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "%s: a file of one mesh must end in .obj, .ply or .stl", path);
    }
}

// ---- any file

vplResult vplScene_ReadModel(vplScene* scene, const char* path, bool whole, vplModel* model)
{
    if (vplModelKindOf(path) == VPL_MODEL_GLTF) {
        return vplScene_ReadGltf(scene, path, whole, model);
    }
    vplModelPart part = {.toModel = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}};
    TRY(vplScene_LoadMesh(scene, path, &part.mesh));
    TRY(vplArena_Reserve(model->arena, &model->parts, &model->capacity, model->count + 1, sizeof part));
    model->parts[model->count++] = part;
    return VPL_SUCCESS;
}

vplResult vplScene_AddPart(vplScene* scene, const vplAffine* outer, const vplModelPart* part,
                           const vplObjectDef* def)
{
    vplObjectDef object = *def;
    const vplAffine whole = vplAffine_Multiply(outer, &part->toModel);
    int index;
    object.type = VPL_OBJECT_MESH;
    object.mesh = part->mesh;
    object.transform = vplAffine_ToMat4(&whole);
    TRY(vplScene_AddObject(scene, &object, &index));
    if (part->placeCount == 0) {
        return VPL_SUCCESS;
    }
    vplTransformKey* keys = vplAlloc(scene->context, (size_t)part->placeCount, sizeof *keys);
    for (int i = 0; i < part->placeCount && keys != NULL; i++) {
        const vplAffine place = vplAffine_Multiply(outer, &part->places[i]);
        keys[i] = (vplTransformKey){(double)(part->firstFrame + i), vplAffine_ToMat4(&place)};
    }
    const vplResult result =
        keys != NULL ? vplScene_SetObjectPath(scene, index, keys, part->placeCount) : VPL_OUT_OF_MEMORY;
    vplFree(scene->context, keys);
    return result;
}

static vplResult addObjects(vplScene* scene, const char* path, const vplObjectDef* def, vplModel* model)
{
    const vplAffine outer = vplAffine_FromMat4(&def->transform);
    TRY(vplScene_ReportFault(scene, "vplObjectDef.", vplCheckTransform(&def->transform)));
    TRY(vplScene_ReadModel(scene, path, false, model));
    for (size_t i = 0; i < model->count; i++) {
        vplObjectDef object = *def;
        object.name = def->name != NULL ? def->name : model->parts[i].name;
        TRY(vplScene_AddPart(scene, &outer, &model->parts[i], &object));
    }
    return VPL_SUCCESS;
}

vplResult vplScene_LoadModel(vplScene* scene, const char* path, const vplObjectDef* def, int* firstOut,
                             int* countOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, path, def);
    vplModel model = {.arena = vplArena_Create(scene->context)};
    const int materials = scene->materialCount, meshes = scene->meshCount, objects = scene->objectCount,
              movers = scene->moverCount;
    const vplResult result = vplIsModelPath(path) ? addObjects(scene, path, def, &model)
                                                  : vplFail(scene->context, VPL_INVALID_ARGUMENT,
                                                            "%s: must end in %s", path, VPL_MODEL_ENDINGS);
    vplArena_Destroy(model.arena);
    if (result != VPL_SUCCESS) {
        scene->materialCount = materials;
        scene->meshCount = meshes;
        scene->objectCount = objects;
        scene->moverCount = movers;
        return result;
    }
    if (firstOut != NULL) {
        *firstOut = objects;
    }
    if (countOut != NULL) {
        *countOut = scene->objectCount - objects;
    }
    return result;
}
