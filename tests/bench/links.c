// SPDX-License-Identifier: MIT
// Compares hierarchical radiosity's links with all pairs: links, rays, processor time, memory and the
// difference in irradiance.
//   links SCENE [ERROR [POINTS [PATCHES ...]]]
#include "bench.h"

#include <math.h>
#include <string.h>

enum { MOST_DENSE = 6000, RUNS = 3 };

// Returns each side's radiosity from its emission and a lamp below the middle of the ceiling, which lights
// the sides very unevenly.
static vplRgb* lightSides(const vplPatchSides* sides)
{
    const vplGeometry* g = sides->patches->geometry;
    vplRgb* b = malloc(sizeof *b * (size_t)(sides->count + 1));
    const vplVec3 low = g->boundsMin, high = g->boundsMax;
    const vplVec3 lamp = {0.5f * (low.x + high.x), low.y + 0.8f * (high.y - low.y), 0.5f * (low.z + high.z)};
    const float size = vplLength(vplSub(high, low));
    for (int i = 0; i < sides->count; i++) {
        const vplPatchSide* s = &sides->sides[i];
        const vplVec3 way = vplSub(lamp, s->incentre);
        const float r = fmaxf(vplLength(way), 0.02f * size), cosine = vplDot(way, s->normal) / r;
        const float e = cosine > 0 ? size * size * cosine / (r * r) : 0;
        b[i] = (vplRgb){s->reflectance.r * e + s->emission.r, s->reflectance.g * e + s->emission.g,
                        s->reflectance.b * e + s->emission.b};
    }
    return b;
}

typedef struct Difference {
    double rms, mean; // relative to the area-weighted mean of b
} Difference;

static Difference differ(const vplPatchSides* sides, const vplRgb* a, const vplRgb* b)
{
    double squares = 0, sum = 0, wanted = 0, area = 0;
    for (int i = 0; i < sides->count; i++) {
        const double w = (double)sides->sides[i].area;
        const double d = vplRgbMean(a[i]) - vplRgbMean(b[i]);
        squares += w * d * d;
        sum += w * d;
        wanted += w * vplRgbMean(b[i]);
        area += w;
    }
    return (Difference){sqrt(squares / area) / (wanted / area), sum / wanted};
}

typedef struct Row {
    vplLinks* links;
    double ms;
} Row;

static Row timeLinks(const vplPatchSides* sides, const vplLinkDef* def)
{
    Row row = {.links = NULL};
    double times[RUNS];
    const int runs = sides->count < 20000 ? RUNS : 1;
    for (int run = 0; run < runs; run++) {
        vplLinks_Destroy(row.links);
        const double start = cpuMs();
        check(vplLinks_Create(sides, def, &row.links));
        times[run] = cpuMs() - start;
    }
    row.ms = medianOf(times, runs);
    return row;
}

// Returns the processor time of one sweep, ms.
static double sweepMs(const vplTransport* transport, vplSolver solver, const vplRgb* source)
{
    enum { SWEEPS = 20 };
    vplSolveDef def = vplDefaultSolveDef();
    vplRgb* b = malloc(sizeof *b * (size_t)transport->sides->count);
    memcpy(b, source, sizeof *b * (size_t)transport->sides->count);
    def.solver = solver;
    def.iterations = SWEEPS;
    def.residual = 0;
    def.spectrum = false;
    const double start = cpuMs();
    check(vplSolveRadiosity(transport, &def, source, b, NULL));
    const double ms = (cpuMs() - start) / SWEEPS;
    free(b);
    return ms;
}

