// SPDX-License-Identifier: MIT
// Geometry that follows the edits of its scene is that of a new one: arrays bit by bit, and the hits of rays.
#include "shapes.h"

#include "geometry/bvh.h"
#include "geometry/cut_outs.h"
#include "geometry/paint_data.h"
#include "geometry/triangle.h"
#include "scene/scene.h"

static void assertSameArray(const void* a, const void* b, size_t count, size_t size)
{
    assert_true((a != NULL) == (b != NULL));
    if (a != NULL && count > 0) {
        assert_memory_equal(a, b, count * size);
    }
}

static void assertSameObjects(const vplGeometry* a, const vplGeometry* b)
{
    for (int i = 0; i < a->objectCount; i++) {
        const vplGeometryObject *one = &a->objects[i], *other = &b->objects[i];
        assert_int_equal(one->material, other->material);
        assert_memory_equal(&one->reflectance, &other->reflectance, sizeof one->reflectance);
        assert_memory_equal(&one->placement, &other->placement, sizeof one->placement);
        assert_memory_equal(&one->bounds, &other->bounds, sizeof one->bounds);
        assert_true(one->byFormula == other->byFormula && one->coplanar == other->coplanar);
    }
}

static void assertSamePaint(const vplGeometry* a, const vplGeometry* b)
{
    const vplPaint *one = a->paint, *other = b->paint;
    assert_true((one != NULL) == (other != NULL));
    if (one != NULL) {
        assertSameArray(one->texcoords, other->texcoords, 2 * (size_t)a->vertexCount, sizeof(float));
        assertSameArray(one->colours, other->colours, (size_t)a->vertexCount, sizeof(vplRgb));
        assertSameArray(one->means, other->means, (size_t)a->triangleCount, sizeof(vplRgb));
        assertSameArray(one->places, other->places, (size_t)a->materialCount, sizeof(vplTexturePlace));
        assert_int_equal(one->textureCount, other->textureCount);
    }
    assert_true((a->cutOuts != NULL) == (b->cutOuts != NULL));
    if (a->cutOuts != NULL) {
        assertSameArray(a->cutOuts->is, b->cutOuts->is, (size_t)a->triangleCount, 1);
        assertSameArray(a->cutOuts->indices, b->cutOuts->indices, 3 * (size_t)a->triangleCount,
                        sizeof(uint32_t));
    }
    assert_true((a->environment != NULL) == (b->environment != NULL));
    if (a->environment != NULL) {
        assert_memory_equal(&a->environment->irradiance, &b->environment->irradiance, sizeof(vplRgb));
    }
}

static void assertSameGeometry(const vplGeometry* a, const vplGeometry* b)
{
    const size_t vertices = (size_t)a->vertexCount, triangles = (size_t)a->triangleCount;
    assertSameArray(a->positions, b->positions, vertices, sizeof *a->positions);
    assertSameArray(a->shadingNormals, b->shadingNormals, vertices, sizeof *a->shadingNormals);
    assertSameArray(a->indices, b->indices, 3 * triangles, sizeof *a->indices);
    assertSameArray(a->normals, b->normals, triangles, sizeof *a->normals);
    assertSameArray(a->owners, b->owners, triangles, sizeof *a->owners);
    assertSameArray(a->triangleMaterials, b->triangleMaterials, triangles, sizeof *a->triangleMaterials);
    assert_int_equal(a->materialCount, b->materialCount);
    assert_int_equal(a->formulaCount, b->formulaCount);
    assertSameArray(a->formulaObjects, b->formulaObjects, (size_t)a->formulaCount, sizeof *a->formulaObjects);
    assert_memory_equal(&a->boundsMin, &b->boundsMin, sizeof a->boundsMin);
    assert_memory_equal(&a->boundsMax, &b->boundsMax, sizeof a->boundsMax);
    assert_true(a->area == b->area && a->meanReflectance == b->meanReflectance && a->emits == b->emits);
    assert_true(a->emittingArea == b->emittingArea && a->emittingTriangles == b->emittingTriangles);
    assertSameObjects(a, b);
    assertSamePaint(a, b);
}

// Returns how many of the rays hit something.
static int assertSameHits(const vplGeometry* a, const vplGeometry* b, Dice* dice, int rays)
{
    int hits = 0;
    for (int i = 0; i < rays; i++) {
        const vplRay ray = {rollVec(dice, 4), rollUnit(dice), {0, 0}};
        vplHit one, other;
        const bool hit = vplGeometry_ClosestHit(a, &ray, &one);
        assert_true(hit == vplGeometry_ClosestHit(b, &ray, &other));
        if (hit) {
            assert_int_equal(one.triangle, other.triangle);
            assert_memory_equal(&one.position, &other.position, sizeof one.position);
            hits++;
        }
        assert_true(vplGeometry_IsOccluded(a, &ray, 2) == vplGeometry_IsOccluded(b, &ray, 2));
    }
    return hits;
}

