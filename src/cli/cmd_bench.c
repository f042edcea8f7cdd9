// SPDX-License-Identifier: MIT
// Times every stage on the benchmark room, which is built here so that the program needs no files. Each figure
// is a median; speed-ups compare medians of one run. Hashes show that all thread counts gave the same bits.
#include "cli/cli.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Bench {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplCubeMap* map;
    vplShadow shadow;
    vplLightSet* set;
    vplShadeLight* lights; // of all virtual lights
    vplView view;
    vplImage* image;
} Bench;

// What one run of a stage did.
typedef struct Outcome {
    double pixelLights; // pixels times lights, or 0
    int64_t drawCalls;
    uint64_t hash;
} Outcome;

typedef struct Stage {
    const char* name;
    vplResult (*run)(Bench* b, const struct Stage* stage, Outcome* outcome);
    vplLighting lighting;
    vplAccumulation accumulation;
    int lights, batch;
    bool direct;
} Stage;

static void addObject(vplScene* scene, vplObjectType type, int material, vplVec3 place, double turnX,
                      double turnY, vplVec3 size)
{
    vplObjectDef def = vplDefaultObjectDef();
    const double rotate[3] = {turnX * VPL_PI / 180, turnY * VPL_PI / 180, 0};
    def.type = type;
    def.material = material;
    def.transform = vplMat4_FromParts(place, rotate, size);
    vplScene_AddObject(scene, &def, NULL);
}

// The room of examples/scenes/room.json.
static vplResult buildRoom(vplContext* context, vplScene** sceneOut)
{
    static const vplRgb colours[3] = {{0.725f, 0.71f, 0.68f}, {0.63f, 0.065f, 0.05f}, {0.14f, 0.45f, 0.091f}};
    vplScene* s;
    vplResult result = vplScene_Create(context, &s);
    if (result != VPL_SUCCESS) {
        return result;
    }
    for (int i = 0; i < 3; i++) {
        vplMaterialDef material = vplDefaultMaterialDef();
        material.diffuse = colours[i];
        vplScene_AddMaterial(s, &material, NULL);
    }
    const vplVec3 wall = {5, 5, 1};
    addObject(s, VPL_OBJECT_QUAD, 0, (vplVec3){0, 0, 0}, -90, 0, wall);
    addObject(s, VPL_OBJECT_QUAD, 0, (vplVec3){0, 5, 0}, 90, 0, wall);
    addObject(s, VPL_OBJECT_QUAD, 0, (vplVec3){0, 2.5f, -2.5f}, 0, 0, wall);
    addObject(s, VPL_OBJECT_QUAD, 1, (vplVec3){-2.5f, 2.5f, 0}, 0, 90, wall);
    addObject(s, VPL_OBJECT_QUAD, 2, (vplVec3){2.5f, 2.5f, 0}, 0, -90, wall);
    addObject(s, VPL_OBJECT_BOX, 0, (vplVec3){-0.9f, 1.65f, -0.8f}, 0, 17, (vplVec3){1.5f, 3.3f, 1.5f});
    addObject(s, VPL_OBJECT_BOX, 0, (vplVec3){0.85f, 0.75f, 0.75f}, 0, -17, (vplVec3){1.5f, 1.5f, 1.5f});
    vplEmitterDef light = vplDefaultEmitterDef();
    light.position = (vplVec3){0, 4.5f, 0};
    light.intensity = (vplRgb){10, 10, 10};
    vplScene_AddEmitter(s, &light, NULL);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = (vplVec3){0, 2.5f, 8.5f};
    camera.target = (vplVec3){0, 2.5f, 0};
    camera.far = 50;
    vplScene_AddCamera(s, &camera, NULL);
    *sceneOut = s;
    return VPL_SUCCESS;
}

static vplResult runCubeMap(Bench* b, const Stage* stage, Outcome* outcome)
{
    (void)stage;
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.position = vplScene_GetEmitter(b->scene, 0)->position;
    vplCubeMap* map;
    vplResult result = vplCubeMap_Create(b->geometry, &def, NULL, NULL, &map);
    if (result == VPL_SUCCESS) {
        vplCubeMap_Destroy(b->map);
        b->map = map;
        outcome->drawCalls = map->stats.drawCalls;
        for (int i = 0; i < 6 * def.size * def.size; i += 997) {
            uint32_t bits;
            memcpy(&bits, &map->texels[i], sizeof bits);
            outcome->hash = (outcome->hash ^ bits) * 0x9E3779B97F4A7C15u;
        }
        vplShadowDef shadowDef = vplDefaultShadowDef();
        result = vplShadow_Create(map, &shadowDef, &b->shadow);
    }
    return result;
}

