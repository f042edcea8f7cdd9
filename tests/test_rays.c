// SPDX-License-Identifier: MIT
// Tests of rays against triangles: the BVH against all triangles, closed surfaces without leaks, ties, and
// scenes without surfaces.
#include "shapes.h"

#include "base/context.h"
#include "base/hash.h"
#include "base/isa.h"
#include "geometry/bvh.h"
#include "math/vec.h"

#include <limits.h>

enum { BIG_AND_TINY, COPIES, GRID, QUADS_AT_1E3, QUADS_AT_1E6, NEEDLES, AT_1E_10, AT_1E10, KINDS };

// Makes 200 triangles of a kind, 25 blocks and more, which give a BVH of two levels.
static Shape makeSoup(int kind, Dice* dice)
{
    Shape soup = {0};
    for (int i = 0; i < 200; i++) {
        vplVec3 a = rollVec(dice, 1), u = rollVec(dice, 0.2f), v = rollVec(dice, 0.2f);
        if (kind == BIG_AND_TINY) {
            float size = ldexpf(8, -(int)roll(dice, 0, 24));
            u = vplScale(size, u);
            v = vplScale(size, v);
        } else if (kind == COPIES && i % 10 != 0) { // ten copies of each
            const vplVec3* p = soup.corners + 3 * (i - 1);
            addTriangle(&soup, p[0], p[1], p[2]);
            continue;
        } else if (kind == GRID) { // 10 x 10 cells in one plane
            float x = (float)(i / 2 % 10), y = (float)(i / 20);
            vplVec3 p = {x, y, 0.25f * x}, q = {x + 1, y + 1, 0.25f * (x + 1)};
            addTriangle(&soup, p, i & 1 ? q : vplVec(q.x, p.y, q.z), i & 1 ? vplVec(p.x, q.y, p.z) : q);
            continue;
        } else if (kind == QUADS_AT_1E3 || kind == QUADS_AT_1E6) { // halves of squares that fill a lattice
            float far = kind == QUADS_AT_1E3 ? 1e3f : 1e6f;
            float at[3] = {far + (float)(i / 2 % 5), -far + (float)(i / 10 % 5), far + (float)(i / 50)};
            float next[3] = {at[0] + 1, at[1] + 1, at[2] + 1}, other[3] = {at[0], at[1], at[2]};
            next[i % 3] = at[i % 3];
            other[(i + 1) % 3] += 1;
            addTriangle(&soup, vplVec(at[0], at[1], at[2]), vplVec(other[0], other[1], other[2]),
                        vplVec(next[0], next[1], next[2]));
            continue;
        } else if (kind == NEEDLES) {
            u = vplScale(10, u);
            v = vplAdd(u, vplScale(1e-6f, v));
        }
        float size = kind == AT_1E_10 ? 1e-10f : kind == AT_1E10 ? 1e10f : 1;
        addTriangle(&soup, vplScale(size, a), vplScale(size, vplAdd(a, u)), vplScale(size, vplAdd(a, v)));
    }
    return soup;
}

// Makes a ray aimed at a feature of one of the triangles; `extent` is the size of all of them.
static vplRay makeRay(int index, const Shape* soup, float extent, Dice* dice)
{
    static const float lengths[] = {1, 1e-30f, 1e-12f, 1e12f, 1e27f};
    const vplVec3* p = soup->corners + 3 * (int)roll(dice, 0, (float)soup->triangleCount - 0.5f);
    const vplVec3 u = vplSub(p[1], p[0]), v = vplSub(p[2], p[0]);
    const float s = roll(dice, -0.5f, 1.5f), t = roll(dice, 0, 1);
    vplVec3 target = p[0], from = vplAdd(p[0], rollVec(dice, extent));
    switch (index % 8) {
    case 0: // near the triangle
        target = vplAdd(p[0], rollVec(dice, 0.1f * extent));
        break;
    case 1: // a corner
        break;
    case 2: // a point on an edge
        target = vplAdd(p[0], vplScale(t, u));
        break;
    case 3: // inside
        target = vplAdd(p[0], vplAdd(vplScale(t, u), vplScale(t * (1 - t), v)));
        break;
    case 4: // along an edge
        from = vplSub(p[0], vplScale(s, u));
        target = vplAdd(from, u);
        break;
    case 5: // in the plane
        from = vplSub(p[0], vplAdd(vplScale(3, u), vplScale(s, v)));
        target = vplAdd(p[0], vplAdd(vplScale(t, u), v));
        break;
    case 6: // along an axis, with zeros of both signs
        target = vplAdd(p[0], vplAdd(vplScale(t, u), vplScale(1 - t, v)));
        from = target;
        *(index & 8 ? &from.x : index & 16 ? &from.y : &from.z) += s * extent;
        break;
    default: // from a corner
        from = p[0];
        target = vplAdd(from, rollVec(dice, extent));
    }
    const float length = lengths[(int)roll(dice, 0, 4.99f)] / extent;
    vplVec3 d = vplScale(length, vplSub(target, from));
    if (index & 32) {
        d = vplVec(d.x == 0 ? -0.0f : d.x, d.y == 0 ? -0.0f : d.y, d.z == 0 ? -0.0f : d.z);
    }
    vplSkip skip = {(int)roll(dice, 0, 200), index % 3 == 0 ? (int)roll(dice, 0, 40) : 0};
    return (vplRay){from, d, skip};
}

