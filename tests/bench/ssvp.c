// SPDX-License-Identifier: MIT
// Measures the shading of a frame whose memory is already allocated: G-buffer, interleaved light classes,
// sharing, and the visibility of clusters. Runs are alternated; figures are medians of processor and
// wall-clock time, and errors against all lights in every pixel. The last line assigns lights to classes
// differently: each class has the lights of one or two clusters, instead of some of every cluster.
// `bench/ssvp SCENE [LIGHTS [RUNS [WIDTH HEIGHT [CLUSTERS [THREADS]]]]]`; direct light is left out.
#include "bench.h"

#include <malloc.h>

enum { MAX_CLUSTERS = 64, MAP_SIZE = 256, SIDE = 4 };

typedef struct Way {
    const char* name;
    vplShadeOutput output;
    int side; // 1: deferred
    bool lights, clusters, whole;
    int before, truth; // indices of the ways that its time and its error are compared with
} Way;

enum { ALL, ALL_CLUSTERS, GBUFFER, CLASSES, SHARED, CLUSTER_CLASSES, CLUSTER_SHARED, WHOLE, WAYS };
static const Way ways[WAYS] = {
    {"all lights", VPL_OUTPUT_RADIANCE, 1, true, false, false, ALL, ALL},
    {"all lights, clusters", VPL_OUTPUT_RADIANCE, 1, true, true, false, ALL, ALL_CLUSTERS},
    {"G-buffer", VPL_OUTPUT_RADIANCE, SIDE, false, false, false, GBUFFER, GBUFFER},
    {"+ classes", VPL_OUTPUT_GATHER, SIDE, true, false, false, GBUFFER, CLASSES},
    {"+ sharing", VPL_OUTPUT_RADIANCE, SIDE, true, false, false, CLASSES, ALL},
    {"+ classes, clusters", VPL_OUTPUT_GATHER, SIDE, true, true, false, GBUFFER, CLUSTER_CLASSES},
    {"+ sharing, clusters", VPL_OUTPUT_RADIANCE, SIDE, true, true, false, CLUSTER_CLASSES, ALL_CLUSTERS},
    {"the same, dealt whole", VPL_OUTPUT_RADIANCE, SIDE, true, true, true, CLUSTER_CLASSES, ALL_CLUSTERS}};

typedef struct Bench {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplView view;
    vplShadeLight *lights, *wholeLights;
    int lightCount, clusterCount;
    int *clusters, *wholeClusters;
    vplParaboloidMaps* maps;
    vplImage* images[WAYS];
} Bench;

// Takes `count` of the particles' lights at equal strides. Their order spreads any run of them over the
// scene.
static void makeLights(Bench* b, int count)
{
    vplParticleDef particles = vplDefaultParticleDef();
    particles.particleCount = 4 * count; // many leave an open scene
    particles.sampler = VPL_SAMPLER_HALTON;
    vplLightSet* set;
    check(vplSimulateParticles(b->geometry, vplScene_GetEmitter(b->scene, 0),
                               vplScene_GetEmitterCount(b->scene), &particles, &set));
    vplShadeLight* all = malloc((size_t)set->lightCount * sizeof *all);
    const int made = vplPrepareLights(set, VPL_LIGHTING_PHYSICAL, all);
    b->lightCount = made < count ? made : count;
    b->lights = malloc((size_t)count * sizeof *b->lights);
    for (int i = 0; i < b->lightCount; i++) {
        b->lights[i] = all[(int64_t)i * made / b->lightCount];
    }
    free(all);
    vplLightSet_Destroy(set);
}

static int alongX(const void* a, const void* b)
{
    const float x = ((const vplShadeLight*)a)->px, y = ((const vplShadeLight*)b)->px;
    return (x > y) - (x < y);
}

