// SPDX-License-Identifier: MIT
// Measures time and memory of reading scenes: build/bench/load FILE... Times are processor time, the best of
// fifteen.
#include "cli/bench/measure.h"

#include <vpl/stages.h>

#include <stdio.h>
#include <sys/stat.h>

enum { RUNS = 15 };

typedef struct Load {
    double milliseconds;
    size_t peak, mesh; // bytes: the most allocated at once while reading, and the meshes' arrays
    long long vertices, triangles;
} Load;

static void countMeshes(const vplScene* scene, Load* load)
{
    for (int i = 0; i < vplScene_GetMeshCount(scene); i++) {
        const vplMeshDef* mesh = vplScene_GetMesh(scene, i);
        size_t perVertex = sizeof *mesh->positions + (mesh->normals ? sizeof *mesh->normals : 0);
        size_t perTriangle = 3 * sizeof *mesh->indices + sizeof *mesh->materials;
        load->vertices += mesh->vertexCount;
        load->triangles += mesh->triangleCount;
        load->mesh += (size_t)mesh->vertexCount * perVertex + (size_t)mesh->triangleCount * perTriangle;
    }
}

static bool loadOnce(const char* path, Load* load)
{
    vplContext* context;
    vplScene* scene = NULL;
    if (vplContext_Create(NULL, &context) != VPL_SUCCESS) {
        return false;
    }
    double start = cpuMs();
    bool good = vplScene_Load(context, path, &scene) == VPL_SUCCESS;
    *load = (Load){cpuMs() - start, vplContext_GetPeakBytes(context), 0, 0, 0};
    if (good) {
        countMeshes(scene, load);
    }
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return good;
}

int main(int count, char** words)
{
    printf("%9s %9s %9s %8s %9s %9s  %s\n", "text MB", "triangles", "vertices", "ms", "mesh MB", "peak MB",
           "file");
    for (int i = 1; i < count; i++) {
        Load best = {1e300, 0, 0, 0, 0};
        struct stat info;
        for (int run = 0; run < RUNS; run++) {
            Load load;
            if (stat(words[i], &info) != 0 || !loadOnce(words[i], &load)) {
                fprintf(stderr, "%s cannot be loaded\n", words[i]);
                return 1;
            }
            best = load.milliseconds < best.milliseconds ? load : best;
        }
        printf("%9.2f %9lld %9lld %8.1f %9.2f %9.2f  %s\n", (double)info.st_size * 1e-6, best.triangles,
               best.vertices, best.milliseconds, (double)best.mesh * 1e-6, (double)best.peak * 1e-6,
               words[i]);
    }
    return 0;
}
