// SPDX-License-Identifier: MIT
// Compares two initializations of k-means, farthest-point seeds and every n/C-th light, by the final sum of
// distances from lights to their clusters and by processor time. `bench/clusters SCENE...`: 256 first hits of
// each scene; then the mean over 200 random rooms.
#include "bench.h"

#include <math.h>
#include <string.h>

enum { SIZES = 4, LIGHTS = 256, ROOMS = 200 };
static const int sizes[SIZES] = {4, 8, 16, 32};

typedef struct Outcome {
    double sum, iterations, us;
} Outcome;

static double sumOf(const vplLightSet* set, const vplLightClusters* clusters, const vplClusterDef* def)
{
    double sum = 0;
    for (int i = 0; i < set->lightCount; i++) {
        const vplVirtualLight* v = &set->lights[i];
        const vplLightCluster* c = &clusters->clusters[clusters->of[i]];
        sum += def->w1 * (double)vplLength(vplSub(v->position, c->position)) +
               def->w2 * (1 - (double)vplDot(v->normal, c->normal));
    }
    return sum;
}

static void addRun(const vplLightSet* set, int count, const int* seeds, Outcome* outcome)
{
    vplClusterDef def = vplDefaultClusterDef();
    def.count = count;
    def.seeds = seeds;
    vplLightClusters* clusters;
    const double start = cpuMs();
    check(vplFindClusters(set, &def, &clusters));
    outcome->us += 1e3 * (cpuMs() - start);
    outcome->sum += sumOf(set, clusters, &def);
    outcome->iterations += clusters->iterations;
    vplLightClusters_Destroy(clusters);
}

// Runs k-means with both initializations: outcomes[0] with every n/C-th light, outcomes[1] with the default.
static void addBoth(const vplLightSet* set, int count, Outcome outcomes[2])
{
    int seeds[LIGHTS];
    for (int j = 0; j < count; j++) {
        seeds[j] = (int)((int64_t)j * set->lightCount / count);
    }
    addRun(set, count, seeds, &outcomes[0]);
    addRun(set, count, NULL, &outcomes[1]);
}

static void print(const char* name, int lights, Outcome outcomes[SIZES][2], int sets)
{
    for (int k = 0; k < SIZES; k++) {
        const Outcome *plain = &outcomes[k][0], *ours = &outcomes[k][1];
        printf("%-40s %6d %8d %10.2f %10.2f %6.2f %6.1f %6.1f %6.0f %6.0f\n", name, lights, sizes[k],
               plain->sum / sets, ours->sum / sets, ours->sum / plain->sum, plain->iterations / sets,
               ours->iterations / sets, plain->us / sets, ours->us / sets);
    }
}

static void measureScene(const char* path)
{
    vplContext* context;
    vplScene* scene;
    vplLightSet* set;
    openScene(path, 1, VPL_ISA_AUTO, &context, &scene);
    vplRenderOptions o = plainOptions();
    o.particles.placement = VPL_PLACEMENT_RSM;
    o.particles.sampler = VPL_SAMPLER_HAMMERSLEY;
    o.particles.count = LIGHTS;
    o.particles.reflectivity = 0;
    check(vplMakeLights(scene, &o, &set));
    Outcome outcomes[SIZES][2] = {{{0, 0, 0}}};
    for (int k = 0; k < SIZES; k++) {
        addBoth(set, sizes[k], outcomes[k]);
    }
    print(path, set->lightCount, outcomes, 1);
    vplLightSet_Destroy(set);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
}

static float unit(uint64_t room, uint64_t index)
{
    return vplUnitFloat(vplRandomAt(room, 0, index).v[0]);
}

// Places lights at random on the walls of a box of 2 to 10 metres.
static void fillRoom(uint64_t room, vplVirtualLight* lights)
{
    const float size[3] = {2 + 8 * unit(room, 0), 2 + 4 * unit(room, 1), 2 + 8 * unit(room, 2)};
    for (uint64_t i = 0; i < LIGHTS; i++) {
        const int wall = (int)(6 * unit(room, 8 + 4 * i));
        float p[3], n[3] = {0, 0, 0};
        for (uint64_t k = 0; k < 3; k++) {
            p[k] = size[k] * unit(room, 9 + 4 * i + k);
        }
        p[wall / 2] = wall % 2 ? size[wall / 2] : 0;
        n[wall / 2] = wall % 2 ? -1 : 1;
        lights[i] = (vplVirtualLight){
            .position = {p[0], p[1], p[2]}, .normal = {n[0], n[1], n[2]}, .light = {1, 1, 1}, .weight = 1};
    }
}

static void measureRooms(void)
{
    vplContext* context;
    check(vplContext_Create(NULL, &context));
    Outcome outcomes[SIZES][2] = {{{0, 0, 0}}};
    for (uint64_t room = 1; room <= ROOMS; room++) {
        static vplVirtualLight lights[LIGHTS];
        fillRoom(room, lights);
        const vplLightSet set = {
            .lights = lights, .lightCount = LIGHTS, .particleCount = LIGHTS, .context = context};
        for (int k = 0; k < SIZES; k++) {
            addBoth(&set, sizes[k], outcomes[k]);
        }
    }
    print("random rooms", LIGHTS, outcomes, ROOMS);
    vplContext_Destroy(context);
}

int main(int count, char** words)
{
    printf("%-40s %6s %8s %10s %10s %6s %13s %13s\n", "scene", "lights", "clusters", "n/C-th", "far apart",
           "ratio", "iterations", "us");
    for (int i = 1; i < count; i++) {
        measureScene(words[i]);
    }
    measureRooms();
    return 0;
}
