// SPDX-License-Identifier: MIT
// Measures shadow acne and peter-panning: compares the cube map's shadow factors at all visible points of the
// room with ray-traced shadows, for static bias only, dynamic bias only, both, and the exact rule, over map
// sizes, with hard and filtered shadows.
//   acne   lit by the ray, but more than half shadowed by the map, % of the points that face the light
//   leak   shadowed by the ray, but less than half shadowed by the map
//   error  mean |s - ray| over the same points; with 16 samples it includes the soft edge itself
#include "bench.h"

#include <vpl/stages.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 384 };

typedef struct Point {
    vplVec3 position, normal;
    bool lit; // according to the ray
} Point;

// Collects the visible points that face the light.
static int findPoints(const vplGeometry* g, const vplView* view, vplVec3 light, Point* points)
{
    int count = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
        vplRay ray = {view->eye, rayThrough(view, i % SIZE, i / SIZE), {0, 0}};
        vplHit hit;
        if (!vplGeometry_ClosestHit(g, &ray, &hit)) {
            continue;
        }
        vplVec3 l = {light.x - hit.position.x, light.y - hit.position.y, light.z - hit.position.z};
        if (hit.normal.x * l.x + hit.normal.y * l.y + hit.normal.z * l.z <= 0) {
            continue;
        }
        vplRay shadowRay = vplGeometry_Leave(g, &hit, l);
        bool lit = !vplGeometry_IsOccluded(g, &shadowRay, 1);
        points[count++] = (Point){hit.position, hit.normal, lit};
    }
    return count;
}

static void measure(const vplShadow* shadow, const Point* points, int count)
{
    int acne = 0, leak = 0;
    double error = 0;
    for (int i = 0; i < count; i++) {
        double s = (double)vplShadow_Factor(shadow, points[i].position, points[i].normal);
        acne += points[i].lit && s > 0.5;
        leak += !points[i].lit && s < 0.5;
        error += fabs(s - !points[i].lit);
    }
    printf(" | %6.2f %6.2f %6.2f", 100.0 * acne / count, 100.0 * leak / count, 100 * error / count);
}

int main(void)
{
    vplContext* context;
    vplScene* scene;
    vplGeometry* g;
    check(vplContext_Create(NULL, &context));
    check(vplScene_Load(context, "examples/scenes/room.json", &scene));
    check(vplGeometry_Create(scene, &g));
    vplView view = vplView_Create(vplScene_GetCamera(scene, 0), SIZE, SIZE);
    vplVec3 light = vplScene_GetEmitter(scene, 0)->position;
    Point* points = malloc(SIZE * SIZE * sizeof *points);
    int count = findPoints(g, &view, light, points);
    printf("%d points; acne, leak and error in %%\n", count);
    printf("  map  S |      static only     |     dynamic only     |         both         |        exact\n");
    for (int size = 128; size <= 2048; size *= 2) {
        vplCubeMapDef def = vplDefaultCubeMapDef();
        def.position = light;
        def.size = size;
        vplCubeMap* map;
        check(vplCubeMap_Create(g, &def, NULL, NULL, &map));
        for (int samples = 1; samples <= 16; samples += 15) {
            printf("%5d %2d", size, samples);
            for (int rule = 0; rule < 4; rule++) {
                vplShadowDef shadowDef = vplDefaultShadowDef();
                vplShadow shadow;
                shadowDef.biasRule = rule == 3 ? VPL_BIAS_EXACT : VPL_BIAS_PAIR;
                shadowDef.pcfSamples = samples;
                check(vplShadow_Create(map, &shadowDef, &shadow));
                shadow.def.biasDynamic = rule == 0 ? 0 : shadow.def.biasDynamic;
                shadow.def.biasStatic = rule == 1 ? 0 : shadow.def.biasStatic;
                measure(&shadow, points, count);
            }
            printf("\n");
        }
        vplCubeMap_Destroy(map);
    }
    free(points);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
