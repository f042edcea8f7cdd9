// SPDX-License-Identifier: MIT
// The frozen scene: world-space arrays of all triangles.
#include "geometry/freeze.h"
#include "geometry/ray_tree.h"
#include "geometry/triangle.h"
#include "math/vec.h"

#include <math.h>

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

static vplResult allocate(vplGeometry* g, vplFreezer* f, bool smooth)
{
    vplContext* context = g->context;
    const size_t vertices = (size_t)g->vertexCount, triangles = (size_t)g->triangleCount;
    g->objects = f->objects = vplAllocZero(context, (size_t)g->objectCount, sizeof *f->objects);
    g->positions = f->positions = vplAlloc(context, vertices, sizeof *f->positions);
    g->indices = f->indices = vplAlloc(context, 3 * triangles, sizeof *f->indices);
    g->normals = f->normals = vplAlloc(context, triangles, sizeof *f->normals);
    g->owners = f->owners = vplAlloc(context, triangles, sizeof *f->owners);
    g->triangleMaterials = f->materials = vplAlloc(context, triangles, sizeof *f->materials);
    g->materials = vplAlloc(context, (size_t)g->materialCount, sizeof *g->materials);
    bool complete =
        f->objects && f->positions && f->indices && f->normals && f->owners && f->materials && g->materials;
    if (smooth && complete) {
        g->shadingNormals = f->shadingNormals = vplAlloc(context, vertices, sizeof *f->shadingNormals);
        complete = f->shadingNormals != NULL;
    }
    return complete ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static bool isSmooth(const vplScene* scene, const vplObjectDef* def)
{
    return def->type == VPL_OBJECT_MESH && scene->meshes[def->mesh].normals != NULL;
}

static vplResult fill(const vplScene* scene, vplGeometry* g, const vplFreezer* f)
{
    int vertex = 0, triangle = 0;
    for (int i = 0; i < g->objectCount; i++) {
        const vplObjectDef* def = &scene->objects[i];
        vplGeometryObject* object = &f->objects[i];
        *object = (vplGeometryObject){.type = def->type,
                                      .material = def->material,
                                      .smooth = isSmooth(scene, def),
                                      .firstVertex = vertex,
                                      .vertexCount = vplCountVertices(scene, def),
                                      .firstTriangle = triangle,
                                      .triangleCount = vplCountTriangles(scene, def)};
        vplResult result = vplPlacement_Create(g->context, &def->transform, &object->placement);
        if (result != VPL_SUCCESS) {
            return result;
        }
        vplFreezeObject(f, i);
        vertex += object->vertexCount;
        triangle += object->triangleCount;
    }
    for (int i = 0; i < g->materialCount; i++) {
        vplMaterialDef* material = (vplMaterialDef*)&g->materials[i];
        *material = scene->materials[i];
        material->name = NULL; // the scene may be destroyed before the geometry
    }
    findBounds(g);
    return vplRayTree_Create(g->context, &g->rayTree);
}

// What renders ask for again and again, over all triangles in order.
static void sumUp(vplGeometry* g)
{
    double reflecting = 0;
    for (int i = 0; i < g->triangleCount; i++) {
        const vplMaterialDef* material = &g->materials[g->triangleMaterials[i]];
        const vplRgb rho = material->diffuse;
        const double area = vplGeometry_TriangleArea(g, i);
        g->area += area;
        reflecting += area * ((double)rho.r + (double)rho.g + (double)rho.b) / 3;
        g->emits = g->emits || vplRgbMean(material->emission) > 0;
    }
    g->meanReflectance = g->area > 0 ? reflecting / g->area : 0;
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
    bool smooth = false;
    for (int i = 0; i < scene->objectCount; i++) {
        vertices += vplCountVertices(scene, &scene->objects[i]);
        triangles += vplCountTriangles(scene, &scene->objects[i]);
        smooth = smooth || isSmooth(scene, &scene->objects[i]);
    }
    vplFreezer freezer = {.scene = scene};
    vplResult result = VPL_SUCCESS;
    if (triangles > VPL_MAX_TRIANGLES || vertices > VPL_MAX_TRIANGLES) {
        result = vplFail(context, VPL_LIMIT, "the scene has %lld triangles, at most %d are allowed",
                         (long long)triangles, VPL_MAX_TRIANGLES);
    } else {
        g->vertexCount = (int)vertices;
        g->triangleCount = (int)triangles;
        result = allocate(g, &freezer, smooth);
    }
    if (result == VPL_SUCCESS) {
        result = fill(scene, g, &freezer);
    }
    if (result != VPL_SUCCESS) {
        vplGeometry_Destroy(g);
        return result;
    }
    sumUp(g);
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
        vplFree(context, (void*)geometry->shadingNormals);
        vplFree(context, (void*)geometry->triangleMaterials);
        vplRayTree_Destroy(context, geometry->rayTree);
        vplFree(context, (void*)geometry->materials);
        vplFree(context, geometry);
    }
}

double vplGeometry_Area(const vplGeometry* geometry)
{
    return geometry->area;
}

double vplGeometry_MeanReflectance(const vplGeometry* geometry)
{
    return geometry->meanReflectance;
}

float vplGeometry_Diagonal(const vplGeometry* geometry)
{
    return vplLength(vplSub(geometry->boundsMax, geometry->boundsMin));
}
