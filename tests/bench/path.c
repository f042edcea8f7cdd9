// SPDX-License-Identifier: MIT
// Measures the value of the path tracer's techniques: error of the picture, rays, time, and variance times
// time relative to the first line of each group (smaller is better). `bench/path SCENE [SAMPLES [SIZE
// [GROUP|NAME]]]`.
#include "cli/bench/measure.h"
#include "reference/path_trace.h"

#include <vpl/stages.h>

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Line {
    const char* group;
    const char* name;
    void (*adjust)(vplPathDef* def);
} Line;

static void asItIs(vplPathDef* def)
{
    (void)def;
}

static void randomNumbers(vplPathDef* def)
{
    def->random = true;
}

static void balance(vplPathDef* def)
{
    def->balanceHeuristic = true;
}

static void points(vplPathDef* def)
{
    def->techniques = VPL_PATH_LIGHT_SAMPLING;
}

static void chance(vplPathDef* def)
{
    def->techniques = VPL_PATH_BSDF_SAMPLING;
}

static void pointsAndChance(vplPathDef* def)
{
    def->techniques = VPL_PATH_LIGHT_SAMPLING | VPL_PATH_BSDF_SAMPLING;
}

static void rouletteAt1(vplPathDef* def)
{
    def->rouletteFrom = 1;
}

static void rouletteAtHalf(vplPathDef* def)
{
    def->rouletteFrom = 0.5;
}

static void rouletteAtEighth(vplPathDef* def)
{
    def->rouletteFrom = 0.125;
}

static void rouletteAt64th(vplPathDef* def)
{
    def->rouletteFrom = 1.0 / 64;
}

static void noVertex(vplPathDef* def)
{
    def->lightVertices = 0;
}

static void twoVertices(vplPathDef* def)
{
    def->lightVertices = 2;
}

static void fourVertices(vplPathDef* def)
{
    def->lightVertices = 4;
}

static void eightVertices(vplPathDef* def)
{
    def->lightVertices = 8;
}

static void mostVertices(vplPathDef* def)
{
    def->lightVertices = VPL_MOST_LIGHT_VERTICES;
}

static void eachEmitter(vplPathDef* def)
{
    def->emittersOfTree = def->trianglesOfTree = INT_MAX;
}

static void tree(vplPathDef* def)
{
    def->emittersOfTree = def->trianglesOfTree = 1;
}

// The trees of makeTreesByPower.
static void byPower(vplPathDef* def)
{
    tree(def);
}

static const Line LINES[] = {
    {"numbers", "scrambled Sobol'", asItIs},
    {"numbers", "random", randomNumbers},
    {"lights", "all ways, power heuristic", asItIs},
    {"lights", "all ways, balance heuristic", balance},
    {"lights", "points and chance", pointsAndChance},
    {"lights", "points alone", points},
    {"lights", "chance alone", chance},
    {"roulette", "below a quarter", asItIs},
    {"roulette", "always", rouletteAt1},
    {"roulette", "below a half", rouletteAtHalf},
    {"roulette", "below an eighth", rouletteAtEighth},
    {"roulette", "below a 64th", rouletteAt64th},
    {"vertices", "one", asItIs},
    {"vertices", "none", noVertex},
    {"vertices", "two", twoVertices},
    {"vertices", "four", fourVertices},
    {"vertices", "eight", eightVertices},
    {"vertices", "sixteen", mostVertices},
    {"lamps", "all, triangles by power", eachEmitter},
    {"lamps", "by power", byPower},
    {"lamps", "from a tree", tree},
};

static vplResult measure(const vplGeometry* geometry, const vplPathDef* def, int samples, vplPathStats* stats,
                         double* ms)
{
    vplPathTracer* tracer = NULL;
    vplImage* image = NULL;
    double start = cpuMs();
    vplResult result = vplPathTracer_Create(geometry, def, &tracer);
    if (result == VPL_SUCCESS) {
        result = vplPathTracer_Pass(tracer, samples, NULL, NULL, 0, 1);
    }
    *ms = cpuMs() - start;
    if (result == VPL_SUCCESS) {
        result = vplImage_Create(geometry->context, def->width, def->height, &image);
    }
    if (result == VPL_SUCCESS) {
        vplPathTracer_Resolve(tracer, image, stats);
    }
    vplImage_Destroy(image);
    vplPathTracer_Destroy(tracer);
    return result;
}

