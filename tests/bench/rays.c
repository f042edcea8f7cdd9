// SPDX-License-Identifier: MIT
// Measures ray throughput: bench/rays SCENE [--runs N] [--isa NAME] [--all] [--only KIND]
// The program prints millions of rays per second of processor time on one thread, medians of alternated runs,
// and the share of Intel Embree's rate (robust scene, built at high quality) if Embree was found at build
// time. The quick tree is the one for renders with little time. The last lines compare the time to build both with Embree's at medium quality, on
// one thread and on all.
// --all: also traces without a BVH. --only: traces only the rays of this number in the table, and skips the
// build times.
#include "bench.h"
#include "embree.h"
#include "math/sampling.h"

#include <math.h>
#include <string.h>

enum { SIDE = 512, MOST_RAYS = SIDE * SIDE, MOST_RUNS = 63 };

typedef enum Kind { COHERENT, DIFFUSE, RANDOM, RANDOM_ANY, SHADOW, SHADOW_16, KIND_COUNT } Kind;

static const char* const KINDS[KIND_COUNT] = {"coherent",   "diffuse", "random closest",
                                              "random any", "shadow",  "shadow, 16 at once"};

typedef struct Bench {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplBvh *tree, *quick, *all;
    vplRay* rays;
    int rayCount;
} Bench;

static float unit(int index, uint32_t stream, int word)
{
    return vplUnitFloat(vplRandomAt(1, stream, (uint64_t)index).v[word]);
}

// ---- rays to measure

// Makes camera rays in blocks of 4 x 4 pixels, the order in which shading traces them.
static void makeCameraRays(Bench* b)
{
    const vplView v = vplView_Create(vplScene_GetCamera(b->scene, 0), SIDE, SIDE);
    for (int i = 0; i < MOST_RAYS; i++) {
        const int block = i / 16, x = block % (SIDE / 4) * 4 + i % 4, y = block / (SIDE / 4) * 4 + i % 16 / 4;
        float sx = (float)((2 * (x + 0.5) / SIDE - 1) / v.scaleX);
        float sy = (float)((1 - 2 * (y + 0.5) / SIDE) / v.scaleY);
        vplVec3 d = vplAdd(v.forward, vplAdd(vplScale(sx, v.right), vplScale(sy, v.up)));
        b->rays[i] = (vplRay){vplAdd(v.eye, vplScale((float)v.nearPlane, d)), d, {0, 0}};
    }
    b->rayCount = MOST_RAYS;
}

// Replaces each camera ray by the secondary ray from its hit.
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
        vplVec3 d =
            shadow ? vplSub(light, hit.position) : vplSampleCosineAround(n, unit(i, 0, 0), unit(i, 0, 1));
        b->rays[count++] = vplGeometry_Leave(b->geometry, &hit, d);
    }
    b->rayCount = count;
}

// Makes rays between random pairs of points in the bounds.
static void makeRandomRays(Bench* b)
{
    const vplVec3 low = b->geometry->boundsMin, size = vplSub(b->geometry->boundsMax, low);
    for (int i = 0; i < MOST_RAYS; i++) {
        vplVec3 ends[2];
        for (uint32_t k = 0; k < 2; k++) {
            ends[k] = vplVec(low.x + unit(i, k, 0) * size.x, low.y + unit(i, k, 1) * size.y,
                             low.z + unit(i, k, 2) * size.z);
        }
        b->rays[i] = (vplRay){ends[0], vplSub(ends[1], ends[0]), {0, 0}};
    }
    b->rayCount = MOST_RAYS;
}

static void makeRays(Bench* b, Kind kind)
{
    if (kind == RANDOM || kind == RANDOM_ANY) {
        makeRandomRays(b);
    } else {
        makeCameraRays(b);
        if (kind != COHERENT) {
            followRays(b, kind != DIFFUSE);
        }
    }
}

// ---- engines; each returns the number of hits, so that nothing is optimised away and engines can be compared

