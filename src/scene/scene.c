// SPDX-License-Identifier: MIT
#include "scene/scene.h"
#include "scene/texture.h"

#include <math.h>
#include <string.h>

vplResult vplScene_Create(vplContext* context, vplScene** sceneOut)
{
    REQUIRE(context, context, sceneOut);
    vplArena* arena = vplArena_Create(context);
    vplScene* scene = vplArena_AllocZero(arena, 1, sizeof *scene);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        scene->context = context;
        scene->arena = arena;
        scene->identity = vplNextStamp(context);
        vplScene_Touch(scene, true);
        scene->environment = vplDefaultEnvironmentDef();
    }
    return vplArena_Deliver(arena, result, scene, sceneOut);
}

void vplScene_Destroy(vplScene* scene)
{
    if (scene != NULL) {
        vplScene_DropTextures(scene, 0);
        vplArena_Destroy(scene->arena);
    }
}

size_t vplScene_GetBytes(const vplScene* scene)
{
    size_t bytes = vplArena_GetBytes(scene->arena);
    for (int i = 0; i < scene->textureCount; i++) {
        bytes += vplArena_GetBytes(scene->textures[i].decoded->arena);
    }
    return bytes;
}

void vplScene_DropTextures(vplScene* scene, int count)
{
    while (scene->textureCount > count) {
        vplTexture_Release(scene->textures[--scene->textureCount].decoded);
    }
}

void vplScene_Touch(vplScene* scene, bool surfaces)
{
    scene->stamp = vplNextStamp(scene->context);
    scene->surfaces = surfaces ? scene->stamp : scene->surfaces;
}

vplResult vplScene_Deliver(vplScene* scene, vplResult result, vplScene** sceneOut)
{
    if (result == VPL_SUCCESS) {
        *sceneOut = scene;
    } else {
        vplScene_Destroy(scene);
    }
    return result;
}

// One of the scene's growing arrays.
typedef struct List {
    void* array; // address of the pointer to its elements
    size_t* capacity;
    int* count;
    size_t size; // of an element
} List;

#define LIST(scene, one, many)                                                                               \
    ((List){&(scene)->many, &(scene)->one##Capacity, &(scene)->one##Count, sizeof *(scene)->many})

static vplResult append(vplScene* scene, List list, const void* element, int* indexOut)
{
    const size_t count = (size_t)*list.count;
    TRY(vplArena_Reserve(scene->arena, list.array, list.capacity, count + 1, list.size));
    char* elements;
    memcpy(&elements, list.array, sizeof elements);
    memcpy(elements + count * list.size, element, list.size);
    if (indexOut != NULL) {
        *indexOut = *list.count;
    }
    ++*list.count;
    vplScene_Touch(scene, list.count != &scene->cameraCount && list.count != &scene->emitterCount);
    return VPL_SUCCESS;
}

// Replaces a name, or NULL, by a copy in the scene.
static vplResult copyName(vplScene* scene, const char** name)
{
    if (*name != NULL) {
        *name = vplArena_CopyString(scene->arena, *name);
        return *name != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    }
    return VPL_SUCCESS;
}

vplResult vplScene_SetOrigin(vplScene* scene, const double origin[3])
{
    REQUIRE(CONTEXT_OF(scene), scene, origin);
    for (int i = 0; i < 3; i++) {
        if (!(fabs(origin[i]) <= VPL_MAX_MAGNITUDE_DOUBLE)) {
            return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                           "vplScene_SetOrigin: origin[%d] is %g, must be in [%g, %g]", i, origin[i],
                           -VPL_MAX_MAGNITUDE_DOUBLE, VPL_MAX_MAGNITUDE_DOUBLE);
        }
    }
    for (int i = 0; i < 3; i++) {
        scene->origin[i] = origin[i];
    }
    vplScene_Touch(scene, true);
    return VPL_SUCCESS;
}

void vplScene_GetOrigin(const vplScene* scene, double originOut[3])
{
    if (scene == NULL || originOut == NULL) {
        return;
    }
    memcpy(originOut, scene->origin, sizeof scene->origin);
}

vplResult vplScene_AddCamera(vplScene* scene, const vplCameraDef* def, int* indexOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    const vplCamera camera = {.def = *def};
    TRY(vplScene_CheckCamera(scene, "vplCameraDef.", def));
    return append(scene, LIST(scene, camera, cameras), &camera, indexOut);
}

vplResult vplScene_AddTexture(vplScene* scene, const vplTextureDef* def, int* indexOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    TRY(vplScene_CheckTexture(scene, def));
    vplSceneTexture texture = {.def = *def};
    texture.def.texels = NULL;
    texture.def.linear = NULL;
    TRY(copyName(scene, &texture.def.name));
    TRY(vplTexture_Create(scene->context, def, &texture.decoded));
    const vplResult result = append(scene, LIST(scene, texture, textures), &texture, indexOut);
    if (result != VPL_SUCCESS) {
        vplTexture_Release(texture.decoded);
    }
    return result;
}

vplResult vplScene_AddMaterial(vplScene* scene, const vplMaterialDef* def, int* indexOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    TRY(vplScene_CheckMaterial(scene, def, scene->materialCount));
    vplMaterialDef copy = *def;
    TRY(copyName(scene, &copy.name));
    return vplScene_AdoptMaterial(scene, &copy, indexOut);
}

vplResult vplScene_AdoptMaterial(vplScene* scene, const vplMaterialDef* material, int* indexOut)
{
    return append(scene, LIST(scene, material, materials), material, indexOut);
}

vplResult vplScene_AdoptMesh(vplScene* scene, const vplMeshDef* mesh, vplArena* arena, int* indexOut)
{
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        result = append(scene, LIST(scene, mesh, meshes), mesh, indexOut);
    }
    if (result == VPL_SUCCESS) {
        vplArena_Absorb(scene->arena, arena);
    } else {
        vplArena_Destroy(arena);
    }
    return result;
}

