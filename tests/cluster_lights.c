// SPDX-License-Identifier: MIT
#include "cluster_lights.h"

void beginLights(Lights* l, vplContext* context, int count)
{
    assert_true(count <= MOST_LIGHTS);
    memset(l, 0, sizeof *l);
    l->set = (vplLightSet){
        .lights = l->lights, .lightCount = count, .particleCount = count > 0 ? count : 1, .context = context};
    for (int i = 0; i < count; i++) {
        l->lights[i].weight = 1;
        l->lights[i].light = (vplRgb){(float)count, (float)count / 2, 0};
        l->lights[i].normal = (vplVec3){0, 1, 0};
    }
}

vplLightClusters* find(const vplLightSet* set, const vplClusterDef* def)
{
    vplLightClusters* clusters = NULL;
    if (vplFindClusters(set, def, &clusters) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return clusters;
}

vplClusterMetric metricOf(const char* name)
{
    static const char* const names[] = {"one_minus", "printed", "one_minus_clamped", "angle"};
    for (int i = 0; i < 4; i++) {
        if (strcmp(name, names[i]) == 0) {
            return (vplClusterMetric)i;
        }
    }
    fail_msg("metric %s", name);
    return VPL_CLUSTER_ONE_MINUS;
}

void fillRoom(Lights* l, uint64_t room)
{
    const float size[3] = {3 + 2 * (float)uniformAt(room, 0), 2 + 2 * (float)uniformAt(room, 1),
                           4 + 2 * (float)uniformAt(room, 2)};
    for (int i = 0; i < l->set.lightCount; i++) {
        const uint64_t at = 16 + 4 * (uint64_t)i;
        const int wall = (int)(6 * uniformAt(room, at));
        float p[3], n[3] = {0, 0, 0};
        for (int k = 0; k < 3; k++) {
            p[k] = (float)uniformAt(room, at + 1 + (uint64_t)k) * size[k];
        }
        p[wall / 2] = wall % 2 ? size[wall / 2] : 0;
        n[wall / 2] = wall % 2 ? -1 : 1;
        l->lights[i].position = (vplVec3){p[0], p[1], p[2]};
        l->lights[i].normal = (vplVec3){n[0], n[1], n[2]};
    }
}

void assertSame(const vplLightClusters* a, const vplLightClusters* b)
{
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->lightCount, b->lightCount);
    assert_memory_equal(a->of, b->of, (size_t)a->lightCount * sizeof *a->of);
    for (int j = 0; j < a->count; j++) {
        const vplLightCluster *x = &a->clusters[j], *y = &b->clusters[j];
        assert_memory_equal(x, y, offsetof(vplLightCluster, lightCount)); // compares the floats
        assert_true(x->lightCount == y->lightCount && x->nearest == y->nearest && x->flat == y->flat);
    }
}
