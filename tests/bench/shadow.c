// SPDX-License-Identifier: MIT
// Compares soft shadows with and without the cube map's bounds, at all points that a camera sees and that
// face the scene's first point light: `bench/shadow SCENE [WIDTH HEIGHT [SAMPLES]]`. Both must give the same
// bits; if not, the program fails. It uses one thread and alternated runs, and prints medians of processor
// time.
#include "bench.h"

#include "visibility/blocks.h"
#include "visibility/cube_bounds.h"
#include "visibility/kernels.h"

#include <vpl/stages.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RUNS = 11 };

// Fills a block of 4 x 4 pixels; returns false if nothing in it faces the light. Lanes that see no surface
// get position 0.
static bool findBlock(const vplGeometry* g, const vplView* view, vplVec3 light, int x, int y, vplSurface* s)
{
    bool faces = false;
    memset(s, 0, sizeof *s);
    for (int l = 0; l < VPL_LANES; l++) {
        vplRay ray = {view->eye, rayThrough(view, x + (l & 3), y + (l >> 2)), {0, 0}};
        vplHit hit;
        if (vplGeometry_ClosestHit(g, &ray, &hit)) {
            vplVec3 p = hit.position, n = hit.normal;
            s->px[l] = p.x, s->py[l] = p.y, s->pz[l] = p.z;
            s->nx[l] = n.x, s->ny[l] = n.y, s->nz[l] = n.z;
            faces |= (light.x - p.x) * n.x + (light.y - p.y) * n.y + (light.z - p.z) * n.z > 0;
        }
    }
    return faces;
}

typedef struct Counts {
    int64_t told, blocksTold, same, blocksSame; // decided by bounds without samples; all samples agree
} Counts;

// The two compared ways: without bounds, and with them.
typedef struct Factors {
    const vplShadow* shadows[2];
    float* out[2];
    const vplSurface* blocks;
    int count;
} Factors;

static vplResult findFactors(void* user, int way)
{
    const Factors* f = user;
    for (int i = 0; i < f->count; i++) {
        vplShadow_FactorBlock(f->shadows[way], &f->blocks[i], f->out[way] + (size_t)i * VPL_LANES);
    }
    return VPL_SUCCESS;
}

static vplResult findBounds(void* map, int way)
{
    (void)way;
    return vplCubeMap_FindBounds(map);
}

static void count(const vplShadow* shadow, const vplSurface* blocks, int blockCount, Counts* c)
{
    for (int i = 0; i < blockCount; i++) {
        float factor[VPL_LANES];
        const vplVisibilityKernels* kernels = vplVisibilityKernels_Get(shadow->map->context->isa);
        int told = kernels->shadowFactor(shadow, &blocks[i], factor), same = 0;
        for (int l = 0; l < VPL_LANES; l++) {
            same += factor[l] == 0 || factor[l] == 1;
        }
        c->told += told;
        c->blocksTold += told == VPL_LANES;
        c->same += same;
        c->blocksSame += same == VPL_LANES;
    }
}

static void measure(const vplShadow* shadow, const vplSurface* blocks, int blockCount)
{
    vplCubeMap bare = *shadow->map;
    vplShadow without = *shadow;
    bare.bounds = NULL;
    without.map = &bare;
    const size_t lanes = (size_t)blockCount * VPL_LANES;
    float *a = calloc(lanes, sizeof *a), *b = calloc(lanes, sizeof *b);
    Times times[2];
    Factors factors = {{&without, shadow}, {a, b}, blocks, blockCount};
    const Measurement measurement = {findFactors, &factors, 2, RUNS, 0, 0};
    check(measureInTurn(&measurement, times, NULL));
    if (memcmp(a, b, lanes * sizeof *a) != 0) {
        fprintf(stderr, "the bounds changed a shadow\n");
        exit(1);
    }
    Counts c = {0};
    count(shadow, blocks, blockCount, &c);
    const double old = times[0].cpu, new = times[1].cpu;
    printf("all samples, ms %30.2f\nbounds first, ms %29.2f\nratio %40.2f\n", old, new, old / new);
    printf("told without samples: %.1f %% of points, %.1f %% of blocks\n",
           100.0 * (double)c.told / (double)lanes, 100.0 * (double)c.blocksTold / blockCount);
    printf("all samples alike:    %.1f %% of points, %.1f %% of blocks\n",
           100.0 * (double)c.same / (double)lanes, 100.0 * (double)c.blocksSame / blockCount);
    free(a);
    free(b);
}

static void measureBounds(vplCubeMap* map)
{
    Times times;
    const Measurement measurement = {findBounds, map, 1, RUNS, 0, 0};
    check(measureInTurn(&measurement, &times, NULL));
    printf("bounds of 6 x %d^2 texels, ms %16.2f\n", map->size, times.cpu);
}

int main(int argc, char** argv)
{
    vplContextDef contextDef = vplDefaultContextDef();
    contextDef.workerCount = 1;
    vplContext* context;
    vplScene* scene;
    vplGeometry* g;
    check(vplContext_Create(&contextDef, &context));
    check(vplScene_Load(context, argc > 1 ? argv[1] : "examples/scenes/room.json", &scene));
    check(vplGeometry_Create(scene, &g));
    const int width = argc > 3 ? atoi(argv[2]) : 1920, height = argc > 3 ? atoi(argv[3]) : 1080;
    const vplView view = vplView_Create(vplScene_GetCamera(scene, 0), width, height);
    vplCubeMapDef mapDef = vplDefaultCubeMapDef();
    mapDef.position = vplScene_GetEmitter(scene, 0)->position;
    vplSurface* blocks = malloc((size_t)((width + 3) / 4) * (size_t)((height + 3) / 4) * sizeof *blocks);
    int blockCount = 0;
    for (int y = 0; y < height; y += 4) {
        for (int x = 0; x < width; x += 4) {
            blockCount += findBlock(g, &view, mapDef.position, x, y, &blocks[blockCount]);
        }
    }
    printf("%d blocks\n", blockCount);
    vplCubeMap* map;
    double start = cpuMs();
    check(vplCubeMap_Create(g, &mapDef, NULL, NULL, &map));
    printf("cube map, ms %33.2f\n", cpuMs() - start);
    measureBounds(map);
    vplShadowDef shadowDef = vplDefaultShadowDef();
    shadowDef.pcfSamples = argc > 4 ? atoi(argv[4]) : shadowDef.pcfSamples;
    vplShadow shadow;
    check(vplShadow_Create(map, &shadowDef, &shadow));
    measure(&shadow, blocks, blockCount);
    free(blocks);
    vplCubeMap_Destroy(map);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