// A texture of 4 x 4 with alpha.
static int addTexture(vplScene* scene)
{
    unsigned char codes[4 * 16];
    vplTextureDef def = vplDefaultTextureDef();
    int index;
    for (int i = 0; i < 64; i++) {
        codes[i] = (unsigned char)(37 * i);
    }
    def.texels = codes;
    def.width = def.height = 4;
    def.channels = 4;
    assert_int_equal(vplScene_AddTexture(scene, &def, &index), VPL_SUCCESS);
    return index;
}

enum { SPHERES = 4, QUADS = 8, BOXES = 8, MATERIALS = 6 };

// Objects of all types, with materials 0 to MATERIALS - 1. Only the first `smooth` spheres are smooth.
static vplScene* crowd(vplContext* context, Dice* dice)
{
    vplScene* scene = sceneOf(context, 0.5f);
    Shape sphere = icosphere(2);
    addTexture(scene);
    for (int i = 1; i < MATERIALS; i++) {
        addMaterial(scene, (vplRgb){roll(dice, 0, 1), roll(dice, 0, 1), roll(dice, 0, 1)}, 0);
    }
    for (int i = 0; i < SPHERES; i++) {
        const double turn[3] = {0, 0, 0};
        const vplMat4 transform = vplMat4_FromParts(rollVec(dice, 3), turn, (vplVec3){0.5f, 0.4f, 0.6f});
        addShape(scene, &sphere, i % 2 == 0, &transform);
    }
    for (int i = 0; i < QUADS + BOXES; i++) {
        addThing(scene, i < QUADS ? VPL_OBJECT_QUAD : VPL_OBJECT_BOX, i % MATERIALS, rollVec(dice, 3),
                 (double)roll(dice, 0, 6), (double)roll(dice, 0, 6),
                 (vplVec3){1, 0.5f, i < QUADS ? 1 : 0.3f});
    }
    freeShape(&sphere);
    return scene;
}

static void moveOne(vplScene* scene, Dice* dice)
{
    const int object = (int)roll(dice, 0, (float)vplScene_GetObjectCount(scene));
    const double turn[3] = {(double)roll(dice, 0, 6), (double)roll(dice, 0, 6), 0};
    const float reach = roll(dice, 0, 1) < 0.1f ? 40 : 3; // far away, where a tree is built anew, or near
    const float mirrored = roll(dice, 0, 1) < 0.3f ? -1 : 1;
    // Small objects are tested by formula, and triangles of the smallest have no area.
    static const float sizes[8] = {1, 1, 1, 1, 1, 1, 1e-5f, 1e-9f};
    const float size = sizes[(int)roll(dice, 0, 8)];
    const vplVec3 scale = {mirrored * size, 0.7f * size, 0.6f * size};
    const vplMat4 transform = vplMat4_FromParts(rollVec(dice, reach), turn, scale);
    assert_int_equal(vplScene_SetTransform(scene, object, &transform), VPL_SUCCESS);
}

static void changeMaterial(vplScene* scene, Dice* dice)
{
    const int index = (int)roll(dice, 0, MATERIALS);
    vplMaterialDef material = *vplScene_GetMaterial(scene, index);
    const int what = (int)roll(dice, 0, 6);
    material.diffuse.g = roll(dice, 0, 1);
    material.emission.r = what == 0 ? 3 : 0;
    material.opacity = what == 1 || what == 2 ? 0.5f : 1;
    material.texture = what == 2 || what == 3 ? 0 : -1;
    material.textureScale[0] = roll(dice, 1, 4);
    material.alphaFromTexture = what == 3 && roll(dice, 0, 1) < 0.5f;
    assert_int_equal(vplScene_SetMaterial(scene, index, &material), VPL_SUCCESS);
}

static void changeEnvironment(vplScene* scene, Dice* dice)
{
    vplEnvironmentDef sky = vplDefaultEnvironmentDef();
    sky.type = roll(dice, 0, 1) < 0.5f ? VPL_ENVIRONMENT_CONSTANT : VPL_ENVIRONMENT_NONE;
    sky.radiance.b = roll(dice, 0, 1);
    assert_int_equal(vplScene_SetEnvironment(scene, &sky), VPL_SUCCESS);
}

static void editOnce(vplScene* scene, Dice* dice)
{
    const float what = roll(dice, 0, 1);
    const int count = vplScene_GetObjectCount(scene);
    if (what < 0.5f) {
        moveOne(scene, dice);
    } else if (what < 0.8f) {
        changeMaterial(scene, dice);
    } else if (what < 0.9f) {
        const int object = SPHERES + (int)roll(dice, 0, (float)(count - SPHERES));
        assert_int_equal(vplScene_SetObjectMaterial(scene, object, (int)roll(dice, 0, MATERIALS)),
                         VPL_SUCCESS);
    } else if (what < 0.95f) {
        changeEnvironment(scene, dice);
    } else if (what < 0.98f) {
        const int material = addMaterial(scene, (vplRgb){0, roll(dice, 0, 1), 0}, 0);
        assert_int_equal(vplScene_SetObjectMaterial(scene, count - 1, material), VPL_SUCCESS);
    } else {
        addTexture(scene);
    }
}

