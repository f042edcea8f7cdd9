// SPDX-License-Identifier: MIT
#include "scene/scene.h"
#include "scene/texture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    CAMERA_COOKIE = 0x56504c34,
    MATERIAL_COOKIE,
    OBJECT_COOKIE,
    EMITTER_COOKIE,
    MESH_COOKIE,
    TEXTURE_COOKIE
};

static const double DEGREE = VPL_PI / 180;

vplCameraDef vplDefaultCameraDef(void)
{
    return (vplCameraDef){{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40 * DEGREE, 0.1, 100, CAMERA_COOKIE};
}

vplMaterialDef vplDefaultMaterialDef(void)
{
    return (vplMaterialDef){.diffuse = {0.5f, 0.5f, 0.5f},
                            .texture = -1,
                            .textureScale = {1, 1},
                            .alphaTexture = -1,
                            .opacity = 1,
                            .cookie = MATERIAL_COOKIE};
}

vplTextureDef vplDefaultTextureDef(void)
{
    return (vplTextureDef){.channels = 3, .cookie = TEXTURE_COOKIE};
}

vplMeshDef vplDefaultMeshDef(void)
{
    return (vplMeshDef){.cookie = MESH_COOKIE};
}

vplObjectDef vplDefaultObjectDef(void)
{
    return (vplObjectDef){NULL, VPL_OBJECT_QUAD, 0, 0, vplMat4_Identity(), OBJECT_COOKIE};
}

vplEmitterDef vplDefaultEmitterDef(void)
{
    return (vplEmitterDef){.type = VPL_EMITTER_POINT,
                           .direction = {0, -1, 0},
                           .intensity = {1, 1, 1},
                           .innerAngle = 20 * DEGREE,
                           .outerAngle = 30 * DEGREE,
                           .cookie = EMITTER_COOKIE};
}

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

vplResult vplScene_ReportFault(const vplScene* scene, const char* subject, vplFault fault)
{
    if (fault.field == NULL) {
        return VPL_SUCCESS;
    }
    char component[16] = "";
    if (fault.index >= 0) {
        snprintf(component, sizeof component, "[%d]", fault.index);
    }
    return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s%s%s %s", subject, fault.field, component,
                   fault.text);
}

static vplResult requireCookie(const vplScene* scene, const char* type, bool present)
{
    return present ? VPL_SUCCESS
                   : vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s was not made by its default function",
                             type);
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

vplResult vplScene_CheckCamera(const vplScene* scene, const char* subject, const vplCameraDef* def)
{
    TRY(requireCookie(scene, "vplCameraDef", def->cookie == CAMERA_COOKIE));
    return vplScene_ReportFault(scene, subject, vplCheckCamera(def));
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
    TRY(requireCookie(scene, "vplTextureDef", def->cookie == TEXTURE_COOKIE));
    TRY(vplScene_ReportFault(scene, "vplTextureDef.", vplCheckTexture(def)));
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

// Checks a material that is to be number `index`.
static vplResult checkMaterial(const vplScene* scene, const vplMaterialDef* def, int index)
{
    TRY(requireCookie(scene, "vplMaterialDef", def->cookie == MATERIAL_COOKIE));
    TRY(vplScene_ReportFault(scene, "vplMaterialDef.", vplCheckMaterial(def, scene->textureCount)));
    for (int i = 0; def->name != NULL && i < scene->materialCount; i++) {
        const char* taken = scene->materials[i].name;
        if (i != index && taken != NULL && strcmp(taken, def->name) == 0) {
            return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                           "vplMaterialDef.name \"%s\" is taken, must be unique", def->name);
        }
    }
    return VPL_SUCCESS;
}

vplResult vplScene_AddMaterial(vplScene* scene, const vplMaterialDef* def, int* indexOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    TRY(checkMaterial(scene, def, scene->materialCount));
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
    TRY(requireCookie(scene, "vplMeshDef", def->cookie == MESH_COOKIE));
    TRY(vplScene_ReportFault(scene, "vplMeshDef.", vplCheckMesh(def, scene->materialCount)));
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

vplResult vplScene_CheckObjectMaterial(const vplScene* scene, vplObjectType type, int mesh, int material)
{
    const bool own = type == VPL_OBJECT_MESH && material == -1 && scene->meshes[mesh].materials != NULL;
    return own || (material >= 0 && material < scene->materialCount)
               ? VPL_SUCCESS
               : vplFail(scene->context, VPL_INVALID_ARGUMENT,
                         "vplObjectDef.material is %d, must be one of the scene's %d materials", material,
                         scene->materialCount);
}

vplResult vplScene_AddObject(vplScene* scene, const vplObjectDef* def, int* indexOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    TRY(requireCookie(scene, "vplObjectDef", def->cookie == OBJECT_COOKIE));
    TRY(vplScene_ReportFault(scene, "vplObjectDef.", vplCheckTransform(&def->transform)));
    if (def->type != VPL_OBJECT_QUAD && def->type != VPL_OBJECT_BOX && def->type != VPL_OBJECT_MESH) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplObjectDef.type is %d, must be a vplObjectType", (int)def->type);
    }
    bool mesh = def->type == VPL_OBJECT_MESH;
    if (mesh && (def->mesh < 0 || def->mesh >= scene->meshCount)) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplObjectDef.mesh is %d, must be one of the scene's %d meshes", def->mesh,
                       scene->meshCount);
    }
    TRY(vplScene_CheckObjectMaterial(scene, def->type, def->mesh, def->material));
    vplObjectDef copy = *def;
    TRY(copyName(scene, &copy.name));
    return append(scene, LIST(scene, object, objects), &copy, indexOut);
}

vplResult vplScene_AddEmitter(vplScene* scene, const vplEmitterDef* def, int* indexOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    const vplEmitter emitter = {.def = *def};
    TRY(requireCookie(scene, "vplEmitterDef", def->cookie == EMITTER_COOKIE));
    TRY(vplScene_ReportFault(scene, "vplEmitterDef.", vplCheckEmitter(def)));
    return append(scene, LIST(scene, emitter, emitters), &emitter, indexOut);
}

// ---- changes

vplResult vplScene_CheckIndex(const vplScene* scene, const char* what, int index, int count)
{
    return index >= 0 && index < count
               ? VPL_SUCCESS
               : vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s %d does not exist, the scene has %d", what,
                         index, count);
}

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
    TRY(requireCookie(scene, "vplEmitterDef", def->cookie == EMITTER_COOKIE));
    TRY(vplScene_ReportFault(scene, "vplEmitterDef.", vplCheckEmitter(def)));
    TRY(vplScene_SetEmitterPath(scene, index, NULL, 0));
    scene->emitters[index].def = *def;
    vplScene_Touch(scene, false);
    return VPL_SUCCESS;
}

vplResult vplScene_SetMaterial(vplScene* scene, int index, const vplMaterialDef* def)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    TRY(vplScene_CheckIndex(scene, "material", index, scene->materialCount));
    TRY(checkMaterial(scene, def, index));
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
