// SPDX-License-Identifier: MIT
// Measures the cost of form factors, and the share of rays, the BVH and the contour integral in it:
// bench/form_factors SCENE [--runs N] [--most PATCHES] [--brute PATCHES]
// The program prints milliseconds of processor time on one thread, medians of alternated runs, for about 784,
// 3000, 12000 and 50000 patches, up to --most (default 4000; all pairs of 50000 are refused). Ratios are
// relative to the first way. Ways that test every triangle run up to --brute patches (default 1000). The
// error is the mean over rows of the sum of |F - F of 64 samples|, up to 1000 patches.
#include "bench.h"

#include <math.h>
#include <string.h>

enum { MOST_RUNS = 31, REFERENCE_SAMPLES = 64, MOST_REFERENCE = 1000 };

typedef struct Way {
    const char* name;
    vplFormFactorKind kind;
    bool analytic, bruteForce;
} Way;

static const Way WAYS[] = {{"incentres, every triangle", VPL_FORM_FACTORS_INCENTRE, false, true},
                           {"incentres", VPL_FORM_FACTORS_INCENTRE, false, false},
                           {"points, every triangle", VPL_FORM_FACTORS_MONTE_CARLO, false, true},
                           {"points", VPL_FORM_FACTORS_MONTE_CARLO, false, false},
                           {"default, every triangle", VPL_FORM_FACTORS_MONTE_CARLO, true, true},
                           {"default", VPL_FORM_FACTORS_MONTE_CARLO, true, false}};
enum { WAY_COUNT = sizeof WAYS / sizeof *WAYS };

static vplFormFactors* create(const vplPatchSides* sides, const Way* way, int samples)
{
    vplFormFactorDef def = vplDefaultFormFactorDef();
    def.kind = way->kind;
    def.analytic = way->analytic;
    def.bruteForce = way->bruteForce;
    def.rowSums = VPL_ROW_SUMS_KEEP;
    def.samples = samples ? samples : def.samples;
    vplFormFactors* factors;
    check(vplFormFactors_Create(sides, &def, &factors));
    return factors;
}

// Returns the mean over rows, weighted by area, of the sum of |F - truth|.
static double errorOf(const vplPatchSides* sides, const vplFormFactors* f, const vplFormFactors* truth)
{
    double sum = 0, area = 0;
    const size_t count = (size_t)f->count;
    for (size_t i = 0; i < count; i++) {
        double row = 0;
        for (size_t j = 0; j < count; j++) {
            row += fabs((double)f->rows[i * count + j] - (double)truth->rows[i * count + j]);
        }
        sum += (double)sides->sides[i].area * row;
        area += (double)sides->sides[i].area;
    }
    return sum / area;
}

static double meanSum(const vplPatchSides* sides, const vplFormFactors* f)
{
    double sum = 0, area = 0;
    for (int i = 0; i < f->count; i++) {
        sum += (double)sides->sides[i].area * (double)f->rowSums[i];
        area += (double)sides->sides[i].area;
    }
    return sum / area;
}

static void print(const vplPatchSides* sides, const Way* way, double ms, double first,
                  const vplFormFactors* f, const vplFormFactors* truth)
{
    printf("  %-26s %10.1f %8.2f %12lld %8lld %9.4f", way->name, ms, first / ms, (long long)f->rays,
           (long long)f->analyticPairs, meanSum(sides, f));
    if (truth != NULL) {
        printf(" %9.4f", errorOf(sides, f, truth));
    }
    printf("\n");
}

