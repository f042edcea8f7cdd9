// SPDX-License-Identifier: MIT
// Tests of rays against the objects of a scene; test_ray_tables.c has the tables of single quads and boxes. Covers
// extremes X001 to X005, X008, X021 to X023, X029 and X031.
#include "shapes.h"

#include "math/vec.h"

TEST(EveryRayOfTheRoomMeetsTheObjectOfTheTable, 1)
{
    static const char* const faces[6] = {"x+", "x-", "y+", "y-", "z+", "z-"};
    vplGeometry* room = tableRoom(context);
    Table objects = loadTable("room_objects.csv"), t = loadTable("room_rays.csv");
    for (int row = 0; row < t.rows; row++) {
        vplRay ray = {vectorOf(&t, row, "o"), vectorOf(&t, row, "d"), {0, 0}};
        vplHit hit;
        const char* wanted = cell(&t, row, "object");
        if (!vplGeometry_ClosestHit(room, &ray, &hit)) {
            assert_string_equal("none", wanted);
            continue;
        }
        assert_string_equal(cell(&objects, hit.object, "name"), wanted);
        assert_string_equal(faces[hit.face], cell(&t, row, "face"));
        assertNear((double)hit.t, number(&t, row, "t"), 3.2e-6 / (double)vplLength(ray.direction), "t", row);
        vplVec3 p = vectorOf(&t, row, "p"), n = vectorOf(&t, row, "n");
        assertNear((double)vplLength(vplSub(hit.position, p)), 0, 3.2e-6, "position", row);
        assertNear((double)vplLength(vplSub(hit.normal, n)), 0, 2e-7, "normal", row);
    }
    freeTable(&t);
    freeTable(&objects);
    vplGeometry_Destroy(room);
}

// X002 to X004: scales of any magnitude have a usable inverse.
TEST(AnyUniformScaleGivesTheSameHit, 1)
{
    const float scales[] = {1, 1e-13f, 1e-6f, 1e6f, 1e12f};
    double wanted = 0;
    for (int i = 0; i < 5; i++) {
        float s = scales[i];
        vplMat4 m = vplMat4_FromParts((vplVec3){0, 0, 0}, (double[3]){0.3, 0.2, 0.1}, (vplVec3){s, s, s});
        vplPlacement placement;
        assert_int_equal(vplPlacement_Create(context, &m, &placement), VPL_SUCCESS);
        vplRay ray = {{0.1f * s, 0.2f * s, 3 * s}, {0, 0, -s}, {0, 0}};
        vplHit hit;
        assert_true(vplRay_HitBox(&ray, &placement, VPL_FACE_NONE, &hit));
        wanted = i == 0 ? (double)hit.t : wanted;
        assertNear((double)hit.t, wanted, 1e-6, "t", i);
        assertNear((double)vplLength(hit.normal), 1, 2e-7, "|n|", i);
    }
}

// X008, X001: creation refuses matrices without an inverse.
TEST(SingularAndNonFiniteMatricesAreRefused, 1)
{
    vplPlacement placement;
    const float bad[] = {NAN, INFINITY, 1e30f};
    for (int i = 0; i < 3; i++) {
        for (int element = 0; element < 16; element++) {
            vplMat4 m = vplMat4_Identity();
            m.m[element] = bad[i];
            assert_int_equal(vplPlacement_Create(context, &m, &placement), VPL_INVALID_ARGUMENT);
        }
    }
    for (int axis = 0; axis < 3; axis++) {
        vplMat4 m = vplMat4_Identity();
        m.m[5 * axis] = 0;
        assert_int_equal(vplPlacement_Create(context, &m, &placement), VPL_INVALID_ARGUMENT);
    }
}

// X029: two surfaces lie in one plane; the lower object index is reported, from both sides.
TEST(AmongEqualDistancesTheLowestObjectWins, 1)
{
    vplScene* scene;
    vplGeometry* geometry;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    vplMaterialDef material = vplDefaultMaterialDef();
    vplScene_AddMaterial(scene, &material, NULL);
    vplObjectDef object = vplDefaultObjectDef();
    for (int i = 0; i < 3; i++) {
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    }
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    vplRay ray = {{0.1f, 0.2f, 2}, {0, 0, -1}, {0, 0}};
    vplHit hit;
    assert_true(vplGeometry_ClosestHit(geometry, &ray, &hit));
    assert_int_equal(hit.object, 0);
    ray = vplGeometry_Leave(geometry, &hit, ray.direction);
    ray.origin.z = 2; // the other objects lie at the same place
    assert_true(vplGeometry_ClosestHit(geometry, &ray, &hit));
    assert_int_equal(hit.object, 1);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
}

