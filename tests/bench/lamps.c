// SPDX-License-Identifier: MIT
// Measures direct light of many lamps: error and processor time of lamps that a tree chooses for each pixel, of points that
// stand for all area lights, and of asking all. `bench/lamps SCENE [SIZE [TRUTH]]`: SIZE pixels a side, TRUTH points on area
// lights for the truth. Points and spots are asked without shadow maps, and the truth asks all of them.
//   error    root of the mean squared error of a pixel, % of the mean
//   regions  the same of means of 8 x 8 pixels, which noise leaves and banding does not
#include "bench.h"
#include "geometry/emission.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { REGION = 8 };

typedef struct Bench {
    const vplGeometry* geometry;
    vplView view;
    vplShadeDef truth; // all lamps
    vplImage* image;
} Bench;

static double draw(const Bench* b, const vplShadeDef* def, vplImage* image)
{
    const double start = cpuMs();
    check(vplShadeView(b->geometry, &b->view, def, image, NULL));
    return cpuMs() - start;
}

// The root of the mean squared difference of means of side x side pixels, % of the mean of `b`.
static double errorOf(const vplImage* a, const vplImage* b, int side)
{
    double squares = 0, sum = 0;
    int regions = 0;
    for (int top = 0; top + side <= a->height; top += side) {
        for (int left = 0; left + side <= a->width; left += side) {
            double difference = 0;
            for (int i = 0; i < side * side; i++) {
                const size_t at = (size_t)(top + i / side) * (size_t)a->width + (size_t)(left + i % side);
                const float *p = a->pixels + 3 * at, *q = b->pixels + 3 * at;
                difference += (double)p[0] + p[1] + p[2] - q[0] - q[1] - q[2];
                sum += (double)q[0] + q[1] + q[2];
            }
            difference /= side * side;
            squares += difference * difference;
            regions++;
        }
    }
    return 100 * sqrt(squares / regions) / (sum / regions / side / side);
}

static void printLine(const Bench* b, const char* name, int count, const vplShadeDef* def)
{
    vplImage* image;
    vplComparison c;
    check(vplImage_Create(b->geometry->context, b->view.width, b->view.height, &image));
    const double ms = draw(b, def, image);
    check(vplImage_Compare(image, b->image, &c));
    printf("%-24s %8d %9.3f s %9.5f %8.2f %% %8.2f %% %10.4f\n", name, count, 1e-3 * ms, c.relmse,
           errorOf(image, b->image, 1), errorOf(image, b->image, REGION), c.energyRatio);
    fflush(stdout);
    vplImage_Destroy(image);
}

// Emission of surfaces is not shown: it has no error.
static void run(Bench* b, const vplEmission* area, int truth)
{
    vplShadeLight* lights = calloc((size_t)truth + 1, sizeof *lights);
    check(lights != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY);
    printf("%-24s %8s %11s %9s %10s %10s %10s\n", "", "", "time", "relmse", "error", "regions", "energy");
    b->truth.areaLights = lights;
    b->truth.areaLightCount = vplSampleAreaLights(area, truth, lights);
    printf("%-24s %8d %9.3f s\n", "all", b->truth.emitterCount + b->truth.areaLightCount,
           1e-3 * draw(b, &b->truth, b->image));
    for (int count = 16; count <= 1024; count *= 2) {
        vplShadeDef def = b->truth;
        if (b->truth.areaLightCount > 0) {
            def.areaLightCount = vplSampleAreaLights(area, count, lights);
            printLine(b, "points on area lights", count, &def);
        }
        def.areaLightCount = 0;
        def.emittersPerPoint = count;
        def.trianglesPerPoint = b->truth.areaLightCount > 0 ? count : 0;
        printLine(b, "chosen for each pixel", count, &def);
    }
    free(lights);
}

int main(int count, char** words)
{
    const char* path = count > 1 ? words[1] : "examples/scenes/room-area.json";
    const int size = count > 2 ? atoi(words[2]) : 96, truth = count > 3 ? atoi(words[3]) : 16384;
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplEmission* area;
    openScene(path, 1, VPL_ISA_AUTO, &context, &scene);
    check(vplGeometry_Create(scene, &geometry));
    check(vplEmission_Create(geometry, NULL, 0, &area));
    Bench b = {.geometry = geometry, .view = vplView_Create(vplScene_GetCamera(scene, 0), size, size)};
    const int emitterCount = vplScene_GetEmitterCount(scene);
    vplEmitterDef* emitters = calloc((size_t)emitterCount + 1, sizeof *emitters);
    check(emitters != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY);
    for (int i = 0; i < emitterCount; i++) {
        emitters[i] = *vplScene_GetEmitter(scene, i);
    }
    b.truth = vplDefaultShadeDef();
    b.truth.accumulation = VPL_ACCUMULATE_DEFERRED;
    b.truth.emitters = emitters;
    b.truth.emitterCount = emitterCount;
    check(vplImage_Create(context, size, size, &b.image));
    run(&b, area, truth);
    vplImage_Destroy(b.image);
    free(emitters);
    vplEmission_Destroy(area);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
