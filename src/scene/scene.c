// SPDX-License-Identifier: MIT
#include "scene/scene.h"

#include <string.h>

enum { CAMERA_COOKIE = 0x56504c34, MATERIAL_COOKIE, OBJECT_COOKIE, EMITTER_COOKIE, MESH_COOKIE };

static const double DEGREE = VPL_PI / 180;

vplCameraDef vplDefaultCameraDef(void)
{
    return (vplCameraDef){{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40 * DEGREE, 0.1, 100, CAMERA_COOKIE};
}

vplMaterialDef vplDefaultMaterialDef(void)
{
    return (vplMaterialDef){NULL, {0.5f, 0.5f, 0.5f}, {0, 0, 0}, MATERIAL_COOKIE};
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
    return (vplEmitterDef){VPL_EMITTER_POINT, {0, 0, 0},   {0, -1, 0},    {1, 1, 1},
                           20 * DEGREE,       30 * DEGREE, EMITTER_COOKIE};
}

vplResult vplScene_Create(vplContext* context, vplScene** sceneOut)
{
    vplScene* scene = vplAllocZero(context, 1, sizeof *scene);
    if (scene == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    scene->context = context;
    scene->stamp = vplNextStamp(context);
    *sceneOut = scene;
    return VPL_SUCCESS;
}

void vplScene_Destroy(vplScene* scene)
{
    if (scene == NULL) {
        return;
    }
    vplContext* context = scene->context;
    for (int i = 0; i < scene->materialCount; i++) {
        vplFree(context, (char*)scene->materials[i].name);
    }
    for (int i = 0; i < scene->objectCount; i++) {
        vplFree(context, (char*)scene->objects[i].name);
    }
    for (int i = 0; i < scene->meshCount; i++) {
        vplFreeMesh(context, &scene->meshes[i]);
    }
    vplFreePaths(scene);
    vplFree(context, scene->meshes);
    vplFree(context, scene->cameras);
    vplFree(context, scene->materials);
    vplFree(context, scene->objects);
    vplFree(context, scene->emitters);
    vplFree(context, scene);
}

static vplResult report(const vplScene* scene, const char* type, bool initialised, const vplFault* fault)
{
    if (!initialised) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s was not made by its default function", type);
    }
    if (fault->field == NULL) {
        return VPL_SUCCESS;
    }
    if (fault->index >= 0) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s.%s[%d] %s", type, fault->field, fault->index,
                       fault->text);
    }
    return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s.%s %s", type, fault->field, fault->text);
}

// Room for one more element at *array; NULL when out of memory.
static void* grow(vplScene* scene, void* array, int* count, size_t* capacity, size_t size)
{
    if (vplReserve(scene->context, array, capacity, (size_t)*count + 1, size) != VPL_SUCCESS) {
        return NULL;
    }
    scene->stamp = vplNextStamp(scene->context);
    char* base;
    memcpy(&base, array, sizeof base);
    return base + (size_t)*count * size;
}

static void finish(int* count, int* indexOut)
{
    if (indexOut != NULL) {
        *indexOut = *count;
    }
    ++*count;
}

// Copies an optional name into the scene; false when out of memory.
static bool keepName(vplScene* scene, const char** name)
{
    if (*name != NULL) {
        *name = vplCopyString(scene->context, *name);
        return *name != NULL;
    }
    return true;
}

vplResult vplScene_AddCamera(vplScene* scene, const vplCameraDef* def, int* indexOut)
{
    vplFault fault = vplCheckCamera(def);
    vplResult result = report(scene, "vplCameraDef", def->cookie == CAMERA_COOKIE, &fault);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplCameraDef* slot =
        grow(scene, &scene->cameras, &scene->cameraCount, &scene->cameraCapacity, sizeof *scene->cameras);
    if (slot == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    *slot = *def;
    finish(&scene->cameraCount, indexOut);
    return VPL_SUCCESS;
}

vplResult vplScene_AddMaterial(vplScene* scene, const vplMaterialDef* def, int* indexOut)
{
    vplFault fault = vplCheckMaterial(def);
    vplResult result = report(scene, "vplMaterialDef", def->cookie == MATERIAL_COOKIE, &fault);
    if (result != VPL_SUCCESS) {
        return result;
    }
    for (int i = 0; def->name != NULL && i < scene->materialCount; i++) {
        if (scene->materials[i].name != NULL && strcmp(scene->materials[i].name, def->name) == 0) {
            return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                           "vplMaterialDef.name \"%s\" is taken, must be unique", def->name);
        }
    }
    vplMaterialDef copy = *def;
    return keepName(scene, &copy.name) ? vplScene_AdoptMaterial(scene, &copy, indexOut) : VPL_OUT_OF_MEMORY;
}

vplResult vplScene_AdoptMaterial(vplScene* scene, const vplMaterialDef* material, int* indexOut)
{
    vplMaterialDef* slot = grow(scene, &scene->materials, &scene->materialCount, &scene->materialCapacity,
                                sizeof *scene->materials);
    if (slot == NULL) {
        vplFree(scene->context, (char*)material->name);
        return VPL_OUT_OF_MEMORY;
    }
    *slot = *material;
    finish(&scene->materialCount, indexOut);
    return VPL_SUCCESS;
}

