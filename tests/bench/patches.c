// SPDX-License-Identifier: MIT
// Measures the cost of patches and of finding their lit sides: milliseconds of processor time of one thread,
// medians of five, and numbers of rays. `patches SCENE [COUNT ...]`
#include "cli/bench/measure.h"

#include <vpl/stages.h>

#include <stdio.h>
#include <stdlib.h>

static int measure(const vplScene* scene, const vplGeometry* geometry, int count)
{
    enum { RUNS = 5 };
    double making[RUNS], finding[RUNS];
    vplPatchDef def = vplDefaultPatchDef();
    vplPatchSidesDef sidesDef = vplDefaultPatchSidesDef();
    vplPatches* patches = NULL;
    vplPatchSides* sides = NULL;
    def.count = count;
    sidesDef.emitterCount = vplScene_GetEmitterCount(scene);
    sidesDef.emitters = sidesDef.emitterCount > 0 ? vplScene_GetEmitter(scene, 0) : NULL;
    for (int run = 0; run < RUNS; run++) {
        vplPatchSides_Destroy(sides);
        vplPatches_Destroy(patches);
        const double start = cpuMs();
        if (vplPatches_Create(geometry, &def, &patches) != VPL_SUCCESS) {
            return 1;
        }
        const double middle = cpuMs();
        if (vplPatchSides_Create(patches, &sidesDef, &sides) != VPL_SUCCESS) {
            return 1;
        }
        making[run] = middle - start;
        finding[run] = cpuMs() - middle;
    }
    int part = 0;
    for (int i = 0; i < sides->count; i++) {
        part += sides->sides[i].open != 0xffff;
    }
    printf("%8d patches %9.2f ms  %8d sides, %6d in part %9.1f ms %10lld rays, %5.1f a patch\n",
           patches->patchCount, medianOf(making, RUNS), sides->count, part, medianOf(finding, RUNS),
           (long long)sides->rays, (double)sides->rays / patches->patchCount);
    vplPatchSides_Destroy(sides);
    vplPatches_Destroy(patches);
    return 0;
}

int main(int count, char** words)
{
    static const int usual[] = {784, 3000, 12000, 50000, 200000};
    vplContextDef def = vplDefaultContextDef();
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    def.workerCount = 1;
    if (count < 2 || vplContext_Create(&def, &context) != VPL_SUCCESS ||
        vplScene_Load(context, words[1], &scene) != VPL_SUCCESS ||
        vplGeometry_Create(scene, &geometry) != VPL_SUCCESS) {
        fprintf(stderr, "usage: patches SCENE [COUNT ...]\n");
        return 1;
    }
    int failed = 0;
    for (int i = 0; i < (count > 2 ? count - 2 : 5) && !failed; i++) {
        failed = measure(scene, geometry, count > 2 ? atoi(words[i + 2]) : usual[i]);
    }
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return failed;
}