static void* copyArray(vplArena* arena, const void* from, int count, size_t size)
{
    return from != NULL ? vplArena_Copy(arena, from, (size_t)count, size) : NULL;
}

vplResult vplScene_AddMesh(vplScene* scene, const vplMeshDef* def, int* indexOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    TRY(vplScene_CheckMesh(scene, def));
    vplArena* arena = vplArena_Create(scene->context);
    vplMeshDef copy = *def;
    copy.positions = copyArray(arena, def->positions, def->vertexCount, sizeof *def->positions);
    copy.normals = copyArray(arena, def->normals, def->vertexCount, sizeof *def->normals);
    copy.indices = copyArray(arena, def->indices, def->triangleCount, 3 * sizeof *def->indices);
    copy.materials = copyArray(arena, def->materials, def->triangleCount, sizeof *def->materials);
    copy.texcoords = copyArray(arena, def->texcoords, def->vertexCount, 2 * sizeof *def->texcoords);
    copy.colors = copyArray(arena, def->colors, def->vertexCount, sizeof *def->colors);
    return vplScene_AdoptMesh(scene, &copy, arena, indexOut);
}

vplResult vplScene_AddObject(vplScene* scene, const vplObjectDef* def, int* indexOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    TRY(vplScene_CheckObject(scene, def));
    vplObjectDef copy = *def;
    TRY(copyName(scene, &copy.name));
    return append(scene, LIST(scene, object, objects), &copy, indexOut);
}

vplResult vplScene_AddEmitter(vplScene* scene, const vplEmitterDef* def, int* indexOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    const vplEmitter emitter = {.def = *def};
    TRY(vplScene_CheckEmitter(scene, def));
    return append(scene, LIST(scene, emitter, emitters), &emitter, indexOut);
}

// ---- changes

vplResult vplScene_SetCamera(vplScene* scene, int index, const vplCameraDef* def)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    TRY(vplScene_CheckIndex(scene, "camera", index, scene->cameraCount));
    TRY(vplScene_CheckCamera(scene, "vplCameraDef.", def));
    TRY(vplScene_SetCameraPath(scene, index, NULL, 0));
    scene->cameras[index].def = *def;
    vplScene_Touch(scene, false);
    return VPL_SUCCESS;
}

vplResult vplScene_SetEmitter(vplScene* scene, int index, const vplEmitterDef* def)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    TRY(vplScene_CheckIndex(scene, "emitter", index, scene->emitterCount));
    TRY(vplScene_CheckEmitter(scene, def));
    TRY(vplScene_SetEmitterPath(scene, index, NULL, 0));
    scene->emitters[index].def = *def;
    vplScene_Touch(scene, false);
    return VPL_SUCCESS;
}

vplResult vplScene_SetMaterial(vplScene* scene, int index, const vplMaterialDef* def)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    TRY(vplScene_CheckIndex(scene, "material", index, scene->materialCount));
    TRY(vplScene_CheckMaterial(scene, def, index));
    vplMaterialDef copy = *def;
    const char* before = scene->materials[index].name;
    if (before != NULL && copy.name != NULL && strcmp(before, copy.name) == 0) {
        copy.name = before; // names stay in the scene's memory
    } else {
        TRY(copyName(scene, &copy.name));
    }
    scene->materials[index] = copy;
    vplScene_Touch(scene, true);
    return VPL_SUCCESS;
}

vplResult vplScene_SetTransform(vplScene* scene, int object, const vplMat4* transform)
{
    REQUIRE(CONTEXT_OF(scene), scene, transform);
    TRY(vplScene_CheckIndex(scene, "object", object, scene->objectCount));
    TRY(vplScene_ReportFault(scene, "vplScene_SetTransform: ", vplCheckTransform(transform)));
    vplScene_DropMover(scene, object);
    scene->objects[object].transform = *transform;
    vplScene_Touch(scene, true);
    return VPL_SUCCESS;
}

vplResult vplScene_SetObjectMaterial(vplScene* scene, int object, int material)
{
    REQUIRE(CONTEXT_OF(scene), scene);
    TRY(vplScene_CheckIndex(scene, "object", object, scene->objectCount));
    TRY(vplScene_CheckObjectMaterial(scene, scene->objects[object].type, scene->objects[object].mesh,
                                     material));
    scene->objects[object].material = material;
    vplScene_Touch(scene, true);
    return VPL_SUCCESS;
}

// Defines vplScene_GetThingCount and vplScene_GetThing.
#define GETTERS(Thing, thingCount, element)                                                                  \
    int vplScene_Get##Thing##Count(const vplScene* scene)                                                    \
    {                                                                                                        \
        return scene != NULL ? scene->thingCount : 0;                                                        \
    }                                                                                                        \
    const vpl##Thing##Def* vplScene_Get##Thing(const vplScene* scene, int index)                             \
    {                                                                                                        \
        return index >= 0 && index < vplScene_Get##Thing##Count(scene) ? &scene->element : NULL;             \
    }

GETTERS(Camera, cameraCount, cameras[index].def)
GETTERS(Texture, textureCount, textures[index].def)
GETTERS(Material, materialCount, materials[index])
GETTERS(Mesh, meshCount, meshes[index])
GETTERS(Object, objectCount, objects[index])
GETTERS(Emitter, emitterCount, emitters[index].def)

vplContext* vplScene_GetContext(const vplScene* scene)
{
    return CONTEXT_OF(scene);
}
