// SPDX-License-Identifier: MIT
// Tests of ray trees that are built in little time, from groups of triangles along a Morton curve (test_rays.c compares their hits).
#include "shapes.h"

#include "base/context.h"
#include "geometry/bvh.h"
#include "render/renderer.h"

#include <string.h>

// A sphere of 20,480 triangles.
static vplScene* sphereScene(vplContext* context)
{
    vplScene* scene = sceneOf(context, 0.5f);
    Shape sphere = icosphere(5);
    addShape(scene, &sphere, false, NULL);
    freeShape(&sphere);
    return scene;
}

// `count` copies of one triangle: their Morton codes are equal.
static vplGeometry* copies(vplContext* context, int count)
{
    Shape shape = {0};
    for (int i = 0; i < count; i++) {
        addTriangle(&shape, vplVec(-1, -1, 0), vplVec(1, -1, 0), vplVec(0, 1, 0));
    }
    vplScene* scene = sceneOf(context, 0.5f);
    addShape(scene, &shape, false, NULL);
    freeShape(&shape);
    return buildGeometry(scene);
}

// Each block has up to eight triangles, ids ascending, and all blocks have each triangle once.
static void assertHoldsAll(const vplBvh* tree, const vplGeometry* g)
{
    uint8_t* seen = vplAllocZero(g->context, (size_t)g->triangleCount, 1);
    for (int i = 0; i < tree->blockCount; i++) {
        const int32_t* ids = tree->blocks[i].id;
        for (int lane = 0; lane < VPL_BVH_WIDTH && ids[lane] >= 0; lane++) {
            assert_true(lane == 0 || ids[lane] > ids[lane - 1]);
            assert_int_equal(seen[ids[lane]]++, 0);
        }
    }
    for (int i = 0; i < g->triangleCount; i++) {
        assert_int_equal(seen[i], 1);
    }
    vplFree(g->context, seen);
}

TEST(AQuickTreeHoldsEachTriangleOnce, 1)
{
    vplGeometry* sets[] = {buildGeometry(sphereScene(context)), clutter(context, 1), copies(context, 1000)};
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
        vplBvh* tree;
        assert_int_equal(vplBvh_Create(sets[i], 0, true, &tree), VPL_SUCCESS);
        assertHoldsAll(tree, sets[i]);
        assert_true(tree->blockCount >= sets[i]->triangleCount / VPL_BVH_WIDTH);
        assert_true(tree->blockCount < sets[i]->triangleCount / 3); // blocks are mostly filled
        vplBvh_Destroy(tree);
        vplGeometry_Destroy(sets[i]);
    }
}

TEST(AQuickTreeOfManyWorkersIsThatOfOne, 1)
{
    vplContext* several = openTestContext(3);
    vplGeometry *one = buildGeometry(sphereScene(context)), *many = buildGeometry(sphereScene(several));
    vplBvh *a, *b;
    assert_int_equal(vplBvh_Create(one, 0, true, &a), VPL_SUCCESS);
    assert_int_equal(vplBvh_Create(many, 0, true, &b), VPL_SUCCESS);
    assert_true(a->nodeCount == b->nodeCount && a->blockCount == b->blockCount);
    for (int i = 0; i < a->nodeCount; i++) {
        assert_true(memcmp(&a->nodes[i], &b->nodes[i], offsetof(vplBvhNode, count)) == 0);
        assert_int_equal(a->nodes[i].count, b->nodes[i].count);
    }
    assert_true(memcmp(a->blocks, b->blocks, (size_t)a->blockCount * sizeof *a->blocks) == 0);
    // The cost of a ray is about that of the other tree, although groups were not chosen by it.
    assert_true(a->cost < 1.25 * one->rayTree->cost && a->cost > one->rayTree->cost);
    vplBvh_Destroy(a);
    vplBvh_Destroy(b);
    vplGeometry_Destroy(one);
    vplGeometry_Destroy(many);
    closeTestContext(several);
}

static const vplBvh* treeFor(const vplScene* scene, double budgetMs, vplRenderer** rendererOut)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    o.output.width = o.output.height = 16;
    o.stop.budgetMs = budgetMs;
    assert_int_equal(vplRenderer_Create(scene, &o, rendererOut), VPL_SUCCESS);
    const vplGeometry* g = (*rendererOut)->runner.run.results[VPL_STAGE_GEOMETRY];
    return g->rayTree;
}

TEST(OnlyLittleTimeBuildsAQuickTree, 2)
{
    vplScene* scene = sphereScene(context);
    aim(scene, vplVec(0, 0, 4), vplVec(0, 0, 0));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(3, 3, 3), vplVec(0, 0, 1), 10);
    const double ms = vplTimeOfTree(context, 20480), budgets[] = {0, 3 * ms, 4 * ms};
    assertNear(ms, 20480 * 700e-6 / 1.9, 1e-9, "ms, with the usual speeds", 0);
    for (int i = 0; i < 3; i++) {
        vplRenderer* r;
        assert_true(treeFor(scene, budgets[i], &r)->quick == (i == 1));
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
}

// What an edit breaks is built in the same way.
TEST(AnEditKeepsTheKindOfTree, 1)
{
    for (int quick = 0; quick < 2; quick++) {
        vplScene* scene = sphereScene(context);
        vplGeometry* g;
        assert_int_equal(vplGeometry_CreateForRaster(scene, &g), VPL_SUCCESS);
        assert_int_equal(vplGeometry_BuildTree(g, quick), VPL_SUCCESS);
        const double cost = g->rayTree->cost;
        const vplMat4 larger = vplMat4_FromParts(vplVec(0, 0, 0), (double[]){0, 0, 0}, vplVec(2, 2, 2));
        assert_int_equal(vplScene_SetTransform(scene, 0, &larger), VPL_SUCCESS);
        assert_int_equal(vplGeometry_Update(g, scene), VPL_SUCCESS);
        assertNear(g->rayTree->cost / cost, 4, 0.01, "times the cost", 0); // so it was built again
        assert_true(g->rayTree->quick == quick);
        vplGeometry_Destroy(g);
        vplScene_Destroy(scene);
    }
}
