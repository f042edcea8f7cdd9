// SPDX-License-Identifier: MIT
// The sides of patches that take part. The document's equations are about patches that face the room, and what covers
// the floor under its blocks "I have not found a good solution to" (Hemgren, 4): here no light gets there, and neither
// do equations.
#include "geometry/triangle.h"
#include "base/context.h"
#include "geometry/emission.h"
#include "math/scalar.h"
#include "radiosity/cells.h"
#include "radiosity/open_cells.h"

#include <float.h>

enum { SIDES_COOKIE = 0x56504ca1 };

vplPatchSidesDef vplDefaultPatchSidesDef(void)
{
    return (vplPatchSidesDef){.cookie = SIDES_COOKIE};
}

static vplResult checkDef(vplContext* context, const vplPatchSidesDef* def)
{
    if (def->cookie != SIDES_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplPatchSidesDef was not made by vplDefaultPatchSidesDef");
    }
    if (def->emitterCount < 0 || (def->emitterCount > 0 && def->emitters == NULL)) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "vplPatchSidesDef.emitterCount is %d, must be at least 0, and 0 where emitters is NULL",
            def->emitterCount);
    }
    if (def->eyeCount < 0 || (def->eyeCount > 0 && def->eyes == NULL)) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplPatchSidesDef.eyeCount is %d, must be at least 0, and 0 where eyes is NULL",
                       def->eyeCount);
    }
    for (int i = 0; i < def->eyeCount; i++) {
        if (!vplIsFiniteVec(def->eyes[i])) {
            return vplFail(context, VPL_INVALID_ARGUMENT, "vplPatchSidesDef.eyes[%d] is not finite", i);
        }
    }
    return VPL_SUCCESS;
}

// ---- which cells are open

// A place is a thousandth of its patch's size above it: what stands on the patch is mostly thicker, and what covers it
// nearer. But at least four roundings of a coordinate.
static void findHeights(vplReach* reach)
{
    double total = 0;
    for (int i = 0; i < reach->patches->patchCount; i++) {
        const double area = vplPatches_Area(reach->patches, i);
        vplVec3 corners[3];
        float largest = 0;
        vplSide_GetCorners(reach->patches, i, false, corners);
        for (int k = 0; k < 9; k++) {
            largest = fmaxf(largest, fabsf(vplComponent(corners[k / 3], k % 3)));
        }
        reach->heights[i] = vplMaxf((float)sqrt(area) * 0x1p-10f, largest * 0x1p-20f);
        total += area;
    }
    reach->meanArea = reach->patches->patchCount > 0 ? total / reach->patches->patchCount : 0;
}

