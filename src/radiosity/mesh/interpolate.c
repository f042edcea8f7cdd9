// SPDX-License-Identifier: MIT
// Turns one value per side of a patch into values at vertices.
//
// Interpolation is based on: Hemgren, Radiosity in Realtime Rendering, 4 ("averaging the color of each vertex
// based on the color of adjacent patches"). Departs: weights, since otherwise a patch counts for more if it
// is cut finer than its neighbours; and sides that light does not reach are ignored, where Hemgren's vertices
// under boxes darken the floor beside them.
//
// Sharpening is based on: P. H. van Cittert, Zum Einfluss der Spaltbreite auf die Intensitaetsverteilung in
// Spektrallinien II, Zeitschrift fuer Physik 69, 1931. Means at vertices blur light: a patch in a dark corner
// takes on its neighbours' light. Each round compares the mean of the interpolated values over each side with
// the side's own value, and adds the interpolated differences.
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/mesh/patch_mesh.h"

#include <string.h>

enum { CHUNK = 1024 }; // vertices per task

typedef struct Means {
    const vplPatchMesh* mesh;
    vplVertexWeight weight;
    const vplRgb* values;
    vplRgb* out;
} Means;

static double weightOf(const Means* m, const vplPatchAround* around, int face)
{
    if (m->weight == VPL_VERTEX_WEIGHT_EQUAL) {
        return 1;
    }
    if (m->weight == VPL_VERTEX_WEIGHT_AREA) {
        return (double)m->mesh->sides->sides[around->side[face]].area;
    }
    return (double)around->angle * (double)around->open[face];
}

// Sums in double, in the order of patches; the mean of equal values is that value.
static vplRgb meanAt(const Means* m, int vertex, int face)
{
    const struct vplPatchesAround* around = m->mesh->around;
    double sum[3] = {0, 0, 0}, total = 0;
    for (size_t i = around->first[vertex]; i < around->first[vertex + 1]; i++) {
        const int side = around->list[i].side[face];
        if (side >= 0) {
            const double weight = weightOf(m, &around->list[i], face);
            vplAddRgb(sum, weight, m->values[side]);
            total += weight;
        }
    }
    return total > 0 ? vplDivideRgb(sum, total) : (vplRgb){0, 0, 0};
}

static void interpolateChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Means* m = data;
    const int end = vplMini((chunk + 1) * CHUNK, m->mesh->vertexCount);
    for (int v = chunk * CHUNK; v < end; v++) {
        m->out[2 * (size_t)v] = meanAt(m, v, 0);
        m->out[2 * (size_t)v + 1] = meanAt(m, v, 1);
    }
}

vplResult vplPatchMesh_Interpolate(const vplPatchMesh* mesh, vplVertexWeight weight, const vplRgb* values,
                                   vplRgb* vertexValuesOut)
{
    REQUIRE(CONTEXT_OF(mesh), mesh, values, vertexValuesOut);
    vplContext* context = mesh->context;
    if ((int)weight < 0 || weight > VPL_VERTEX_WEIGHT_EQUAL) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "the weight of vertices is %d, must be a vplVertexWeight", (int)weight);
    }
    TRY(vplCheckRgb(context, "values", values, (size_t)mesh->sides->count));
    Means means = {mesh, weight, values, vertexValuesOut};
    return vplParallelForAsking(context, (mesh->vertexCount + CHUNK - 1) / CHUNK, interpolateChunk, &means);
}

// ---- sharpening

typedef struct Sharpening {
    const vplPatchMesh* mesh;
    const vplRgb* values;
    vplRgb* missing;   // one per side
    double (*sums)[4]; // one per side: r, g, b times area, and the area
    vplRgb* change;    // [vertex][front, back]
} Sharpening;

// Adds the values over one face, times its area, to the sum of its side.
static void addFace(const Sharpening* s, const vplMeshFace* face, const vplRgb* vertexValues)
{
    const double area = vplCrossLength(face->cross);
    double* sum = s->sums[face->side];
    for (int k = 0; k < 3; k++) {
        vplAddRgb(sum, area / 3, vertexValues[face->at[k]]);
    }
    sum[3] += area;
}

// Finds what interpolation misses of each side's value. Nothing for sides with closed cells: their value is
// the mean of a part that interpolation does not know.
static void findMissing(const Sharpening* s, const vplRgb* vertexValues)
{
    const vplPatchSides* sides = s->mesh->sides;
    memset(s->sums, 0, (size_t)sides->count * sizeof *s->sums);
    for (int i = 0; i < 2 * s->mesh->triangleCount; i++) {
        vplMeshFace face;
        if (vplPatchMesh_GetFace(s->mesh, i / 2, i % 2, &face)) {
            addFace(s, &face, vertexValues);
        }
    }
    for (int i = 0; i < sides->count; i++) {
        const double* sum = s->sums[i];
        const bool known = sum[3] > 0 && sides->sides[i].open == VPL_ALL_CELLS &&
                           !vplPatches_IsGroup(sides->patches, sides->sides[i].patch);
        const vplRgb v = s->values[i];
        s->missing[i] =
            known ? (vplRgb){(float)((double)v.r - sum[0] / sum[3]), (float)((double)v.g - sum[1] / sum[3]),
                             (float)((double)v.b - sum[2] / sum[3])}
                  : (vplRgb){0, 0, 0};
    }
}

static vplResult sharpen(vplArena* scratch, Sharpening* s, vplVertexWeight weight, int rounds,
                         vplRgb* vertexValues)
{
    const size_t sides = (size_t)s->mesh->sides->count, vertices = 2 * (size_t)s->mesh->vertexCount;
    s->missing = vplArena_Alloc(scratch, sides, sizeof *s->missing);
    s->sums = vplArena_Alloc(scratch, sides, sizeof *s->sums);
    s->change = vplArena_Alloc(scratch, vertices, sizeof *s->change);
    TRY(vplArena_Check(scratch));
    for (int round = 0; round < rounds; round++) {
        findMissing(s, vertexValues);
        TRY(vplPatchMesh_Interpolate(s->mesh, weight, s->missing, s->change));
        for (size_t i = 0; i < vertices; i++) {
            vplRgb* v = &vertexValues[i];
            v->r = vplMaxf(v->r + s->change[i].r, 0);
            v->g = vplMaxf(v->g + s->change[i].g, 0);
            v->b = vplMaxf(v->b + s->change[i].b, 0);
        }
    }
    return VPL_SUCCESS;
}

vplResult vplPatchMesh_Sharpen(const vplPatchMesh* mesh, vplVertexWeight weight, const vplRgb* values,
                               int rounds, vplRgb* vertexValues)
{
    REQUIRE(CONTEXT_OF(mesh), mesh, values, vertexValues);
    Sharpening s = {.mesh = mesh, .values = values};
    vplArena* scratch = vplArena_Create(mesh->context);
    const vplResult result = sharpen(scratch, &s, weight, rounds, vertexValues);
    vplArena_Destroy(scratch);
    return result;
}
