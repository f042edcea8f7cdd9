// SPDX-License-Identifier: MIT
#include "cli/cli.h"

#include <stdio.h>

static void printLights(const vplLightSet* set)
{
    puts("index,step,px,py,pz,nx,ny,nz,r,g,b,weight");
    for (int i = 0; i < set->lightCount && !ferror(stdout); i++) {
        const vplVirtualLight* v = &set->lights[i];
        printf("%d,%d,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", i, v->step, (double)v->position.x,
               (double)v->position.y, (double)v->position.z, (double)v->normal.x, (double)v->normal.y,
               (double)v->normal.z, (double)v->light.r, (double)v->light.g, (double)v->light.b,
               (double)v->weight);
    }
}

int runLights(const Arguments* a)
{
    vplContext* context = openContext(a);
    if (context == NULL) {
        return EXIT_USAGE;
    }
    vplScene* scene = NULL;
    vplLightSet* set = NULL;
    int code = exitCode(vplScene_Load(context, a->positionals[0], &scene), true);
    if (code == EXIT_DONE) {
        code = exitCode(vplMakeLights(scene, &a->render, &set), true);
    }
    if (code == EXIT_DONE) {
        printLights(set);
        if (a->verbose) {
            complain("%d lights, %d particles escaped, %lld rays, %lld ray-object tests", set->lightCount,
                     set->escaped, (long long)set->rays, (long long)set->rayObjectTests);
        }
    }
    vplLightSet_Destroy(set);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return code;
}
