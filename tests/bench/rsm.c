// SPDX-License-Identifier: MIT
// Compares reflective shadow maps with rays: build/bench/rsm SCENE...: the cost of a map, the cost of a
// particle's first segment with the map and with rays, the number of particles from which the map pays, and
// the difference in the picture; then direct light of the first emitter at 1920x1080 with shadows by rays and
// by the map. Figures are medians of processor time.
#include "bench.h"
#include "rsm_band.h"

#include "lights/kernels.h"
#include "visibility/blocks.h"

#include <string.h>

enum { PARTICLES = 100000, RUNS = 5, SIDE = 96, SHOWN = 300, WIDTH = 1920, HEIGHT = 1080 };

typedef struct Bench {
    const vplScene* scene;
    const vplGeometry* geometry;
    const vplEmitterDef* emitters;
    int emitterCount;
} Bench;

// Draws maps of all emitters.
static void drawMaps(const Bench* b, int size, vplReflectiveMap** maps)
{
    for (int i = 0; i < b->emitterCount; i++) {
        vplReflectiveMapDef def = vplDefaultReflectiveMapDef();
        def.emitter = b->emitters[i];
        def.size = size;
        check(vplReflectiveMap_Create(b->geometry, &def, NULL, NULL, &maps[i]));
    }
}

static void destroyMaps(const Bench* b, vplReflectiveMap** maps)
{
    for (int i = 0; i < b->emitterCount; i++) {
        vplReflectiveMap_Destroy(maps[i]);
    }
}

// Returns the milliseconds of the particles' first segments only.
static double simulate(const Bench* b, vplReflectiveMap** maps)
{
    vplParticleDef def = vplDefaultParticleDef();
    vplLightSet* set;
    def.particleCount = PARTICLES;
    def.reflectivity = 0;
    def.maps = (const vplReflectiveMap* const*)maps;
    const double start = cpuMs();
    check(vplSimulateParticles(b->geometry, b->emitters, b->emitterCount, &def, &set));
    const double ms = cpuMs() - start;
    vplLightSet_Destroy(set);
    return ms;
}

// Renders indirect light without shadows; size 0: with rays instead of a map.
static vplImage* picture(const Bench* b, int size, uint64_t seed)
{
    vplRenderOptions o = plainOptions();
    vplImage* image;
    o.output.width = o.output.height = SIDE;
    o.particles.count = SHOWN;
    o.particles.sampler = VPL_SAMPLER_HALTON;
    o.seed = seed;
    o.output.show = VPL_SHOW_INDIRECT;
    o.lights.shadows = VPL_LIGHT_SHADOWS_NONE;
    o.particles.placement = size > 0 ? VPL_PLACEMENT_RSM : VPL_PLACEMENT_PARTICLES;
    o.shadow.rsmSize = size > 0 ? size : o.shadow.rsmSize;
    check(vplRender(b->scene, &o, &image, NULL));
    return image;
}

static double difference(vplImage* a, vplImage* b)
{
    vplComparison c;
    check(vplImage_Compare(a, b, &c));
    return c.relativeRmse;
}

static void measure(const Bench* b, const char* name)
{
    vplReflectiveMap** maps = calloc((size_t)b->emitterCount, sizeof *maps);
    double draws[RUNS], looks[RUNS], rays[RUNS];
    vplImage *cast = picture(b, 0, 1), *other = picture(b, 0, 2);
    printf("%s: %d triangles, %d emitters; pictures of two seeds differ by %.4f\n", name,
           b->geometry->triangleCount, b->emitterCount, difference(other, cast));
    printf("%6s %9s %12s %12s %10s %10s\n", "size", "map ms", "ray ns", "look-up ns", "pays at N",
           "difference");
    for (int size = 16; size <= 1024; size *= 4) {
        for (int run = 0; run < RUNS; run++) {
            const double start = cpuMs();
            drawMaps(b, size, maps);
            draws[run] = cpuMs() - start;
            looks[run] = simulate(b, maps);
            destroyMaps(b, maps);
            rays[run] = simulate(b, NULL);
        }
        const double map = medianOf(draws, RUNS), look = medianOf(looks, RUNS) / PARTICLES,
                     ray = medianOf(rays, RUNS) / PARTICLES;
        vplImage* moved = picture(b, size, 1);
        printf("%6d %9.2f %12.0f %12.0f %10.0f %10.4f\n", size, map, 1e6 * ray, 1e6 * look,
               ray > look ? map / (ray - look) : INFINITY, difference(moved, cast));
        vplImage_Destroy(moved);
    }
    vplImage_Destroy(cast);
    vplImage_Destroy(other);
    free(maps);
}

// ---- shadows

// Shades direct light of one emitter; map NULL: shadows by rays.
static double light(const Bench* b, const vplView* view, const vplReflectiveMap* map, vplImage* image)
{
    const vplShadow none = {0};
    vplShadeDef def = vplDefaultShadeDef();
    def.accumulation = VPL_ACCUMULATE_DEFERRED;
    def.emitters = b->emitters;
    def.emitterCount = 1;
    def.shadows = &none;
    def.emitterMaps = &map;
    const double start = cpuMs();
    check(vplShadeView(b->geometry, view, &def, image, NULL));
    return cpuMs() - start;
}

// Counts the shares of pixels that differ by more than 1 % and by more than half of the larger value.
static void countDifferent(const vplImage* a, const vplImage* b, double* someOut, double* muchOut)
{
    const size_t pixels = (size_t)a->width * (size_t)a->height;
    size_t some = 0, much = 0;
    for (size_t i = 0; i < pixels; i++) {
        const float x = a->pixels[3 * i], y = b->pixels[3 * i], larger = fmaxf(x, y);
        some += fabsf(x - y) > 0.01f * larger;
        much += fabsf(x - y) > 0.5f * larger;
    }
    *someOut = 100.0 * (double)some / (double)pixels;
    *muchOut = 100.0 * (double)much / (double)pixels;
}

