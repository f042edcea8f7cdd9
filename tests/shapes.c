// SPDX-License-Identifier: MIT
#include "shapes.h"

#include "math/matrix.h"
#include "math/scalar.h"
#include "math/vec.h"

#include <stdlib.h>

void addTriangle(Shape* shape, vplVec3 a, vplVec3 b, vplVec3 c)
{
    if (shape->triangleCount == shape->capacity) {
        shape->capacity = shape->capacity ? 2 * shape->capacity : 64;
        shape->corners = realloc(shape->corners, 3 * (size_t)shape->capacity * sizeof *shape->corners);
        assert_non_null(shape->corners);
    }
    vplVec3* to = shape->corners + 3 * shape->triangleCount++;
    to[0] = a;
    to[1] = b;
    to[2] = c;
}

void freeShape(Shape* shape)
{
    free(shape->corners);
    *shape = (Shape){0};
}

// Adds the two triangles of a quad whose corners are in order around it.
static void addFlat(Shape* shape, vplVec3 a, vplVec3 b, vplVec3 c, vplVec3 d)
{
    addTriangle(shape, a, b, c);
    addTriangle(shape, a, c, d);
}

static void addOnSphere(Shape* shape, vplVec3 a, vplVec3 b, vplVec3 c, int levels)
{
    if (levels == 0) {
        addTriangle(shape, a, b, c);
        return;
    }
    // Floating-point addition is commutative, so both triangles at an edge get the same midpoint.
    vplVec3 ab = vplNormalize(vplAdd(a, b)), bc = vplNormalize(vplAdd(b, c)), ca = vplNormalize(vplAdd(c, a));
    addOnSphere(shape, a, ab, ca, levels - 1);
    addOnSphere(shape, ab, b, bc, levels - 1);
    addOnSphere(shape, ca, bc, c, levels - 1);
    addOnSphere(shape, ab, bc, ca, levels - 1);
}

