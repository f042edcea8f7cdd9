// SPDX-License-Identifier: MIT
// Paraboloid maps: build/bench/paraboloid [--quick] [--agree] [--two] SCENE...: measures the cost of drawing
// 1 to 32 maps (wall-clock and processor time, medians), of one hemisphere at points on surfaces and of both
// at points in mid-air; the cost of a look-up of 16 visible points; and the agreement of look-ups and rays.
#include "band.h"
#include "bench.h"

#include "visibility/blocks.h"

#include <string.h>

enum { MOST = 32, RUNS = 7, POINTS_X = 320, POINTS_Y = 180, POINTS = POINTS_X * POINTS_Y, RAYS_OF = 16 };

typedef struct Bench {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplParaboloidPlace places[2][MOST]; // [0]: on surfaces; [1]: in mid-air, between two surface points
    vplSurface* blocks;
    vplHit* hits;
    int pointCount;
} Bench;

static void makePlaces(Bench* b)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = 16 * MOST;
    def.sampler = VPL_SAMPLER_HALTON;
    vplLightSet* set;
    const int emitters = vplScene_GetEmitterCount(b->scene);
    check(vplSimulateParticles(b->geometry, emitters ? vplScene_GetEmitter(b->scene, 0) : NULL, emitters,
                               &def, &set));
    for (int i = 0; i < MOST; i++) {
        const vplVirtualLight* l = &set->lights[i * 619 % set->lightCount];
        const vplVirtualLight* other = &set->lights[(i * 619 + 1) % set->lightCount];
        b->places[0][i] = (vplParaboloidPlace){l->position, l->normal, 1, true};
        b->places[1][i] =
            (vplParaboloidPlace){vplScale(0.5f, vplAdd(l->position, other->position)), l->normal, 2, false};
    }
    vplLightSet_Destroy(set);
}

// Makes visible points in blocks of 4 x 4 pixels.
static void makePoints(Bench* b)
{
    const vplView view = vplView_Create(vplScene_GetCamera(b->scene, 0), POINTS_X, POINTS_Y);
    b->blocks = calloc(POINTS / VPL_LANES, sizeof *b->blocks);
    b->hits = calloc(POINTS, sizeof *b->hits);
    b->pointCount = 0;
    for (int i = 0; i < POINTS; i++) {
        const int block = i / VPL_LANES, l = i % VPL_LANES, across = POINTS_X / 4;
        const int x = block % across * 4 + l % 4, y = block / across * 4 + l / 4;
        const vplRay ray = {view.eye, rayThrough(&view, x, y), {0, 0}};
        vplHit* hit = &b->hits[i];
        if (!vplGeometry_ClosestHit(b->geometry, &ray, hit)) {
            hit->triangle = -1;
            continue;
        }
        hit->normal = vplDot(hit->normal, ray.direction) < 0 ? hit->normal : vplNegate(hit->normal);
        vplSurface* s = &b->blocks[block];
        s->px[l] = hit->position.x;
        s->py[l] = hit->position.y;
        s->pz[l] = hit->position.z;
        s->nx[l] = hit->normal.x;
        s->ny[l] = hit->normal.y;
        s->nz[l] = hit->normal.z;
    }
}

// ---- drawing

typedef struct Drawing {
    const Bench* bench;
    vplParaboloidMaps* maps;
    int air, count;
} Drawing;

static vplResult draw(void* user, int way)
{
    const Drawing* d = user;
    (void)way;
    return vplParaboloidMaps_Draw(d->maps, d->bench->geometry, d->bench->places[d->air], d->count, NULL,
                                  NULL);
}

static void timeDrawing(const Bench* b, const char* name, int size, int air, bool triangles)
{
    printf("%-18s %4d %-8s %-9s", name, size, air ? "mid-air" : "surface", triangles ? "triangles" : "-");
    for (int count = 1; count <= MOST; count *= count == 1 ? 4 : 2) {
        Drawing drawing = {b, NULL, air, count};
        const Measurement measurement = {draw, &drawing, 1, RUNS, 0, INFINITY};
        Times times;
        check(vplParaboloidMaps_Create(b->context, size, count, triangles, &drawing.maps));
        check(measureInTurn(&measurement, &times, NULL));
        printf("  %2d: %6.2f (%6.2f)", count, times.wall, times.cpu);
        vplParaboloidMaps_Destroy(drawing.maps);
    }
    printf("\n");
    fflush(stdout);
}

// ---- look-ups