// Compares the BVH with all triangles, closest and any hit, for one instruction set; folds the results into
// `state`.
static uint64_t compareOne(const vplBvh* tree, const vplBvh* all, const vplRay* ray, vplIsa isa,
                           uint64_t state, int* hits)
{
    vplRawHit a, b;
    vplGetRayKernels(isa)->closest(tree, ray, INFINITY, &a);
    vplGetRayKernels(isa)->closest(all, ray, INFINITY, &b);
    assert_true(a.triangle == b.triangle);
    assert_true(memcmp(&a, &b, offsetof(vplRawHit, triangle)) == 0);
    *hits += a.triangle >= 0;
    const float limits[] = {INFINITY, a.t, nextafterf(a.t, INFINITY), 0.5f * a.t};
    for (int i = 0; i < 4; i++) {
        const bool wanted = a.triangle >= 0 && a.t < limits[i];
        assert_true(vplGetRayKernels(isa)->any(tree, ray, limits[i]) == wanted);
        assert_true(vplGetRayKernels(isa)->any(all, ray, limits[i]) == wanted);
        vplGetRayKernels(isa)->closest(tree, ray, limits[i], &b);
        assert_true(b.triangle == (wanted ? a.triangle : -1) && b.t == (wanted ? a.t : limits[i]));
    }
    state = vplHashWords(state, (const uint32_t*)&a.triangle, 1);
    return vplHashFloats(state, (const float[]){a.t, a.b1, a.b2}, 3);
}

TEST(TreeAgreesWithAllTriangles, 1)
{
    uint64_t sums[VPL_ISA_COUNT] = {0};
    for (int kind = 0; kind < KINDS; kind++) {
        Dice dice = {(uint64_t)kind, 0};
        Shape soup = makeSoup(kind, &dice);
        vplScene* scene = sceneOf(context, 0.5f);
        addShape(scene, &soup, false, NULL);
        vplGeometry* g = buildGeometry(scene);
        vplBvh *tree, *quick, *all;
        assert_int_equal(vplBvh_Create(g, 0, false, &tree), VPL_SUCCESS);
        assert_int_equal(vplBvh_Create(g, 0, true, &quick), VPL_SUCCESS);
        assert_int_equal(vplBvh_Create(g, INT_MAX, false, &all), VPL_SUCCESS);
        assert_true(tree->nodeCount > 1 && all->nodes == NULL && all->blockCount >= 25);
        assert_true(quick->nodeCount > 1);
        assert_true(quick->blockCount != tree->blockCount ||
                    memcmp(quick->blocks, tree->blocks, (size_t)tree->blockCount * sizeof *tree->blocks) !=
                        0);
        const float extent = vplGeometry_Diagonal(g);
        int hits = 0, quickHits = 0;
        enum { RAYS = 800 };
        for (int i = 0; i < RAYS; i++) {
            const vplRay ray = makeRay(i, &soup, extent, &dice);
            for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
                if (vplHasIsa((vplIsa)isa)) {
                    sums[isa] = compareOne(tree, all, &ray, (vplIsa)isa, sums[isa], &hits);
                    compareOne(quick, all, &ray, (vplIsa)isa, 0, &quickHits);
                }
            }
        }
        assert_true(hits > RAYS / 4 && quickHits == hits);
        vplBvh_Destroy(tree);
        vplBvh_Destroy(quick);
        vplBvh_Destroy(all);
        vplGeometry_Destroy(g);
        freeShape(&soup);
    }
    for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
        if (vplHasIsa((vplIsa)isa) && sums[isa] != 0xdf32cd29ea929fe4ull) {
            fail_msg("%s: checksum %016llx", vplIsa_GetName((vplIsa)isa), (unsigned long long)sums[isa]);
        }
    }
}

// ---- closed surfaces

enum { SURFACES = 4, PLACES = 4 };

