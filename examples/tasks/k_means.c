// SPDX-License-Identifier: MIT
// K-means of lights of the program's own: two heaps of four become two clusters.
#include <vpl/stages.h>

#include <stdio.h>

int main(void)
{
    static vplVirtualLight lights[8];
    for (int i = 0; i < 8; i++) {
        lights[i].position = (vplVec3){(float)(i % 4), 0, i < 4 ? 0.0f : 100.0f};
        lights[i].normal = (vplVec3){0, 1, 0};
        lights[i].light = (vplRgb){1, 1, 1};
        lights[i].weight = 1;
    }
    vplContextDef context = vplDefaultContextDef();
    context.log = vplLogToStderr;
    vplClusterDef def = vplDefaultClusterDef();
    def.count = 2;
    vplLightSet set = {.lights = lights, .lightCount = 8, .particleCount = 8};
    vplLightClusters* clusters = NULL;
    const bool failed = vplContext_Create(&context, &set.context) || vplFindClusters(&set, &def, &clusters);
    const bool apart = !failed && clusters->of[0] == clusters->of[3] && clusters->of[4] == clusters->of[7] &&
                       clusters->of[0] != clusters->of[4];
    for (int i = 0; !failed && i < 2; i++) {
        const vplLightCluster* c = &clusters->clusters[i];
        printf("%d lights about (%g, %g, %g)\n", c->lightCount, (double)c->position.x, (double)c->position.y,
               (double)c->position.z);
    }
    vplLightClusters_Destroy(clusters);
    vplContext_Destroy(set.context);
    return apart ? 0 : 1;
}
