// SPDX-License-Identifier: MIT
// Refinement priorities: where another bisection lowers the error most.
// Based on: Hemgren, Radiosity in Realtime Rendering, 4 and 6, who asks for "a more dynamic approach to
// subdividing the surfaces": smaller patches in corners, at contacts and at shadow boundaries.
#include "math/vec.h"
#include "radiosity/mesh/patch_mesh.h"

#include <float.h>

enum { PRIORITY_COOKIE = 0x56504ca2 };

vplPatchPriorityDef vplDefaultPatchPriorityDef(void)
{
    return (vplPatchPriorityDef){.cookie = PRIORITY_COOKIE};
}

// The weight of the squared range over the corners, which also shows at edges of light that bend little, where
// the squared bend counts 1. Weights from 0.05 to 0.2 change the squared error by less than a tenth
// (bench/radiosity_error).
static const double GRADIENT = 0.1;

// Errors are relative to irradiance plus this fraction of the mean irradiance. From 0.05 to 0.3 the error is
// the same.
static const double FLOOR = 0.1;

// Vertex values of one side of a patch; sums are integrals over its area.
typedef struct VertexSums {
    double low[3], high[3], sum[3];
    double direct, directSquare;
    double area;
} VertexSums;

static void addFace(const vplPatchPriorityDef* def, const vplMeshFace* face, VertexSums* c)
{
    const float twice = (float)vplCrossLength(face->cross);
    const double area = 0.5 * (double)twice;
    double direct = 0, square = 0;
    for (int k = 0; k < 3; k++) {
        const vplRgb v = def->vertexIrradiance[face->at[k]];
        const double values[3] = {(double)v.r, (double)v.g, (double)v.b};
        for (int channel = 0; channel < 3; channel++) {
            c->low[channel] = fmin(c->low[channel], values[channel]);
            c->high[channel] = fmax(c->high[channel], values[channel]);
            c->sum[channel] += area * values[channel] / 3;
        }
        const double d = def->vertexDirect != NULL ? vplRgbMean(def->vertexDirect[face->at[k]]) : 0;
        direct += d;
        square += d * d;
    }
    c->direct += area * direct / 3;
    c->directSquare += area * (square + direct * direct) / 12; // the mean square of a linear function
    c->area += area;
}

// The variance of direct light over a side, by its corners and by its samples.
static double directVariance(const vplPatchPriorityDef* def, int index, const VertexSums* c)
{
    const double mean = c->area > 0 ? c->direct / c->area : 0,
                 linear = c->area > 0 ? c->directSquare / c->area - mean * mean : 0,
                 spread = def->directSpread != NULL ? (double)def->directSpread[index] : 0;
    return fmax(linear, 0) + spread * spread;
}

// The estimated squared relative error of a side, summed over the channels. `bend`: the difference between the
// mean of the interpolated corners and the side's own irradiance, which bisection removes. Direct light is
// drawn per pixel, so its variance causes errors only in what the side reflects; its weight of 1 instead of 0.3
// lowers the squared error of cornell-area by a third (bench/radiosity_error).
static double errorOf(const vplPatchPriorityDef* def, const vplPatchSide* side, int index,
                      const VertexSums* c, double floor)
{
    const vplRgb e = def->irradiance[index];
    const double values[3] = {(double)e.r, (double)e.g, (double)e.b};
    double error = 0;
    for (int channel = 0; channel < 3 && c->area > 0; channel++) {
        const double range = c->high[channel] - c->low[channel],
                     bend = c->sum[channel] / c->area - values[channel];
        const double scale = values[channel] + floor;
        error += (GRADIENT * range * range + bend * bend) / (scale * scale);
    }
    const double reflectance = vplRgbMean(side->reflectance), scale = vplRgbMean(e) + floor;
    error += reflectance * reflectance * directVariance(def, index, c) / (scale * scale);
    return error;
}

static double meanIrradiance(const vplPatchSides* sides, const vplRgb* irradiance)
{
    double sum = 0, area = 0;
    for (int i = 0; i < sides->count; i++) {
        sum += (double)sides->sides[i].area * vplRgbMean(irradiance[i]);
        area += (double)sides->sides[i].area;
    }
    return area > 0 ? sum / area : 0;
}

static vplResult checkDef(const vplPatchMesh* mesh, const vplPatchPriorityDef* def)
{
    if (def->cookie != PRIORITY_COOKIE) {
        return vplFail(mesh->context, VPL_INVALID_ARGUMENT,
                       "vplPatchPriorityDef was not made by vplDefaultPatchPriorityDef");
    }
    if (mesh->sides->count > 0 && (def->irradiance == NULL || def->vertexIrradiance == NULL)) {
        return vplFail(mesh->context, VPL_INVALID_ARGUMENT,
                       "vplPatchPriorityDef.irradiance and vertexIrradiance are NULL, must be given where "
                       "there are sides");
    }
    return VPL_SUCCESS;
}

vplResult vplFindPatchPriority(const vplPatchMesh* mesh, const vplPatchPriorityDef* def, float* priorityOut)
{
    REQUIRE(CONTEXT_OF(mesh), mesh, def, priorityOut);
    const vplPatchSides* sides = mesh->sides;
    const vplPatches* patches = sides->patches;
    TRY(checkDef(mesh, def));
    VertexSums* sums = vplAlloc(mesh->context, (size_t)sides->count, sizeof *sums);
    if (sums == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < sides->count; i++) {
        sums[i] = (VertexSums){{DBL_MAX, DBL_MAX, DBL_MAX}, {-DBL_MAX, -DBL_MAX, -DBL_MAX}, {0}, 0, 0, 0};
    }
    for (int i = 0; i < 2 * mesh->triangleCount; i++) {
        vplMeshFace face;
        if (vplPatchMesh_GetFace(mesh, i / 2, i % 2, &face)) {
            addFace(def, &face, &sums[face.side]);
        }
    }
    const double floor = FLOOR * meanIrradiance(sides, def->irradiance);
    for (int i = 0; i < patches->patchCount; i++) {
        double error = 0;
        for (int back = 0; back < 2; back++) {
            const int side = vplSideOf(sides, i, back);
            if (side >= 0 && floor > 0) {
                error += errorOf(def, &sides->sides[side], side, &sums[side], floor);
            }
        }
        priorityOut[i] = (float)(error * vplPatches_Area(patches, i));
    }
    vplFree(mesh->context, sums);
    return VPL_SUCCESS;
}