// Makes a closed surface around the origin, with a corner or a face at the origin, or 100 times its size
// away.
static Shape makeClosed(int which, int place, float scale, vplVec3* centreOut)
{
    Shape shape = which == 0   ? icosphere(2)
                  : which == 1 ? ringSphere(12)
                  : which == 2 ? gridBox(4)
                               : gridBox(8);
    const double turned[3] = {0.3, 0.2, 0.1}, straight[3] = {0, 0, 0};
    const double* rotate = which == 3 ? straight : turned;
    placeShape(&shape, scale, rotate, vplVec(0, 0, 0));
    const vplVec3* p = shape.corners;
    *centreOut = place == 0   ? vplVec(0, 0, 0)
                 : place == 1 ? vplNegate(p[0])
                 : place == 2 ? vplScale(-1 / 3.0f, vplAdd(p[0], vplAdd(p[1], p[2])))
                              : vplScale(scale, vplVec(60, -70, 40));
    placeShape(&shape, 1, straight, *centreOut);
    return shape;
}

static vplVec3 pointOn(const Shape* shape, int index, Dice* dice)
{
    const vplVec3* p = shape->corners + 3 * (index / 3 % shape->triangleCount);
    const float s = roll(dice, 0, 1), t = roll(dice, 0, 1 - s);
    vplVec3 along = vplScale(s, vplSub(p[1], p[0]));
    return index % 3 == 0   ? p[0]
           : index % 3 == 1 ? vplAdd(p[0], along)
                            : vplAdd(p[0], vplAdd(along, vplScale(t, vplSub(p[2], p[0]))));
}

// X013
// Rays aim at corners, at edges and anywhere, from inside and through the surface from far outside: they must
// always hit.
TEST(SharedEdgesLetNothingThrough, 1)
{
    static const float scales[] = {1e-3f, 1, 1e5f};
    int leaks = 0, rays = 0;
    for (int i = 0; i < SURFACES * PLACES * 3; i++) {
        const float scale = scales[i / (SURFACES * PLACES)];
        vplVec3 centre;
        Shape shape = makeClosed(i % SURFACES, i / SURFACES % PLACES, scale, &centre);
        vplScene* scene = sceneOf(context, 0.5f);
        addShape(scene, &shape, false, NULL);
        vplGeometry* g = buildGeometry(scene);
        Dice dice = {(uint64_t)i, 0};
        for (int k = 0; k < 2000; k++, rays++) {
            const vplVec3 within = vplAdd(centre, vplScale(0.8f * scale, rollUnit(&dice)));
            const vplVec3 target = pointOn(&shape, k, &dice);
            vplRay ray = {within, vplSub(target, within), {0, 0}};
            if (k & 1) { // from outside, past the target to a point inside
                const float far = scale * ldexpf(1, k / 2 % 11);
                ray.origin = vplAdd(target, vplScale(far, vplNormalize(vplSub(target, within))));
                ray.direction = vplSub(within, ray.origin);
            }
            const float limit = k & 1 ? 1 : INFINITY; // before the point inside
            vplHit hit;
            leaks += !vplGeometry_ClosestHit(g, &ray, &hit) || !(hit.t < limit) ||
                     !vplGeometry_IsOccluded(g, &ray, limit);
        }
        vplGeometry_Destroy(g);
        freeShape(&shape);
    }
    if (leaks > 0) {
        fail_msg("%d of %d rays found a gap", leaks, rays);
    }
}

// If edges are parallel to axes, a triangle's bounding box ends at the edge. From a distance of a thousand
// times its size, both tests have errors above the box's padding, but must decide consistently.
TEST(EdgesAlongAxesHoldFromAfar, 1)
{
    vplVec3 centre;
    Shape shape = makeClosed(3, 1, 1, &centre);
    vplScene* scene = sceneOf(context, 0.5f);
    addShape(scene, &shape, false, NULL);
    vplGeometry* g = buildGeometry(scene);
    Dice dice = {1, 0};
    int leaks = 0;
    enum { RAYS = 60000 };
    for (int i = 0; i < RAYS; i++) { // in the second row of cells, next to the origin
        const vplVec3* p = shape.corners + 3 * (16 + i % 16);
        vplVec3 target = vplAdd(p[0], vplScale(roll(&dice, 0, 1), vplSub(p[1], p[0])));
        vplVec3 d = rollUnit(&dice);
        d.x = -fabsf(d.x) - 0.1f; // through the face +x into the box
        const float far = ldexpf(1, i % 13);
        vplRay ray = {vplSub(target, vplScale(far, d)), d, {0, 0}};
        vplHit hit;
        leaks += target.y > 0.1f && target.y < 1.9f &&
                 !(vplGeometry_ClosestHit(g, &ray, &hit) && hit.position.x > -1); // not the wall behind
    }
    if (leaks > 0) {
        fail_msg("%d of %d rays found a gap", leaks, RAYS);
    }
    vplGeometry_Destroy(g);
    freeShape(&shape);
}

// ---- ties, and scenes without surfaces

