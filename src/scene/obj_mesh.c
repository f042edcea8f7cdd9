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

static vplResult addCorner(vplObjMesh* mesh, uint32_t hash, uint32_t point, vplVec3 normal)
{
    const size_t count = mesh->vertexCount;
    TRY(vplArena_Reserve(mesh->corners.arena, &mesh->cornerPoint, &mesh->pointCapacity, count + 1,
                         sizeof *mesh->cornerPoint));
    TRY(vplArena_Reserve(mesh->arena, &mesh->cornerNormal, &mesh->normalCapacity, count + 1,
                         sizeof *mesh->cornerNormal));
    TRY(vplHashIndex_Add(&mesh->corners, hash));
    mesh->cornerPoint[count] = point;
    mesh->cornerNormal[count] = normal;
    mesh->vertexCount++;
    return VPL_SUCCESS;
}

vplResult vplObjMesh_FindVertex(vplObjMesh* mesh, uint32_t point, vplVec3 normal, uint32_t* out)
{
    uint32_t words[4] = {point};
    memcpy(words + 1, &normal, sizeof normal);
    uint32_t hash = vplHashKey(words, 4);
    uint32_t i = vplHashIndex_First(&mesh->corners, hash);
    while (i != VPL_NO_ENTRY &&
           (mesh->cornerPoint[i] != point || memcmp(&mesh->cornerNormal[i], &normal, sizeof normal) != 0)) {
        i = vplHashIndex_Next(&mesh->corners, i);
    }
    *out = i == VPL_NO_ENTRY ? mesh->vertexCount : i;
    return i == VPL_NO_ENTRY ? addCorner(mesh, hash, point, normal) : VPL_SUCCESS;
}

vplResult vplObjMesh_AddTriangle(const vplObj* obj, vplObjMesh* mesh, const uint32_t points[3],
                                 const int64_t normals[3], int material)
{
    vplVec3 flat;
    const vplVec3 at[3] = {obj->points[points[0]], obj->points[points[1]], obj->points[points[2]]};
    if (!vplObj_FindNormal(at, &flat)) {
        mesh->emptyCount++;
        return VPL_SUCCESS;
    }
    uint32_t* index = mesh->indices + 3 * (size_t)mesh->triangleCount;
    if (mesh->groups != NULL) {
        mesh->groups[mesh->triangleCount] = obj->group;
    }
    for (int k = 0; k < 3; k++) {
        if (mesh->groups != NULL) {
            index[k] = points[k];
            continue;
        }
        if (!obj->hasNormals) {
            index[k] = findPointVertex(mesh, points[k]);
            continue;
        }
        vplVec3 n = normals[k] >= 0 ? obj->normals[normals[k]] : flat;
        n = n.x == 0 && n.y == 0 && n.z == 0 ? flat : n;
        TRY(vplObjMesh_FindVertex(mesh, points[k], n, &index[k]));
    }
    mesh->materials[mesh->triangleCount++] = material;
    return VPL_SUCCESS;
}
