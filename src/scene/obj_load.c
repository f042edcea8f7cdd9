// SPDX-License-Identifier: MIT
// Reads Wavefront OBJ files in three sweeps over the text. Memory is freed after each step: at its peak it
// holds the text and one copy of the mesh.
#include "scene/obj.h"
#include "base/file.h"
#include "scene/texture_load.h"

#include <stdio.h>
#include <string.h>

enum { MOST_UNDEFINED = 8 }; // warnings about undefined materials

// Warns about the materials that triangles use but no MTL file defines.
static void warnOfUndefined(const vplObj* obj)
{
    int count = 0;
    for (uint32_t i = 0; i < obj->materials.names.index.count; i++) {
        const vplObjMaterial* material = &obj->materials.list[i];
        if (!material->defined && material->sceneIndex >= 0 && count++ < MOST_UNDEFINED) {
            vplLog(obj->text.context, VPL_LOG_WARNING, "%s: material \"%.80s\" is not defined, taken as grey",
                   obj->text.file, obj->materials.names.names[i]);
        }
    }
    if (count > MOST_UNDEFINED) {
        vplLog(obj->text.context, VPL_LOG_WARNING, "%s: %d materials in all are not defined", obj->text.file,
               count);
    }
}

static bool isPrefixTaken(const vplScene* scene, const char* prefix)
{
    for (int i = 0; i < scene->materialCount; i++) {
        const char* name = scene->materials[i].name;
        if (name != NULL && strncmp(name, prefix, strlen(prefix)) == 0) {
            return true;
        }
    }
    return false;
}

char* vplScene_MakePrefix(const vplScene* scene, const char* path, vplArena* scratch)
{
    const char* base = vplBaseName(path);
    size_t size = strlen(base) + 24;
    char* prefix = vplArena_Alloc(scratch, size, 1);
    if (prefix == NULL) {
        return NULL;
    }
    snprintf(prefix, size, "%s:", base);
    for (int number = scene->meshCount + 1; isPrefixTaken(scene, prefix); number++) {
        snprintf(prefix, size, "%s(%d):", base, number);
    }
    return prefix;
}

static vplResult addMap(vplScene* scene, const vplObjMap* map, float otherwise, int* indexOut)
{
    const vplTextureWrap wrap = map->clamp ? VPL_WRAP_CLAMP : VPL_WRAP_REPEAT;
    const vplTextureFile file = {
        .path = map->path, .where = map->where, .wrapU = wrap, .wrapV = wrap, .otherwise = otherwise};
    return vplScene_LoadTexture(scene, &file, indexOut);
}

// Adds the pictures of a material. One that gives both colour and opacity has the opacity in its alpha. A material has
// one placing: that of its colour, if there are two.
static vplResult addMaps(vplScene* scene, const vplObjMaterial* material, vplMaterialDef* def)
{
    const vplObjMap *colour = &material->colourMap, *opacity = &material->opacityMap;
    const vplObjMap* placed = colour->path != NULL ? colour : opacity;
    if (placed->path == NULL) {
        return VPL_SUCCESS;
    }
    memcpy(def->textureScale, placed->scale, sizeof placed->scale);
    memcpy(def->textureOffset, placed->offset, sizeof placed->offset);
    if (colour->path != NULL) {
        TRY(addMap(scene, colour, 0.5f, &def->texture));
    }
    def->alphaFromTexture =
        colour->path != NULL && opacity->path != NULL && strcmp(colour->path, opacity->path) == 0;
    return opacity->path != NULL && !def->alphaFromTexture ? addMap(scene, opacity, 1, &def->alphaTexture)
                                                           : VPL_SUCCESS;
}

