// SPDX-License-Identifier: MIT
// Measures the cost of patches after the light is known: building the mesh, averaging at its vertices, and
// drawing it, compared with a deferred picture of the same view that only shows depth. Figures are medians of
// milliseconds of processor time, on one thread unless --threads is given.
//   patch_mesh [--threads N] SCENE...
#include "bench.h"

#include <string.h>

enum { RUNS = 15, WIDTH = 1280, HEIGHT = 720 };

// Makes both sides of all patches lit.
static vplPatchSides* fillSides(const vplPatches* p)
{
    const int count = 2 * p->patchCount;
    vplPatchSides* sides = calloc(1, sizeof *sides);
    vplPatchSide* list = calloc((size_t)count, sizeof *list);
    int* of = calloc((size_t)count, sizeof *of);
    for (int i = 0; i < count; i++) {
        list[i] =
            (vplPatchSide){.patch = i / 2, .open = 0xffff, .area = 1, .reflectance = {0.5f, 0.5f, 0.5f}};
        of[i] = i;
    }
    *sides =
        (vplPatchSides){.patches = p, .sides = list, .count = count, .ofPatch = of, .context = p->context};
    return sides;
}

typedef struct PhaseTimes {
    double mesh[RUNS], means[RUNS], clip[RUNS], flat[RUNS], smooth[RUNS], depth[RUNS];
} PhaseTimes;

static void drawOnce(const vplPatchDraw* draw, float (*clip)[4], vplImage* image)
{
    check(vplDrawPatches(draw, (const float(*)[4])clip, NULL, NULL, image, NULL));
}

static void runOnce(const vplPatchSides* sides, const vplView* view, vplImage* image, PhaseTimes* t, int run)
{
    vplPatchMesh* mesh;
    double start = cpuMs();
    check(vplPatchMesh_Create(sides, &mesh));
    t->mesh[run] = cpuMs() - start;
    vplRgb* values = calloc((size_t)sides->count, sizeof *values);
    vplRgb* corners = calloc(2 * (size_t)mesh->vertexCount, sizeof *corners);
    float(*clip)[4] = calloc((size_t)mesh->vertexCount, sizeof *clip);
    start = cpuMs();
    check(vplPatchMesh_Interpolate(mesh, VPL_VERTEX_WEIGHT_ANGLE, values, corners));
    t->means[run] = cpuMs() - start;
    start = cpuMs();
    vplView_ToClip(view, mesh->positions, mesh->vertexCount, clip);
    t->clip[run] = cpuMs() - start;
    vplPatchDraw draw = {.mesh = mesh, .values = values, .reflect = true};
    start = cpuMs();
    drawOnce(&draw, clip, image);
    t->flat[run] = cpuMs() - start;
    draw.vertexValues = corners;
    start = cpuMs();
    drawOnce(&draw, clip, image);
    t->smooth[run] = cpuMs() - start;
    vplShadeDef def = vplDefaultShadeDef();
    def.output = VPL_OUTPUT_DEPTH;
    start = cpuMs();
    check(vplShadeView(sides->patches->geometry, view, &def, image, NULL));
    t->depth[run] = cpuMs() - start;
    free(values);
    free(corners);
    free(clip);
    vplPatchMesh_Destroy(mesh);
}

// Makes patches of about one size; or, if uneven, an eighth as many that are bisected at random in three
// rounds, so that neighbours split edges.
static vplPatches* divide(const vplGeometry* g, int count, bool uneven)
{
    vplPatchDef def = vplDefaultPatchDef();
    vplPatches* patches;
    def.count = uneven ? count / 8 : count;
    check(vplPatches_Create(g, &def, &patches));
    for (int round = 0; round < 3 && uneven; round++) {
        vplPatches* finer;
        float* priorities = calloc((size_t)patches->patchCount, sizeof *priorities);
        for (int i = 0; i < patches->patchCount; i++) {
            priorities[i] = (float)vplRandomAt(1, (uint32_t)round, (uint64_t)i).v[0] + 1;
        }
        check(vplPatches_Refine(patches, priorities, patches->patchCount * 2 - patches->patchCount / 5,
                                &finer));
        vplPatches_Destroy(patches);
        free(priorities);
        patches = finer;
    }
    return patches;
}

static void measure(const vplGeometry* g, const vplView* view, int count, bool uneven)
{
    vplImage* image;
    vplPatchMesh* mesh;
    static PhaseTimes t;
    vplPatches* patches = divide(g, count, uneven);
    check(vplImage_Create(g->context, WIDTH, HEIGHT, &image));
    vplPatchSides* sides = fillSides(patches);
    for (int run = 0; run < RUNS; run++) {
        runOnce(sides, view, image, &t, run);
    }
    check(vplPatchMesh_Create(sides, &mesh));
    printf("%7d %8d %8d %7d %7.2f %7.2f %7.2f %7.2f %7.2f %7.2f\n", patches->patchCount, mesh->vertexCount,
           mesh->triangleCount, mesh->hangingVertices, medianOf(t.mesh, RUNS), medianOf(t.means, RUNS),
           medianOf(t.clip, RUNS), medianOf(t.flat, RUNS), medianOf(t.smooth, RUNS), medianOf(t.depth, RUNS));
    vplPatchMesh_Destroy(mesh);
    free((void*)sides->sides);
    free((void*)sides->ofPatch);
    free(sides);
    vplImage_Destroy(image);
    vplPatches_Destroy(patches);
}

static void measureScene(const char* path, int threads)
{
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    openScene(path, threads, VPL_ISA_AUTO, &context, &scene);
    const vplView view = vplView_Create(vplScene_GetCamera(scene, 0), WIDTH, HEIGHT);
    check(vplGeometry_Create(scene, &geometry));
    printf("%s, %d x %d, %d threads\n", path, WIDTH, HEIGHT, threads);
    printf(
        "patches vertices triangles hanging    mesh   means    clip    flat  smooth   depth of deferred\n");
    for (int count = 784; count <= 51200; count *= 4) {
        measure(geometry, &view, count, false);
        measure(geometry, &view, count, true);
    }
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
}

int main(int argCount, char** args)
{
    int threads = 1;
    for (int i = 1; i < argCount; i++) {
        if (strcmp(args[i], "--threads") == 0 && i + 1 < argCount) {
            threads = atoi(args[++i]);
        } else {
            measureScene(args[i], threads);
        }
    }
    return 0;
}
