// SPDX-License-Identifier: MIT
// Gathers irradiance at vertices by rays to the sides that it comes from.
// Based on: Mark Reichert, A Two-Pass Radiosity Method Driven by Lights and Viewer Position, Cornell 1992
// (the final gather, which he does at pixels).
#include "base/rng.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/mesh/patch_mesh.h"

enum { CHUNK = 64, MOST_RAYS = 65536, GATHER_STREAM = 0x67617468 };

// Rays start this fraction of the way from the vertex to the centroid of the open cells at it.
static const float INSET = 0x1p-5f;

// Rays at groups start this fraction of the way to a triangle's centroid. Long triangles end in dark corners, which say
// nothing of their middle; the mean over a triangle on which light changes evenly stays the same.
static const float GROUP_INSET = 0.5f;

typedef struct Gathering {
    const vplPatchMesh* mesh;
    const vplVertexGather* def;
    vplRgb* out;
    int64_t* cast; // one per task
} Gathering;

// The centroid of a side's open cells or, of a group, of a triangle.
static vplVec3 openCentroid(const vplPatchSides* sides, const vplPatchAround* around, int face)
{
    const vplPatchSide* side = &sides->sides[around->side[face]];
    if (vplPatches_IsGroup(sides->patches, side->patch)) {
        const vplTriangleCorners c = vplGeometry_Corners(sides->patches->geometry, around->triangle);
        return vplScale(1 / 3.0f, vplAdd(c.corner[0], vplAdd(c.corner[1], c.corner[2])));
    }
    const int open = __builtin_popcount(side->open);
    vplVec3 sum = {0, 0, 0};
    for (int k = 0; k < open; k++) {
        sum = vplAdd(sum, vplPatchSide_CellCentre(side, vplPatchSide_OpenCell(side, k)));
    }
    return vplScale(1 / (float)open, sum);
}

// The start of rays: the vertex, moved towards the sides at it, weighted by their angles. A vertex inside a
// surface stays in place, one at a wall moves away from it. The normal is that of one of the sides or, where some are
// groups, the vertex's. False if there is no side.
typedef struct Start {
    vplSidePoint from;
    bool group;
} Start;

static bool findStart(const vplPatchMesh* mesh, int vertex, int face, Start* startOut)
{
    const struct vplPatchesAround* around = mesh->around;
    const vplVec3 at = mesh->positions[vertex];
    const vplPatchAround* any = NULL;
    bool group = false;
    vplVec3 sum = {0, 0, 0};
    float total = 0;
    for (size_t i = around->first[vertex]; i < around->first[vertex + 1]; i++) {
        const vplPatchAround* a = &around->list[i];
        if (a->side[face] >= 0) {
            const float weight = a->angle * (float)a->open[face];
            any = a;
            group = group || vplPatches_IsGroup(mesh->sides->patches, a->patch);
            sum = vplAdd(sum, vplScale(weight, vplSub(openCentroid(mesh->sides, a, face), at)));
            total += weight;
        }
    }
    if (any == NULL) {
        return false;
    }
    const vplVec3 normal = mesh->normals[vertex];
    startOut->group = group;
    // A mean over triangles that are not in one plane would be inside of a ball.
    const vplVec3 way = group ? vplSub(openCentroid(mesh->sides, any, face), at) : sum;
    startOut->from.at = total > 0 ? vplAdd(at, vplScale(group ? GROUP_INSET : INSET / total, way)) : at;
    startOut->from.normal = !group      ? mesh->sides->sides[any->side[face]].normal
                            : face == 0 ? normal
                                        : vplNegate(normal);
    startOut->from.triangle = any->triangle;
    return true;
}

// Rays do not go into the triangle that they leave, as a vertex's normal would have some do.
static vplRgb gatherAt(const Gathering* g, const Start* start, uint64_t index)
{
    const vplSidePoint* from = &start->from;
    const vplVec3 front = g->mesh->sides->patches->geometry->normals[from->triangle],
                  up = index % 2 == 0 ? front : vplNegate(front);
    const vplPatchSides* sides = g->mesh->sides;
    const vplRandom4 r = vplRandomAt(g->def->seed, GATHER_STREAM, index);
    const int rays = g->def->rays;
    int count = 0;
    double sum[3] = {0, 0, 0};
    for (int i = 0; i < rays; i++) {
        const float u = ((float)i + 0.5f) / (float)rays + vplUnitFloat(r.v[0]),
                    v = vplVanDerCorput((uint32_t)i) + vplUnitFloat(r.v[1]);
        const vplVec3 way = vplSampleCosineAround(from->normal, u < 1 ? u : u - 1, v < 1 ? v : v - 1);
        if (start->group && !(vplDot(way, up) > 0)) {
            continue;
        }
        count++;
        const vplRay ray = vplPatchSides_Leave(sides, from, way);
        const int met = vplPatchSides_Hit(sides, &ray);
        if (met >= 0) {
            vplAddRgb(sum, 1, g->def->radiosity[met]);
        }
    }
    return vplDivideRgb(sum, count > 0 ? count : 1);
}

static void gatherChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Gathering* g = data;
    const int end = vplMini((chunk + 1) * CHUNK, g->mesh->vertexCount);
    for (int i = 2 * chunk * CHUNK; i < 2 * end; i++) {
        Start start;
        if (g->def->only != NULL && !g->def->only[i]) {
            continue;
        }
        const bool lit = findStart(g->mesh, i / 2, i % 2, &start);
        g->out[i] = lit ? gatherAt(g, &start, (uint64_t)i) : (vplRgb){0, 0, 0};
        g->cast[chunk] += lit ? g->def->rays : 0;
    }
}

vplResult vplPatchMesh_Gather(const vplPatchMesh* mesh, const vplVertexGather* gather,
                              vplRgb* vertexIrradianceOut, int64_t* raysOut)
{
    REQUIRE(CONTEXT_OF(mesh), mesh, gather, vertexIrradianceOut);
    vplContext* context = mesh->context;
    const int chunks = (mesh->vertexCount + CHUNK - 1) / CHUNK;
    if (gather->rays < 1 || gather->rays > MOST_RAYS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "rays is %d, must be in [1, %d]", gather->rays,
                       MOST_RAYS);
    }
    TRY(vplCheckRgb(context, "vplVertexGather.radiosity", gather->radiosity, (size_t)mesh->sides->count));
    Gathering g = {mesh, gather, vertexIrradianceOut, vplAllocZero(context, (size_t)chunks, sizeof *g.cast)};
    if (g.cast == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const vplResult result = vplParallelForProgress(
        context, chunks, gatherChunk, &g, (vplProgressRange){gather->progress, gather->progressUser, 0, 1});
    for (int i = 0; i < chunks && raysOut != NULL; i++) {
        *raysOut += g.cast[i];
    }
    vplFree(context, g.cast);
    return result;
}
