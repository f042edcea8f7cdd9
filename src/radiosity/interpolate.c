// SPDX-License-Identifier: MIT
// From one value per side of a patch to values at vertices.
// Based on: Hemgren, Radiosity in Realtime Rendering, 4 ("averaging the color of each vertex based on the color of
// adjacent patches"). Departs: weights, without which a patch that was cut finer than its neighbours counts for more;
// and of what no light reaches nothing counts, where the report's vertices under boxes darken the floor beside them.
#include "base/context.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/mesh.h"

enum { CHUNK = 1024 }; // vertices per task

typedef struct Means {
    const vplPatchMesh* mesh;
    vplVertexWeight weight;
    const vplRgb* values;
    vplRgb* out;
} Means;

vplResult vplCheckRgb(const vplContext* context, const char* name, const vplRgb* values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const vplRgb v = values[i];
        if (!(isfinite(v.r) && isfinite(v.g) && isfinite(v.b))) {
            return vplFail(context, VPL_INVALID_ARGUMENT, "%s[%zu] is (%g, %g, %g), must be finite", name, i,
                           (double)v.r, (double)v.g, (double)v.b);
        }
    }
    return VPL_SUCCESS;
}

static double weightOf(const Means* m, const vplPatchAround* around, int face)
{
    if (m->weight == VPL_VERTEX_WEIGHT_EQUAL) {
        return 1;
    }
    if (m->weight == VPL_VERTEX_WEIGHT_AREA) {
        return (double)m->mesh->sides->sides[around->side[face]].area; // of open cells
    }
    return (double)around->angle * (double)around->open[face];
}

// In double, and in the order of patches: the mean of equal values is that value.
static vplRgb meanAt(const Means* m, int vertex, int face)
{
    const struct vplPatchesAround* around = m->mesh->around;
    double sum[3] = {0, 0, 0}, total = 0;
    for (size_t i = around->first[vertex]; i < around->first[vertex + 1]; i++) {
        const int side = around->list[i].side[face];
        if (side >= 0) {
            const double weight = weightOf(m, &around->list[i], face);
            const vplRgb value = m->values[side];
            sum[0] += weight * (double)value.r;
            sum[1] += weight * (double)value.g;
            sum[2] += weight * (double)value.b;
            total += weight;
        }
    }
    if (!(total > 0)) {
        return (vplRgb){0, 0, 0};
    }
    return (vplRgb){(float)(sum[0] / total), (float)(sum[1] / total), (float)(sum[2] / total)};
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
    vplContext* context = mesh->context;
    if ((int)weight < 0 || weight > VPL_VERTEX_WEIGHT_EQUAL) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "the weight of vertices is %d, must be a vplVertexWeight", (int)weight);
    }
    const vplResult result =
        vplCheckRgb(context, "a side's value: values", values, (size_t)mesh->sides->count);
    if (result != VPL_SUCCESS) {
        return result;
    }
    Means means = {mesh, weight, values, vertexValuesOut};
    vplParallelFor(context, (mesh->vertexCount + CHUNK - 1) / CHUNK, interpolateChunk, &means);
    return VPL_SUCCESS;
}
