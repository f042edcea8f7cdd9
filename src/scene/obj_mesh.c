// SPDX-License-Identifier: MIT
// Triangles become a mesh: those without area are left out, corners with the same point and normal share a vertex.
#include "scene/obj.h"

#include <math.h>
#include <string.h>

// The triangle's normal by its corners' order; false if it has no area. In double: floats of like size give an
// exact 0, and no triangle that floats can hold underflows.
static bool findNormal(const vplVec3* a, const vplVec3* b, const vplVec3* c, vplVec3* out)
{
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (double)(&b->x)[k] - (double)(&a->x)[k];
        v[k] = (double)(&c->x)[k] - (double)(&a->x)[k];
    }
    double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    double largest = fmax(fabs(x), fmax(fabs(y), fabs(z)));
    if (!(largest > 0)) {
        return false;
    }
    x /= largest;
    y /= largest;
    z /= largest;
    double length = sqrt(x * x + y * y + z * z);
    *out = (vplVec3){(float)(x / length), (float)(y / length), (float)(z / length)};
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
    vplContext* context = mesh->corners.context;
    size_t count = mesh->vertexCount;
    vplResult result =
        vplReserve(context, &mesh->cornerPoint, &mesh->pointCapacity, count + 1, sizeof *mesh->cornerPoint);
    if (result == VPL_SUCCESS) {
        result = vplReserve(context, &mesh->cornerNormal, &mesh->normalCapacity, count + 1,
                            sizeof *mesh->cornerNormal);
    }
    if (result == VPL_SUCCESS) {
        result = vplHashIndex_Add(&mesh->corners, hash);
    }
    if (result == VPL_SUCCESS) {
        mesh->cornerPoint[count] = point;
        mesh->cornerNormal[count] = normal;
        mesh->vertexCount++;
    }
    return result;
}

// The vertex of a point and a normal.
static vplResult findCornerVertex(vplObjMesh* mesh, uint32_t point, vplVec3 normal, uint32_t* out)
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

vplResult vplObjMesh_AddTriangle(const vplObj* obj, vplObjMesh* mesh, const uint32_t* points,
                                 const int64_t* normals, int material)
{
    vplVec3 flat;
    const vplVec3* p = obj->points;
    if (!findNormal(&p[points[0]], &p[points[1]], &p[points[2]], &flat)) {
        mesh->emptyCount++;
        return VPL_SUCCESS;
    }
    uint32_t* index = mesh->indices + 3 * (size_t)mesh->triangleCount;
    for (int k = 0; k < 3; k++) {
        if (!obj->hasNormals) {
            index[k] = findPointVertex(mesh, points[k]);
            continue;
        }
        vplVec3 n = normals[k] >= 0 ? obj->normals[normals[k]] : flat;
        n = n.x == 0 && n.y == 0 && n.z == 0 ? flat : n;
        vplResult result = findCornerVertex(mesh, points[k], n, &index[k]);
        if (result != VPL_SUCCESS) {
            return result;
        }
    }
    mesh->materials[mesh->triangleCount++] = material;
    return VPL_SUCCESS;
}

void vplObjMesh_Close(vplContext* context, vplObjMesh* mesh)
{
    vplFree(context, mesh->indices);
    vplFree(context, mesh->materials);
    vplFree(context, mesh->vertexOf);
    vplFree(context, mesh->cornerPoint);
    vplFree(context, mesh->cornerNormal);
    vplHashIndex_Close(&mesh->corners);
}