// Makes clusters as slices of the scene across x with equal numbers of lights, each with a map at its middle
// light.
static void makeClusters(Bench* b, int count)
{
    vplParaboloidPlace places[MAX_CLUSTERS];
    count = count < MAX_CLUSTERS ? count : MAX_CLUSTERS;
    b->clusterCount = count;
    b->clusters = malloc((size_t)b->lightCount * sizeof *b->clusters);
    b->wholeLights = malloc((size_t)b->lightCount * sizeof *b->lights);
    b->wholeClusters = malloc((size_t)b->lightCount * sizeof *b->clusters);
    qsort(b->lights, (size_t)b->lightCount, sizeof *b->lights, alongX);
    for (int i = 0; i < b->lightCount; i++) {
        b->clusters[i] = (int)((int64_t)i * count / b->lightCount);
    }
    for (int i = 0; i < count; i++) {
        const vplShadeLight* l = &b->lights[(2 * i + 1) * b->lightCount / (2 * count)];
        places[i] = (vplParaboloidPlace){{l->px, l->py, l->pz}, {l->nx, l->ny, l->nz}, 2, true};
    }
    for (int i = 0, from = 0; i < SIDE * SIDE; i++) {
        for (int k = i; k < b->lightCount; k += SIDE * SIDE, from++) {
            b->wholeLights[k] = b->lights[from];
            b->wholeClusters[k] = b->clusters[from];
        }
    }
    check(vplParaboloidMaps_Create(b->context, MAP_SIZE, count, false, &b->maps));
    check(vplParaboloidMaps_Draw(b->maps, b->geometry, places, count, NULL, NULL));
}

static vplResult shade(void* user, int which)
{
    const Bench* b = user;
    const Way* way = &ways[which];
    vplShadeDef def = vplDefaultShadeDef();
    def.minDistance = 0.5f;
    def.output = way->output;
    def.accumulation = VPL_ACCUMULATE_INTERLEAVED;
    def.interleave = way->side;
    def.lights = way->whole ? b->wholeLights : b->lights;
    def.lightCount = way->lights ? b->lightCount : 0;
    if (way->clusters) {
        def.lightClusters = way->whole ? b->wholeClusters : b->clusters;
        def.clusterShadows = b->maps->maps;
        def.clusterCount = b->clusterCount;
    }
    return vplShadeView(b->geometry, &b->view, &def, b->images[which], NULL);
}

static void print(const Bench* b, const Times* times, int runs)
{
    printf("%d lights in %d clusters, %dx%d, 4x4, medians of %d runs\n", b->lightCount, b->clusterCount,
           b->view.width, b->view.height, runs);
    printf("%-22s %9s %9s %9s %9s  %s\n", "", "cpu ms", "more", "wall ms", "rel. rmse", "hash");
    for (int i = 0; i < WAYS; i++) {
        vplComparison c = {0};
        check(vplImage_Compare(b->images[i], b->images[ways[i].truth], &c));
        printf("%-22s %9.2f %9.2f %9.2f %9.4f  %016llx\n", ways[i].name, times[i].cpu,
               times[i].cpu - times[ways[i].before].cpu, times[i].wall, c.relativeRmse,
               (unsigned long long)vplImage_Hash(b->images[i]));
    }
}

int main(int count, char** words)
{
    static Bench b;
    // As in a sequence of frames, freed memory is kept, and no page is cleared twice.
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    int runs = count > 3 ? atoi(words[3]) : 9;
    runs = runs < 1 ? 1 : runs > MAX_RUNS ? MAX_RUNS : runs;
    openScene(count > 1 ? words[1] : "examples/scenes/room.json", count > 7 ? atoi(words[7]) : 0,
              VPL_ISA_AUTO, &b.context, &b.scene);
    check(vplGeometry_Create(b.scene, &b.geometry));
    b.view = vplView_Create(vplScene_GetCamera(b.scene, 0), count > 5 ? atoi(words[4]) : 1920,
                            count > 5 ? atoi(words[5]) : 1080);
    for (int i = 0; i < WAYS; i++) {
        check(vplImage_Create(b.context, b.view.width, b.view.height, &b.images[i]));
    }
    makeLights(&b, count > 2 ? atoi(words[2]) : 512);
    makeClusters(&b, count > 6 ? atoi(words[6]) : 8);
    Times times[WAYS];
    const Measurement measurement = {shade, &b, WAYS, runs, 0, INFINITY}; // the first run allocates memory
    check(measureInTurn(&measurement, times, NULL));
    print(&b, times, runs);
    for (int i = 0; i < WAYS; i++) {
        vplImage_Destroy(b.images[i]);
    }
    free(b.lights);
    free(b.clusters);
    free(b.wholeLights);
    free(b.wholeClusters);
    vplParaboloidMaps_Destroy(b.maps);
    vplGeometry_Destroy(b.geometry);
    vplScene_Destroy(b.scene);
    vplContext_Destroy(b.context);
    return 0;
}
