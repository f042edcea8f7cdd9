// SPDX-License-Identifier: MIT
// Compares shadows of virtual lights by maps and by rays: their cost and their agreement.
// `bench/crossover [--quick] [SCENE...]`: for each scene, picture size and number of lights the program
// measures the processor time of shading with rays, and of drawing and shading with maps of 64 and 128
// texels, alternated in one run. The column `none` is the time of the same lights without shadows. Rays that
// would take more than MOST_MS are not cast (-).
// The second part tests pairs of a visible point and a light: the share of pairs on which map and ray differ,
// and how much of that lies outside the band that vplHemiMap_FactorBlock states.
#include "band.h"
#include "bench.h"

#include "render/stages/shadow_choice.h"

#include <string.h>

enum { MOST_LIGHTS = 1024, RUNS = 3, MAP_SIZES = 3 };
static const int mapSizes[MAP_SIZES] = {64, 128, 256};
static const double MOST_MS = 4000;

typedef struct Bench {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplShadeLight lights[MOST_LIGHTS];
    int lightCount;
} Bench;

// Takes lights from all path lengths at equal strides.
static void makeLights(Bench* b)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = 4 * MOST_LIGHTS;
    def.sampler = VPL_SAMPLER_HALTON;
    vplLightSet* set;
    const int emitters = vplScene_GetEmitterCount(b->scene);
    check(vplSimulateParticles(b->geometry, emitters ? vplScene_GetEmitter(b->scene, 0) : NULL, emitters,
                               &def, &set));
    vplShadeLight* all = malloc((size_t)set->lightCount * sizeof *all);
    const int count = vplPrepareLights(set, VPL_LIGHTING_PHYSICAL, all);
    b->lightCount = count < MOST_LIGHTS ? count : MOST_LIGHTS;
    // The stride is odd, so that the first few lights, too, are spread over the scene.
    for (int i = 0; i < b->lightCount; i++) {
        b->lights[i] = all[(int64_t)i * 619 % b->lightCount * count / b->lightCount];
    }
    free(all);
    vplLightSet_Destroy(set);
}

static void placesOf(const Bench* b, int first, int count, vplHemiMapPlace* places)
{
    for (int i = 0; i < count; i++) {
        const vplShadeLight* l = &b->lights[first + i];
        places[i] = (vplHemiMapPlace){{l->px, l->py, l->pz}, {l->nx, l->ny, l->nz}};
    }
}

// ---- cost

// Times shading without shadows (maps NULL, no rays), with rays, or with maps.
static double shadeMs(const Bench* b, const vplView* view, vplImage* image, int first, int lights,
                      const vplHemiMaps* maps, bool rays)
{
    vplShadeDef def = vplDefaultShadeDef();
    def.minDistance = 0.2f;
    def.accumulation = VPL_ACCUMULATE_DEFERRED;
    def.lights = b->lights + first;
    def.lightCount = lights;
    def.lightRays = rays;
    def.lightShadows = maps ? maps->maps : NULL;
    const double start = cpuMs();
    check(vplShadeView(b->geometry, view, &def, image, NULL));
    return cpuMs() - start;
}

typedef struct Cell {
    double none, ray, draw[MAP_SIZES], look[MAP_SIZES];
} Cell;

// Draws maps and shades in batches that fit into map memory, as renders do.
static void measureMaps(const Bench* b, const vplView* view, vplImage* image, int lights, int size,
                        double* drawMs, double* lookMs)
{
    const int room = (int)(((size_t)plainOptions().lights.mapMemory << 20) / vplHemiMaps_BytesPerMap(size)),
              batch = room < lights ? room : lights;
    vplHemiMaps* maps;
    check(vplHemiMaps_Create(b->context, size, batch, &maps));
    *drawMs = *lookMs = 0;
    for (int first = 0; first < lights; first += batch) {
        const int count = lights - first < batch ? lights - first : batch;
        vplHemiMapPlace* places = malloc((size_t)count * sizeof *places);
        placesOf(b, first, count, places);
        const double start = cpuMs();
        check(vplHemiMaps_Draw(maps, b->geometry, places, count, NULL, NULL));
        *drawMs += cpuMs() - start;
        *lookMs += shadeMs(b, view, image, first, count, maps, false);
        free(places);
    }
    vplHemiMaps_Destroy(maps);
}

