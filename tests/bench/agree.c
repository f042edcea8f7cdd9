// SPDX-License-Identifier: MIT
// Checks with grazing rays that the BVH and a loop over all triangle blocks give the same bits, and prints
// how many rays differed: bench/agree SCENE [RAYS].
#include "bench.h"
#include "math/sampling.h"

#include <math.h>
#include <string.h>

typedef struct Trees {
    vplContext* context;
    vplGeometry* geometry;
    vplBvh *tree, *all;
    vplTraceClosestFcn* closest;
    vplTraceAnyFcn* any;
} Trees;

static vplVec3 cornerOf(const vplGeometry* g, uint32_t word, int k)
{
    int triangle = (int)(word % (uint32_t)g->triangleCount);
    uint32_t index = g->indices[3 * (size_t)triangle + (size_t)k];
    return g->positions[(uint32_t)g->objects[g->owners[triangle]].firstVertex + index];
}

static vplVec3 mix(vplVec3 a, vplVec3 b, float t)
{
    return vplAdd(vplScale(1 - t, a), vplScale(t, b));
}

// Makes ray i, of one of several kinds: between two points of the bounds; from one edge to another; along an
// edge; in the plane of a triangle; along an axis from a corner.
static vplRay makeTestRay(const vplGeometry* g, uint64_t i)
{
    const vplRandom4 a = vplRandomAt(7, 1, i), b = vplRandomAt(7, 2, i);
    const float s = vplUnitFloat(a.v[0]), t = vplUnitFloat(a.v[1]);
    vplVec3 from = cornerOf(g, a.v[2], 0), to = cornerOf(g, b.v[2], 0);
    vplVec3 size = vplSub(g->boundsMax, g->boundsMin);
    vplRay ray = {vplVec(g->boundsMin.x + s * size.x, g->boundsMin.y + t * size.y,
                         g->boundsMin.z + vplUnitFloat(a.v[3]) * size.z),
                  vplSampleSphere(vplUnitFloat(b.v[0]), vplUnitFloat(b.v[1])),
                  {0, 0}};
    switch (i % 8) {
    case 3:
        ray.origin = mix(from, cornerOf(g, a.v[2], 1), s);
        ray.direction = vplSub(mix(to, cornerOf(g, b.v[2], 1), t), ray.origin);
        break;
    case 4: // from any point towards an edge
        ray.direction = vplSub(mix(to, cornerOf(g, b.v[2], 1), t), ray.origin);
        break;
    case 5:
        ray.direction = vplSub(cornerOf(g, a.v[2], 1), from);
        ray.origin = vplSub(from, vplScale(s < 0.5f ? 0 : t, ray.direction));
        break;
    case 6:
        ray.origin = mix(from, cornerOf(g, a.v[2], 2), 3 * s - 1);
        ray.direction = vplSub(mix(from, cornerOf(g, a.v[2], 1), t), ray.origin);
        break;
    case 7:
        ray.origin = from;
        ray.direction =
            vplVec(b.v[0] % 3 == 0 ? 1.0f : 0.0f, b.v[0] % 3 == 1 ? -1.0f : 0.0f, b.v[0] % 3 == 2);
        break;
    default:
        break;
    }
    if (!(vplLength(ray.direction) > 0)) {
        ray.direction = vplVec(0, 0, 1);
    }
    return ray;
}

enum { CHUNK = 1024 };

typedef struct Agreement {
    const Trees* trees;
    int64_t count;
    int64_t *hits, *wrong; // per chunk
} Agreement;

// Finds the closest hit over all triangles for each of CHUNK rays. The outer loop takes groups of blocks that
// stay in cache, the inner one rays.
static void testAll(const Trees* b, const vplRay* rays, int count, vplRawHit* truth)
{
    enum { GROUP = 64 };
    for (int first = 0; first < b->all->blockCount; first += GROUP) {
        vplBvh group = *b->all;
        group.blocks += first;
        group.blockCount = group.blockCount - first < GROUP ? group.blockCount - first : GROUP;
        for (int i = 0; i < count; i++) {
            vplRawHit hit;
            b->closest(&group, &rays[i], INFINITY, &hit);
            bool better = hit.t < truth[i].t || (hit.t == truth[i].t && hit.triangle < truth[i].triangle);
            if (hit.triangle >= 0 && (better || truth[i].triangle < 0)) {
                truth[i] = hit;
            }
        }
    }
}

static void compareChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Agreement* a = data;
    const Trees* b = a->trees;
    const int64_t from = (int64_t)chunk * CHUNK;
    const int count = a->count - from < CHUNK ? (int)(a->count - from) : CHUNK;
    vplRay rays[CHUNK];
    vplRawHit truth[CHUNK];
    for (int i = 0; i < count; i++) {
        rays[i] = makeTestRay(b->geometry, (uint64_t)(from + i));
        truth[i] = (vplRawHit){INFINITY, 0, 0, -1, 0};
    }
    testAll(b, rays, count, truth);
    for (int i = 0; i < count; i++) {
        vplRawHit hit;
        b->closest(b->tree, &rays[i], INFINITY, &hit);
        hit.blocks = truth[i].blocks = 0;
        // Any-hit queries must find nothing in front of the closest hit and something just beyond it.
        const bool found = truth[i].triangle >= 0,
                   any = b->any(b->tree, &rays[i], nextafterf(truth[i].t, INFINITY)),
                   before = b->any(b->tree, &rays[i], truth[i].t);
        a->hits[chunk] += found;
        a->wrong[chunk] += memcmp(&hit, &truth[i], sizeof hit) != 0 || any != found || (found && before);
    }
}

static int compare(const Trees* b, int64_t count)
{
    const int chunks = (int)((count + CHUNK - 1) / CHUNK);
    Agreement a = {b, count, calloc((size_t)chunks, sizeof(int64_t)),
                   calloc((size_t)chunks, sizeof(int64_t))};
    vplParallelFor(b->context, chunks, compareChunk, &a);
    int64_t hits = 0, wrong = 0;
    for (int i = 0; i < chunks; i++) {
        hits += a.hits[i];
        wrong += a.wrong[i];
    }
    printf("%lld rays, %lld hits, %lld differences\n", (long long)count, (long long)hits, (long long)wrong);
    free(a.hits);
    free(a.wrong);
    return wrong != 0;
}

int main(int argc, char** argv)
{
    const int64_t count = argc > 2 ? atoll(argv[2]) : 1000000;
    Trees b = {0};
    vplScene* scene;
    openScene(argc > 1 ? argv[1] : "examples/scenes/room.json", 0, VPL_ISA_AUTO, &b.context, &scene);
    check(vplGeometry_Create(scene, &b.geometry));
    check(vplBvh_Create(b.geometry, 0, false, &b.tree));
    check(vplBvh_Create(b.geometry, 1 << 30, false, &b.all));
    b.closest = vplGetRayKernels(vplContext_GetIsa(b.context))->closest;
    b.any = vplGetRayKernels(vplContext_GetIsa(b.context))->any;
    const int code = compare(&b, count);
    vplBvh_Destroy(b.tree);
    vplBvh_Destroy(b.all);
    vplGeometry_Destroy(b.geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(b.context);
    return code;
}