static void printRow(vplContext* context, const vplPatches* patches, const vplScene* scene,
                     const vplLinkDef* def)
{
    vplPatchSidesDef sidesDef = vplDefaultPatchSidesDef();
    sidesDef.emitterCount = vplScene_GetEmitterCount(scene);
    vplEmitterDef emitters[64];
    for (int i = 0; i < sidesDef.emitterCount && i < 64; i++) {
        emitters[i] = *vplScene_GetEmitter(scene, i);
    }
    sidesDef.emitters = emitters;
    vplPatchSides* sides = NULL;
    vplFormFactors* factors = NULL;
    check(vplPatchSides_Create(patches, &sidesDef, &sides));
    vplRgb* b = lightSides(sides);
    vplRgb* e = malloc(sizeof *e * (size_t)(sides->count + 1));
    vplRgb* dense = malloc(sizeof *dense * (size_t)(sides->count + 1));
    const size_t before = vplContext_GetBytes(context);
    const Row row = timeLinks(sides, def);
    const size_t bytes = vplContext_GetBytes(context) - before;
    const vplTransport byLinks = {.sides = sides, .links = row.links};
    double times[9], sum = 0, square = 0;
    for (int run = 0; run < 9; run++) {
        const double start = cpuMs();
        check(vplGatherRadiosity(&byLinks, b, e));
        times[run] = cpuMs() - start;
    }
    for (int i = 0; i < sides->count; i++) {
        sum += (double)row.links->rowSums[i] / sides->count;
        square += pow((double)row.links->rowSums[i] - 1, 2) / sides->count;
    }
    printf("%7d %8lld %6.1f %9lld %8.0f %8.2f %7.1f  %6.4f %6.4f", sides->count,
           (long long)row.links->linkCount, (double)row.links->linkCount / sides->count,
           (long long)row.links->rays, row.ms, medianOf(times, 9), (double)bytes / 0x1p20, sum, sqrt(square));
    if (sides->count <= MOST_DENSE) {
        vplFormFactorDef all = vplDefaultFormFactorDef();
        double start = cpuMs();
        check(vplFormFactors_Create(sides, &all, &factors));
        const double ms = cpuMs() - start;
        const vplTransport usual = {.sides = sides, .factors = factors};
        vplRgb* few = malloc(sizeof *few * (size_t)sides->count);
        check(vplGatherRadiosity(&usual, b, few));
        const double gaussSeidel = sweepMs(&usual, VPL_SOLVER_GAUSS_SEIDEL, b);
        const double jacobi = sweepMs(&usual, VPL_SOLVER_JACOBI, b);
        const double shooting = sweepMs(&usual, VPL_SOLVER_SHOOTING, b);
        vplFormFactors_Destroy(factors);
        all.samples = 64;
        all.seed = 1;
        factors = NULL;
        check(vplFormFactors_Create(sides, &all, &factors));
        const vplTransport byAll = {.sides = sides, .factors = factors};
        check(vplGatherRadiosity(&byAll, b, dense));
        const Difference d = differ(sides, e, dense), f = differ(sides, few, dense);
        double rows = 0;
        for (int i = 0; i < sides->count; i++) {
            rows += (double)factors->rowSums[i] / sides->count;
            b[i].r -= sides->sides[i].emission.r;
            b[i].g -= sides->sides[i].emission.g;
            b[i].b -= sides->sides[i].emission.b;
        }
        check(vplGatherRadiosity(&byAll, b, dense));
        check(vplGatherRadiosity(&byLinks, b, e));
        const Difference dark = differ(sides, e, dense);
        printf("  %5.2f%% %+5.2f%%  %5.2f%% %+5.2f%%   %8.0f %5.2f%% %6.4f", 100 * d.rms, 100 * d.mean,
               100 * dark.rms, 100 * dark.mean, ms, 100 * f.rms, rows);
        printf("\n        sweeps over all pairs: Gauss-Seidel %.2f ms, Jacobi %.2f, shooting %.2f; over "
               "links %.2f",
               gaussSeidel, jacobi, shooting, sweepMs(&byLinks, VPL_SOLVER_JACOBI, b));
        free(few);
    }
    printf("\n");
    free(b);
    free(e);
    free(dense);
    vplFormFactors_Destroy(factors);
    vplLinks_Destroy(row.links);
    vplPatchSides_Destroy(sides);
}

int main(int count, char** words)
{
    static const int usual[] = {784, 3136, 12544, 50176};
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    if (count < 2) {
        fprintf(stderr, "links SCENE [ERROR [POINTS [PATCHES ...]]]\n");
        return 2;
    }
    openScene(words[1], 1, VPL_ISA_AUTO, &context, &scene);
    check(vplGeometry_Create(scene, &geometry));
    vplLinkDef def = vplDefaultLinkDef();
    def.error = count > 2 ? atof(words[2]) : def.error;
    def.samples = count > 3 ? atoi(words[3]) : def.samples;
    printf("%s, error %g, %d points; processor ms; difference of irradiance to all pairs with 64 rays each\n",
           words[1], def.error, def.samples);
    printf("  sides    links  /side      rays   create   gather     MiB  rows: mean, rms-1     rms    mean   "
           "all: ms    "
           "rms   rows\n");
    for (int i = 0; i < (count > 4 ? count - 4 : 4); i++) {
        vplPatchDef patchDef = vplDefaultPatchDef();
        vplPatches* patches = NULL;
        patchDef.count = count > 4 ? atoi(words[4 + i]) : usual[i];
        check(vplPatches_Create(geometry, &patchDef, &patches));
        printRow(context, patches, scene, &def);
        vplPatches_Destroy(patches);
    }
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
