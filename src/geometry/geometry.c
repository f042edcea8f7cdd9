// SPDX-License-Identifier: MIT
// Freezes a scene: every quad becomes two world-space triangles, every box twelve. Corners are rounded from
// double once and shared by the faces that meet there, so edges are watertight.
#include <vpl/geometry.h>

#include "math/matrix.h"
#include "math/vec.h"
#include "scene/scene.h"

#include <string.h>

static const float QUAD_CORNERS[4][3] = {
    {-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}};
static const uint32_t QUAD_INDICES[6] = {0, 1, 2, 0, 2, 3};

// Corner i has x = +0.5 if bit 0 is set, y if bit 1, z if bit 2.
static const uint32_t BOX_INDICES[36] = {
    1, 3, 7, 1, 7, 5, // +x
    0, 4, 6, 0, 6, 2, // -x
    2, 6, 7, 2, 7, 3, // +y
    0, 1, 5, 0, 5, 4, // -y
    4, 5, 7, 4, 7, 6, // +z
    0, 2, 3, 0, 3, 1, // -z
};

typedef struct Builder {
    vplGeometryObject* objects;
    vplVec3* positions;
    uint32_t* indices;
    vplVec3* normals;
    int* owners;
    vplMaterialDef* materials;
} Builder;

static int vertexCountOf(vplObjectType type)
{
    return type == VPL_OBJECT_QUAD ? 4 : 8;
}

static int triangleCountOf(vplObjectType type)
{
    return type == VPL_OBJECT_QUAD ? 2 : 12;
}

static void fillObject(const Builder* b, const vplObjectDef* def, int index)
{
    const vplGeometryObject* object = &b->objects[index];
    const vplPlacement* placement = &object->placement;
    bool quad = def->type == VPL_OBJECT_QUAD;
    vplAffine world = vplAffine_FromMat4(&def->transform);
    for (int i = 0; i < object->vertexCount; i++) {
        float p[3];
        for (int row = 0; row < 3; row++) {
            double sum = world.m[row][3];
            for (int axis = 0; axis < 3; axis++) {
                sum += world.m[row][axis] * (quad ? QUAD_CORNERS[i][axis] : i >> axis & 1 ? 0.5 : -0.5);
            }
            p[row] = (float)sum;
        }
        b->positions[object->firstVertex + i] = vplVec(p[0], p[1], p[2]);
    }
    memcpy(b->indices + 3 * object->firstTriangle, quad ? QUAD_INDICES : BOX_INDICES,
           3 * (size_t)object->triangleCount * sizeof(uint32_t));
    for (int i = 0; i < object->triangleCount; i++) {
        const float* n = placement->normal[quad ? VPL_FACE_QUAD : i / 2];
        b->owners[object->firstTriangle + i] = index;
        b->normals[object->firstTriangle + i] = vplVec(n[0], n[1], n[2]);
    }
}

// A mirroring matrix turns counter-clockwise into clockwise; swapping two corners turns it back.
static void keepWinding(const Builder* b, const vplGeometryObject* object)
{
    for (int i = 0; i < object->triangleCount; i++) {
        uint32_t* index = b->indices + 3 * (object->firstTriangle + i);
        const vplVec3* p = b->positions + object->firstVertex;
        vplVec3 cross = vplCross(vplSub(p[index[1]], p[index[0]]), vplSub(p[index[2]], p[index[0]]));
        if (vplDot(cross, b->normals[object->firstTriangle + i]) < 0) {
            uint32_t swap = index[1];
            index[1] = index[2];
            index[2] = swap;
        }
    }
}

static void findBounds(vplGeometry* g)
{
    if (g->vertexCount == 0) {
        return;
    }
    g->boundsMin = g->boundsMax = g->positions[0];
    for (int i = 1; i < g->vertexCount; i++) {
        vplVec3 p = g->positions[i];
        g->boundsMin =
            vplVec(fminf(g->boundsMin.x, p.x), fminf(g->boundsMin.y, p.y), fminf(g->boundsMin.z, p.z));
        g->boundsMax =
            vplVec(fmaxf(g->boundsMax.x, p.x), fmaxf(g->boundsMax.y, p.y), fmaxf(g->boundsMax.z, p.z));
    }
}

