// SPDX-License-Identifier: MIT
// Turns objects into world-space triangles: two for a quad, twelve for a box, those of a mesh. Corners are
// rounded from double once and shared by the faces that meet there, so edges are watertight.
#include "geometry/object_build.h"
#include "geometry/triangle.h"
#include "math/double3.h"
#include "math/matrix.h"
#include "math/vec.h"

#include <math.h>
#include <string.h>

static const vplVec3 QUAD_CORNERS[4] = {
    {-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}};
static const uint32_t QUAD_INDICES[6] = {0, 1, 2, 0, 2, 3};

// Corner i has x = +0.5 if bit 0 is set, y if bit 1, z if bit 2.
static const vplVec3 BOX_CORNERS[8] = {{-0.5f, -0.5f, -0.5f}, {0.5f, -0.5f, -0.5f}, {-0.5f, 0.5f, -0.5f},
                                       {0.5f, 0.5f, -0.5f},   {-0.5f, -0.5f, 0.5f}, {0.5f, -0.5f, 0.5f},
                                       {-0.5f, 0.5f, 0.5f},   {0.5f, 0.5f, 0.5f}};
static const uint32_t BOX_INDICES[36] = {
    1, 3, 7, 1, 7, 5, // +x
    0, 4, 6, 0, 6, 2, // -x
    2, 6, 7, 2, 7, 3, // +y
    0, 1, 5, 0, 5, 4, // -y
    4, 5, 7, 4, 7, 6, // +z
    0, 2, 3, 0, 3, 1, // -z
};

vplMeshDef vplShapeOf(const vplScene* scene, const vplObjectDef* def)
{
    if (def->type == VPL_OBJECT_MESH) {
        return scene->meshes[def->mesh];
    }
    vplMeshDef shape = {0};
    bool quad = def->type == VPL_OBJECT_QUAD;
    shape.positions = quad ? QUAD_CORNERS : BOX_CORNERS;
    shape.indices = quad ? QUAD_INDICES : BOX_INDICES;
    shape.vertexCount = quad ? 4 : 8;
    shape.triangleCount = quad ? 2 : 12;
    return shape;
}

static vplVec3 toWorld(const vplAffine* world, vplVec3 p)
{
    double at[3];
    for (int row = 0; row < 3; row++) {
        at[row] = world->m[row][3];
        for (int axis = 0; axis < 3; axis++) {
            at[row] += world->m[row][axis] * vplComponent(p, axis);
        }
    }
    return vplRound3(at);
}

static vplVec3 unit(const double v[3])
{
    double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(largest > 0)) {
        return vplVec(0, 0, 0);
    }
    double x = v[0] / largest, y = v[1] / largest, z = v[2] / largest;
    double length = sqrt(x * x + y * y + z * z);
    return vplVec((float)(x / length), (float)(y / length), (float)(z / length));
}

// Transforms a normal by the inverse transpose.
static vplVec3 normalToWorld(const vplPlacement* placement, vplVec3 n)
{
    double v[3];
    for (int i = 0; i < 3; i++) {
        v[i] =
            n.x * placement->toLocal[0][i] + n.y * placement->toLocal[1][i] + n.z * placement->toLocal[2][i];
    }
    return unit(v);
}

// True for a placement that turns counter-clockwise triangles into clockwise ones.
static bool mirrors(const vplPlacement* p)
{
    double cross[3];
    vplCross3(p->toWorld[1], p->toWorld[2], cross);
    return vplDot3(p->toWorld[0], cross) < 0;
}

static void fillVertices(const vplGeometryBuilder* b, const vplObjectDef* def, const vplMeshDef* shape,
                         const vplGeometryObject* object)
{
    const vplAffine world = vplAffine_FromMat4(&def->transform);
    for (int i = 0; i < shape->vertexCount; i++) {
        b->positions[object->firstVertex + i] = toWorld(&world, shape->positions[i]);
    }
    for (int i = 0; b->shadingNormals != NULL && i < shape->vertexCount; i++) {
        b->shadingNormals[object->firstVertex + i] =
            object->smooth ? normalToWorld(&object->placement, shape->normals[i]) : vplVec(0, 0, 0);
    }
}

