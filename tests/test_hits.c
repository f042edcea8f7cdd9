// SPDX-License-Identifier: MIT
// Tests of hit records and of rays that leave a hit: meshes, boxes and quads with arbitrary transforms.
#include "scenes.h"
#include "shapes.h"

#include "geometry/triangle.h"
#include "math/matrix.h"
#include "math/vec.h"

// Returns a transform that randomly scales, rotates, shears and mirrors, or leaves some of these out.
static vplMat4 rollTransform(Dice* dice, bool shear)
{
    const double rotate[3] = {roll(dice, -3, 3), roll(dice, -3, 3), roll(dice, -3, 3)};
    const vplVec3 scale = {roll(dice, 0.2f, 3), roll(dice, 0.2f, 3), roll(dice, 0.2f, 3)};
    vplMat4 m = vplMat4_FromParts(rollVec(dice, 5), rotate, scale);
    if (shear) {
        vplMat4 s = vplMat4_Identity();
        s.m[4] = roll(dice, -1, 1);
        s.m[9] = roll(dice, -1, 1);
        s.m[0] = roll(dice, 0, 1) < 0.5f ? -1 : 1;
        m = vplMat4_Multiply(&m, &s);
    }
    return m;
}

static vplGeometry* oneObject(vplContext* context, vplObjectType type, const vplMat4* transform)
{
    vplScene* scene = sceneOf(context, 0.5f);
    vplObjectDef object = vplDefaultObjectDef();
    object.type = type;
    object.transform = *transform;
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    return buildGeometry(scene);
}

// Returns a direction on the given side of a plane. One in four is close to the plane: 1e-4 off it outwards,
// 1e-2 off it inwards. Inward ones cannot be closer: a hit is off its plane by rounding, and near an edge
// such a ray would pass outside.
static vplVec3 rollSide(Dice* dice, vplVec3 normal, bool outward)
{
    const vplVec3 d = rollUnit(dice);
    const float cosine = vplDot(d, normal), wanted = outward ? 1 : -1;
    if (roll(dice, 0, 1) < 0.25f) {
        return vplAdd(vplSub(d, vplScale(cosine, normal)), vplScale(outward ? 1e-4f : -1e-2f, normal));
    }
    return cosine * wanted > 0 ? d : vplSub(d, vplScale(2 * cosine, normal));
}

// Casts rays from inside or outside onto a convex body around `centre`, and from each hit on to either side.
static void checkConvex(const vplGeometry* g, vplVec3 centre, float size, Dice* dice, int row)
{
    for (int i = 0; i < 1000; i++) {
        const bool within = i & 1;
        const vplVec3 middle = vplAdd(centre, rollVec(dice, 0.1f * size));
        const vplVec3 d = rollUnit(dice);
        const vplRay ray = {within ? middle : vplSub(middle, vplScale(20 * size, d)), d, {0, 0}};
        vplHit hit, next;
        if (!vplGeometry_ClosestHit(g, &ray, &hit) || (vplDot(hit.normal, d) > 0) != within) {
            fail_msg("surface %d, ray %d: missed it", row, i);
        }
        vplRay out = vplGeometry_Leave(g, &hit, rollSide(dice, hit.normal, true));
        if (vplGeometry_ClosestHit(g, &out, &next) || vplGeometry_IsOccluded(g, &out, INFINITY)) {
            fail_msg("surface %d, ray %d: left triangle %d and met %d at %g", row, i, hit.triangle,
                     next.triangle, (double)next.t);
        }
        vplRay in = vplGeometry_Leave(g, &hit, rollSide(dice, hit.normal, false));
        if (!vplGeometry_ClosestHit(g, &in, &next) || next.triangle == hit.triangle) {
            fail_msg("surface %d, ray %d: went in at triangle %d and met nothing", row, i, hit.triangle);
        }
    }
}

TEST(RaysLeaveConvexMeshes, 1)
{
    static const float scales[] = {1e-3f, 1, 1e5f};
    for (int i = 0; i < 27; i++) {
        const float scale = scales[i / 9];
        Shape shape = i % 3 == 0 ? icosphere(2) : i % 3 == 1 ? ringSphere(9) : gridBox(4);
        placeShape(&shape, scale, (double[3]){0.3, 0.2, 0.1}, vplVec(0, 0, 0));
        vplVec3 centre = i / 3 % 3 == 0   ? vplVec(0, 0, 0)
                         : i / 3 % 3 == 1 ? vplNegate(shape.corners[0])
                                          : vplScale(scale, vplVec(60, -70, 40));
        placeShape(&shape, 1, (double[3]){0, 0, 0}, centre);
        vplScene* scene = sceneOf(context, 0.5f);
        addShape(scene, &shape, false, NULL);
        vplGeometry* g = buildGeometry(scene);
        Dice dice = {(uint64_t)i, 0};
        checkConvex(g, centre, scale, &dice, i);
        vplGeometry_Destroy(g);
        freeShape(&shape);
    }
}