static vplResult allocate(vplGeometry* g, Builder* b)
{
    vplContext* context = g->context;
    b->objects = vplAlloc(context, (size_t)g->objectCount, sizeof *b->objects);
    b->positions = vplAlloc(context, (size_t)g->vertexCount, sizeof *b->positions);
    b->indices = vplAlloc(context, 3 * (size_t)g->triangleCount, sizeof *b->indices);
    b->normals = vplAlloc(context, (size_t)g->triangleCount, sizeof *b->normals);
    b->owners = vplAlloc(context, (size_t)g->triangleCount, sizeof *b->owners);
    b->materials = vplAlloc(context, (size_t)g->materialCount, sizeof *b->materials);
    g->objects = b->objects;
    g->positions = b->positions;
    g->indices = b->indices;
    g->normals = b->normals;
    g->owners = b->owners;
    g->materials = b->materials;
    bool complete = b->objects && b->positions && b->indices && b->normals && b->owners && b->materials;
    return complete ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static vplResult fill(const vplScene* scene, vplGeometry* g, Builder* b)
{
    int vertex = 0, triangle = 0;
    for (int i = 0; i < g->objectCount; i++) {
        const vplObjectDef* def = &scene->objects[i];
        vplGeometryObject* object = &b->objects[i];
        *object = (vplGeometryObject){.type = def->type,
                                      .material = def->material,
                                      .firstVertex = vertex,
                                      .vertexCount = vertexCountOf(def->type),
                                      .firstTriangle = triangle,
                                      .triangleCount = triangleCountOf(def->type)};
        vplResult result = vplPlacement_Create(g->context, &def->transform, &object->placement);
        if (result != VPL_SUCCESS) {
            return result;
        }
        fillObject(b, def, i);
        keepWinding(b, object);
        vertex += object->vertexCount;
        triangle += object->triangleCount;
    }
    for (int i = 0; i < g->materialCount; i++) {
        b->materials[i] = scene->materials[i];
        b->materials[i].name = NULL; // the scene may be destroyed before the geometry
    }
    findBounds(g);
    return VPL_SUCCESS;
}

vplResult vplGeometry_Create(const vplScene* scene, vplGeometry** geometryOut)
{
    vplContext* context = scene->context;
    vplGeometry* g = vplAllocZero(context, 1, sizeof *g);
    if (g == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    g->context = context;
    g->objectCount = scene->objectCount;
    g->materialCount = scene->materialCount;
    int64_t vertices = 0, triangles = 0;
    for (int i = 0; i < scene->objectCount; i++) {
        vertices += vertexCountOf(scene->objects[i].type);
        triangles += triangleCountOf(scene->objects[i].type);
    }
    Builder builder = {NULL, NULL, NULL, NULL, NULL, NULL};
    vplResult result = VPL_SUCCESS;
    if (triangles > VPL_MAX_TRIANGLES || vertices > VPL_MAX_TRIANGLES) {
        result = vplFail(context, VPL_LIMIT, "the scene has %lld triangles, at most %d are allowed",
                         (long long)triangles, VPL_MAX_TRIANGLES);
    } else {
        g->vertexCount = (int)vertices;
        g->triangleCount = (int)triangles;
        result = allocate(g, &builder);
    }
    if (result == VPL_SUCCESS) {
        result = fill(scene, g, &builder);
    }
    if (result != VPL_SUCCESS) {
        vplGeometry_Destroy(g);
        return result;
    }
    *geometryOut = g;
    return VPL_SUCCESS;
}

void vplGeometry_Destroy(vplGeometry* geometry)
{
    if (geometry != NULL) {
        vplContext* context = geometry->context;
        vplFree(context, (void*)geometry->objects);
        vplFree(context, (void*)geometry->positions);
        vplFree(context, (void*)geometry->indices);
        vplFree(context, (void*)geometry->normals);
        vplFree(context, (void*)geometry->owners);
        vplFree(context, (void*)geometry->materials);
        vplFree(context, geometry);
    }
}

static double triangleArea(const vplVec3* p, const uint32_t* index)
{
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
        double origin = vplComponent(p[index[0]], axis);
        u[axis] = vplComponent(p[index[1]], axis) - origin;
        v[axis] = vplComponent(p[index[2]], axis) - origin;
    }
    double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    return 0.5 * sqrt(x * x + y * y + z * z);
}

// Sums area, and area times mean reflectance, over all triangles in order.
static void sumAreas(const vplGeometry* g, double* area, double* reflecting)
{
    *area = *reflecting = 0;
    for (int i = 0; i < g->triangleCount; i++) {
        const vplGeometryObject* object = &g->objects[g->owners[i]];
        const vplRgb rho = g->materials[object->material].diffuse;
        double a = triangleArea(g->positions + object->firstVertex, g->indices + 3 * (size_t)i);
        *area += a;
        *reflecting += a * ((double)rho.r + (double)rho.g + (double)rho.b) / 3;
    }
}

double vplGeometry_Area(const vplGeometry* geometry)
{
    double area, reflecting;
    sumAreas(geometry, &area, &reflecting);
    return area;
}

double vplGeometry_MeanReflectance(const vplGeometry* geometry)
{
    double area, reflecting;
    sumAreas(geometry, &area, &reflecting);
    return area > 0 ? reflecting / area : 0;
}

float vplGeometry_Diagonal(const vplGeometry* geometry)
{
    return vplLength(vplSub(geometry->boundsMax, geometry->boundsMin));
}