static double measure(const vplPatchSides* sides, int runs, int brute)
{
    static const Way truthWay = {"", VPL_FORM_FACTORS_MONTE_CARLO, true, false};
    double times[WAY_COUNT][MOST_RUNS], first = 0;
    const bool small = sides->patches->patchCount <= MOST_REFERENCE;
    vplFormFactors* truth = small ? create(sides, &truthWay, REFERENCE_SAMPLES) : NULL;
    printf("%d patches, %d sides\n  %-26s %10s %8s %12s %8s %9s %9s\n", sides->patches->patchCount,
           sides->count, "way", "ms", "times", "rays", "exact", "row sum", "error");
    for (int run = 0; run < runs; run++) {
        for (int w = 0; w < WAY_COUNT; w++) {
            const bool many = (int64_t)sides->count * sides->count * 4 > VPL_MAX_FORM_FACTOR_BYTES;
            if (many || (WAYS[w].bruteForce && sides->patches->patchCount > brute)) {
                continue;
            }
            const double start = cpuMs();
            vplFormFactors* f = create(sides, &WAYS[w], 0);
            times[w][run] = cpuMs() - start;
            if (run == runs - 1) {
                const double ms = medianOf(times[w], runs);
                first = first > 0 ? first : ms;
                print(sides, &WAYS[w], ms, first, f, truth);
            }
            vplFormFactors_Destroy(f);
        }
    }
    vplFormFactors_Destroy(truth);
    return first;
}

// Measures the hierarchy of links; `first` is the time of the first way, for the ratio.
static void measureLinks(const vplPatchSides* sides, int runs, double first)
{
    double times[MOST_RUNS];
    const vplLinkDef def = vplDefaultLinkDef();
    for (int run = 0; run < runs; run++) {
        vplLinks* links;
        const double start = cpuMs();
        check(vplLinks_Create(sides, &def, &links));
        times[run] = cpuMs() - start;
        if (run == runs - 1) {
            const double ms = medianOf(times, runs);
            printf("  %-26s %10.1f %8.2f %12lld %8s  %lld links\n", "links", ms, first > 0 ? first / ms : 1,
                   (long long)links->rays, "", (long long)links->linkCount);
        }
        vplLinks_Destroy(links);
    }
}

int main(int argc, char** argv)
{
    const char* path = NULL;
    int runs = 5, most = 4000, brute = 1000;
    for (int i = 1; i < argc; i++) {
        int* number = strcmp(argv[i], "--runs") == 0    ? &runs
                      : strcmp(argv[i], "--most") == 0  ? &most
                      : strcmp(argv[i], "--brute") == 0 ? &brute
                                                        : NULL;
        if (number != NULL && i + 1 < argc) {
            *number = atoi(argv[++i]);
        } else {
            path = argv[i];
        }
    }
    if (path == NULL || runs < 1 || runs > MOST_RUNS) {
        fprintf(stderr, "form_factors SCENE [--runs N up to %d] [--most PATCHES] [--brute PATCHES]\n",
                MOST_RUNS);
        return 2;
    }
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    openScene(path, 1, VPL_ISA_AUTO, &context, &scene);
    check(vplGeometry_Create(scene, &geometry));
    const int emitters = vplScene_GetEmitterCount(scene);
    static const int counts[] = {784, 3000, 12000, 50000};
    for (int i = 0; i < 4 && counts[i] <= most; i++) {
        vplPatchDef patchDef = vplDefaultPatchDef();
        patchDef.count = counts[i];
        vplPatches* patches;
        check(vplPatches_Create(geometry, &patchDef, &patches));
        vplPatchSidesDef sidesDef = vplDefaultPatchSidesDef();
        const vplVec3 eye = vplScene_GetCamera(scene, 0)->eye;
        sidesDef.viewpoints = &eye;
        sidesDef.viewpointCount = 1;
        sidesDef.emitters = emitters > 0 ? vplScene_GetEmitter(scene, 0) : NULL;
        sidesDef.emitterCount = emitters;
        vplPatchSides* sides;
        check(vplPatchSides_Create(patches, &sidesDef, &sides));
        measureLinks(sides, runs, measure(sides, runs, brute));
        vplPatchSides_Destroy(sides);
        vplPatches_Destroy(patches);
    }
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