// X012
TEST(RaysLeaveBoxesAndQuads, 1)
{
    for (int i = 0; i < 40; i++) {
        Dice dice = {(uint64_t)i, 0};
        const vplMat4 m = rollTransform(&dice, i & 1);
        vplGeometry* g = oneObject(context, VPL_OBJECT_BOX, &m);
        checkConvex(g, vplVec(m.m[12], m.m[13], m.m[14]), 0.2f, &dice, i);
        vplGeometry_Destroy(g);
        g = oneObject(context, VPL_OBJECT_QUAD, &m);
        for (int k = 0; k < 500; k++) {
            const vplVec3 on =
                vplMat4_TransformPoint(&m, vplVec(roll(&dice, -0.4f, 0.4f), roll(&dice, -0.4f, 0.4f), 0));
            const vplVec3 d = rollSide(&dice, g->normals[0], k & 1);
            const vplRay ray = {vplSub(on, vplScale(3, d)), d, {0, 0}};
            vplHit hit, next;
            assert_true(vplGeometry_ClosestHit(g, &ray, &hit));
            for (int side = 0; side < 2; side++) {
                vplRay away = vplGeometry_Leave(g, &hit, rollSide(&dice, hit.normal, side));
                assert_false(vplGeometry_ClosestHit(g, &away, &next));
                assert_false(vplGeometry_IsOccluded(g, &away, INFINITY));
            }
        }
        vplGeometry_Destroy(g);
    }
}

// Six quads form a room: a ray that leaves one hits another, in the corners, too.
TEST(WallsOfARoomAreLeftForOtherWalls, 1)
{
    vplGeometry* g = closedCube(context, 0.5f);
    Dice dice = {3, 0};
    for (int i = 0; i < 20000; i++) {
        vplVec3 target = rollVec(&dice, 1); // towards a corner, an edge, or any point
        target.x = i % 3 == 0 ? copysignf(1 - 1e-5f, target.x) : target.x;
        target.y = i % 3 <= 1 ? copysignf(1 - 1e-5f, target.y) : target.y;
        target.z = copysignf(1, target.z);
        const vplRay ray = {vplVec(0.1f, 0.2f, -0.3f), vplSub(target, vplVec(0.1f, 0.2f, -0.3f)), {0, 0}};
        vplHit hit, next;
        assert_true(vplGeometry_ClosestHit(g, &ray, &hit));
        const vplRay away = vplGeometry_Leave(g, &hit, rollSide(&dice, hit.normal, true));
        if (!vplGeometry_ClosestHit(g, &away, &next)) {
            fail_msg("ray %d left wall %d at (%.9g, %.9g, %.9g) and the room", i, hit.object,
                     (double)hit.position.x, (double)hit.position.y, (double)hit.position.z);
        }
        assert_int_not_equal(next.object, hit.object);
    }
    vplGeometry_Destroy(g);
}

// X026
// Triangles find the face, and the analytic shape gives the hit point: the bits are those of vplRay_HitQuad
// and vplRay_HitBox. The two could disagree on hit or miss only at edges, by rounding; no ray here comes that
// near.
TEST(BoxesAndQuadsAreHitToTheLastDigit, 1)
{
    int hits = 0, apart = 0, otherFace = 0;
    for (int i = 0; i < 200; i++) {
        Dice dice = {(uint64_t)i, 0};
        const vplObjectType type = i & 1 ? VPL_OBJECT_BOX : VPL_OBJECT_QUAD;
        const vplMat4 m = rollTransform(&dice, i & 2);
        vplGeometry* g = oneObject(context, type, &m);
        const vplPlacement* placement = &g->objects[0].placement;
        for (int k = 0; k < 300; k++) {
            const vplVec3 local = rollVec(&dice, k % 3 ? 0.5f : 0.9f);
            const vplVec3 from = vplMat4_TransformPoint(&m, rollVec(&dice, 4));
            const vplRay ray = {from, vplSub(vplMat4_TransformPoint(&m, local), from), {0, 0}};
            vplHit a, b;
            const bool met = vplGeometry_ClosestHit(g, &ray, &a);
            const bool wanted = type == VPL_OBJECT_BOX ? vplRay_HitBox(&ray, placement, VPL_FACE_NONE, &b)
                                                       : vplRay_HitQuad(&ray, placement, &b);
            apart += met != wanted;
            if (!met || !wanted) {
                continue;
            }
            otherFace += a.face != b.face;
            hits += a.face == b.face;
            assert_true(a.face != b.face || (a.t == b.t && memcmp(&a.position, &b.position, 12) == 0 &&
                                             memcmp(&a.normal, &b.normal, 12) == 0));
        }
        vplGeometry_Destroy(g);
    }
    assert_true(hits > 25000 && apart == 0 && otherFace == 0);
}