// X021 to X023, X031: a particle that bounces inside a box hits the box's other faces, and one that leaves never hits
// it again.
TEST(ABoxIsLeftOrCrossedFromItsOwnFace, 1)
{
    for (uint64_t i = 0; i < 2000; i++) {
        vplMat4 m = vplMat4_FromParts((vplVec3){1, 2, 3},
                                      (double[3]){uniformAt(i, 0), uniformAt(i, 1), uniformAt(i, 2)},
                                      (vplVec3){2, 0.5f, 1});
        vplPlacement placement;
        assert_int_equal(vplPlacement_Create(context, &m, &placement), VPL_SUCCESS);
        vplVec3 d = {(float)uniformAt(i, 3) - 0.5f, (float)uniformAt(i, 4) - 0.5f,
                     (float)uniformAt(i, 5) - 0.5f};
        vplRay ray = {{1, 2, 3}, d, {0, 0}};
        vplHit out, next;
        assert_true(vplRay_HitBox(&ray, &placement, VPL_FACE_NONE, &out)); // from the centre outwards
        assert_true(vplDot(out.normal, d) > 0);
        ray.origin = out.position;
        assert_false(vplRay_HitBox(&ray, &placement, out.face, &next)); // continues outwards: no hit
        ray.direction = vplNegate(d);
        assert_true(vplRay_HitBox(&ray, &placement, out.face, &next)); // goes back: hits the opposite side
        assert_int_not_equal(next.face, out.face);
        assertNear((double)next.t, 2 * (double)out.t, 1e-5 * (double)out.t + 1e-5, "t", (int)i);
    }
}

TEST(MeanReflectanceIsThatOfTheTable, 1)
{
    vplGeometry* room = tableRoom(context);
    Table t = loadTable("room_mean_reflectivity.csv"), objects = loadTable("room_objects.csv");
    assert_string_equal(cell(&t, 0, "definition"), "area_weighted");
    assertNear(vplGeometry_MeanReflectance(room), number(&t, 0, "scalar_mean_of_rgb"), 1e-7, "mean", 0);
    double area = 0;
    for (int row = 0; row < objects.rows; row++) {
        area += number(&objects, row, "area");
    }
    assertNear(vplGeometry_Area(room), area, 1e-5 * area, "area", 0);
    freeTable(&objects);
    freeTable(&t);
    vplGeometry_Destroy(room);
}

// Triangles and ray tests describe the same surfaces: corners lie on the boxes, and normals agree with the
// winding, also under mirroring matrices (X005).
TEST(TrianglesWindTowardsTheirNormals, 1)
{
    for (int mirror = 0; mirror < 8; mirror++) {
        vplScene* scene;
        vplGeometry* g;
        assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
        vplMaterialDef material = vplDefaultMaterialDef();
        vplScene_AddMaterial(scene, &material, NULL);
        for (int type = 0; type < 2; type++) {
            vplObjectDef object = vplDefaultObjectDef();
            object.type = (vplObjectType)type;
            object.transform =
                vplMat4_FromParts((vplVec3){1, 2, 3}, (double[3]){0.5, 1, 2},
                                  (vplVec3){mirror & 1 ? -2 : 2, mirror & 2 ? -1 : 1, mirror & 4 ? -3 : 3});
            assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
        }
        assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
        assert_int_equal(g->triangleCount, 14);
        for (int i = 0; i < g->triangleCount; i++) {
            const vplVec3* p = g->positions + g->objects[g->owners[i]].firstVertex;
            const uint32_t* index = g->indices + 3 * i;
            vplVec3 cross = vplCross(vplSub(p[index[1]], p[index[0]]), vplSub(p[index[2]], p[index[0]]));
            assertNear((double)vplDot(vplNormalize(cross), g->normals[i]), 1, 1e-6, "winding", i);
        }
        vplGeometry_Destroy(g);
        vplScene_Destroy(scene);
    }
}

TEST_ALONE(NoGeometryHasNoArea)
{
    assert_true(vplGeometry_Area(NULL) == 0);
}