static Cell measure(const Bench* b, int width, int height, int lights, int runs)
{
    const vplView view = vplView_Create(vplScene_GetCamera(b->scene, 0), width, height);
    vplImage* image;
    check(vplImage_Create(b->context, width, height, &image));
    double none[RUNS], ray[RUNS], draw[MAP_SIZES][RUNS], look[MAP_SIZES][RUNS];
    bool casts = true;
    for (int run = 0; run < runs; run++) {
        none[run] = shadeMs(b, &view, image, 0, lights, NULL, false);
        if (run == 0 && lights > 16) {
            casts = shadeMs(b, &view, image, 0, 16, NULL, true) * lights / 16 * runs < MOST_MS;
        }
        ray[run] = casts ? shadeMs(b, &view, image, 0, lights, NULL, true) : INFINITY;
        for (int k = 0; k < MAP_SIZES; k++) {
            measureMaps(b, &view, image, lights, mapSizes[k], &draw[k][run], &look[k][run]);
        }
    }
    Cell cell = {.none = medianOf(none, runs), .ray = medianOf(ray, runs)};
    for (int k = 0; k < MAP_SIZES; k++) {
        cell.draw[k] = medianOf(draw[k], runs);
        cell.look[k] = medianOf(look[k], runs);
    }
    vplImage_Destroy(image);
    return cell;
}

// Prints one row. Ratios are the time of rays over that of maps. * marks rows in which the rule of
// choose_shadows.c picks the slower way.
static void printCell(const Cell* cell, vplShadowLoad load)
{
    printf(" %9.1f", cell->none);
    if (isinf(cell->ray)) {
        printf(" %9s", "-");
    } else {
        printf(" %9.1f", cell->ray);
    }
    for (int k = 0; k < MAP_SIZES; k++) {
        load.mapSize = mapSizes[k];
        const vplShadowCosts costs = vplEstimateShadows(&load);
        const double map = cell->draw[k] + cell->look[k];
        printf(" | %8.1f %8.1f %6.2f%c", cell->draw[k], cell->look[k], cell->ray / map,
               (costs.mapMs < costs.rayMs) == (map < cell->ray) ? ' ' : '*');
    }
    printf("\n");
    fflush(stdout);
}

static void printCosts(const Bench* b, const char* name, bool quick)
{
    static const int sizes[][2] = {{64, 64}, {128, 128}, {256, 256}, {640, 360}, {1280, 720}};
    static const int counts[] = {16, 64, 256, 1024};
    const vplView view = vplView_Create(vplScene_GetCamera(b->scene, 0), 640, 360);
    vplShadowLoad load = vplMeasureShadowLoad(b->geometry, &view, 1, b->lights, b->lightCount, 1);
    printf("%-16s %.0f triangles, %.0f above a light, %.3f of pixels and lights face each other\n", name,
           load.triangles, load.trianglesAbove, load.facing);
    for (int s = 0; s < (quick ? 4 : 5); s++) {
        for (int c = 0; c < (quick ? 2 : s < 3 ? 4 : 3) && counts[c] <= b->lightCount; c++) {
            const int width = sizes[s][0], height = sizes[s][1], lights = counts[c];
            const Cell cell = measure(b, width, height, lights, quick || lights > 64 ? 1 : RUNS);
            load.pixels = (double)width * height;
            load.lights = lights;
            printf("%-16s %4dx%-4d %5d", name, width, height, lights);
            printCell(&cell, load);
        }
    }
}

// ---- agreement

enum { POINTS_X = 80, POINTS_Y = 45, AGREEMENT_LIGHTS = 64 };

typedef struct Agreement {
    int64_t pairs, acne, leaks, outside, texelWrong;
} Agreement;

