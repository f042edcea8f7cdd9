// SPDX-License-Identifier: MIT
// Measures the gain of interleaved shading: processor and wall-clock time of a scene's indirect light,
// alternated with deferred shading of the same lights, the number of pixel-light pairs, and the error.
// `bench/interleaved SCENE [LIGHTS [RUNS [WIDTH HEIGHT]]]`; figures are medians; the shadow map and direct
// light are left out.
#include "bench.h"

enum { SIDES = 6 };
static const int sides[SIDES] = {1, 2, 3, 4, 8, 16}; // 1: deferred

typedef struct Bench {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplShadeLight* lights;
    int lightCount;
    vplImage* images[SIDES];
} Bench;

static void makeLights(Bench* b, int lights)
{
    vplParticleDef particles = vplDefaultParticleDef();
    vplLightSet* set;
    particles.particleCount = lights; // gives more lights than asked for, even if many particles escape
    particles.sampler = VPL_SAMPLER_HALTON;
    check(vplSimulateParticles(b->geometry, vplScene_GetEmitter(b->scene, 0),
                               vplScene_GetEmitterCount(b->scene), &particles, &set));
    if (set->lightCount < lights) {
        fprintf(stderr, "interleaved: %d particles left %d lights only\n", lights, set->lightCount);
        exit(1);
    }
    b->lights = malloc((size_t)set->lightCount * sizeof *b->lights);
    b->lightCount = lights;
    vplPrepareLights(set, VPL_LIGHTING_PHYSICAL, b->lights);
    vplLightSet_Destroy(set);
}

static vplResult shade(void* user, int way)
{
    const Bench* b = user;
    const vplImage* image = b->images[way];
    const vplView view = vplView_Create(vplScene_GetCamera(b->scene, 0), image->width, image->height);
    vplShadeDef def = vplDefaultShadeDef();
    def.minDistance = 0.2f;
    def.accumulation = sides[way] > 1 ? VPL_ACCUMULATE_INTERLEAVED : VPL_ACCUMULATE_DEFERRED;
    def.interleave = sides[way];
    def.lights = b->lights;
    def.lightCount = b->lightCount;
    return vplShadeView(b->geometry, &view, &def, b->images[way], NULL);
}

static void print(const Bench* b, const Times* times, int runs)
{
    printf("%d lights, %dx%d, medians of %d runs\n", b->lightCount, b->images[0]->width, b->images[0]->height,
           runs);
    printf("%3s %9s %7s %9s %7s %14s %9s %8s  %s\n", "K", "cpu ms", "ratio", "wall ms", "ratio",
           "Mpixel-lights", "rel. rmse", "energy", "hash");
    const double pixels = (double)b->images[0]->width * b->images[0]->height;
    for (int i = 0; i < SIDES; i++) {
        vplComparison m = {0};
        check(vplImage_Compare(b->images[i], b->images[0], &m));
        printf("%3d %9.2f %6.2fx %9.2f %6.2fx %14.1f %9.4f %8.5f  %016llx\n", sides[i], times[i].cpu,
               times[0].cpu / times[i].cpu, times[i].wall, times[0].wall / times[i].wall,
               pixels * b->lightCount / sides[i] / sides[i] * 1e-6, m.relativeRmse, m.energyRatio,
               (unsigned long long)vplImage_Hash(b->images[i]));
    }
}

int main(int count, char** words)
{
    Bench b = {0};
    Times times[SIDES];
    const int runs = count > 3 ? atoi(words[3]) : 9;
    openScene(count > 1 ? words[1] : "examples/scenes/room.json", 0, VPL_ISA_AUTO, &b.context, &b.scene);
    check(vplGeometry_Create(b.scene, &b.geometry));
    for (int i = 0; i < SIDES; i++) {
        check(vplImage_Create(b.context, count > 5 ? atoi(words[4]) : 1920, count > 5 ? atoi(words[5]) : 1080,
                              &b.images[i]));
    }
    makeLights(&b, count > 2 ? atoi(words[2]) : 512);
    const Measurement measurement = {shade, &b, SIDES, runs < 1 ? 1 : runs > MAX_RUNS ? MAX_RUNS : runs,
                                     0,     0};
    check(measureInTurn(&measurement, times, NULL));
    print(&b, times, measurement.runs);
    for (int i = 0; i < SIDES; i++) {
        vplImage_Destroy(b.images[i]);
    }
    free(b.lights);
    vplGeometry_Destroy(b.geometry);
    vplScene_Destroy(b.scene);
    vplContext_Destroy(b.context);
    return 0;
}
