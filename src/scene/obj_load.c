// SPDX-License-Identifier: MIT
// OBJ files, as Wavefront's Advanced Visualizer wrote them: three sweeps over the text, then a mesh. Memory is
// freed as soon as a step is done, so that the most held at once is the text and one copy of the mesh.
#include "scene/obj.h"
#include "base/file.h"

#include <stdio.h>
#include <string.h>

enum { MOST_UNDEFINED = 8 }; // materials told one by one

// Says which materials the triangles use but no MTL file defines.
static void warnOfUndefined(const vplObj* obj)
{
    int count = 0;
    for (uint32_t i = 0; i < obj->materials.names.index.count; i++) {
        const vplObjMaterial* material = &obj->materials.list[i];
        if (!material->defined && material->sceneIndex >= 0 && count++ < MOST_UNDEFINED) {
            vplLog(obj->context, VPL_LOG_WARNING, "%s: material \"%.80s\" is not defined, taken as grey",
                   obj->text.file, obj->materials.names.names[i]);
        }
    }
    if (count > MOST_UNDEFINED) {
        vplLog(obj->context, VPL_LOG_WARNING, "%s: %d materials in all are not defined", obj->text.file,
               count);
    }
}

// A start for the names of a file's materials that no name in the scene has: "room.obj:", else with the number of
// the mesh, from 1: "room.obj(2):". Files may share material names, and one file may be read twice.
static char* makePrefix(const vplScene* scene, const char* path)
{
    const char* base = vplBaseName(path);
    size_t room = strlen(base) + 24;
    char* prefix = vplAlloc(scene->context, room, 1);
    if (prefix == NULL) {
        return NULL;
    }
    snprintf(prefix, room, "%s:", base);
    bool taken = true;
    for (int number = scene->meshCount + 1; taken; number++) {
        taken = false;
        for (int i = 0; i < scene->materialCount && !taken; i++) {
            const char* name = scene->materials[i].name;
            taken = name != NULL && strncmp(name, prefix, strlen(prefix)) == 0;
        }
        if (taken) {
            snprintf(prefix, room, "%s(%d):", base, number);
        }
    }
    return prefix;
}