static vplResult runParticles(Bench* b, const Stage* stage, Outcome* outcome)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = stage->lights;
    def.sampler = VPL_SAMPLER_HALTON;
    vplLightSet* set;
    vplResult result = vplSimulateParticles(b->geometry, vplScene_GetEmitter(b->scene, 0), 1, &def, &set);
    if (result == VPL_SUCCESS) {
        vplLightSet_Destroy(b->set);
        b->set = set;
        outcome->hash = (uint64_t)set->lightCount << 32 | (uint64_t)set->escaped;
    }
    return result;
}

static vplResult runShading(Bench* b, const Stage* stage, Outcome* outcome)
{
    vplShadeDef def = {0};
    def.lighting = stage->lighting;
    def.accumulation = stage->accumulation;
    def.batch = stage->batch;
    def.minDistance = 0.2f;
    def.emitters = vplScene_GetEmitter(b->scene, 0);
    def.shadows = &b->shadow;
    def.emitterCount = stage->direct;
    def.particleCount = 10;
    def.lights = b->lights;
    def.lightCount = stage->lights;
    vplShadeStats stats;
    vplResult result = vplShadeView(b->geometry, &b->view, &def, NULL, NULL, b->image, &stats);
    outcome->drawCalls = stats.raster.drawCalls;
    outcome->pixelLights = (double)b->image->width * b->image->height * stage->lights;
    outcome->hash = vplImage_Hash(b->image);
    return result;
}

#define DOCUMENTED VPL_LIGHTING_DOCUMENTED
#define PHYSICAL   VPL_LIGHTING_PHYSICAL

// In this order: later stages use what earlier ones made.
static const Stage STAGES[] = {
    {"particles, N = 3000", runParticles, PHYSICAL, 0, 3000, 1, false},
    {"cube shadow map, 6 x 1024^2", runCubeMap, PHYSICAL, 0, 0, 1, false},
    {"G-buffer", runShading, PHYSICAL, VPL_ACCUMULATE_DEFERRED, 0, 1, false},
    {"direct light, 16 PCF samples", runShading, PHYSICAL, VPL_ACCUMULATE_DEFERRED, 0, 1, true},
    {"multipass, 18 lights, documented", runShading, DOCUMENTED, VPL_ACCUMULATE_MULTIPASS, 18, 1, false},
    {"batched, 18 lights, documented", runShading, DOCUMENTED, VPL_ACCUMULATE_BATCHED, 18, 18, false},
    {"deferred, 18 lights, documented", runShading, DOCUMENTED, VPL_ACCUMULATE_DEFERRED, 18, 1, false},
    {"multipass, 198 lights, documented", runShading, DOCUMENTED, VPL_ACCUMULATE_MULTIPASS, 198, 1, false},
    {"deferred, 198 lights, documented", runShading, DOCUMENTED, VPL_ACCUMULATE_DEFERRED, 198, 1, false},
    {"multipass, 198 lights, physical", runShading, PHYSICAL, VPL_ACCUMULATE_MULTIPASS, 198, 1, false},
    {"deferred, 198 lights, physical", runShading, PHYSICAL, VPL_ACCUMULATE_DEFERRED, 198, 1, false},
    {"deferred, 1998 lights, physical", runShading, PHYSICAL, VPL_ACCUMULATE_DEFERRED, 1998, 1, false},
};

enum { STAGE_COUNT = sizeof STAGES / sizeof *STAGES, MAX_RUNS = 1000 };