// Three objects have eight different triangles in one plane, eight copies of each. Among copies the lowest
// index is hit, whatever the BVH's layout; rounding may decide which of the eight is nearest.
TEST(EqualDistancesGoToTheLowestTriangle, 1)
{
    Shape wall = {0};
    for (int i = 0; i < 64; i++) {
        float size = 2 + (float)(i % 8);
        addTriangle(&wall, vplVec(-size, -size, 1), vplVec(size, -size, 1), vplVec(0, size, 1));
    }
    vplScene* scene = sceneOf(context, 0.5f);
    for (int i = 0; i < 3; i++) {
        addShape(scene, &wall, false, NULL);
    }
    vplGeometry* g = buildGeometry(scene);
    assert_true(g->rayTree->nodes != NULL);
    Dice dice = {5, 0};
    for (int i = 0; i < 1000; i++) {
        vplVec3 target = rollVec(&dice, 0.5f);
        target.z = 1;
        vplRay ray = {{roll(&dice, -1, 1), 0, i & 1 ? -2 : 4}, {0, 0, 0}, {0, i % 184}};
        ray.direction = vplSub(target, ray.origin);
        vplHit hit;
        assert_true(vplGeometry_ClosestHit(g, &ray, &hit));
        assert_in_range(hit.triangle, i % 184, i % 184 + 7);
        assert_int_equal(hit.object, hit.triangle / 64);
    }
    vplGeometry_Destroy(g);
    freeShape(&wall);
}

// No plane separates the copies: the BVH is built by halving the list, and must be as shallow as that allows.
TEST(AThousandCopiesOfATriangleAreATreeOfHalves, 1)
{
    Shape copies = {0};
    for (int i = 0; i < 1000; i++) {
        addTriangle(&copies, vplVec(-1, -1, 0), vplVec(1, -1, 0), vplVec(0, 1, 0));
    }
    vplScene* scene = sceneOf(context, 0.5f);
    addShape(scene, &copies, false, NULL);
    vplGeometry* g = buildGeometry(scene);
    int triangles = 0;
    for (int i = 0; i < g->rayTree->blockCount; i++) {
        for (int lane = 0; lane < VPL_BVH_WIDTH; lane++) {
            triangles += g->rayTree->blocks[i].id[lane] >= 0;
        }
    }
    assert_int_equal(triangles, 1000);
    assert_true(g->rayTree->nodeCount > 1 && g->rayTree->blockCount <= 256);
    for (int first = 0; first < 1000; first += 37) {
        vplRay ray = {{0.1f, 0.2f, 3}, {0, 0, -1}, {0, first}};
        vplHit hit;
        assert_true(vplGeometry_ClosestHit(g, &ray, &hit));
        assert_int_equal(hit.triangle, first);
        assert_true(hit.t == 3);
    }
    const vplRay none = {{0.1f, 0.2f, 3}, {0, 0, -1}, {0, 1000}};
    vplHit hit;
    assert_false(vplGeometry_ClosestHit(g, &none, &hit) || vplGeometry_IsOccluded(g, &none, INFINITY));
    vplGeometry_Destroy(g);
    freeShape(&copies);
}

// Tests a scene of objects without surface, and one without objects.
TEST(WithoutSurfacesNothingIsEverHit, 1)
{
    for (int which = 0; which < 5; which++) {
        vplScene* scene = sceneOf(context, 0.5f);
        Shape shape = {0};
        const vplVec3 p = {1, 2, 3}, q = {4, 5, 6}, middle = {2.5f, 3.5f, 4.5f};
        for (int i = 0; i < 100 && which > 1; i++) { // in a point, on a line, folded back
            addTriangle(&shape, p, which == 2 ? p : q, which == 4 ? middle : p);
        }
        if (which > 0) {
            addShape(scene, &shape, false, NULL);
        }
        vplGeometry* g = buildGeometry(scene);
        assert_true(vplIsFiniteVec(g->boundsMin) && vplIsFiniteVec(g->boundsMax));
        assert_true(vplGeometry_Area(g) == 0 && vplGeometry_MeanReflectance(g) == 0);
        assert_true(isfinite(vplGeometry_Diagonal(g)));
        Dice dice = {9, 0};
        for (int i = 0; i < 200; i++) {
            vplRay ray = {rollVec(&dice, 8), rollUnit(&dice), {0, 0}};
            if (i & 1) {
                ray.direction = vplSub(i & 2 ? p : middle, ray.origin);
            }
            vplHit hit;
            assert_false(vplGeometry_ClosestHit(g, &ray, &hit));
            assert_false(vplGeometry_IsOccluded(g, &ray, INFINITY));
        }
        vplGeometry_Destroy(g);
        freeShape(&shape);
    }
}