// Finds the point that a pixel shows. Returns whether it faces the emitter, and in `dark` whether a ray finds
// it in shadow.
static bool seePoint(const Bench* b, const vplView* view, int x, int y, vplHit* hit, vplVec3* normal,
                     bool* dark)
{
    const vplEmitterDef* e = &b->emitters[0];
    const vplRay look = {view->eye, rayThrough(view, x, y), {0, 0}};
    if (!vplGeometry_ClosestHit(b->geometry, &look, hit)) {
        return false;
    }
    const bool parallel = e->type == VPL_EMITTER_DIRECTIONAL;
    const vplVec3 way = parallel ? vplNegate(e->direction) : vplSub(e->position, hit->position);
    const vplRay ray = vplGeometry_Leave(b->geometry, hit, way);
    *normal = vplDot(hit->normal, look.direction) > 0 ? vplNegate(hit->normal) : hit->normal;
    *dark = vplGeometry_IsOccluded(b->geometry, &ray, parallel ? INFINITY : 1);
    return vplDot(way, *normal) > 0 &&
           (e->type != VPL_EMITTER_SPOT ||
            vplSpot_Falloff(e, -(double)vplDot(vplNormalize(way), vplNormalize(e->direction))) > 0);
}

// Compares map and rays at every `STEP`-th pixel each way: counts where they disagree, and checks that they
// agree at all points where they must.
static void measureAgreement(const Bench* b, const vplView* view, const vplReflectiveMap* map)
{
    enum { STEP = 11 };
    int points = 0, sure = 0, mapOnly = 0, rayOnly = 0, wrong = 0;
    for (int i = 0; i < (WIDTH / STEP) * (HEIGHT / STEP); i++) {
        vplSurface s;
        vplHit hit;
        vplVec3 n;
        bool dark;
        float factor[VPL_LANES];
        if (!seePoint(b, view, i % (WIDTH / STEP) * STEP, i / (WIDTH / STEP) * STEP, &hit, &n, &dark)) {
            continue;
        }
        memset(&s, 0, sizeof s);
        s.px[0] = hit.position.x;
        s.py[0] = hit.position.y;
        s.pz[0] = hit.position.z;
        s.nx[0] = n.x;
        s.ny[0] = n.y;
        s.nz[0] = n.z;
        vplReflectiveMap_FactorBlock(map, &s, factor);
        const bool must = isSureReflective(b->geometry, map, hit.position, n, dark);
        points++;
        sure += must;
        mapOnly += factor[0] > 0.5f && !dark;
        rayOnly += factor[0] <= 0.5f && dark;
        wrong += must && factor[0] != (dark ? 1 : 0);
    }
    const double percent = 100.0 / (points > 0 ? points : 1);
    printf("%6d: dark in the map only %.3f%%, by the ray only %.3f%%; beyond the band %.1f%%, of these wrong "
           "%d of %d\n",
           map->size, percent * mapOnly, percent * rayOnly, percent * sure, wrong, sure);
}

static void measureShadows(Bench* b)
{
    const vplView view = vplView_Create(vplScene_GetCamera(b->scene, 0), WIDTH, HEIGHT);
    vplImage *byRays, *byMap;
    check(vplImage_Create(b->geometry->context, WIDTH, HEIGHT, &byRays));
    check(vplImage_Create(b->geometry->context, WIDTH, HEIGHT, &byMap));
    b->emitterCount = 1;
    printf("%6s %9s %12s %12s %10s %10s\n", "size", "map ms", "by rays ms", "by map ms", "> 1 % off",
           "> 50 % off");
    for (int size = 512; size <= 2048; size *= 2) {
        double draws[RUNS], rays[RUNS], looks[RUNS], some, much;
        for (int run = 0; run < RUNS; run++) {
            vplReflectiveMap* map;
            const double start = cpuMs();
            drawMaps(b, size, &map);
            draws[run] = cpuMs() - start;
            rays[run] = light(b, &view, NULL, byRays);
            looks[run] = light(b, &view, map, byMap);
            vplReflectiveMap_Destroy(map);
        }
        countDifferent(byRays, byMap, &some, &much);
        printf("%6d %9.2f %12.2f %12.2f %9.3f%% %9.3f%%\n", size, medianOf(draws, RUNS), medianOf(rays, RUNS),
               medianOf(looks, RUNS), some, much);
    }
    for (int size = 512; size <= 2048; size *= 2) {
        vplReflectiveMap* map;
        drawMaps(b, size, &map);
        measureAgreement(b, &view, map);
        vplReflectiveMap_Destroy(map);
    }
    vplImage_Destroy(byRays);
    vplImage_Destroy(byMap);
}

int main(int count, char** words)
{
    for (int i = 1; i < count; i++) {
        vplContext* context;
        vplScene* scene;
        vplGeometry* geometry;
        openScene(words[i], 1, VPL_ISA_AUTO, &context, &scene);
        check(vplGeometry_Create(scene, &geometry));
        Bench b = {scene, geometry, NULL, vplScene_GetEmitterCount(scene)};
        if (b.emitterCount > 0) {
            b.emitters = vplScene_GetEmitter(scene, 0);
            measure(&b, words[i]);
            measureShadows(&b);
        } else {
            printf("%s has no emitter that could have a map\n", words[i]);
        }
        vplGeometry_Destroy(geometry);
        vplScene_Destroy(scene);
        vplContext_Destroy(context);
    }
    return 0;
}
