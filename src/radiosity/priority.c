// SPDX-License-Identifier: MIT
// Where another bisection lowers the error most.
// Based on: Hemgren, Radiosity in Realtime Rendering, 4 and 6, which asks for "a more dynamic approach to subdividing the
// surfaces": smaller patches in corners, where things touch and where shadows end.
#include "base/context.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/side.h"

#include <vpl/radiosity.h>

#include <float.h>

enum { PRIORITY_COOKIE = 0x56504ca2 };

vplPatchPriorityDef vplDefaultPatchPriorityDef(void)
{
    return (vplPatchPriorityDef){.cookie = PRIORITY_COOKIE};
}

// Weights of squares of relative errors. The bend, how far the mean of the interpolated corners is from the patch's own
// light, is what bisecting takes away; but it is small across many an edge of light, which only the gradient sees. From
// 0.05 to 0.2 the squared error of cornell-area and room-area at 500 to 2000 patches differs by less than a tenth in the
// mean (bench/radiosity_error).
static const double GRADIENT = 0.1, BEND = 1;

// Direct light is drawn by pixels, and its changes err only in what the patch reflects: near a box in a patch that is
// half in its shadow. Squared error of cornell-area at 500 patches with 0.3: 0.0012, with 1: 0.0008; elsewhere the same.
static const double SHADOW = 1;

// Of the mean irradiance: relative errors of what is darker than this share are of no more weight. From 0.05 to 0.3 the
// same error.
static const double FLOOR = 0.1;

// What the corners of one side of a patch say.
typedef struct Corners {
    double low[3], high[3], sum[3]; // sum: over the area
    double direct, directSquare;    // over the area
    double area;
} Corners;

static void addTriangle(const vplPatchMesh* mesh, const vplPatchPriorityDef* def, int triangle, bool back,
                        Corners* c)
{
    const uint32_t* index = mesh->indices + 3 * (size_t)triangle;
    const vplVec3 p = mesh->positions[index[0]], q = mesh->positions[index[1]], r = mesh->positions[index[2]];
    const double area = 0.5 * (double)vplLength(vplCross(vplSub(q, p), vplSub(r, p)));
    double direct = 0, square = 0;
    for (int k = 0; k < 3; k++) {
        const size_t at = 2 * (size_t)index[k] + back;
        const vplRgb v = def->vertexIrradiance[at];
        const double values[3] = {(double)v.r, (double)v.g, (double)v.b};
        for (int channel = 0; channel < 3; channel++) {
            c->low[channel] = fmin(c->low[channel], values[channel]);
            c->high[channel] = fmax(c->high[channel], values[channel]);
            c->sum[channel] += area * values[channel] / 3;
        }
        const double d = def->vertexDirect != NULL ? vplRgbMean(def->vertexDirect[at]) : 0;
        direct += d;
        square += d * d;
    }
    c->direct += area * direct / 3;
    c->directSquare += area * (square + direct * direct) / 12; // the mean of the square of what is linear
    c->area += area;
}

// Of direct light over a side: what its corners and its samples know of it.
static double directVariance(const vplPatchPriorityDef* def, int index, const Corners* c)
{
    const double mean = c->area > 0 ? c->direct / c->area : 0,
                 linear = c->area > 0 ? c->directSquare / c->area - mean * mean : 0,
                 spread = def->directSpread != NULL ? (double)def->directSpread[index] : 0;
    return fmax(linear, 0) + spread * spread;
}

// Square of the relative error that a side is believed to have, summed over the channels.
static double errorOf(const vplPatchPriorityDef* def, const vplPatchSide* side, int index, const Corners* c,
                      double floor)
{
    const vplRgb e = def->irradiance[index];
    const double values[3] = {(double)e.r, (double)e.g, (double)e.b};
    double error = 0;
    for (int channel = 0; channel < 3 && c->area > 0; channel++) {
        const double range = c->high[channel] - c->low[channel],
                     bend = c->sum[channel] / c->area - values[channel];
        const double scale = values[channel] + floor;
        error += (GRADIENT * range * range + BEND * bend * bend) / (scale * scale);
    }
    const double reflectance = vplRgbMean(side->reflectance), scale = vplRgbMean(e) + floor;
    error += SHADOW * reflectance * reflectance * directVariance(def, index, c) / (scale * scale);
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
        return vplFail(
            mesh->context, VPL_INVALID_ARGUMENT,
            "vplPatchPriorityDef.irradiance and vertexIrradiance are NULL, must be given where there are sides");
    }
    return VPL_SUCCESS;
}

vplResult vplFindPatchPriority(const vplPatchMesh* mesh, const vplPatchPriorityDef* def, float* priorityOut)
{
    const vplPatchSides* sides = mesh->sides;
    const vplPatches* patches = sides->patches;
    vplResult result = checkDef(mesh, def);
    Corners* corners =
        result == VPL_SUCCESS ? vplAlloc(mesh->context, (size_t)sides->count, sizeof *corners) : NULL;
    if (corners == NULL) {
        return result == VPL_SUCCESS ? VPL_OUT_OF_MEMORY : result;
    }
    for (int i = 0; i < sides->count; i++) {
        corners[i] = (Corners){{DBL_MAX, DBL_MAX, DBL_MAX}, {-DBL_MAX, -DBL_MAX, -DBL_MAX}, {0}, 0, 0, 0};
    }
    for (int t = 0; t < mesh->triangleCount; t++) {
        for (int back = 0; back < 2; back++) {
            const int side = vplSideOf(sides, mesh->patchOf[t], back);
            if (side >= 0) {
                addTriangle(mesh, def, t, back, &corners[side]);
            }
        }
    }
    const double floor = FLOOR * meanIrradiance(sides, def->irradiance);
    for (int i = 0; i < patches->patchCount; i++) {
        double worth = 0;
        for (int back = 0; back < 2; back++) {
            const int side = vplSideOf(sides, i, back);
            if (side >= 0 && floor > 0) {
                worth += errorOf(def, &sides->sides[side], side, &corners[side], floor);
            }
        }
        priorityOut[i] = (float)(worth * vplPatches_Area(patches, i));
    }
    vplFree(mesh->context, corners);
    return VPL_SUCCESS;
}
