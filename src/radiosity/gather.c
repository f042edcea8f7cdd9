// SPDX-License-Identifier: MIT
// Irradiance at vertices, by rays to the patches that it comes from.
// Based on: Mark Reichert, A Two-Pass Radiosity Method Driven by Lights and Viewer Position, Cornell 1992 (the final
// gather, there at pixels).
#include "base/context.h"
#include "base/rng.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/mesh.h"
#include "radiosity/side.h"

enum { CHUNK = 64, MOST_RAYS = 65536, GATHER_STREAM = 0x67617468 };

// Of the way from a vertex to the middle of what is open around it.
static const float INSET = 0x1p-5f;

typedef struct Gathering {
    const vplPatchMesh* mesh;
    const vplRgb* radiosity;
    int rays;
    uint64_t seed;
    vplRgb* out;
    int64_t* cast; // one per task
} Gathering;

static vplVec3 middleOf(const vplPatchSide* side)
{
    const float middle = 2.0f / 3; // of a cell
    const int open = __builtin_popcount(side->open);
    vplVec3 sum = {0, 0, 0};
    for (int k = 0; k < open; k++) {
        sum = vplAdd(sum, vplPatchSide_SampleCell(side, vplPatchSide_OpenCell(side, k), middle, middle));
    }
    return vplScale(1 / (float)open, sum);
}

// Among the sides around it, as much in each as it has of the vertex's angle: a vertex within a surface stays where it is,
// one at a wall leaves it. Returns one of the sides, NULL if there is none.
static const vplPatchSide* findPlace(const vplPatchMesh* mesh, int vertex, int face, vplVec3* placeOut)
{
    const struct vplPatchesAround* around = mesh->around;
    const vplVec3 at = mesh->positions[vertex];
    const vplPatchSide* any = NULL;
    vplVec3 sum = {0, 0, 0};
    float total = 0;
    for (size_t i = around->first[vertex]; i < around->first[vertex + 1]; i++) {
        const vplPatchAround* a = &around->list[i];
        if (a->side[face] >= 0) {
            const float weight = a->angle * (float)a->open[face];
            any = &mesh->sides->sides[a->side[face]];
            sum = vplAdd(sum, vplScale(weight, vplSub(middleOf(any), at)));
            total += weight;
        }
    }
    *placeOut = total > 0 ? vplAdd(at, vplScale(INSET / total, sum)) : at;
    return any;
}

static vplRgb gatherAt(const Gathering* g, const vplPatchSide* side, vplVec3 place, uint64_t index)
{
    const vplPatchSides* sides = g->mesh->sides;
    const vplGeometry* geometry = sides->patches->geometry;
    const vplHit start = vplPatchSide_HitAt(sides, side, place);
    const vplRandom4 r = vplRandomAt(g->seed, GATHER_STREAM, index);
    double sum[3] = {0, 0, 0};
    for (int i = 0; i < g->rays; i++) {
        const float u = ((float)i + 0.5f) / (float)g->rays + vplUnitFloat(r.v[0]),
                    v = vplVanDerCorput((uint32_t)i) + vplUnitFloat(r.v[1]);
        const vplVec3 way = vplSampleCosineAround(side->normal, u < 1 ? u : u - 1, v < 1 ? v : v - 1);
        const vplRay ray = vplGeometry_Leave(geometry, &start, way);
        vplHit hit;
        const int met =
            vplGeometry_ClosestHit(geometry, &ray, &hit) ? vplPatchSides_Find(sides, &hit, way) : -1;
        if (met >= 0) {
            sum[0] += (double)g->radiosity[met].r;
            sum[1] += (double)g->radiosity[met].g;
            sum[2] += (double)g->radiosity[met].b;
        }
    }
    return (vplRgb){(float)(sum[0] / g->rays), (float)(sum[1] / g->rays), (float)(sum[2] / g->rays)};
}

static void gatherChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Gathering* g = data;
    const int end = vplMini((chunk + 1) * CHUNK, g->mesh->vertexCount);
    for (int i = 2 * chunk * CHUNK; i < 2 * end; i++) {
        vplVec3 place;
        const vplPatchSide* side = findPlace(g->mesh, i / 2, i % 2, &place);
        g->out[i] = side != NULL ? gatherAt(g, side, place, (uint64_t)i) : (vplRgb){0, 0, 0};
        g->cast[chunk] += side != NULL ? g->rays : 0;
    }
}

vplResult vplPatchMesh_Gather(const vplPatchMesh* mesh, const vplRgb* radiosity, int rays, uint64_t seed,
                              vplRgb* vertexIrradianceOut, vplProgressFcn* progress, void* user,
                              int64_t* raysOut)
{
    vplContext* context = mesh->context;
    const int chunks = (mesh->vertexCount + CHUNK - 1) / CHUNK;
    if (rays < 1 || rays > MOST_RAYS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "rays is %d, must be in [1, %d]", rays, MOST_RAYS);
    }
    vplResult result =
        vplCheckRgb(context, "a side's radiosity: radiosity", radiosity, (size_t)mesh->sides->count);
    if (result != VPL_SUCCESS) {
        return result;
    }
    Gathering g = {mesh, radiosity,           rays,
                   seed, vertexIrradianceOut, vplAllocZero(context, (size_t)chunks, sizeof *g.cast)};
    if (g.cast == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    result = vplGeometry_PrepareRays(mesh->sides->patches->geometry);
    if (result == VPL_SUCCESS) {
        result = vplParallelForProgress(context, chunks, gatherChunk, &g, progress, user, 0, 1);
    }
    for (int i = 0; i < chunks && raysOut != NULL; i++) {
        *raysOut += g.cast[i];
    }
    vplFree(context, g.cast);
    return result;
}