// ---- normals

TEST(SmoothNormalsAreInterpolated, 1)
{
    const vplVec3 corners[3] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
    const vplVec3 normals[3] = {{0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}, {0, 0, 5}}; // of any length
    for (int back = 0; back < 2; back++) { // normals that point to the other side are flipped
        vplVec3 given[3];
        for (int i = 0; i < 3; i++) {
            given[i] = vplScale(back ? -1 : 1, normals[i]);
        }
        vplScene* scene = sceneOf(context, 0.5f);
        vplMeshDef mesh = vplDefaultMeshDef();
        vplObjectDef object = vplDefaultObjectDef();
        mesh.positions = corners;
        mesh.normals = given;
        mesh.indices = (const uint32_t[]){0, 1, 2};
        mesh.vertexCount = 3;
        mesh.triangleCount = 1;
        object.type = VPL_OBJECT_MESH;
        assert_int_equal(vplScene_AddMesh(scene, &mesh, &object.mesh), VPL_SUCCESS);
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
        vplGeometry* g = buildGeometry(scene);
        for (int i = 0; i < 200; i++) {
            Dice dice = {(uint64_t)i, 0};
            const float u = roll(&dice, 0, 1), v = roll(&dice, 0, 1 - u);
            const vplRay ray = {{2 * u, 2 * v, i & 1 ? 3 : -3}, {0, 0, i & 1 ? -1 : 1}, {0, 0}};
            vplHit hit;
            assert_true(vplGeometry_ClosestHit(g, &ray, &hit));
            assertNear((double)hit.u, (double)u, 1e-6, "u", i);
            assertNear((double)hit.v, (double)v, 1e-6, "v", i);
            const vplVec3 wanted = vplNormalize(
                vplAdd(vplScale(1 - u - v, normals[0]), vplAdd(vplScale(u, normals[1]), vplVec(0, 0, v))));
            const vplVec3 got = vplGeometry_ShadingNormal(g, &hit);
            assertNear((double)vplLength(vplSub(got, wanted)), 0, 1e-6, "normal", i);
            assert_true(hit.normal.x == 0 && hit.normal.y == 0 && hit.normal.z == 1);
        }
        vplGeometry_Destroy(g);
    }
}

// X005
// The front of a quad made of triangles is where that of an analytic quad is, mirrored or not.
TEST(TheFrontOfAMirroredMeshStaysTheFront, 1)
{
    for (int i = 0; i < 32; i++) {
        Dice dice = {(uint64_t)i, 0};
        vplMat4 m = rollTransform(&dice, true), mirror = vplMat4_Identity();
        for (int axis = 0; axis < 3; axis++) {
            mirror.m[5 * axis] = i >> axis & 1 ? -1 : 1;
        }
        m = vplMat4_Multiply(&m, &mirror);
        vplGeometry* quad = oneObject(context, VPL_OBJECT_QUAD, &m);
        const vplVec3 corners[4] = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}};
        const vplVec3 normals[4] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
        vplScene* scene = sceneOf(context, 0.5f);
        vplMeshDef mesh = vplDefaultMeshDef();
        vplObjectDef object = vplDefaultObjectDef();
        mesh.positions = corners;
        mesh.normals = normals;
        mesh.indices = (const uint32_t[]){0, 1, 2, 0, 2, 3};
        mesh.vertexCount = 4;
        mesh.triangleCount = 2;
        object.type = VPL_OBJECT_MESH;
        object.transform = m;
        assert_int_equal(vplScene_AddMesh(scene, &mesh, &object.mesh), VPL_SUCCESS);
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
        vplGeometry* g = buildGeometry(scene);
        const vplVec3 on = vplMat4_TransformPoint(&m, vplVec(0.1f, 0.2f, 0));
        const vplRay ray = {vplAdd(on, rollVec(&dice, 3)), {0, 0, 0}, {0, 0}};
        const vplRay to = {ray.origin, vplSub(on, ray.origin), {0, 0}};
        vplHit a, b;
        assert_true(vplGeometry_ClosestHit(quad, &to, &a) && vplGeometry_ClosestHit(g, &to, &b));
        assertNear((double)vplLength(vplSub(a.normal, b.normal)), 0, 2e-6, "front", i);
        assertNear((double)vplLength(vplSub(a.position, b.position)), 0, 1e-5, "position", i);
        const vplVec3 shading = vplGeometry_ShadingNormal(g, &b);
        assertNear((double)vplLength(vplSub(a.normal, shading)), 0, 2e-6, "shading", i);
        vplGeometry_Destroy(g);
        vplGeometry_Destroy(quad);
    }
}

