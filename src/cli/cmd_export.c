// SPDX-License-Identifier: MIT
// vpl lights and vpl bake: virtual lights and lit patches, for other programs.
#include "cli/cli.h"

#include <stdio.h>
#include <string.h>

// ---- virtual lights

static void printLights(const vplScene* scene, const vplLightSet* set)
{
    double origin[3];
    vplScene_GetOrigin(scene, origin);
    const int digits = origin[0] != 0 || origin[1] != 0 || origin[2] != 0 ? 15 : 9;
    puts("index,step,px,py,pz,nx,ny,nz,r,g,b,weight");
    for (int i = 0; i < set->lightCount && !ferror(stdout); i++) {
        const vplVirtualLight* v = &set->lights[i];
        printf("%d,%d,%.*g,%.*g,%.*g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", i, v->step, digits,
               origin[0] + (double)v->position.x, digits, origin[1] + (double)v->position.y, digits,
               origin[2] + (double)v->position.z, (double)v->normal.x, (double)v->normal.y,
               (double)v->normal.z, (double)v->light.r, (double)v->light.g, (double)v->light.b,
               (double)v->weight);
    }
}

static int listLights(const Arguments* a, vplScene* scene)
{
    vplLightSet* set = NULL;
    int code = exitCode(vplMakeLights(scene, &a->render, &set), true);
    if (code == EXIT_DONE) {
        printLights(scene, set);
    }
    if (code == EXIT_DONE && a->verbose) {
        complain("%d lights, %d particles escaped, %lld rays, %lld ray-object tests", set->lightCount,
                 set->escaped, (long long)set->rays, (long long)set->rayObjectTests);
    }
    vplLightSet_Destroy(set);
    return code;
}

int runLights(const Arguments* a)
{
    return runOnScene(a, listLights);
}

// ---- patches

int bakeScene(const Arguments* a, vplScene* scene)
{
    catchInterrupts();
    Progress progress = beginProgress(a->quiet);
    vplRenderOptions options = a->render;
    vplRenderStats stats;
    options.progress = showProgress;
    options.progressUser = &progress;
    int code = exitCode(vplBake(scene, &options, (float)a->exposure, a->output, &stats), false);
    endProgress(&progress);
    if (code == EXIT_DONE && a->verbose) {
        complain("%d patches, light reaches %d of them on %d sides, %d sweeps", stats.patches,
                 stats.litPatches, stats.patchSides, stats.solve.iterations);
    }
    if (code == EXIT_DONE && a->stats != NULL) {
        code = writeStats(vplScene_GetContext(scene), a->stats, &stats);
    }
    return code;
}

int checkBake(const Arguments* a)
{
    const size_t length = a->output != NULL ? strlen(a->output) : 0;
    if (a->render.method != VPL_METHOD_RADIOSITY) {
        complain("bake writes the patches of --method radiosity alone");
        return EXIT_USAGE;
    }
    if (!a->dryRun && (length < 4 || strcmp(a->output + length - 4, ".ply") != 0)) {
        complain("bake needs -o FILE, a name that ends in .ply");
        return EXIT_USAGE;
    }
    if (!a->dryRun && (!checkOutput(a->output) || (a->stats != NULL && !checkOutput(a->stats)))) {
        return EXIT_COULD_NOT;
    }
    return EXIT_DONE;
}

int runBake(const Arguments* a)
{
    const int code = checkBake(a);
    return code == EXIT_DONE ? runOnScene(a, bakeScene) : code;
}