static void addPair(const Bench* b, const vplShadeLight* light, const vplHemiMap* map, const vplHit* hit,
                    vplVec3 normal, Agreement* a)
{
    vplSurface s;
    float factor[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        s.px[l] = hit->position.x;
        s.py[l] = hit->position.y;
        s.pz[l] = hit->position.z;
        s.nx[l] = normal.x;
        s.ny[l] = normal.y;
        s.nz[l] = normal.z;
    }
    const vplVec3 way = vplSub(map->position, hit->position);
    if (!(vplDot(way, normal) > 0 && vplDot(way, map->forward) < 0)) {
        return;
    }
    vplHemiMap_FactorBlock(map, &s, factor);
    const bool dark = isDark(b->geometry, hit, light), darkMap = factor[0] > 0;
    a->pairs++;
    if (dark != darkMap) {
        a->acne += darkMap;
        a->leaks += dark;
        a->outside += isSure(b->geometry, map, hit->position, normal, dark);
    }
}

static void printAgreement(const Bench* b, const char* name)
{
    const vplView view = vplView_Create(vplScene_GetCamera(b->scene, 0), POINTS_X, POINTS_Y);
    const int lights = b->lightCount < AGREEMENT_LIGHTS ? b->lightCount : AGREEMENT_LIGHTS;
    vplHemiMapPlace places[AGREEMENT_LIGHTS];
    placesOf(b, 0, lights, places);
    for (int k = 0; k < MAP_SIZES; k++) {
        Agreement a = {0};
        vplHemiMaps* maps;
        check(vplHemiMaps_Create(b->context, mapSizes[k], lights, &maps));
        check(vplHemiMaps_Draw(maps, b->geometry, places, lights, NULL, NULL));
        for (int i = 0; i < POINTS_X * POINTS_Y; i++) {
            const vplRay ray = {view.eye, rayThrough(&view, i % POINTS_X, i / POINTS_X), {0, 0}};
            vplHit hit;
            if (!vplGeometry_ClosestHit(b->geometry, &ray, &hit)) {
                continue;
            }
            const vplVec3 n = vplDot(hit.normal, ray.direction) < 0 ? hit.normal : vplNegate(hit.normal);
            for (int l = 0; l < lights; l++) {
                addPair(b, &b->lights[l], &maps->maps[l], &hit, n, &a);
            }
        }
        const double share = 100.0 / (double)(a.pairs > 0 ? a.pairs : 1);
        printf("%-16s map %4d: %8lld pairs, dark in the map only %.3f %%, in the ray only %.3f %%, outside "
               "the band "
               "%.4f %%\n",
               name, mapSizes[k], (long long)a.pairs, (double)a.acne * share, (double)a.leaks * share,
               (double)a.outside * share);
        vplHemiMaps_Destroy(maps);
    }
}

int main(int argc, char** argv)
{
    static Bench b;
    bool quick = false, costs = true;
    printf("%-16s %9s %5s %9s %9s", "scene", "size", "lights", "none", "ray");
    for (int k = 0; k < MAP_SIZES; k++) {
        printf(" | draw%4d   + shade ray/map", mapSizes[k]);
    }
    printf("\n");
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--quick") == 0) {
            quick = true;
            continue;
        }
        if (strcmp(argv[i], "--agree") == 0) {
            costs = false;
            continue;
        }
        const char* slash = strrchr(argv[i], '/');
        char name[17];
        snprintf(name, sizeof name, "%s", slash ? slash + 1 : argv[i]);
        openScene(argv[i], 1, VPL_ISA_AUTO, &b.context, &b.scene);
        check(vplGeometry_Create(b.scene, &b.geometry));
        makeLights(&b);
        if (costs) {
            printCosts(&b, name, quick);
        }
        printAgreement(&b, name);
        vplGeometry_Destroy(b.geometry);
        vplScene_Destroy(b.scene);
        vplContext_Destroy(b.context);
    }
    return 0;
}
