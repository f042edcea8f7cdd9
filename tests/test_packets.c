// SPDX-License-Identifier: MIT
// Tests of packets of sixteen rays, and of the BVH: built with any number of workers, built later, or not at
// all.
#include "shapes.h"

#include "base/context.h"
#include "base/hash.h"
#include "base/isa.h"
#include "geometry/bvh.h"
#include "math/vec.h"

#include <stdlib.h>

// ---- packets

enum { TO_A_POINT, PARALLEL, ALONG_AXES, ANYWHERE, ONE_AND_THE_SAME, PACKET_KINDS };

static vplRay makeRay(int kind, int lane, const vplVec3* common, Dice* dice)
{
    vplRay ray = {rollVec(dice, 3), rollUnit(dice), {(int)roll(dice, 0, 300), lane % 4 == 0 ? 40 : 0}};
    if (kind == TO_A_POINT) { // from points of a patch, as pixels of a block cast them
        ray.origin = vplAdd(common[0], vplScale(0.1f, ray.origin));
        ray.direction = vplSub(common[1], ray.origin);
    } else if (kind == PARALLEL) {
        ray.direction = common[1];
    } else if (kind == ALONG_AXES) {
        float d[3] = {0, 0, 0};
        d[lane % 3] = lane & 4 ? -2.0f : 1.0f;
        ray.direction = vplVec(d[0], d[1], d[2]);
    } else if (kind == ONE_AND_THE_SAME) {
        ray.origin = common[0];
        ray.direction = common[1];
    }
    return ray;
}

static void comparePacket(const vplGeometry* g, int kind, Dice* dice, int* hits, int* rays)
{
    const vplVec3 common[2] = {rollVec(dice, 2), rollVec(dice, 1)};
    const float limits[] = {INFINITY, 1, 0.4f};
    vplRayPacket packet;
    memset(&packet, 0xCD, sizeof packet); // inactive lanes may hold anything
    packet.active = 0;
    for (int lane = 0; lane < VPL_RAY_PACKET; lane++) {
        const vplRay ray = makeRay(kind, lane, common, dice);
        if (roll(dice, 0, 1) < 0.8f) {
            vplRayPacket_Set(&packet, lane, &ray);
        }
    }
    for (int k = 0; k < 3; k++) {
        uint32_t wanted = 0;
        for (int lane = 0; lane < VPL_RAY_PACKET; lane++) {
            if (packet.active >> lane & 1) {
                const vplRay ray = vplRayPacket_Get(&packet, lane);
                wanted |= (uint32_t)vplGeometry_IsOccluded(g, &ray, limits[k]) << lane;
            }
        }
        const uint32_t found = vplGeometry_AreOccluded(g, &packet, limits[k]);
        if (found != wanted) {
            fail_msg("kind %d, limit %g: %04x, wanted %04x", kind, (double)limits[k], found, wanted);
        }
        *hits += __builtin_popcount(found);
        *rays += __builtin_popcount(packet.active);
    }
}

// Tests a BVH of 1280 triangles, and 20 triangles that rays test without a BVH.
TEST_ALONE(SixteenRaysSayWhatEachSaysAlone)
{
    for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
        if (!vplHasIsa((vplIsa)isa)) {
            continue;
        }
        vplContext* context = openIsaContext(1, (vplIsa)isa);
        for (int level = 0; level < 4; level += 3) {
            Shape ball = icosphere(level);
            vplScene* scene = sceneOf(context, 0.5f);
            addShape(scene, &ball, false, NULL);
            vplGeometry* g = buildGeometry(scene);
            assert_int_equal(g->rayTree->nodes == NULL, level == 0);
            Dice dice = {11, 0};
            int hits = 0, rays = 0;
            for (int i = 0; i < 600; i++) {
                comparePacket(g, i % PACKET_KINDS, &dice, &hits, &rays);
            }
            assert_true(hits > rays / 10 && hits < rays * 9 / 10);
            const vplRayPacket none = {.active = 0};
            assert_int_equal(vplGeometry_AreOccluded(g, &none, INFINITY), 0);
            vplGeometry_Destroy(g);
            freeShape(&ball);
        }
        closeTestContext(context);
    }
}

// ---- the tree

static vplGeometry* ballOf(vplContext* context, int level, bool forRaster)
{
    Shape ball = icosphere(level);
    vplScene* scene = sceneOf(context, 0.5f);
    addShape(scene, &ball, false, NULL);
    vplGeometry* g;
    assert_int_equal((forRaster ? vplGeometry_CreateForRaster : vplGeometry_Create)(scene, &g), VPL_SUCCESS);
    vplScene_Destroy(scene);
    freeShape(&ball);
    return g;
}

static uint64_t hashTree(const vplBvh* bvh)
{
    uint64_t hash = 0;
    for (int i = 0; i < bvh->nodeCount; i++) {
        const vplBvhNode* node = &bvh->nodes[i];
        hash = vplHashFloats(hash, node->planes[0], 6 * VPL_BVH_WIDTH);
        hash = vplHashWords(hash, (const uint32_t*)node->child, VPL_BVH_WIDTH);
        hash = vplHashWords(hash, (const uint32_t*)&node->count, 1);
    }
    return vplHashWords(hash, (const uint32_t*)bvh->blocks,
                        (size_t)bvh->blockCount * sizeof *bvh->blocks / sizeof(uint32_t));
}

