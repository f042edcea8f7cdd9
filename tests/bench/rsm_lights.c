// SPDX-License-Identifier: MIT
// Where lights of reflective maps are of use: build/bench/rsm_lights SCENE...: 256 lights as sampled, and chosen of more
// by what they see or by what the camera's points get of them, with rays for shadows, against path tracing. Errors of
// indirect light of one bounce, tone-mapped as x / (1 + x); processor time of sampling and choosing, medians.
#include "bench.h"

#include "base/clock.h"
#include "shading/shading.h"

enum { COUNT = 256, WIDTH = 160, HEIGHT = 90, PATHS = 256, RUNS = 5, SHIFTS = 3, RAYS = 4, SIZE = 1024 };

typedef enum Choice { AS_SAMPLED, BY_OUTLOOK, BY_VIEW } Choice;

typedef struct Bench {
    const vplScene* scene;
    const vplGeometry* geometry;
    vplReflectiveMap* map;
    vplImage* truth;
} Bench;

static vplLightSet* makeLights(const Bench* b, Choice choice, int oversampling, uint64_t shift)
{
    vplRsmSampleDef def = vplDefaultRsmSampleDef();
    vplPlacementDef placement = vplDefaultPlacementDef();
    vplLightSet *set, *chosen;
    def.count = COUNT * oversampling;
    def.shift = shift;
    placement.camera = *vplScene_GetCamera(b->scene, 0);
    placement.width = WIDTH;
    placement.height = HEIGHT;
    placement.pointCount = 64;
    placement.shadows = false;
    placement.minDistance = 1;
    check(vplSampleReflectiveMaps(b->geometry, (const vplReflectiveMap* const*)&b->map, 1, &def, &set));
    if (choice == AS_SAMPLED) {
        return set;
    }
    float* worth = calloc((size_t)def.count, sizeof *worth);
    check(choice == BY_OUTLOOK ? vplMeasureOutlook(b->geometry, set, RAYS, NULL, NULL, worth)
                               : vplMeasureLights(b->geometry, set, &placement, worth, NULL));
    check(vplChooseLights(set, worth, COUNT, &placement, &chosen));
    free(worth);
    vplLightSet_Destroy(set);
    return chosen;
}

// Root of the mean square of tone-mapped differences.
static double errorOf(const Bench* b, const vplLightSet* set, float minDistance)
{
    const vplView view = vplView_Create(vplScene_GetCamera(b->scene, 0), WIDTH, HEIGHT);
    vplShadeLight* lights = calloc((size_t)set->lightCount + 1, sizeof *lights);
    const vplShadeDef def = {.accumulation = VPL_ACCUMULATE_DEFERRED,
                             .lights = lights,
                             .lightCount = vplPrepareLights(set, VPL_LIGHTING_PHYSICAL, lights),
                             .lightRays = true,
                             .minDistance = minDistance};
    vplImage* image;
    double squares = 0;
    check(vplImage_Create(b->geometry->context, WIDTH, HEIGHT, &image));
    check(vplShadeView(b->geometry, &view, &def, NULL, NULL, image, NULL));
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        const double x = (double)image->pixels[i], y = (double)b->truth->pixels[i];
        squares += (x / (1 + x) - y / (1 + y)) * (x / (1 + x) - y / (1 + y));
    }
    vplImage_Destroy(image);
    free(lights);
    return sqrt(squares / (3 * WIDTH * HEIGHT));
}

static void measure(const Bench* b, const char* name, Choice choice, int oversampling)
{
    static const float distances[] = {4, 2, 1, 0.5f, 0.25f, 0.125f};
    double times[RUNS], errors[6] = {0};
    for (int run = 0; run < RUNS; run++) {
        const double start = vplCpuMs();
        vplLightSet_Destroy(makeLights(b, choice, oversampling, 0));
        times[run] = vplCpuMs() - start;
    }
    int lights = 0;
    for (uint64_t shift = 0; shift < SHIFTS; shift++) {
        vplLightSet* set = makeLights(b, choice, oversampling, shift);
        lights += set->lightCount;
        for (int i = 0; i < 6; i++) {
            errors[i] += errorOf(b, set, distances[i]) / SHIFTS;
        }
        vplLightSet_Destroy(set);
    }
    printf("%-10s %6d %8.2f %8d ", name, COUNT * oversampling, median(times, RUNS), lights / SHIFTS);
    for (int i = 0; i < 6; i++) {
        printf(" %8.5f", errors[i]);
    }
    printf("\n");
}

static void measureScene(Bench* b, const char* path)
{
    vplReflectiveMapDef def = vplDefaultReflectiveMapDef();
    vplRenderOptions o = vplDefaultRenderOptions();
    def.emitter = *vplScene_GetEmitter(b->scene, 0);
    def.size = SIZE;
    check(vplReflectiveMap_Create(b->geometry, &def, NULL, NULL, &b->map));
    o.method = VPL_METHOD_PATH;
    o.show = VPL_SHOW_INDIRECT;
    o.pixel = VPL_PIXEL_CENTRE;
    o.width = WIDTH;
    o.height = HEIGHT;
    o.samplesPerPixel = PATHS;
    o.maxBounces = 1;
    check(vplRender(b->scene, &o, &b->truth, NULL));
    printf("%s: errors by the bound of the geometry term, metres\n", path);
    printf("%-10s %6s %8s %8s  %8s %8s %8s %8s %8s %8s\n", "lights", "of", "ms", "made", "4", "2", "1", "0.5",
           "0.25", "0.125");
    measure(b, "as sampled", AS_SAMPLED, 1);
    measure(b, "by outlook", BY_OUTLOOK, 8);
    measure(b, "by outlook", BY_OUTLOOK, 32);
    measure(b, "by view", BY_VIEW, 8);
    measure(b, "by view", BY_VIEW, 32);
    vplImage_Destroy(b->truth);
    vplReflectiveMap_Destroy(b->map);
}

int main(int count, char** words)
{
    for (int i = 1; i < count; i++) {
        vplContext* context;
        vplScene* scene;
        vplGeometry* geometry;
        openScene(words[i], 2, VPL_ISA_AUTO, &context, &scene);
        check(vplGeometry_Create(scene, &geometry));
        check(vplGeometry_PrepareRays(geometry));
        Bench b = {scene, geometry, NULL, NULL};
        if (vplScene_GetEmitterCount(scene) > 0) {
            measureScene(&b, words[i]);
        } else {
            printf("%s has no emitter that could have a map\n", words[i]);
        }
        vplGeometry_Destroy(geometry);
        vplScene_Destroy(scene);
        vplContext_Destroy(context);
    }
    return 0;
}