// ---- bounding boxes instead of meshes

// The bounding box of a box made of triangles is the box itself; quads stay quads.
TEST(AMeshIsMetAtItsBox, 1)
{
    int hits = 0;
    for (int i = 0; i < 40; i++) {
        Dice dice = {(uint64_t)i, 0};
        const vplMat4 m = rollTransform(&dice, i & 1);
        vplGeometry* box = oneObject(context, VPL_OBJECT_BOX, &m);
        Shape shape = gridBox(2);
        placeShape(&shape, 0.5f, (double[3]){0, 0, 0}, vplVec(0, 0, 0));
        vplScene* scene = sceneOf(context, 0.5f);
        addShape(scene, &shape, false, &m);
        vplGeometry* mesh = buildGeometry(scene);
        for (int k = 0; k < 200; k++) {
            const vplVec3 from = vplMat4_TransformPoint(&m, rollVec(&dice, k & 1 ? 0.4f : 3));
            const vplVec3 to = vplMat4_TransformPoint(&m, rollVec(&dice, 0.8f));
            const vplRay ray = {from, vplSub(to, from), {0, 0}};
            vplHit a, b, c;
            const bool met = vplGeometry_ClosestBox(box, &ray, NULL, &a);
            assert_true(vplGeometry_ClosestBox(mesh, &ray, NULL, &b) == met);
            if (!met) {
                continue;
            }
            hits++;
            assert_true(a.t == b.t && a.face == b.face && memcmp(&a.position, &b.position, 12) == 0);
            assert_true(memcmp(&a.normal, &b.normal, 12) == 0);
            const vplRay out = {b.position, rollSide(&dice, b.normal, true), {0, 0}};
            assert_false(vplGeometry_ClosestBox(mesh, &out, &b, &c));
            const vplRay in = {b.position, rollSide(&dice, b.normal, false), {0, 0}};
            assert_true(vplGeometry_ClosestBox(mesh, &in, &b, &c) && c.face != b.face);
        }
        vplGeometry_Destroy(mesh);
        vplGeometry_Destroy(box);
        freeShape(&shape);
    }
    assert_true(hits > 5000);
}

// Points of a triangle stay unchanged; other points move to where their barycentric weights are at least
// 2^-16.
TEST(PointsBesideATriangleAreMovedInside, 1)
{
    int moved = 0;
    for (int i = 0; i < 2000; i++) {
        Dice dice = {(uint64_t)i, 0};
        Shape one = {0};
        addTriangle(&one, rollVec(&dice, 1), rollVec(&dice, 1), rollVec(&dice, 1));
        vplScene* scene = sceneOf(context, 0.5f);
        addShape(scene, &one, false, NULL);
        vplGeometry* g = buildGeometry(scene);
        const vplVec3* p = one.corners;
        const float b = roll(&dice, -0.2f, 1.2f), c = roll(&dice, -0.2f, 1.2f - b);
        const vplVec3 u = vplSub(p[1], p[0]), v = vplSub(p[2], p[0]);
        const vplVec3 point = vplAdd(p[0], vplAdd(vplScale(b, u), vplScale(c, v)));
        const vplVec3 inside = vplGeometry_Inside(g, 0, point);
        const bool was = b > 1e-3f && c > 1e-3f && b + c < 0.999f;
        if (was) {
            assert_true(memcmp(&inside, &point, sizeof point) == 0);
        }
        // The barycentric weights of the result, from areas. On slivers they show the rounding of the point.
        const double area = (double)vplLength(vplCross(u, v));
        const vplVec3 r = vplSub(inside, p[0]), n = vplScale((float)(1 / (area * area)), vplCross(u, v));
        const double wb = (double)vplDot(vplCross(r, v), n), wc = (double)vplDot(vplCross(u, r), n);
        const double slack = 1e-6 / area;
        assert_true(wb > -slack && wc > -slack && wb + wc < 1 + slack);
        moved += memcmp(&inside, &point, sizeof point) != 0;
        vplGeometry_Destroy(g);
        freeShape(&one);
    }
    assert_true(moved > 500 && moved < 1500);
}
