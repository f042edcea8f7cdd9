// SPDX-License-Identifier: MIT
// Makes a mesh of the triangles. Those without area are left out; corners with the same point and normal
// share a vertex.
#include "scene/obj.h"

#include "math/double3.h"
#include "math/vec.h"

#include <string.h>

bool vplObj_FindNormal(const vplVec3 corners[3], vplVec3* out)
{
    double u[3], v[3], n[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (double)vplComponent(corners[1], k) - (double)vplComponent(corners[0], k);
        v[k] = (double)vplComponent(corners[2], k) - (double)vplComponent(corners[0], k);
    }
    vplCross3(u, v, n);
    double largest = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
    if (!(largest > 0)) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        n[k] /= largest;
    }
    double length = sqrt(vplDot3(n, n));
    *out = vplVec((float)(n[0] / length), (float)(n[1] / length), (float)(n[2] / length));
    return true;
}

// The vertex of a point in a mesh without normals.
static uint32_t findPointVertex(vplObjMesh* mesh, uint32_t point)
{
    if (mesh->vertexOf[point] == VPL_NO_ENTRY) {
        mesh->vertexOf[point] = mesh->vertexCount++;
    }
    return mesh->vertexOf[point];
}

static vplResult addCorner(const vplObj* obj, vplObjMesh* mesh, uint32_t hash, const vplObjCorner* corner)
{
    const size_t count = mesh->vertexCount;
    TRY(vplArena_Reserve(mesh->corners.arena, &mesh->cornerPoint, &mesh->pointCapacity, count + 1,
                         sizeof *mesh->cornerPoint));
    TRY(vplArena_Reserve(mesh->arena, &mesh->cornerNormal, &mesh->normalCapacity, count + 1,
                         sizeof *mesh->cornerNormal));
    if (obj->hasTexcoords) {
        TRY(vplArena_Reserve(mesh->arena, &mesh->cornerTexcoord, &mesh->texcoordCapacity, count + 1,
                             sizeof *mesh->cornerTexcoord));
        mesh->cornerTexcoord[count] = corner->texcoord;
    }
    TRY(vplHashIndex_Add(&mesh->corners, hash));
    mesh->cornerPoint[count] = corner->point;
    mesh->cornerNormal[count] = corner->normal;
    mesh->vertexCount++;
    return VPL_SUCCESS;
}

static bool isCorner(const vplObjMesh* mesh, uint32_t i, const vplObjCorner* c)
{
    return mesh->cornerPoint[i] == c->point &&
           memcmp(&mesh->cornerNormal[i], &c->normal, sizeof c->normal) == 0 &&
           (mesh->cornerTexcoord == NULL ||
            memcmp(&mesh->cornerTexcoord[i], &c->texcoord, sizeof c->texcoord) == 0);
}

vplResult vplObjMesh_FindVertex(const vplObj* obj, vplObjMesh* mesh, const vplObjCorner* corner,
                                uint32_t* out)
{
    uint32_t words[6];
    _Static_assert(sizeof *corner == sizeof words, "a corner is six words");
    memcpy(words, corner, sizeof words);
    uint32_t hash = vplHashKey(words, obj->hasTexcoords ? 6 : 4);
    uint32_t i = vplHashIndex_First(&mesh->corners, hash);
    while (i != VPL_NO_ENTRY && !isCorner(mesh, i, corner)) {
        i = vplHashIndex_Next(&mesh->corners, i);
    }
    *out = i == VPL_NO_ENTRY ? mesh->vertexCount : i;
    return i == VPL_NO_ENTRY ? addCorner(obj, mesh, hash, corner) : VPL_SUCCESS;
}

// The texture coordinates of a corner that a material needs.
static vplTexcoord texcoordOf(const vplObj* obj, const vplObjIndices* corner, int material)
{
    return obj->hasTexcoords && corner->texcoord >= 0 && vplObj_HasPicture(obj, material)
               ? obj->texcoords[corner->texcoord]
               : (vplTexcoord){0, 0};
}

vplResult vplObjMesh_AddTriangle(const vplObj* obj, vplObjMesh* mesh, const vplObjIndices corners[3],
                                 int material)
{
    vplVec3 flat;
    const vplVec3 at[3] = {obj->points[corners[0].point], obj->points[corners[1].point],
                           obj->points[corners[2].point]};
    if (!vplObj_FindNormal(at, &flat)) {
        mesh->emptyCount++;
        return VPL_SUCCESS;
    }
    uint32_t* index = mesh->indices + 3 * (size_t)mesh->triangleCount;
    if (mesh->groups != NULL) {
        mesh->groups[mesh->triangleCount] = obj->group;
    }
    for (int k = 0; k < 3; k++) {
        const vplObjIndices* corner = &corners[k];
        const vplTexcoord texcoord = texcoordOf(obj, corner, material);
        if (mesh->waiting != NULL) {
            mesh->waiting[3 * (size_t)mesh->triangleCount + (size_t)k] = texcoord;
        }
        if (mesh->groups != NULL) {
            index[k] = corner->point;
            continue;
        }
        if (!vplObj_HasCorners(obj)) {
            index[k] = findPointVertex(mesh, corner->point);
            continue;
        }
        vplVec3 n = corner->normal >= 0 ? obj->normals[corner->normal] : flat;
        n = n.x == 0 && n.y == 0 && n.z == 0 ? flat : n;
        n = obj->hasNormals ? n : vplVec(0, 0, 0);
        TRY(vplObjMesh_FindVertex(obj, mesh, &(vplObjCorner){corner->point, n, texcoord}, &index[k]));
    }
    mesh->materials[mesh->triangleCount++] = material;
    return VPL_SUCCESS;
}