Shape icosphere(int levels)
{
    const float g = 1.6180340f;
    const vplVec3 p[12] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                           {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    static const int8_t faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                        {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                        {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                        {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    Shape shape = {0};
    for (int i = 0; i < 20; i++) {
        addOnSphere(&shape, vplNormalize(p[faces[i][0]]), vplNormalize(p[faces[i][1]]),
                    vplNormalize(p[faces[i][2]]), levels);
    }
    return shape;
}

static vplVec3 onRing(int rings, int ring, int part)
{
    double sine, cosine, x, y;
    vplSinCosQuarters(2.0 * ring / rings, &sine, &cosine);
    vplSinCosQuarters(2.0 * (part % (2 * rings)) / rings, &y, &x);
    return vplVec((float)(sine * x), (float)(sine * y), (float)cosine);
}

Shape ringSphere(int rings)
{
    Shape shape = {0};
    for (int ring = 0; ring < rings; ring++) {
        for (int part = 0; part < 2 * rings; part++) {
            vplVec3 a = onRing(rings, ring, part), b = onRing(rings, ring + 1, part),
                    c = onRing(rings, ring + 1, part + 1), d = onRing(rings, ring, part + 1);
            if (ring == 0) {
                addTriangle(&shape, vplVec(0, 0, 1), b, c);
            } else if (ring == rings - 1) {
                addTriangle(&shape, a, vplVec(0, 0, -1), d);
            } else {
                addFlat(&shape, a, b, c, d);
            }
        }
    }
    return shape;
}

Shape gridBox(int cells)
{
    Shape shape = {0};
    for (int face = 0; face < 6; face++) {
        const int axis = face / 2, turn = face & 1;
        for (int i = 0; i < cells * cells; i++) {
            vplVec3 p[4];
            for (int corner = 0; corner < 4; corner++) {
                float at[3];
                at[axis] = turn ? -1 : 1;
                at[(axis + 1) % 3] =
                    (float)(2 * (i % cells + (corner == 1 || corner == 2))) / (float)cells - 1;
                at[(axis + 2) % 3] = (float)(2 * (i / cells + (corner >= 2))) / (float)cells - 1;
                p[corner] = vplVec(at[0], at[1], at[2]);
            }
            addFlat(&shape, p[0], p[turn ? 3 : 1], p[2], p[turn ? 1 : 3]);
        }
    }
    return shape;
}

void placeShape(Shape* shape, float scale, const double rotate[3], vplVec3 offset)
{
    const vplMat4 m = vplMat4_FromParts(offset, rotate, vplVec(scale, scale, scale));
    for (int i = 0; i < 3 * shape->triangleCount; i++) {
        shape->corners[i] = vplMat4_TransformPoint(&m, shape->corners[i]);
    }
}

vplResult tryAddShape(vplScene* scene, const Shape* shape, bool smooth, vplObjectDef* object)
{
    const int corners = 3 * shape->triangleCount;
    uint32_t* indices = malloc((size_t)corners * sizeof *indices + 1);
    assert_non_null(indices);
    for (int i = 0; i < corners; i++) {
        indices[i] = (uint32_t)i;
    }
    vplMeshDef mesh = vplDefaultMeshDef();
    mesh.positions = shape->corners;
    mesh.normals = smooth ? shape->corners : NULL;
    mesh.indices = indices;
    mesh.vertexCount = corners;
    mesh.triangleCount = shape->triangleCount;
    object->type = VPL_OBJECT_MESH;
    const vplResult result = vplScene_AddMesh(scene, &mesh, &object->mesh);
    free(indices);
    return result == VPL_SUCCESS ? vplScene_AddObject(scene, object, NULL) : result;
}

void addShape(vplScene* scene, const Shape* shape, bool smooth, const vplMat4* transform)
{
    vplObjectDef object = vplDefaultObjectDef();
    object.transform = transform ? *transform : object.transform;
    if (tryAddShape(scene, shape, smooth, &object) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
}

vplGeometry* buildGeometry(vplScene* scene)
{
    vplGeometry* geometry;
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    vplScene_Destroy(scene);
    return geometry;
}

float roll(Dice* dice, float low, float high)
{
    return low + (high - low) * (float)uniformAt(dice->seed, dice->next++);
}

vplVec3 rollVec(Dice* dice, float size)
{
    float x = roll(dice, -size, size), y = roll(dice, -size, size);
    return vplVec(x, y, roll(dice, -size, size));
}

vplVec3 rollUnit(Dice* dice)
{
    for (;;) {
        vplVec3 v = rollVec(dice, 1);
        float length = vplLength(v);
        if (length <= 1 && length > 0.01f) {
            return vplNormalize(v);
        }
    }
}

vplGeometry* clutter(vplContext* context, int which)
{
    if (which == 0) {
        return tableRoom(context);
    }
    vplScene* scene = sceneOf(context, 0.5f);
    Shape ball = icosphere(3), box = gridBox(9);
    const double turned[3] = {0.3, 0.7, 0.1};
    placeShape(&ball, 0.35f, turned, vplVec(0.2f, -0.3f, 0.1f));
    addShape(scene, &ball, false, NULL);
    addShape(scene, &box, false, NULL);
    freeShape(&ball);
    freeShape(&box);
    return buildGeometry(scene);
}

vplHemiMapPlace rollPlace(const vplGeometry* g, Dice* dice, vplHit* hitOut)
{
    for (;;) {
        const vplVec3 size = vplSub(g->boundsMax, g->boundsMin);
        const vplVec3 from = {g->boundsMin.x + roll(dice, 0.01f, 0.99f) * size.x,
                              g->boundsMin.y + roll(dice, 0.01f, 0.99f) * size.y,
                              g->boundsMin.z + roll(dice, 0.01f, 0.99f) * size.z};
        const vplRay ray = {from, rollUnit(dice), {0, 0}};
        if (vplGeometry_ClosestHit(g, &ray, hitOut)) {
            const vplVec3 n = hitOut->normal;
            return (vplHemiMapPlace){hitOut->position, vplDot(n, ray.direction) < 0 ? n : vplNegate(n)};
        }
    }
}

vplReflectiveMap* mapOf(const vplGeometry* geometry, const vplEmitterDef* emitter, int size)
{
    vplReflectiveMapDef def = vplDefaultReflectiveMapDef();
    vplReflectiveMap* map = NULL;
    def.emitter = *emitter;
    def.size = size;
    if (vplReflectiveMap_Create(geometry, &def, NULL, NULL, &map) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return map;
}
