// SPDX-License-Identifier: MIT
// bench/refit [BOXES [RAYS]]: some of many boxes jump to other places; the ray tree is refitted and built anew. Prints, for
// each share of the boxes, the expected cost of a ray after refitting over that of the new tree, processor time of both
// ways, and the time of random rays in both trees.
#include "bench.h"

#include "geometry/object_build.h"

#include <string.h>

static float uniform(uint64_t index)
{
    return vplUnitFloat(vplPhilox((uint32_t[4]){(uint32_t)index, 0, 0, 7}, 7, 0).v[0]);
}

static vplVec3 placeOf(uint64_t index)
{
    return (vplVec3){10 * uniform(3 * index), 10 * uniform(3 * index + 1), 10 * uniform(3 * index + 2)};
}

static vplMat4 transformOf(uint64_t index)
{
    const double turn[3] = {6 * (double)uniform(1u << 30 | (uint32_t)index), 1, 0};
    return vplMat4_FromParts(placeOf(index), turn, (vplVec3){0.3f, 0.2f, 0.1f});
}

static double trace(const vplGeometry* g, int rays, double* sumOut)
{
    const double start = cpuMs();
    *sumOut = 0;
    for (int i = 0; i < rays; i++) {
        const vplVec3 from = placeOf((1u << 28) + 2 * (uint64_t)i),
                      to = placeOf((1u << 28) + 2 * (uint64_t)i + 1);
        const vplRay ray = {from, vplNormalize(vplSub(to, from)), {0, 0}};
        vplHit hit;
        *sumOut += vplGeometry_ClosestHit(g, &ray, &hit) ? (double)hit.t : 0;
    }
    return cpuMs() - start;
}

static void measure(vplScene* scene, int boxes, double share, int rays)
{
    vplGeometry *before, *now;
    uint8_t* changes = calloc((size_t)boxes, 1);
    double sums[2];
    for (int i = 0; i < boxes; i++) {
        const vplMat4 transform = transformOf((uint64_t)i);
        check(vplScene_SetTransform(scene, i, &transform));
    }
    check(vplGeometry_Create(scene, &before));
    for (int i = 0; i < (int)(share * boxes); i++) {
        const int box = (int)((int64_t)i * boxes / (int)(share * boxes));
        const vplMat4 transform = transformOf((uint64_t)(boxes + i));
        check(vplScene_SetTransform(scene, box, &transform));
        changes[box] = VPL_OBJECT_MOVED;
    }
    check(vplGeometry_CreateForRaster(scene, &now));
    double start = cpuMs();
    check(vplGeometry_BuildRayTree(now));
    const double build = cpuMs() - start;
    start = cpuMs();
    (void)vplBvh_Refit(before->rayTree, now, changes); // whatever it says
    const double refit = cpuMs() - start;
    const double anew = trace(now, rays, &sums[0]);
    vplBvh* own = now->rayTree;
    now->rayTree = before->rayTree;
    const double old = trace(now, rays, &sums[1]);
    now->rayTree = own;
    printf("%7.2f %% %8.2f %8.1f %8.1f %8.0f %8.0f  x%.2f  %s\n", 100 * share,
           vplBvh_Cost(before->rayTree) / vplBvh_Cost(own), refit, build, old, anew, old / anew,
           sums[0] == sums[1] ? "same hits" : "OTHER HITS");
    fflush(stdout);
    free(changes);
    vplGeometry_Destroy(before);
    vplGeometry_Destroy(now);
}

int main(int count, char** words)
{
    static const double shares[] = {0.0005, 0.002, 0.005, 0.01, 0.02, 0.05, 0.2};
    const int boxes = count > 1 ? atoi(words[1]) : 10000, rays = count > 2 ? atoi(words[2]) : 200000;
    vplContextDef def = vplDefaultContextDef();
    vplMaterialDef material = vplDefaultMaterialDef();
    vplObjectDef object = vplDefaultObjectDef();
    vplContext* context;
    vplScene* scene;
    if (boxes < 2000 || boxes > 1000000 || rays < 1) {
        fprintf(stderr, "usage: refit [BOXES [RAYS]], 2000 boxes to a million\n");
        return 2;
    }
    check(vplContext_Create(&def, &context));
    check(vplScene_Create(context, &scene));
    check(vplScene_AddMaterial(scene, &material, NULL));
    object.type = VPL_OBJECT_BOX;
    for (int i = 0; i < boxes; i++) {
        check(vplScene_AddObject(scene, &object, NULL));
    }
    printf("boxes moved     cost    refit    build  ms; rays refitted, in the new tree, ms\n");
    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
        measure(scene, boxes, shares[i], rays);
    }
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