// Adds one material to the scene. `material` NULL: the grey of faces that name none.
static vplResult addMaterial(vplScene* scene, const char* prefix, const char* name, vplObjMaterial* material)
{
    vplMaterialDef def = vplDefaultMaterialDef();
    if (material == NULL) {
        return vplScene_AdoptMaterial(scene, &def, NULL);
    }
    size_t room = strlen(prefix) + strlen(name) + 1;
    char* whole = vplAlloc(scene->context, room, 1);
    if (whole == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    snprintf(whole, room, "%s%s", prefix, name);
    def.name = whole;
    def.diffuse = material->diffuse;
    def.emission = material->emission;
    return vplScene_AdoptMaterial(scene, &def, &material->sceneIndex);
}

// Adds the materials that triangles use, in the order of their first use, and renumbers the triangles.
static vplResult addMaterials(vplScene* scene, vplObj* obj, vplObjMesh* mesh, const char* prefix)
{
    vplResult result = VPL_SUCCESS;
    int grey = -1;
    for (int64_t i = 0; i < mesh->triangleCount && result == VPL_SUCCESS; i++) {
        int number = mesh->materials[i];
        vplObjMaterial* material = number >= 0 ? &obj->materials.list[number] : NULL;
        int* index = material ? &material->sceneIndex : &grey;
        if (*index < 0) {
            int next = scene->materialCount;
            result =
                addMaterial(scene, prefix, material ? obj->materials.names.names[number] : NULL, material);
            *index = next;
        }
        mesh->materials[i] = *index;
    }
    return result;
}

// The positions of a mesh's vertices; NULL when out of memory.
static vplVec3* placeVertices(const vplObj* obj, const vplObjMesh* mesh)
{
    vplVec3* positions = vplAlloc(obj->context, mesh->vertexCount, sizeof *positions);
    if (positions == NULL) {
        return NULL;
    }
    if (obj->hasNormals) {
        for (uint32_t i = 0; i < mesh->vertexCount; i++) {
            positions[i] = obj->points[mesh->cornerPoint[i]];
        }
        return positions;
    }
    for (uint32_t i = 0; i < obj->differentPoints; i++) {
        if (mesh->vertexOf[i] != VPL_NO_ENTRY) {
            positions[mesh->vertexOf[i]] = obj->points[i];
        }
    }
    return positions;
}

// Replaces an array by one of exactly `count` elements, if that is less than it has.
static vplResult shrink(vplContext* context, void* array, size_t capacity, size_t count, size_t size)
{
    if (count == capacity) {
        return VPL_SUCCESS;
    }
    void *old, *copy = vplAlloc(context, count, size);
    if (copy == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    memcpy(&old, array, sizeof old); // `array` is the address of a pointer of any type
    memcpy(copy, old, count * size);
    vplFree(context, old);
    memcpy(array, &copy, sizeof copy);
    return VPL_SUCCESS;
}

static vplResult shrinkArrays(vplObj* obj, vplObjMesh* mesh)
{
    size_t triangles = (size_t)mesh->triangleCount, most = (size_t)obj->triangleCount;
    vplContext* context = obj->context;
    vplResult result = shrink(context, &mesh->indices, most, triangles, 3 * sizeof *mesh->indices);
    if (result == VPL_SUCCESS) {
        result = shrink(context, &mesh->materials, most, triangles, sizeof *mesh->materials);
    }
    if (result == VPL_SUCCESS && obj->hasNormals) {
        result = shrink(context, &mesh->cornerNormal, mesh->normalCapacity, mesh->vertexCount,
                        sizeof *mesh->cornerNormal);
    }
    return result;
}

// All but the materials' names is done: the arrays move into the scene.
static vplResult addMesh(vplScene* scene, vplObj* obj, vplObjMesh* mesh, int* indexOut)
{
    vplMeshDef def = {.vertexCount = (int)mesh->vertexCount, .triangleCount = (int)mesh->triangleCount};
    vplHashIndex_Close(&mesh->corners);
    vplVec3* positions = placeVertices(obj, mesh);
    vplResult result = positions ? shrinkArrays(obj, mesh) : VPL_OUT_OF_MEMORY;
    char* prefix = result == VPL_SUCCESS ? makePrefix(scene, obj->text.file) : NULL;
    int materialCount = scene->materialCount;
    result = prefix ? addMaterials(scene, obj, mesh, prefix) : VPL_OUT_OF_MEMORY;
    vplFree(obj->context, prefix);
    if (result == VPL_SUCCESS) {
        warnOfUndefined(obj);
        def.positions = positions;
        def.normals = mesh->cornerNormal;
        def.indices = mesh->indices;
        def.materials = mesh->materials;
        mesh->cornerNormal = NULL;
        mesh->indices = NULL;
        mesh->materials = NULL;
        positions = NULL;
        result = vplScene_AdoptMesh(scene, &def, indexOut);
    }
    if (result != VPL_SUCCESS) {
        vplScene_DropMaterials(scene, materialCount);
    }
    vplFree(obj->context, positions);
    return result;
}

static vplResult finishMesh(vplScene* scene, vplObj* obj, vplObjMesh* mesh, int* indexOut)
{
    if (mesh->triangleCount == 0) {
        return vplFail(obj->context, VPL_PARSE_ERROR,
                       "%s:1:1: found only faces without area, expected one that has some", obj->text.file);
    }
    if (mesh->vertexCount > VPL_MAX_TRIANGLES) {
        return vplFail(obj->context, VPL_LIMIT, "%s: %u different corners, at most %d are allowed",
                       obj->text.file, mesh->vertexCount, VPL_MAX_TRIANGLES);
    }
    if (mesh->emptyCount > 0) {
        vplLog(obj->context, VPL_LOG_INFO, "%s: left out %lld triangles without area", obj->text.file,
               (long long)mesh->emptyCount);
    }
    return addMesh(scene, obj, mesh, indexOut);
}

static void closeObj(vplObj* obj)
{
    vplText_Close(&obj->text);
    vplObjMaterials_Close(&obj->materials);
    vplNames_Close(&obj->libraries);
    vplFree(obj->context, obj->points);
    vplFree(obj->context, obj->pointOf);
    vplFree(obj->context, obj->normals);
}

vplResult vplScene_LoadObj(vplScene* scene, const char* path, int* indexOut)
{
    vplContext* context = scene->context;
    vplObj obj = {.context = context,
                  .materials = {.names = {.index = {.context = context}}},
                  .libraries = {.index = {.context = context}}};
    vplObjMesh mesh = {.corners = {.context = context}};
    vplResult result = vplText_Open(context, path, &obj.text);
    if (result != VPL_SUCCESS) {
        return result;
    }
    result = vplObj_Count(&obj);
    if (result == VPL_SUCCESS) {
        result = vplObj_ReadPoints(&obj);
    }
    if (result == VPL_SUCCESS) {
        result = vplObj_ReadFaces(&obj, &mesh);
    }
    vplText_Close(&obj.text);
    if (result == VPL_SUCCESS) {
        result = finishMesh(scene, &obj, &mesh, indexOut);
    }
    vplObjMesh_Close(context, &mesh);
    closeObj(&obj);
    return result;
}
