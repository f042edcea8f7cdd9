// SPDX-License-Identifier: MIT
// What interleaved shading is worth: processor and wall-clock time of the indirect light of a scene, alternated with
// deferred shading of the same lights, pixels times lights, and the error it makes.
// `bench/interleaved SCENE [LIGHTS [RUNS [WIDTH HEIGHT]]]`; medians; the shadow map and direct light are left out.
#include "bench.h"

#include "base/clock.h"

#include <vpl/vpl.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { SIDES = 6, MAX_RUNS = 101 };
static const int sides[SIDES] = {1, 2, 3, 4, 8, 16}; // 1: deferred

typedef struct Bench {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplLightSet* set;
    vplShadeLight* lights;
    vplImage* images[SIDES];
    double cpu[SIDES][MAX_RUNS], wall[SIDES][MAX_RUNS];
} Bench;

static void printMessage(void* user, vplLogLevel level, const char* message)
{
    (void)user;
    if (level == VPL_LOG_ERROR) {
        fprintf(stderr, "interleaved: %s\n", message);
    }
}

static double processorMs(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static vplResult openBench(Bench* b, const char* path, int lights, int width, int height)
{
    vplContextDef def = vplDefaultContextDef();
    def.log = printMessage;
    vplResult result = vplContext_Create(&def, &b->context);
    if (result == VPL_SUCCESS) {
        result = vplScene_Load(b->context, path, &b->scene);
    }
    if (result == VPL_SUCCESS) {
        result = vplGeometry_Create(b->scene, &b->geometry);
    }
    for (int i = 0; i < SIDES && result == VPL_SUCCESS; i++) {
        result = vplImage_Create(b->context, width, height, &b->images[i]);
    }
    if (result == VPL_SUCCESS) {
        vplParticleDef particles = vplDefaultParticleDef();
        particles.particleCount = lights; // more lights than asked for come of it, also of few that escape
        particles.sampler = VPL_SAMPLER_HALTON;
        result = vplSimulateParticles(b->geometry, vplScene_GetEmitter(b->scene, 0),
                                      vplScene_GetEmitterCount(b->scene), &particles, &b->set);
    }
    if (result == VPL_SUCCESS && b->set->lightCount < lights) {
        fprintf(stderr, "interleaved: %d particles left %d lights only\n", lights, b->set->lightCount);
        return VPL_INVALID_ARGUMENT;
    }
    b->lights = result == VPL_SUCCESS ? malloc((size_t)b->set->lightCount * sizeof *b->lights) : NULL;
    if (b->lights == NULL) {
        return result == VPL_SUCCESS ? VPL_OUT_OF_MEMORY : result;
    }
    vplPrepareLights(b->set, VPL_LIGHTING_PHYSICAL, b->lights);
    return VPL_SUCCESS;
}

static void closeBench(Bench* b)
{
    free(b->lights);
    vplLightSet_Destroy(b->set);
    for (int i = 0; i < SIDES; i++) {
        vplImage_Destroy(b->images[i]);
    }
    vplGeometry_Destroy(b->geometry);
    vplScene_Destroy(b->scene);
    vplContext_Destroy(b->context);
}

static vplResult runOnce(Bench* b, int which, int lights, int run)
{
    const vplImage* image = b->images[which];
    const vplView view = vplView_Create(vplScene_GetCamera(b->scene, 0), image->width, image->height);
    vplShadeDef def = {.lighting = VPL_LIGHTING_PHYSICAL, .minDistance = 0.2f};
    def.accumulation = sides[which] > 1 ? VPL_ACCUMULATE_INTERLEAVED : VPL_ACCUMULATE_DEFERRED;
    def.interleave = sides[which];
    def.lights = b->lights;
    def.lightCount = lights;
    const double cpu = processorMs(), wall = vplClockMs();
    const vplResult result = vplShadeView(b->geometry, &view, &def, NULL, NULL, b->images[which], NULL);
    b->cpu[which][run] = processorMs() - cpu;
    b->wall[which][run] = vplClockMs() - wall;
    return result;
}

static void print(Bench* b, int lights, int runs)
{
    printf("%d lights, %dx%d, medians of %d runs\n", lights, b->images[0]->width, b->images[0]->height, runs);
    printf("%3s %9s %7s %9s %7s %14s %9s %8s  %s\n", "K", "cpu ms", "ratio", "wall ms", "ratio",
           "Mpixel-lights", "rel. rmse", "energy", "hash");
    const double pixels = (double)b->images[0]->width * b->images[0]->height;
    double cpu0 = 0, wall0 = 0;
    for (int i = 0; i < SIDES; i++) {
        const double cpu = median(b->cpu[i], runs), wall = median(b->wall[i], runs);
        cpu0 = i == 0 ? cpu : cpu0;
        wall0 = i == 0 ? wall : wall0;
        vplComparison m = {0};
        vplImage_Compare(b->images[i], b->images[0], &m);
        printf("%3d %9.2f %6.2fx %9.2f %6.2fx %14.1f %9.4f %8.5f  %016llx\n", sides[i], cpu, cpu0 / cpu, wall,
               wall0 / wall, pixels * lights / sides[i] / sides[i] * 1e-6, m.relativeRmse, m.energyRatio,
               (unsigned long long)vplImage_Hash(b->images[i]));
    }
}

int main(int count, char** words)
{
    static Bench b;
    const char* path = count > 1 ? words[1] : "examples/scenes/room.json";
    const int lights = count > 2 ? atoi(words[2]) : 512;
    int runs = count > 3 ? atoi(words[3]) : 9;
    runs = runs < 1 ? 1 : runs > MAX_RUNS ? MAX_RUNS : runs;
    vplResult result =
        openBench(&b, path, lights, count > 5 ? atoi(words[4]) : 1920, count > 5 ? atoi(words[5]) : 1080);
    for (int run = 0; run < runs && result == VPL_SUCCESS; run++) {
        for (int i = 0; i < SIDES && result == VPL_SUCCESS; i++) {
            result = runOnce(&b, i, lights, run);
        }
    }
    if (result == VPL_SUCCESS) {
        print(&b, lights, runs);
    }
    closeBench(&b);
    return result != VPL_SUCCESS;
}