TEST(GeometryFollowsRandomEdits, 2, SLOW)
{
    Dice dice = {71, 0};
    int hits = 0, refitted = 0, rebuilt = 0, painted = 0, cut = 0;
    for (int run = 0; run < 4; run++) {
        vplScene* scene = crowd(context, &dice);
        vplGeometry* g;
        assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
        for (int i = 0; i < 100; i++) {
            vplGeometry* anew;
            const double cost = g->rayTree->cost;
            editOnce(scene, &dice);
            assert_true(vplGeometry_CanUpdate(g, scene));
            assert_int_equal(vplGeometry_Update(g, scene), VPL_SUCCESS);
            assert_int_equal(vplGeometry_Create(scene, &anew), VPL_SUCCESS);
            assertSameGeometry(g, anew);
            hits += assertSameHits(g, anew, &dice, 100);
            refitted += g->rayTree->cost == cost && vplBvh_Cost(g->rayTree) != cost;
            rebuilt += g->rayTree->cost != cost;
            painted += g->paint != NULL;
            cut += g->cutOuts != NULL;
            vplGeometry_Destroy(anew);
        }
        vplGeometry_Destroy(g);
        vplScene_Destroy(scene);
    }
    assert_true(hits > 2000 && refitted > 60 && rebuilt > 20 && painted > 50 && cut > 50);
}

// Objects that move back and forth cost no memory.
TEST(UpdatesHoldNoMoreMemory, 2)
{
    Dice dice = {5, 0};
    vplScene* scene = crowd(context, &dice);
    vplMaterialDef material = *vplScene_GetMaterial(scene, 1);
    vplMat4 transform = vplScene_GetObject(scene, 0)->transform;
    vplGeometry* g;
    size_t bytes = 0;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    for (int i = 0; i < 20; i++) {
        transform.m[12] += i % 2 == 0 ? 9 : -9;
        material.texture = i % 2 == 0 ? 0 : -1;
        material.opacity = i % 2 == 0 ? 0.5f : 1;
        assert_int_equal(vplScene_SetTransform(scene, 0, &transform), VPL_SUCCESS);
        assert_int_equal(vplScene_SetMaterial(scene, 1, &material), VPL_SUCCESS);
        const size_t ofScene = vplScene_GetBytes(scene);
        assert_int_equal(vplGeometry_Update(g, scene), VPL_SUCCESS);
        if (i > 2) {
            const size_t held = vplContext_GetBytes(context) - ofScene;
            assert_true(i % 2 == 0 || bytes == 0 || held == bytes);
            bytes = i % 2 == 0 ? bytes : held;
        }
    }
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

enum { OF_SPHERE = 5120 }; // triangles: tasks fill and sum up 4,096 each

// Three spheres, of which the first and the last emit light.
static vplGeometry* glowingSpheres(vplContext* context)
{
    vplScene* scene = sceneOf(context, 0.5f);
    const int glowing = addMaterial(scene, (vplRgb){0.3f, 0.2f, 0.1f}, 2);
    Shape sphere = icosphere(4);
    vplObjectDef object = vplDefaultObjectDef();
    for (int i = 0; i < 3; i++) {
        object.material = i == 1 ? 0 : glowing;
        object.transform.m[12] = 3 * (float)i;
        assert_int_equal(tryAddShape(scene, &sphere, true, &object), VPL_SUCCESS);
    }
    freeShape(&sphere);
    return buildGeometry(scene);
}

TEST(GeometryOfManyTasksIsThatOfOne, 1)
{
    vplContext* several = openTestContext(3);
    vplGeometry *one = glowingSpheres(context), *many = glowingSpheres(several);
    double area = 0;
    assertSameGeometry(one, many);
    assert_int_equal(one->triangleCount, 3 * OF_SPHERE);
    for (int i = 0; i < one->triangleCount; i++) {
        area += vplGeometry_TriangleArea(one, i);
        assert_int_equal(one->owners[i], i / OF_SPHERE);
    }
    assert_true(one->vertexCount > 3 * VPL_TRIANGLE_CHUNK && area > 37.5 && area < 37.7); // 3 x 4 pi
    assertNear(one->area / area, 1, 1e-12, "area", 0);
    assertNear(one->emittingArea / area, 2.0 / 3, 1e-6, "share that emits", 0);
    assertNear(one->meanReflectance, (2 * 0.2 + 0.5) / 3, 1e-6, "reflectance", 0);
    assert_int_equal(one->emittingTriangles, 2 * OF_SPHERE);
    assert_int_equal(one->emittingObjects, 2);
    vplGeometry_Destroy(one);
    vplGeometry_Destroy(many);
    closeTestContext(several);
}
