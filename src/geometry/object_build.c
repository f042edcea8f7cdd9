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
    double largest = fabs(v[0]); // fmax is a call to libm
    largest = fabs(v[1]) > largest ? fabs(v[1]) : largest;
    largest = fabs(v[2]) > largest ? fabs(v[2]) : largest;
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

// An object whose vertices and triangles are being filled. Each task fills VPL_TRIANGLE_CHUNK of them.
typedef struct Filling {
    const vplGeometryBuilder* builder;
    vplMeshDef shape;
    vplAffine world;
    int owner;
    bool mirrored;
    struct Sums {
        double area, rgb[3]; // reflectance times area
    } * sums;                // by chunk of triangles
} Filling;

static void fillVertices(void* data, int chunk, int worker)
{
    (void)worker;
    const Filling* f = data;
    const vplGeometryBuilder* b = f->builder;
    const vplGeometryObject* object = &b->objects[f->owner];
    const int first = chunk * VPL_TRIANGLE_CHUNK,
              end = vplEndOfChunk(f->shape.vertexCount, first, VPL_TRIANGLE_CHUNK);
    for (int i = first; i < end; i++) {
        b->positions[object->firstVertex + i] = toWorld(&f->world, f->shape.positions[i]);
        if (b->shadingNormals != NULL) {
            b->shadingNormals[object->firstVertex + i] =
                object->smooth ? normalToWorld(&object->placement, f->shape.normals[i]) : vplVec(0, 0, 0);
        }
    }
}

static vplVec3 normalOf(const vplGeometryObject* object, int triangle, const double cross[3])
{
    if (object->type == VPL_OBJECT_MESH) {
        return unit(cross);
    }
    const float* n = object->placement.normal[object->type == VPL_OBJECT_QUAD ? VPL_FACE_QUAD : triangle / 2];
    return vplVec(n[0], n[1], n[2]);
}

static void fillTriangles(void* data, int chunk, int worker)
{
    (void)worker;
    const Filling* f = data;
    const vplGeometryBuilder* b = f->builder;
    const vplGeometryObject* object = &b->objects[f->owner];
    struct Sums sums = {0};
    const int first = chunk * VPL_TRIANGLE_CHUNK,
              end = vplEndOfChunk(f->shape.triangleCount, first, VPL_TRIANGLE_CHUNK);
    for (int i = first; i < end; i++) {
        const size_t at = (size_t)object->firstTriangle + (size_t)i;
        const uint32_t* from = f->shape.indices + 3 * (size_t)i;
        uint32_t* index = b->indices + 3 * at;
        index[0] = from[0];
        index[1] = from[f->mirrored ? 2 : 1];
        index[2] = from[f->mirrored ? 1 : 2];
        const int material = object->material >= 0 ? object->material : f->shape.materials[i];
        const vplRgb rho = b->scene->materials[material].diffuse;
        const vplTriangleCorners corners = vplCornersOf(b->positions + object->firstVertex, index);
        double cross[3];
        vplTriangle_Cross(&corners, cross);
        const double a = vplAreaOfCross(cross);
        sums.area += a;
        sums.rgb[0] += a * rho.r;
        sums.rgb[1] += a * rho.g;
        sums.rgb[2] += a * rho.b;
        b->owners[at] = f->owner;
        b->triangleMaterials[at] = material;
        b->normals[at] = normalOf(object, i, cross);
    }
    f->sums[chunk] = sums;
}

static vplRgb meanReflectance(const Filling* f, int chunks)
{
    struct Sums all = {0};
    for (int i = 0; i < chunks; i++) {
        all.area += f->sums[i].area;
        for (int k = 0; k < 3; k++) {
            all.rgb[k] += f->sums[i].rgb[k];
        }
    }
    const double area = all.area;
    return area > 0
               ? (vplRgb){(float)(all.rgb[0] / area), (float)(all.rgb[1] / area), (float)(all.rgb[2] / area)}
               : (vplRgb){0, 0, 0};
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

vplResult vplBuildObject(const vplGeometryBuilder* b, int index)
{
    vplContext* context = b->scene->context;
    const vplObjectDef* def = &b->scene->objects[index];
    vplGeometryObject* object = &b->objects[index];
    Filling f = {.builder = b,
                 .shape = vplShapeOf(b->scene, def),
                 .world = vplAffine_FromMat4(&def->transform),
                 .owner = index,
                 .mirrored = mirrors(&object->placement)};
    const int chunks = vplCountChunks(f.shape.triangleCount, VPL_TRIANGLE_CHUNK);
    f.sums = vplAlloc(context, (size_t)chunks, sizeof *f.sums);
    if (f.sums == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplParallelFor(context, vplCountChunks(f.shape.vertexCount, VPL_TRIANGLE_CHUNK), fillVertices, &f);
    vplParallelFor(context, chunks, fillTriangles, &f);
    object->reflectance = meanReflectance(&f, chunks);
    vplFree(context, f.sums);
    object->bounds = object->placement; // stays for a mesh without a box: no vertices, or all in one point
    if (def->type == VPL_OBJECT_MESH) {
        findOrientedBox(def, &f.shape, object);
    }
    return VPL_SUCCESS;
}
