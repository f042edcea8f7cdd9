// SPDX-License-Identifier: MIT
// Rays, measured and checked: bench/rays SCENE [--agree N] [--runs N]
//   without --agree  millions of rays a second, one thread, for coherent rays (a camera's), diffuse ones (from
//                    what the camera sees, by the cosine) and shadow rays (from there to one point), through the
//                    tree, all blocks, and Intel Embree's rtcIntersect1 where it was found at build time
//   --agree N        that tree and all blocks give the same bits for N rays, and how many they were
#include "base/context.h"
#include "base/clock.h"
#include "base/rng.h"
#include "geometry/bvh.h"
#include "math/sampling.h"
#include "math/vec.h"

#include <vpl/vpl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef HAVE_EMBREE
#include <embree3/rtcore.h>
#endif

enum { SIDE = 512, MOST_RAYS = SIDE * SIDE };

typedef struct Bench {
    vplContext* context;
    vplGeometry* geometry;
    vplBvh *tree, *all;
    vplTraceClosestFcn* closest;
    vplTraceAnyFcn* any;
    vplRay* rays;
    float* limits; // of shadow rays
    int rayCount;
} Bench;

static void check(vplResult result)
{
    if (result != VPL_SUCCESS) {
        fprintf(stderr, "%s\n", vplResult_GetName(result));
        exit(1);
    }
}

static void say(void* user, vplLogLevel level, const char* message)
{
    (void)user;
    if (level == VPL_LOG_ERROR) {
        fprintf(stderr, "%s\n", message);
    }
}

static float unit(uint64_t index, uint32_t stream, int word)
{
    return vplUnitFloat(vplRandomAt(1, stream, index).v[word]);
}

// ---- rays to measure

static void makeCameraRays(Bench* b, const vplScene* scene)
{
    const vplView v = vplView_Create(vplScene_GetCamera(scene, 0), SIDE, SIDE);
    for (int i = 0; i < MOST_RAYS; i++) {
        float sx = (float)((2 * (i % SIDE + 0.5) / SIDE - 1) / v.scaleX);
        float sy = (float)((1 - 2 * (i / SIDE + 0.5) / SIDE) / v.scaleY);
        vplVec3 d = vplAdd(v.forward, vplAdd(vplScale(sx, v.right), vplScale(sy, v.up)));
        b->rays[i] = (vplRay){vplAdd(v.eye, vplScale((float)v.near, d)), d, {0, 0}};
    }
    b->rayCount = MOST_RAYS;
}

// Replaces the camera's rays by what follows them.
static void followRays(Bench* b, bool shadow)
{
    int count = 0;
    vplVec3 low = b->geometry->boundsMin, high = b->geometry->boundsMax;
    vplVec3 light = {0.5f * (low.x + high.x), 0.1f * low.y + 0.9f * high.y, 0.5f * (low.z + high.z)};
    for (int i = 0; i < b->rayCount; i++) {
        vplHit hit;
        if (!vplGeometry_ClosestHit(b->geometry, &b->rays[i], &hit)) {
            continue;
        }
        vplVec3 n = vplDot(hit.normal, b->rays[i].direction) > 0 ? vplNegate(hit.normal) : hit.normal;
        vplVec3 d = shadow ? vplSub(light, hit.position)
                           : vplSampleCosineAround(n, unit((uint64_t)i, 0, 0), unit((uint64_t)i, 0, 1));
        b->rays[count++] = vplGeometry_Leave(b->geometry, &hit, d);
    }
    b->rayCount = count;
}

static double median(double* values, int count)
{
    for (int i = 1; i < count; i++) {
        for (int k = i; k > 0 && values[k - 1] > values[k]; k--) {
            double swap = values[k];
            values[k] = values[k - 1];
            values[k - 1] = swap;
        }
    }
    return values[count / 2];
}

// Sums hits so that nothing is optimised away, and so that engines can be compared.
static double traceAll(const Bench* b, const vplBvh* bvh, bool shadow, int rays)
{
    double hits = 0;
    for (int i = 0; i < rays; i++) {
        if (shadow) {
            hits += b->any(bvh, &b->rays[i], 1);
        } else {
            vplRawHit hit;
            b->closest(bvh, &b->rays[i], INFINITY, &hit);
            hits += hit.triangle >= 0;
        }
    }
    return hits;
}

#ifdef HAVE_EMBREE
static RTCScene makeEmbree(const Bench* b)
{
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene = rtcNewScene(device);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const vplGeometry* g = b->geometry;
    float* vertices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                              3 * sizeof(float), (size_t)g->vertexCount);
    uint32_t* indices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                3 * sizeof(uint32_t), (size_t)g->triangleCount);
    memcpy(vertices, g->positions, (size_t)g->vertexCount * sizeof *g->positions);
    for (int i = 0; i < g->triangleCount; i++) {
        for (int k = 0; k < 3; k++) {
            indices[3 * i + k] = g->indices[3 * i + k] + (uint32_t)g->objects[g->owners[i]].firstVertex;
        }
    }
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(scene);
    return scene;
}