static int compareDoubles(const void* a, const void* b)
{
    double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

static void closeBench(Bench* b)
{
    if (b->context == NULL) {
        return; // it was refused
    }
    free(b->lights);
    vplImage_Destroy(b->image);
    vplCubeMap_Destroy(b->map);
    vplLightSet_Destroy(b->set);
    vplGeometry_Destroy(b->geometry);
    vplScene_Destroy(b->scene);
    vplContext_Destroy(b->context);
}

static vplResult openBench(const Arguments* a, int threads, Bench* b)
{
    Arguments copy = *a;
    copy.context.workerCount = threads;
    memset(b, 0, sizeof *b);
    b->context = openContext(&copy);
    if (b->context == NULL) {
        return VPL_INVALID_ARGUMENT;
    }
    vplResult result = buildRoom(b->context, &b->scene);
    if (result == VPL_SUCCESS) {
        result = vplGeometry_Create(b->scene, &b->geometry);
    }
    int width = a->sizeGiven ? a->render.width : 1920, height = a->sizeGiven ? a->render.height : 1080;
    if (result == VPL_SUCCESS) {
        result = vplImage_Create(b->context, width, height, &b->image);
    }
    if (result == VPL_SUCCESS) {
        b->view = vplView_Create(vplScene_GetCamera(b->scene, 0), width, height);
        Outcome outcome = {0};
        result = runParticles(b, &STAGES[0], &outcome);
    }
    if (result == VPL_SUCCESS) {
        b->lights = malloc((size_t)b->set->lightCount * sizeof *b->lights);
        result = b->lights ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    }
    if (result == VPL_SUCCESS) {
        vplPrepareLights(b->set, VPL_LIGHTING_PHYSICAL, b->lights);
    }
    return result;
}

typedef struct Figure {
    double ms[MAX_THREAD_COUNTS];
    Outcome outcome[MAX_THREAD_COUNTS];
} Figure;

// One stage under all thread counts, in turn, so that a machine that slows down slows all of them.
static vplResult measureStage(const Arguments* a, int stage, Bench* benches, int columns, Figure* figure)
{
    static double times[MAX_THREAD_COUNTS][MAX_RUNS];
    for (int run = -1; run < a->runs; run++) { // one to warm up
        for (int c = 0; c < columns; c++) {
            Outcome outcome = {0};
            double start = secondsNow();
            vplResult result = STAGES[stage].run(&benches[c], &STAGES[stage], &outcome);
            if (result != VPL_SUCCESS) {
                return result;
            }
            if (run >= 0) {
                times[c][run] = 1e3 * (secondsNow() - start);
                figure->outcome[c] = outcome;
            }
        }
    }
    for (int c = 0; c < columns; c++) {
        qsort(times[c], (size_t)a->runs, sizeof(double), compareDoubles);
        figure->ms[c] = times[c][a->runs / 2];
    }
    return VPL_SUCCESS;
}

static vplResult measureAll(const Arguments* a, const int* threads, int columns, Figure* figures)
{
    Bench benches[MAX_THREAD_COUNTS];
    vplResult result = VPL_SUCCESS;
    int opened = 0;
    for (; opened < columns && result == VPL_SUCCESS; opened++) {
        result = openBench(a, threads[opened], &benches[opened]);
    }
    for (int s = 0; s < STAGE_COUNT && result == VPL_SUCCESS; s++) {
        result = measureStage(a, s, benches, columns, &figures[s]);
    }
    for (int c = 0; c < opened; c++) {
        closeBench(&benches[c]);
    }
    return result;
}

static void printText(const Arguments* a, const Figure* figures, const int* threads, int columns)
{
    int width = a->sizeGiven ? a->render.width : 1920, height = a->sizeGiven ? a->render.height : 1080;
    printf("room at %dx%d, medians of %d runs, ms of wall-clock time\n", width, height, a->runs);
    printf("%-36s", "stage");
    for (int c = 0; c < columns; c++) {
        printf("%7d thr", threads[c]);
    }
    printf("%s  draw calls  Gpixel-lights/s  hash\n", columns > 1 ? "  speed-up" : "");
    for (int s = 0; s < STAGE_COUNT; s++) {
        const Figure* f = &figures[s];
        int last = columns - 1;
        bool same = true;
        printf("%-36s", STAGES[s].name);
        for (int c = 0; c < columns; c++) {
            printf("%11.2f", f->ms[c]);
            same = same && f->outcome[c].hash == f->outcome[0].hash;
        }
        if (columns > 1) {
            printf("%9.2fx", f->ms[0] / f->ms[last]);
        }
        printf("%12lld", (long long)f->outcome[0].drawCalls);
        if (f->outcome[0].pixelLights > 0) {
            printf("%17.3f", f->outcome[last].pixelLights / f->ms[last] * 1e-6);
        } else {
            printf("%17s", "-");
        }
        printf("  %016llx%s\n", (unsigned long long)f->outcome[0].hash,
               same ? "" : " DIFFERS BETWEEN THREAD COUNTS");
    }
}

static void printJson(const Figure* figures, const int* threads, int columns)
{
    json_t* root = json_array();
    for (int s = 0; s < STAGE_COUNT; s++) {
        for (int c = 0; c < columns; c++) {
            char hash[17];
            snprintf(hash, sizeof hash, "%016llx", (unsigned long long)figures[s].outcome[c].hash);
            json_array_append_new(root, json_pack("{s:s, s:i, s:f, s:I, s:f, s:s}", "stage", STAGES[s].name,
                                                  "threads", threads[c], "ms", figures[s].ms[c], "draw_calls",
                                                  (json_int_t)figures[s].outcome[c].drawCalls, "pixel_lights",
                                                  figures[s].outcome[c].pixelLights, "hash", hash));
        }
    }
    json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(6));
    putchar('\n');
    json_decref(root);
}

int runBench(const Arguments* a)
{
    static Figure figures[STAGE_COUNT];
    int threads[MAX_THREAD_COUNTS] = {1, 2}, columns = 2;
    if (a->threadsCount > 0) {
        columns = a->threadsCount;
        memcpy(threads, a->threads, sizeof threads);
    }
    int code = exitCode(measureAll(a, threads, columns, figures), true);
    if (code != EXIT_DONE) {
        return code;
    }
    if (a->json) {
        printJson(figures, threads, columns);
    } else {
        printText(a, figures, threads, columns);
    }
    return EXIT_DONE;
}
