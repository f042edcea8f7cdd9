// SPDX-License-Identifier: MIT
// bench/scale [MILLIONS...]: a terrain of millions of triangles (default 1 and 4), written as a binary PLY file in a
// temporary folder and read again; processor times of all threads and bytes, each per triangle, of loading, of the
// geometry, of its ray tree, of 1,000 particles, of a G-buffer with its geometry and of whole renders. The sun lights it.
#include "cli/bench/measure.h"

#include <vpl/stages.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void check(vplResult result)
{
    if (result != VPL_SUCCESS) {
        fprintf(stderr, "scale: %s\n", vplResult_GetName(result));
        exit(1);
    }
}

// Hills of several sizes; the sum of waves needs no table and is the same everywhere to the digits that matter.
static float heightAt(double x, double z)
{
    double height = 0, size = 1;
    for (int octave = 0; octave < 6; octave++, size *= 2) {
        height += 0.12 / size * sin(1.7 * size * x + 0.9 * octave) * cos(1.3 * size * z + 1.3 * octave);
    }
    return (float)height;
}

static void put(FILE* file, const void* bytes, size_t size)
{
    if (fwrite(bytes, 1, size, file) != size) {
        perror("scale");
        exit(1);
    }
}

// A square of 10 x 10 m of side^2 vertices.
static void writeTerrain(const char* path, int side)
{
    FILE* file = fopen(path, "wb");
    if (file == NULL) {
        perror(path);
        exit(1);
    }
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float "
            "y\nproperty float "
            "z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n",
            side * side, 2 * (side - 1) * (side - 1));
    for (int i = 0; i < side * side; i++) {
        const double x = 10.0 * (i % side) / (side - 1) - 5, z = 10.0 * (i / side) / (side - 1) - 5;
        const float position[3] = {(float)x, heightAt(x, z), (float)z};
        put(file, position, sizeof position);
    }
    for (int i = 0; i < (side - 1) * (side - 1); i++) {
        const int a = i / (side - 1) * side + i % (side - 1);
        const int corners[2][3] = {{a, a + side, a + side + 1}, {a, a + side + 1, a + 1}};
        const unsigned char three = 3;
        for (int k = 0; k < 2; k++) {
            put(file, &three, 1);
            put(file, corners[k], sizeof corners[k]);
        }
    }
    if (fclose(file) != 0) {
        perror(path);
        exit(1);
    }
}

static void addSun(vplScene* scene)
{
    vplEmitterDef sun = vplDefaultEmitterDef();
    sun.type = VPL_EMITTER_DIRECTIONAL;
    sun.direction = (vplVec3){0.6f, -0.5f, 0.3f};
    sun.intensity = (vplRgb){3, 3, 3};
    check(vplScene_AddEmitter(scene, &sun, NULL));
}

static void row(const char* what, double ms, size_t bytes, int triangles)
{
    printf("  %-12s %9.0f ms %8.1f ns %8.1f bytes per triangle\n", what, ms, 1e6 * ms / triangles,
           (double)bytes / triangles);
    fflush(stdout);
}

static void render(const vplScene* scene, vplMethod method, vplShow show, const char* what, int triangles)
{
    vplRenderOptions options = vplDefaultRenderOptions();
    vplRenderStats stats;
    vplImage* image;
    options.method = method;
    options.output.width = 640;
    options.output.height = 360;
    options.output.show = show;
    options.particles.count = 1000;
    const double start = cpuMs();
    check(vplRender(scene, &options, &image, &stats));
    row(what, cpuMs() - start, stats.peakBytes, triangles);
    vplImage_Destroy(image);
}

// A thousand particles of the sun.
static void simulate(const vplGeometry* geometry, const vplScene* scene, int triangles)
{
    vplParticleDef def = vplDefaultParticleDef();
    vplLightSet* set;
    def.particleCount = 1000;
    const double start = cpuMs();
    check(vplSimulateParticles(geometry, vplScene_GetEmitter(scene, 0), 1, &def, &set));
    row("particles", cpuMs() - start, 0, triangles);
    vplLightSet_Destroy(set);
}

static void measure(double millions)
{
    vplContextDef def = vplDefaultContextDef();
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    char path[64];
    const int side = (int)sqrt(0.5e6 * millions) + 1, triangles = 2 * (side - 1) * (side - 1);
    check(vplContext_Create(&def, &context));
    snprintf(path, sizeof path, "/tmp/vpl-scale-%d.ply", (int)getpid());
    double start = cpuMs();
    writeTerrain(path, side);
    printf("%d triangles (%.1f s to write the file)\n", triangles, 1e-3 * (cpuMs() - start));
    start = cpuMs();
    vplModelSceneDef alone = vplDefaultModelSceneDef();
    alone.ground = false;
    alone.unlit = true;
    check(vplScene_LoadFor(context, path, &alone, &scene));
    row("loading", cpuMs() - start, vplContext_GetBytes(context), triangles);
    remove(path);
    addSun(scene);
    size_t held = vplContext_GetBytes(context);
    start = cpuMs();
    check(vplGeometry_CreateForRaster(scene, &geometry));
    row("geometry", cpuMs() - start, vplContext_GetBytes(context) - held, triangles);
    held = vplContext_GetBytes(context);
    vplContext_ResetPeakBytes(context);
    start = cpuMs();
    check(vplGeometry_BuildRayTree(geometry));
    row("ray tree", cpuMs() - start, vplContext_GetBytes(context) - held, triangles);
    row("  its peak", 0, vplContext_GetPeakBytes(context) - held, triangles);
    simulate(geometry, scene, triangles);
    vplGeometry_Destroy(geometry);
    render(scene, VPL_METHOD_DIRECT, VPL_SHOW_DEPTH, "G-buffer", triangles);
    render(scene, VPL_METHOD_DIRECT, VPL_SHOW_PICTURE, "direct", triangles);
    render(scene, VPL_METHOD_KELLER, VPL_SHOW_PICTURE, "keller", triangles);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
}

int main(int count, char** words)
{
    static const double usual[] = {1, 4};
    for (int i = 0; i < (count > 1 ? count - 1 : 2); i++) {
        const double millions = count > 1 ? atof(words[i + 1]) : usual[i];
        if (!(millions > 0 && millions <= 64)) {
            fprintf(stderr, "usage: scale [MILLIONS...], up to 64\n");
            return 2;
        }
        measure(millions);
    }
    return 0;
}