static void timeLooking(const Bench* b, const char* name, const vplParaboloidMaps* maps)
{
    double ns[RUNS];
    float sum = 0;
    for (int run = 0; run < RUNS; run++) {
        const double start = cpuMs();
        for (int m = 0; m < maps->count; m++) {
            for (int i = 0; i < POINTS / VPL_LANES; i++) {
                float factor[VPL_LANES];
                vplParaboloidMap_FactorBlock(&maps->maps[m], &b->blocks[i], factor);
                sum += factor[run];
            }
        }
        ns[run] = (cpuMs() - start) * 1e6 / (double)maps->count / (POINTS / VPL_LANES);
    }
    printf("%-18s %4d: %.1f ns per 16 look-ups (%g)\n", name, maps->size, medianOf(ns, RUNS), (double)sum);
}

// Returns whether a ray between the two points is blocked; surfaces at the ends do not block it.
static bool isBlocked(const vplGeometry* g, const vplHit* hit, vplVec3 to)
{
    const vplRay ray = vplGeometry_Leave(g, hit, vplSub(to, hit->position));
    return vplGeometry_IsOccluded(g, &ray, 1 - 0x1p-14f);
}

static void compareWithRays(const Bench* b, const char* name, const vplParaboloidMaps* maps, const char* kind)
{
    int64_t pairs = 0, acne = 0, leaks = 0, outside = 0;
    double difference = 0;
    for (int m = 0; m < maps->count; m++) {
        const vplParaboloidMap* map = &maps->maps[m];
        for (int i = m; i < POINTS; i += RAYS_OF) {
            const vplHit* hit = &b->hits[i];
            const vplVec3 way = hit->triangle < 0 ? vplVec(0, 0, 0) : vplSub(map->position, hit->position);
            const float rim = map->hemispheres == 2 ? -1 : 4 * 1.41421356f / (float)map->size;
            if (!(vplDot(way, hit->normal) > 0 && -vplDot(way, map->forward) > rim * vplLength(way))) {
                continue; // unlit, or within a texel of the map's rim
            }
            float factor[VPL_LANES];
            vplParaboloidMap_FactorBlock(map, &b->blocks[i / VPL_LANES], factor);
            const bool dark = isBlocked(b->geometry, hit, map->position);
            const float map16 = factor[i % VPL_LANES];
            pairs++;
            difference += (double)fabsf(map16 - (float)dark);
            if (dark != (map16 > 0.5f)) {
                acne += !dark;
                leaks += dark;
                outside += isSureParaboloid(b->geometry, map, hit->position, hit->normal, dark);
            }
        }
    }
    const double share = 100.0 / (double)(pairs > 0 ? pairs : 1);
    printf(
        "%-18s %4d %-8s %8lld pairs, dark in the map only %.3f %%, in the ray only %.3f %%, mean difference "
        "%.3f %%, outside the band %.4f %%\n",
        name, maps->size, kind, (long long)pairs, (double)acne * share, (double)leaks * share,
        difference * share, (double)outside * share);
}

static void benchScene(Bench* b, const char* path, bool quick, bool draw, int workers)
{
    const char* slash = strrchr(path, '/');
    const char* name = slash ? slash + 1 : path;
    openScene(path, workers, VPL_ISA_AUTO, &b->context, &b->scene);
    check(vplGeometry_Create(b->scene, &b->geometry));
    makePlaces(b);
    makePoints(b);
    for (int size = 128; size <= (quick ? 256 : 512); size *= 2) {
        if (draw) {
            timeDrawing(b, name, size, 0, false);
            timeDrawing(b, name, size, 0, true);
            timeDrawing(b, name, size, 1, true);
        }
        for (int air = 0; air < 2; air++) {
            vplParaboloidMaps* maps;
            check(vplParaboloidMaps_Create(b->context, size, MOST, false, &maps));
            check(vplParaboloidMaps_Draw(maps, b->geometry, b->places[air], MOST, NULL, NULL));
            if (air == 0) {
                timeLooking(b, name, maps);
            }
            compareWithRays(b, name, maps, air ? "mid-air" : "surface");
            vplParaboloidMaps_Destroy(maps);
        }
    }
    free(b->blocks);
    free(b->hits);
    vplGeometry_Destroy(b->geometry);
    vplScene_Destroy(b->scene);
    vplContext_Destroy(b->context);
}

int main(int argc, char** argv)
{
    static Bench b;
    bool quick = false, draw = true;
    int workers = 1; // idle workers spin, and other programs' load turns that into milliseconds
    printf("scene, texels a side, places, kept; for counts of maps: ms wall (processor)\n");
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--quick") == 0) {
            quick = true;
        } else if (strcmp(argv[i], "--agree") == 0) {
            draw = false;
        } else if (strcmp(argv[i], "--two") == 0) {
            workers = 2;
        } else {
            benchScene(&b, argv[i], quick, draw, workers);
        }
    }
    return 0;
}