// 20480 triangles take several parallel rounds of splits.
TEST_ALONE(TheTreeIsTheSameForAnyNumberOfWorkers)
{
    uint64_t first = 0;
    for (int workers = 1; workers <= 7; workers += workers == 3 ? 4 : 1) {
        vplContext* context = openTestContext(workers);
        vplGeometry* g = ballOf(context, 5, false);
        const uint64_t hash = hashTree(g->rayTree);
        first = first ? first : hash;
        assert_true(hash == first && g->rayTree->nodeCount > 300);
        vplGeometry_Destroy(g);
        closeTestContext(context);
    }
}

enum { RAYS = 64 };

typedef struct Crowd {
    const vplGeometry* geometry;
    float t[RAYS];
} Crowd;

static vplRay rayOfCrowd(int index)
{
    Dice dice = {(uint64_t)index, 0};
    return (vplRay){rollVec(&dice, 2), rollUnit(&dice), {0, 0}};
}

static void castOne(void* data, int index, int worker)
{
    (void)worker;
    Crowd* crowd = data;
    const vplRay ray = rayOfCrowd(index);
    vplHit hit;
    const bool met = vplGeometry_ClosestHit(crowd->geometry, &ray, &hit);
    const bool any = vplGeometry_IsOccluded(crowd->geometry, &ray, INFINITY);
    crowd->t[index] = met != any ? -2 : met ? hit.t : -1;
}

static vplRayPacket packetOfCrowd(void)
{
    vplRayPacket packet = {.active = 0};
    for (int lane = 0; lane < VPL_RAY_PACKET; lane++) {
        const vplRay ray = rayOfCrowd(lane);
        vplRayPacket_Set(&packet, lane, &ray);
    }
    return packet;
}

// Hits have the same bits without a BVH, with one that is built later, and with one that was built at once.
TEST(RaysNeedNoTree, 4)
{
    vplGeometry *whole = ballOf(context, 4, false), *g = ballOf(context, 4, true);
    assert_true(whole->rayTree->nodes != NULL && g->rayTree == NULL);
    Crowd wanted = {whole, {0}}, without = {g, {0}}, with = {g, {0}};
    const vplRayPacket packet = packetOfCrowd();
    vplParallelFor(context, RAYS, castOne, &wanted);
    vplParallelFor(context, RAYS, castOne, &without);
    assert_memory_equal(wanted.t, without.t, sizeof wanted.t);
    const uint32_t hits = vplGeometry_AreOccluded(whole, &packet, INFINITY);
    assert_int_equal(vplGeometry_AreOccluded(g, &packet, INFINITY), hits);
    const size_t before = vplContext_GetBytes(context);
    assert_int_equal(vplGeometry_BuildRayTree(g), VPL_SUCCESS);
    const size_t after = vplContext_GetBytes(context);
    assert_true(after > before + 5120 * sizeof(float[9]));
    assert_int_equal(vplGeometry_BuildRayTree(g), VPL_SUCCESS); // does nothing the second time
    assert_true(vplContext_GetBytes(context) == after && hashTree(g->rayTree) == hashTree(whole->rayTree));
    vplParallelFor(context, RAYS, castOne, &with);
    assert_memory_equal(wanted.t, with.t, sizeof wanted.t);
    vplGeometry_Destroy(whole);
    vplGeometry_Destroy(g);
}

// Twelve triangles make two blocks, 320 make more than VPL_COUNTED_BLOCKS.
TEST(CountedRaysTestEveryObjectOfSmallScenes, 1)
{
    for (int level = 0; level < 4; level++) {
        for (int forRaster = 0; forRaster < 2; forRaster++) {
            vplGeometry* g = ballOf(context, level, forRaster);
            int tests = 0;
            vplHit hit;
            const vplRay ray = {{0, 0, 0}, {1, 2, 3}, {0, 0}};
            assert_true(vplClosestHit(g, &ray, INFINITY, &tests, &hit));
            const bool everyObject = forRaster || g->rayTree->blockCount <= VPL_COUNTED_BLOCKS;
            assert_true(everyObject == (forRaster || level == 0));
            assert_true(everyObject ? tests == g->objectCount : tests < g->rayTree->blockCount);
            vplGeometry_Destroy(g);
        }
    }
}

static void* allocUnlessTold(void* user, void* memory, size_t oldSize, size_t newSize)
{
    (void)oldSize;
    if (newSize == 0) {
        free(memory);
        return NULL;
    }
    return *(bool*)user ? NULL : realloc(memory, newSize);
}

TEST_ALONE(AFailedTreeLeavesTheGeometryAsItWas)
{
    bool empty = false;
    vplContextDef def = vplDefaultContextDef();
    def.alloc = allocUnlessTold;
    def.allocUser = &empty;
    def.workerCount = 1;
    vplContext* context;
    assert_int_equal(vplContext_Create(&def, &context), VPL_SUCCESS);
    vplGeometry* g = ballOf(context, 3, true);
    Crowd without = {g, {0}}, with = {g, {0}};
    const size_t before = vplContext_GetBytes(context);
    empty = true;
    assert_int_equal(vplGeometry_BuildRayTree(g), VPL_OUT_OF_MEMORY);
    assert_true(g->rayTree == NULL && vplContext_GetBytes(context) == before);
    vplParallelFor(context, RAYS, castOne, &without);
    empty = false;
    assert_int_equal(vplGeometry_BuildRayTree(g), VPL_SUCCESS);
    assert_true(g->rayTree->nodes != NULL);
    vplParallelFor(context, RAYS, castOne, &with);
    assert_memory_equal(with.t, without.t, sizeof with.t);
    vplGeometry_Destroy(g);
    vplContext_Destroy(context);
}