static vplVec3 normalOf(const vplGeometryObject* object, int triangle, const vplTriangleCorners* corners)
{
    if (object->type == VPL_OBJECT_MESH) {
        double cross[3];
        vplTriangle_Cross(corners, cross);
        return unit(cross);
    }
    const float* n = object->placement.normal[object->type == VPL_OBJECT_QUAD ? VPL_FACE_QUAD : triangle / 2];
    return vplVec(n[0], n[1], n[2]);
}

static void fillTriangles(const vplGeometryBuilder* b, const vplMeshDef* shape, int owner)
{
    vplGeometryObject* object = &b->objects[owner];
    const bool mirrored = mirrors(&object->placement);
    double area = 0, sums[3] = {0, 0, 0};
    for (int i = 0; i < shape->triangleCount; i++) {
        const size_t at = (size_t)object->firstTriangle + (size_t)i;
        const uint32_t* from = shape->indices + 3 * (size_t)i;
        uint32_t* index = b->indices + 3 * at;
        index[0] = from[0];
        index[1] = from[mirrored ? 2 : 1];
        index[2] = from[mirrored ? 1 : 2];
        const int material = object->material >= 0 ? object->material : shape->materials[i];
        const vplRgb rho = b->scene->materials[material].diffuse;
        const vplTriangleCorners corners = vplCornersOf(b->positions + object->firstVertex, index);
        const double a = vplTriangle_Area(&corners);
        area += a;
        sums[0] += a * rho.r;
        sums[1] += a * rho.g;
        sums[2] += a * rho.b;
        b->owners[at] = owner;
        b->triangleMaterials[at] = material;
        b->normals[at] = normalOf(object, i, &corners);
    }
    object->reflectance = (vplRgb){0, 0, 0};
    if (area > 0) {
        object->reflectance =
            (vplRgb){(float)(sums[0] / area), (float)(sums[1] / area), (float)(sums[2] / area)};
    }
}

// Finds the oriented bounding box of a mesh: its box in local space, transformed with the object. Flat meshes
// get a thin one.
static void findOrientedBox(const vplObjectDef* def, const vplMeshDef* shape, vplGeometryObject* object)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, largest = 0;
    for (int i = 0; i < shape->vertexCount; i++) {
        for (int axis = 0; axis < 3; axis++) {
            double p = vplComponent(shape->positions[i], axis);
            low[axis] = p < low[axis] ? p : low[axis];
            high[axis] = p > high[axis] ? p : high[axis];
        }
    }
    for (int axis = 0; axis < 3; axis++) {
        largest = fmax(largest, fmax(high[axis] - low[axis], 1e-6 * fmax(fabs(low[axis]), fabs(high[axis]))));
    }
    vplAffine box = vplAffine_FromMat4(&def->transform), fit = box;
    for (int row = 0; row < 3; row++) {
        for (int axis = 0; axis < 3; axis++) {
            fit.m[row][axis] = box.m[row][axis] * fmax(high[axis] - low[axis], 1e-6 * largest);
            fit.m[row][3] += box.m[row][axis] * 0.5 * (low[axis] + high[axis]);
        }
    }
    const vplMat4 matrix = vplAffine_ToMat4(&fit);
    if (shape->vertexCount > 0 && vplCheckTransform(&matrix).field == NULL) {
        vplPlacement_Create(NULL, &matrix, &object->bounds);
    }
}

void vplBuildObject(const vplGeometryBuilder* b, int index)
{
    const vplObjectDef* def = &b->scene->objects[index];
    const vplMeshDef shape = vplShapeOf(b->scene, def);
    vplGeometryObject* object = &b->objects[index];
    fillVertices(b, def, &shape, object);
    fillTriangles(b, &shape, index);
    object->bounds = object->placement; // stays for a mesh without a box: no vertices, or all in one point
    if (def->type == VPL_OBJECT_MESH) {
        findOrientedBox(def, &shape, object);
    }
}