static int traceAll(const Bench* b, const vplBvh* bvh, Kind kind, int count)
{
    const vplIsa isa = vplContext_GetIsa(b->context);
    int hits = 0;
    for (int i = 0; i < count && kind <= RANDOM; i++) {
        vplRawHit hit;
        vplGetRayKernels(isa)->closest(bvh, &b->rays[i], INFINITY, &hit);
        hits += hit.triangle >= 0;
    }
    for (int i = 0; i < count && (kind == RANDOM_ANY || kind == SHADOW); i++) {
        hits += vplGetRayKernels(isa)->any(bvh, &b->rays[i], 1);
    }
    for (int i = 0; i < count && kind == SHADOW_16; i += VPL_RAY_PACKET) {
        const int lanes = count - i < VPL_RAY_PACKET ? count - i : VPL_RAY_PACKET;
        vplRayPacket packet = {0};
        for (int lane = 0; lane < lanes; lane++) {
            vplRayPacket_Set(&packet, lane, &b->rays[i + lane]);
        }
        hits += __builtin_popcount(vplGetRayKernels(isa)->anyPacket(bvh, &packet, 1));
    }
    return hits;
}

// ---- measuring

#ifdef HAVE_EMBREE
static EmbreeWay wayOf(Kind kind)
{
    return (EmbreeWay){.any = kind >= RANDOM_ANY,
                       .packets = kind == SHADOW_16,
                       .coherent = kind == COHERENT || kind >= SHADOW};
}
#endif