static double traceEmbree(const Bench* b, RTCScene scene, bool shadow, int rays)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    double hits = 0;
    for (int i = 0; i < rays; i++) {
        const vplRay* r = &b->rays[i];
        struct RTCRayHit q;
        q.ray = (struct RTCRay){.org_x = r->origin.x,
                                .org_y = r->origin.y,
                                .org_z = r->origin.z,
                                .dir_x = r->direction.x,
                                .dir_y = r->direction.y,
                                .dir_z = r->direction.z,
                                .tnear = 1e-5f,
                                .tfar = shadow ? 1 : INFINITY,
                                .mask = ~0u};
        q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        if (shadow) {
            rtcOccluded1(scene, &context, &q.ray);
            hits += q.ray.tfar < 0;
        } else {
            rtcIntersect1(scene, &context, &q);
            hits += q.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        }
    }
    return hits;
}
#endif

static void measure(Bench* b, const vplScene* scene, int runs)
{
    static const char* const kinds[] = {"coherent", "diffuse", "shadow"};
    printf("%-10s %10s %10s %10s   %s\n", "rays", "tree M/s", "all M/s", "Embree M/s",
           "tree / Embree (hits)");
#ifdef HAVE_EMBREE
    RTCScene embree = makeEmbree(b);
#endif
    for (int kind = 0; kind < 3; kind++) {
        makeCameraRays(b, scene);
        if (kind > 0) {
            followRays(b, kind == 2);
        }
        double speed[3][32] = {{0}}, hits[3] = {0};
        const int few = b->all->blockCount <= 1024 ? b->rayCount / (1 + b->all->blockCount / 64) : 0;
        for (int run = 0; run < runs; run++) {
            double start = vplCpuMs();
            hits[0] = traceAll(b, b->tree, kind == 2, b->rayCount);
            speed[0][run] = b->rayCount / (vplCpuMs() - start) / 1e3;
            start = vplCpuMs();
            traceAll(b, b->all, kind == 2, few);
            speed[1][run] = few / (vplCpuMs() - start) / 1e3;
#ifdef HAVE_EMBREE
            start = vplCpuMs();
            hits[2] = traceEmbree(b, embree, kind == 2, b->rayCount);
            speed[2][run] = b->rayCount / (vplCpuMs() - start) / 1e3;
#endif
        }
        double tree = median(speed[0], runs), peer = median(speed[2], runs);
        printf("%-10s %10.2f %10.2f %10.2f   %.2f (%.0f, %.0f)\n", kinds[kind], tree, median(speed[1], runs),
               peer, peer > 0 ? tree / peer : 0, hits[0], hits[2]);
    }
}

// ---- agreement

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

// Ray i: anywhere in the bounds; from one edge to another; along an edge; in the plane of a triangle; along an
// axis from a corner.
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
    case 4: // at an edge, from anywhere
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
    const Bench* bench;
    int64_t count;
    int64_t *hits, *wrong; // per chunk
} Agreement;

// The closest of all triangles for each of CHUNK rays. Blocks in groups that stay in cache, rays inside.
static void testAll(const Bench* b, const vplRay* rays, int count, vplRawHit* truth)
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
    const Bench* b = a->bench;
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
        // Up to the hit nothing may be, and just beyond it something must.
        const bool found = truth[i].triangle >= 0,
                   any = b->any(b->tree, &rays[i], nextafterf(truth[i].t, INFINITY)),
                   before = b->any(b->tree, &rays[i], truth[i].t);
        a->hits[chunk] += found;
        a->wrong[chunk] += memcmp(&hit, &truth[i], sizeof hit) != 0 || any != found || (found && before);
    }
}

static int agree(const Bench* b, int64_t count)
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
    int64_t count = 0;
    int runs = 5;
    for (int i = 2; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "--agree") == 0) {
            count = atoll(argv[i + 1]);
        } else if (strcmp(argv[i], "--runs") == 0) {
            runs = atoi(argv[i + 1]);
        }
    }
    Bench b = {0};
    vplContextDef def = vplDefaultContextDef();
    def.log = say;
    check(vplContext_Create(&def, &b.context));
    vplScene* scene;
    check(vplScene_Load(b.context, argc > 1 ? argv[1] : "examples/scenes/room.json", &scene));
    check(vplGeometry_Create(scene, &b.geometry));
    double start = vplCpuMs();
    check(vplBvh_Create(b.geometry, 0, &b.tree));
    printf("%d triangles, tree built in %.1f ms: %d nodes, %d blocks\n", b.geometry->triangleCount,
           vplCpuMs() - start, b.tree->nodeCount, b.tree->blockCount);
    check(vplBvh_Create(b.geometry, 1 << 30, &b.all));
    b.closest = vplGetTraceClosest(vplContext_GetIsa(b.context));
    b.any = vplGetTraceAny(vplContext_GetIsa(b.context));
    b.rays = malloc(MOST_RAYS * sizeof *b.rays);
    int code = 0;
    if (count > 0) {
        code = agree(&b, count);
    } else {
        measure(&b, scene, runs < 32 ? runs : 32);
    }
    free(b.rays);
    vplBvh_Destroy(b.context, b.tree);
    vplBvh_Destroy(b.context, b.all);
    vplGeometry_Destroy(b.geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(b.context);
    return code;
}