static vplResult makeTreesByPower(const vplGeometry* geometry, const vplPathDef* def,
                                  vplEmitterTrees** treesOut)
{
    const vplTreesWanted all = {1, 1};
    const vplResult result =
        vplEmitterTrees_Create(geometry, def->emitters, def->emitterCount, all, treesOut);
    if (result == VPL_SUCCESS && (*treesOut)->emitters != NULL) {
        vplEmitterTree_ForgetPlaces((*treesOut)->emitters);
    }
    if (result == VPL_SUCCESS && (*treesOut)->triangles != NULL) {
        vplEmitterTree_ForgetPlaces((*treesOut)->triangles);
    }
    return result;
}

static int run(const vplScene* scene, const vplGeometry* geometry, const vplEmitterDef* emitters, int samples,
               int size, const char* only)
{
    double first = 0;
    printf("%-9s %-28s %10s %8s %9s %9s %9s\n", "", "", "error", "of mean", "rays/path", "Mrays/s",
           "var*time");
    for (size_t i = 0; i < sizeof LINES / sizeof *LINES; i++) {
        if (only != NULL && strcmp(only, LINES[i].group) != 0 && strcmp(only, LINES[i].name) != 0) {
            continue;
        }
        vplPathDef def = vplDefaultPathDef();
        def.camera = vplScene_GetCamera(scene, 0);
        def.emitterCount = vplScene_GetEmitterCount(scene);
        def.emitters = emitters;
        def.width = def.height = size;
        def.emission = false; // aliasing at the edges of visible emitters would dominate the error
        LINES[i].adjust(&def);
        vplPathStats stats;
        vplEmitterTrees* trees = NULL;
        double ms;
        if (LINES[i].adjust == byPower && makeTreesByPower(geometry, &def, &trees) != VPL_SUCCESS) {
            return 1;
        }
        def.trees = trees;
        if (measure(geometry, &def, samples, &stats, &ms) != VPL_SUCCESS) {
            return 1;
        }
        vplEmitterTrees_Destroy(trees);
        double cost = stats.errorEstimate * stats.errorEstimate * ms;
        if (i == 0 || strcmp(LINES[i].group, LINES[i - 1].group) != 0) {
            first = cost;
        }
        printf("%-9s %-28s %10.4g %7.2f%% %9.2f %9.2f %9.2f\n", LINES[i].group, LINES[i].name,
               stats.errorEstimate, 100 * stats.relativeErrorEstimate,
               (double)stats.rays / size / size / samples, (double)stats.rays / ms / 1000, cost / first);
        fflush(stdout);
    }
    return 0;
}

static void printMessage(void* user, vplLogLevel level, const char* message)
{
    (void)user;
    (void)level;
    fprintf(stderr, "%s\n", message);
}

int main(int count, char** words)
{
    vplContextDef def = vplDefaultContextDef();
    def.log = printMessage;
    vplContext* context = NULL;
    vplScene* scene = NULL;
    vplGeometry* geometry = NULL;
    const char* path = count > 1 ? words[1] : "examples/scenes/room-area.json";
    int code = 1;
    if (vplContext_Create(&def, &context) == VPL_SUCCESS &&
        vplScene_Load(context, path, &scene) == VPL_SUCCESS &&
        vplGeometry_Create(scene, &geometry) == VPL_SUCCESS) {
        const int emitterCount = vplScene_GetEmitterCount(scene);
        vplEmitterDef* emitters = calloc((size_t)emitterCount + 1, sizeof *emitters);
        for (int i = 0; i < emitterCount && emitters != NULL; i++) {
            emitters[i] = *vplScene_GetEmitter(scene, i);
        }
        code = emitters == NULL ? 1
                                : run(scene, geometry, emitters, count > 2 ? atoi(words[2]) : 32,
                                      count > 3 ? atoi(words[3]) : 96, count > 4 ? words[4] : NULL);
        free(emitters);
    }
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return code;
}