static void measure(Bench* b, int runs, bool brute, int only)
{
#ifdef HAVE_EMBREE
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene embree = makeEmbree(device, b->geometry, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(embree);
#endif
    printf("%-20s %10s %10s %10s %10s   %s\n", "rays", "tree M/s", "quick M/s", "all M/s", "Embree M/s",
           "quick / tree, tree / Embree (hits)");
    for (Kind kind = 0; kind < KIND_COUNT; kind++) {
        if (only >= 0 && (int)kind != only) {
            continue;
        }
        makeRays(b, kind);
        double speed[4][MOST_RUNS] = {{0}};
        int hits[4] = {0};
        const int few = brute ? b->rayCount / (1 + b->all->blockCount / 64) : 0;
        for (int run = 0; run < runs; run++) {
            double start = cpuMs();
            hits[0] = traceAll(b, b->tree, kind, b->rayCount);
            speed[0][run] = b->rayCount / (cpuMs() - start) / 1e3;
            start = cpuMs();
            hits[1] = traceAll(b, b->all, kind, few);
            speed[1][run] = few / (cpuMs() - start) / 1e3;
            start = cpuMs();
            hits[3] = traceAll(b, b->quick, kind, b->rayCount);
            speed[3][run] = b->rayCount / (cpuMs() - start) / 1e3;
#ifdef HAVE_EMBREE
            start = cpuMs();
            hits[2] = traceEmbree(embree, b->rays, b->rayCount, wayOf(kind));
            speed[2][run] = b->rayCount / (cpuMs() - start) / 1e3;
#endif
        }
        double tree = medianOf(speed[0], runs), peer = medianOf(speed[2], runs);
        double quick = medianOf(speed[3], runs);
        printf("%-20s %10.2f %10.2f %10.2f %10.2f   %.2f, %.2f (%d, %d, %d)\n", KINDS[kind], tree, quick,
               medianOf(speed[1], runs), peer, quick / tree, peer > 0 ? tree / peer : 0, hits[0], hits[3],
               hits[2]);
    }
#ifdef HAVE_EMBREE
    rtcReleaseScene(embree);
    rtcReleaseDevice(device);
#endif
}

// Measures the build time: processor time for one thread, wall-clock time for several.
static void measureBuild(const char* path, int workers, int runs)
{
    Bench b = {0};
    double (*const now)(void) = workers == 1 ? cpuMs : wallMs;
    openScene(path, workers, VPL_ISA_AUTO, &b.context, &b.scene);
    check(vplGeometry_Create(b.scene, &b.geometry));
    double ms[3][MOST_RUNS] = {{0}};
#ifdef HAVE_EMBREE
    char config[64];
    snprintf(config, sizeof config, "threads=%d", vplContext_GetWorkerCount(b.context));
    RTCDevice device = rtcNewDevice(config);
#endif
    for (int run = 0; run < runs; run++) {
        double start = now();
        check(vplBvh_Create(b.geometry, 0, false, &b.tree));
        ms[0][run] = now() - start;
        vplBvh_Destroy(b.tree);
        start = now();
        check(vplBvh_Create(b.geometry, 0, true, &b.quick));
        ms[2][run] = now() - start;
        vplBvh_Destroy(b.quick);
#ifdef HAVE_EMBREE
        RTCScene embree = makeEmbree(device, b.geometry, RTC_BUILD_QUALITY_MEDIUM);
        start = now();
        rtcCommitScene(embree);
        ms[1][run] = now() - start;
        rtcReleaseScene(embree);
#endif
    }
#ifdef HAVE_EMBREE
    rtcReleaseDevice(device);
#endif
    double tree = medianOf(ms[0], runs), peer = medianOf(ms[1], runs);
    printf("build, %d threads: tree %.2f ms, quick %.2f ms, Embree %.2f ms, %.2f of its speed\n",
           vplContext_GetWorkerCount(b.context), tree, medianOf(ms[2], runs), peer, peer / tree);
    vplGeometry_Destroy(b.geometry);
    vplScene_Destroy(b.scene);
    vplContext_Destroy(b.context);
}

static vplIsa isaOf(const char* name)
{
    for (vplIsa isa = 0; isa < VPL_ISA_COUNT; isa++) {
        if (strcmp(name, vplIsa_GetName(isa)) == 0) {
            return isa;
        }
    }
    return VPL_ISA_AUTO;
}

int main(int argc, char** argv)
{
    int runs = 7, only = -1;
    bool brute = false;
    vplIsa isa = VPL_ISA_AUTO;
    for (int i = 2; i < argc; i++) {
        const char* value = i + 1 < argc ? argv[i + 1] : "";
        brute = brute || strcmp(argv[i], "--all") == 0;
        runs = strcmp(argv[i], "--runs") == 0 ? atoi(value) : runs;
        only = strcmp(argv[i], "--only") == 0 ? atoi(value) : only;
        isa = strcmp(argv[i], "--isa") == 0 ? isaOf(value) : isa;
    }
    runs = runs < 1 ? 1 : runs > MOST_RUNS ? MOST_RUNS : runs;
    Bench b = {0};
    const char* path = argc > 1 ? argv[1] : "examples/scenes/room.json";
    openScene(path, 0, isa, &b.context, &b.scene);
    check(vplGeometry_Create(b.scene, &b.geometry));
    check(vplBvh_Create(b.geometry, 0, false, &b.tree));
    check(vplBvh_Create(b.geometry, 0, true, &b.quick));
    check(vplBvh_Create(b.geometry, 1 << 30, false, &b.all));
    printf("%s, %s: %d triangles, %d nodes, %d blocks\n", path, vplIsa_GetName(vplContext_GetIsa(b.context)),
           b.geometry->triangleCount, b.tree->nodeCount, b.tree->blockCount);
    b.rays = malloc(MOST_RAYS * sizeof *b.rays);
    measure(&b, runs, brute, only);
    free(b.rays);
    vplBvh_Destroy(b.tree);
    vplBvh_Destroy(b.quick);
    vplBvh_Destroy(b.all);
    vplGeometry_Destroy(b.geometry);
    vplScene_Destroy(b.scene);
    vplContext_Destroy(b.context);
    if (only < 0) {
        measureBuild(path, 1, runs);
        measureBuild(path, 0, runs);
    }
    return 0;
}