// Adds one material to the scene, its name in `arena`.
static vplResult addMaterial(vplScene* scene, vplArena* arena, const char* prefix, const char* name,
                             vplObjMaterial* material)
{
    size_t size = strlen(prefix) + strlen(name) + 1;
    char* whole = vplArena_Alloc(arena, size, 1);
    if (whole == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    snprintf(whole, size, "%s%s", prefix, name);
    vplMaterialDef def = vplDefaultMaterialDef();
    def.name = whole;
    def.diffuse = material->diffuse;
    def.emission = material->emission;
    def.opacity = material->opacity;
    TRY(addMaps(scene, material, &def));
    return vplScene_AdoptMaterial(scene, &def, &material->sceneIndex);
}

// Adds the materials that triangles use, in the order of their first use, and renumbers the triangles.
static vplResult addMaterials(vplScene* scene, const vplObj* obj, vplObjMesh* mesh)
{
    const char* prefix = vplScene_MakePrefix(scene, obj->text.file, obj->scratch);
    if (prefix == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const vplMaterialDef unnamed = vplDefaultMaterialDef(); // of faces without usemtl
    int grey = -1;
    for (int64_t i = 0; i < mesh->triangleCount; i++) {
        const int number = mesh->materials[i];
        int* index = number >= 0 ? &obj->materials.list[number].sceneIndex : &grey;
        if (*index < 0 && number >= 0) {
            TRY(addMaterial(scene, mesh->arena, prefix, obj->materials.names.names[number],
                            &obj->materials.list[number]));
        } else if (*index < 0) {
            TRY(vplScene_AdoptMaterial(scene, &unnamed, &grey));
        }
        mesh->materials[i] = *index;
    }
    return VPL_SUCCESS;
}

// The positions of a mesh's vertices; NULL when out of memory.
static vplVec3* placeVertices(const vplObj* obj, const vplObjMesh* mesh)
{
    vplVec3* positions = vplArena_Alloc(mesh->arena, mesh->vertexCount, sizeof *positions);
    for (uint32_t i = 0; positions != NULL && vplObj_HasCorners(obj) && i < mesh->vertexCount; i++) {
        positions[i] = obj->points[mesh->cornerPoint[i]];
    }
    for (uint32_t i = 0; positions != NULL && !vplObj_HasCorners(obj) && i < obj->differentPoints; i++) {
        if (mesh->vertexOf[i] != VPL_NO_ENTRY) {
            positions[mesh->vertexOf[i]] = obj->points[i];
        }
    }
    return positions;
}

// Replaces an array by one of exactly `count` elements; failures show in vplArena_Check.
static void* shrink(vplArena* arena, void* array, size_t capacity, size_t count, size_t size)
{
    void* copy = count < capacity ? vplArena_Copy(arena, array, count, size) : NULL;
    if (copy != NULL) {
        vplArena_Free(arena, array);
    }
    return copy != NULL ? copy : array;
}

// Moves the mesh and its materials to the scene.
static vplResult addMesh(vplScene* scene, vplObj* obj, vplObjMesh* mesh, int* indexOut)
{
    vplHashIndex_Close(&mesh->corners);
    const size_t triangles = (size_t)mesh->triangleCount, capacity = (size_t)obj->triangleCount;
    vplMeshDef def = vplDefaultMeshDef();
    def.vertexCount = (int)mesh->vertexCount;
    def.triangleCount = (int)mesh->triangleCount;
    def.positions = placeVertices(obj, mesh);
    def.indices = shrink(mesh->arena, mesh->indices, capacity, triangles, 3 * sizeof *mesh->indices);
    if (obj->hasNormals) {
        def.normals = shrink(mesh->arena, mesh->cornerNormal, mesh->normalCapacity, mesh->vertexCount,
                             sizeof *mesh->cornerNormal);
    } else {
        vplArena_Free(mesh->arena, mesh->cornerNormal);
    }
    if (obj->hasTexcoords) {
        def.texcoords = &((vplTexcoord*)shrink(mesh->arena, mesh->cornerTexcoord, mesh->texcoordCapacity,
                                               mesh->vertexCount, sizeof *mesh->cornerTexcoord))
                             ->u;
    }
    mesh->materials = shrink(mesh->arena, mesh->materials, capacity, triangles, sizeof *mesh->materials);
    def.materials = mesh->materials;
    TRY(vplArena_Check(mesh->arena));
    TRY(addMaterials(scene, obj, mesh));
    warnOfUndefined(obj);
    vplArena* arena = mesh->arena;
    mesh->arena = NULL; // the scene's from now on
    return vplScene_AdoptMesh(scene, &def, arena, indexOut);
}

static vplResult checkMesh(const vplObj* obj, const vplObjMesh* mesh)
{
    if (mesh->triangleCount == 0) {
        return vplFail(obj->text.context, VPL_PARSE_ERROR,
                       "%s:1:1: found only faces without area, expected one that has some", obj->text.file);
    }
    if (mesh->vertexCount > VPL_MAX_TRIANGLES) {
        return vplFail(obj->text.context, VPL_LIMIT, "%s: %u different corners, at most %d are allowed",
                       obj->text.file, mesh->vertexCount, VPL_MAX_TRIANGLES);
    }
    if (mesh->emptyCount > 0) {
        vplLog(obj->text.context, VPL_LOG_INFO, "%s: left out %lld triangles without area", obj->text.file,
               (long long)mesh->emptyCount);
    }
    return VPL_SUCCESS;
}

static vplResult readText(vplObj* obj, vplObjMesh* mesh)
{
    TRY(vplObj_Count(obj));
    TRY(vplObj_ReadPoints(obj));
    return vplObj_ReadFaces(obj, mesh);
}

static vplResult loadObj(vplScene* scene, vplObj* obj, const char* path, vplObjMesh* mesh, int* indexOut)
{
    TRY(vplText_Open(scene->context, path, &obj->text));
    const vplResult result = readText(obj, mesh);
    vplText_Close(&obj->text);
    TRY(result);
    TRY(checkMesh(obj, mesh));
    return addMesh(scene, obj, mesh, indexOut);
}

vplResult vplScene_LoadObj(vplScene* scene, const char* path, int* indexOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, path);
    vplArena* scratch = vplArena_Create(scene->context);
    vplObj obj = {.scratch = scratch,
                  .materials = {.names = {.index = {.arena = scratch}}},
                  .libraries = {.index = {.arena = scratch}}};
    vplObjMesh mesh = {.arena = vplArena_Create(scene->context)};
    const int materialCount = scene->materialCount, textureCount = scene->textureCount;
    const vplResult result = loadObj(scene, &obj, path, &mesh, indexOut);
    if (result != VPL_SUCCESS) {
        scene->materialCount = materialCount; // drops the new ones; their names are in the mesh's arena
        vplScene_DropTextures(scene, textureCount);
    }
    vplArena_Destroy(mesh.arena);
    vplArena_Destroy(scratch);
    return result;
}