static vplResult reserve(vplReach* reach)
{
    vplContext* context = reach->context;
    const size_t patches = (size_t)reach->patches->patchCount,
                 tasks = patches / VPL_REACH_PATCHES + 1 + VPL_REACH_PARTICLE_TASKS;
    reach->heights = vplAlloc(context, patches, sizeof *reach->heights);
    reach->open = reach->heights ? vplAllocZero(context, 2 * patches, sizeof *reach->open) : NULL;
    reach->nextOpen = reach->open ? vplAllocZero(context, 2 * patches, sizeof *reach->nextOpen) : NULL;
    reach->known = reach->nextOpen ? vplAlloc(context, 2 * patches, sizeof *reach->known) : NULL;
    reach->nextKnown = reach->known ? vplAlloc(context, 2 * patches, sizeof *reach->nextKnown) : NULL;
    reach->taskRays = reach->nextKnown ? vplAllocZero(context, tasks, sizeof *reach->taskRays) : NULL;
    return reach->taskRays ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static void release(vplReach* reach)
{
    vplFree(reach->context, reach->heights);
    vplFree(reach->context, reach->open);
    vplFree(reach->context, reach->nextOpen);
    vplFree(reach->context, reach->known);
    vplFree(reach->context, reach->nextKnown);
    vplFree(reach->context, reach->taskRays);
}

static vplResult findOpen(vplReach* reach)
{
    vplEmission* emission = NULL;
    vplResult result =
        vplEmission_Create(reach->geometry, reach->def->emitters, reach->def->emitterCount, &emission);
    if (result == VPL_SUCCESS) {
        result = vplGeometry_PrepareRays(reach->geometry);
    }
    reach->emission = emission;
    if (result == VPL_SUCCESS && emission->sourceCount > 0) {
        result = vplReach_ShootParticles(reach);
    }
    if (result == VPL_SUCCESS && (emission->sourceCount > 0 || reach->def->eyeCount > 0)) {
        result = vplReach_Explore(reach);
    }
    if (result == VPL_SUCCESS) {
        result = vplReach_FindCells(reach);
    }
    vplEmission_Destroy(emission);
    return result;
}

// ---- sides

static vplVec3 incentreOf(const vplVec3 c[3])
{
    double weights[3], sum = 0, at[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        double square = 0;
        for (int axis = 0; axis < 3; axis++) {
            const double d =
                (double)vplComponent(c[(k + 2) % 3], axis) - (double)vplComponent(c[(k + 1) % 3], axis);
            square += d * d;
        }
        weights[k] = sqrt(square);
        sum += weights[k];
    }
    for (int k = 0; k < 9; k++) {
        at[k % 3] += weights[k / 3] / sum * (double)vplComponent(c[k / 3], k % 3);
    }
    return vplVec((float)at[0], (float)at[1], (float)at[2]);
}

static float toFloat(double x)
{
    return x > (double)FLT_MAX ? FLT_MAX : (float)x;
}

static vplPatchSide makeSide(const vplPatches* patches, int patch, bool back, unsigned open)
{
    const vplGeometry* g = patches->geometry;
    const int triangle = vplPatches_TriangleOf(patches, patch);
    const vplMaterialDef* material = &g->materials[g->triangleMaterials[triangle]];
    vplPatchSide side = {
        .patch = patch, .back = back, .open = (uint16_t)open, .reflectance = material->diffuse};
    side.area = toFloat(vplPatches_Area(patches, patch) * __builtin_popcount(open) / VPL_PATCH_CELLS);
    side.normal = back ? vplNegate(g->normals[triangle]) : g->normals[triangle];
    vplSide_GetCorners(patches, patch, back, side.corners);
    side.incentre = incentreOf(side.corners);
    if (!back) {
        side.emission = vplScaleRadiometric(VPL_PI, material->emission);
    }
    return side;
}

// As the document has it: where light reaches some of a triangle's side, all of that is there.
static void openWhole(vplReach* reach)
{
    const vplPatches* p = reach->patches;
    for (int first = 0, end; first < p->patchCount; first = end) {
        const int triangle = p->nodes[p->patches[first]].triangle;
        bool reached[2] = {false, false};
        for (end = first; end < p->patchCount && p->nodes[p->patches[end]].triangle == triangle; end++) {
            reached[0] = reached[0] || reach->open[2 * end] != 0;
            reached[1] = reached[1] || reach->open[2 * end + 1] != 0;
        }
        for (int i = 2 * first; i < 2 * end; i++) {
            reach->open[i] = reached[i & 1] ? 0xffff : 0;
        }
    }
}

static vplResult listSides(const vplReach* reach, vplPatchSides* sides)
{
    const int patchCount = reach->patches->patchCount;
    int count = 0;
    for (int i = 0; i < 2 * patchCount; i++) {
        count += reach->open[i] != 0;
    }
    vplPatchSide* list = vplAlloc(reach->context, (size_t)count, sizeof *list);
    int* ofPatch = list ? vplAlloc(reach->context, 2 * (size_t)patchCount, sizeof *ofPatch) : NULL;
    sides->sides = list;
    sides->ofPatch = ofPatch;
    if (ofPatch == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < 2 * patchCount; i++) {
        ofPatch[i] = -1;
        if (reach->open[i] != 0) {
            list[sides->count] = makeSide(reach->patches, i / 2, i & 1, reach->open[i]);
            ofPatch[i] = sides->count++;
        }
    }
    sides->rays = reach->rays;
    return VPL_SUCCESS;
}

vplResult vplPatchSides_Create(const vplPatches* patches, const vplPatchSidesDef* def,
                               vplPatchSides** sidesOut)
{
    vplContext* context = patches->context;
    vplResult result = checkDef(context, def);
    vplPatchSides* sides = result == VPL_SUCCESS ? vplAllocZero(context, 1, sizeof *sides) : NULL;
    if (sides == NULL) {
        return result == VPL_SUCCESS ? VPL_OUT_OF_MEMORY : result;
    }
    vplReach reach = {.patches = patches, .geometry = patches->geometry, .def = def, .context = context};
    sides->patches = patches;
    sides->context = context;
    result = reserve(&reach);
    if (result == VPL_SUCCESS) {
        findHeights(&reach);
        result = findOpen(&reach);
    }
    if (result == VPL_SUCCESS && def->whole) {
        openWhole(&reach);
    }
    if (result == VPL_SUCCESS) {
        result = listSides(&reach, sides);
    }
    release(&reach);
    if (result != VPL_SUCCESS) {
        vplPatchSides_Destroy(sides);
        return result;
    }
    *sidesOut = sides;
    return VPL_SUCCESS;
}

void vplPatchSides_Destroy(vplPatchSides* sides)
{
    if (sides != NULL) {
        vplFree(sides->context, (void*)sides->sides);
        vplFree(sides->context, (void*)sides->ofPatch);
        vplFree(sides->context, sides);
    }
}

vplVec3 vplPatchSide_SampleCell(const vplPatchSide* side, int k, float u, float v)
{
    return vplCell_Point(side->corners, k, u, v);
}