void vplScene_DropMaterials(vplScene* scene, int count)
{
    while (scene->materialCount > count) {
        vplFree(scene->context, (char*)scene->materials[--scene->materialCount].name);
    }
}

void vplFreeMesh(vplContext* context, const vplMeshDef* mesh)
{
    vplFree(context, (void*)mesh->positions);
    vplFree(context, (void*)mesh->normals);
    vplFree(context, (void*)mesh->indices);
    vplFree(context, (void*)mesh->materials);
}

vplResult vplScene_AdoptMesh(vplScene* scene, const vplMeshDef* mesh, int* indexOut)
{
    vplMeshDef* slot =
        grow(scene, &scene->meshes, &scene->meshCount, &scene->meshCapacity, sizeof *scene->meshes);
    if (slot == NULL) {
        vplFreeMesh(scene->context, mesh);
        return VPL_OUT_OF_MEMORY;
    }
    *slot = *mesh;
    slot->cookie = MESH_COOKIE;
    finish(&scene->meshCount, indexOut);
    return VPL_SUCCESS;
}

// A copy in context memory; NULL stays NULL. Clears *good when out of memory.
static void* copyArray(vplContext* context, const void* from, int count, size_t size, bool* good)
{
    void* copy = from ? vplAlloc(context, (size_t)count, size) : NULL;
    if (copy != NULL) {
        memcpy(copy, from, (size_t)count * size);
    }
    *good = *good && (copy != NULL || from == NULL);
    return copy;
}

vplResult vplScene_AddMesh(vplScene* scene, const vplMeshDef* def, int* indexOut)
{
    vplFault fault = vplCheckMesh(def, scene->materialCount);
    vplResult result = report(scene, "vplMeshDef", def->cookie == MESH_COOKIE, &fault);
    if (result != VPL_SUCCESS) {
        return result;
    }
    bool good = true;
    vplContext* context = scene->context;
    vplMeshDef copy = *def;
    copy.positions = copyArray(context, def->positions, def->vertexCount, sizeof *def->positions, &good);
    copy.normals = copyArray(context, def->normals, def->vertexCount, sizeof *def->normals, &good);
    copy.indices = copyArray(context, def->indices, def->triangleCount, 3 * sizeof *def->indices, &good);
    copy.materials = copyArray(context, def->materials, def->triangleCount, sizeof *def->materials, &good);
    if (!good) {
        vplFreeMesh(context, &copy);
        return VPL_OUT_OF_MEMORY;
    }
    return vplScene_AdoptMesh(scene, &copy, indexOut);
}

vplResult vplScene_AddObject(vplScene* scene, const vplObjectDef* def, int* indexOut)
{
    vplFault fault = vplCheckTransform(&def->transform);
    vplResult result = report(scene, "vplObjectDef", def->cookie == OBJECT_COOKIE, &fault);
    if (result != VPL_SUCCESS) {
        return result;
    }
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
    bool ownMaterials = mesh && def->material == -1 && scene->meshes[def->mesh].materials != NULL;
    if (!ownMaterials && (def->material < 0 || def->material >= scene->materialCount)) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplObjectDef.material is %d, must be one of the scene's %d materials", def->material,
                       scene->materialCount);
    }
    vplObjectDef* slot =
        grow(scene, &scene->objects, &scene->objectCount, &scene->objectCapacity, sizeof *scene->objects);
    vplObjectDef copy = *def;
    if (slot == NULL || !keepName(scene, &copy.name)) {
        return VPL_OUT_OF_MEMORY;
    }
    *slot = copy;
    finish(&scene->objectCount, indexOut);
    return VPL_SUCCESS;
}

vplResult vplScene_AddEmitter(vplScene* scene, const vplEmitterDef* def, int* indexOut)
{
    vplFault fault = vplCheckEmitter(def);
    vplResult result = report(scene, "vplEmitterDef", def->cookie == EMITTER_COOKIE, &fault);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplEmitterDef* slot =
        grow(scene, &scene->emitters, &scene->emitterCount, &scene->emitterCapacity, sizeof *scene->emitters);
    if (slot == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    *slot = *def;
    finish(&scene->emitterCount, indexOut);
    return VPL_SUCCESS;
}

int vplScene_GetCameraCount(const vplScene* scene)
{
    return scene->cameraCount;
}

int vplScene_GetMaterialCount(const vplScene* scene)
{
    return scene->materialCount;
}

int vplScene_GetMeshCount(const vplScene* scene)
{
    return scene->meshCount;
}

int vplScene_GetObjectCount(const vplScene* scene)
{
    return scene->objectCount;
}

int vplScene_GetEmitterCount(const vplScene* scene)
{
    return scene->emitterCount;
}

const vplCameraDef* vplScene_GetCamera(const vplScene* scene, int index)
{
    return &scene->cameras[index];
}

const vplMaterialDef* vplScene_GetMaterial(const vplScene* scene, int index)
{
    return &scene->materials[index];
}

const vplMeshDef* vplScene_GetMesh(const vplScene* scene, int index)
{
    return &scene->meshes[index];
}

const vplObjectDef* vplScene_GetObject(const vplScene* scene, int index)
{
    return &scene->objects[index];
}

const vplEmitterDef* vplScene_GetEmitter(const vplScene* scene, int index)
{
    return &scene->emitters[index];
}

vplContext* vplScene_GetContext(const vplScene* scene)
{
    return scene->context;
}
