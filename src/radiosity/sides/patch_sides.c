// SPDX-License-Identifier: MIT
// The sides of patches that light can reach. Departs from: Hemgren, Radiosity in Realtime Rendering, 4, whose
// equations also contain patches under blocks, for which he has "not found a good solution".
#include "base/context.h"
#include "geometry/emission.h"
#include "geometry/triangle.h"
#include "math/double3.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/sides/lit_search.h"
#include "radiosity/sides/side.h"

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
    if (def->viewpointCount < 0 || (def->viewpointCount > 0 && def->viewpoints == NULL)) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "vplPatchSidesDef.viewpointCount is %d, must be at least 0, and 0 where viewpoints is NULL",
            def->viewpointCount);
    }
    for (int i = 0; i < def->viewpointCount; i++) {
        if (!vplIsFiniteVec(def->viewpoints[i])) {
            return vplFail(context, VPL_INVALID_ARGUMENT, "vplPatchSidesDef.viewpoints[%d] is not finite", i);
        }
    }
    return VPL_SUCCESS;
}

// ---- which cells are open

// An offset point is a thousandth of its patch's size above it, of a group's mean triangle's: most objects that stand on
// the patch are thicker, and most that cover it are nearer. The height is at least four roundings of a coordinate.
static void findHeights(vplLitSearch* s)
{
    double total = 0;
    for (int i = 0; i < s->patches->patchCount; i++) {
        const double area = vplPatches_Area(s->patches, i);
        const vplPatchParts parts = vplPatches_GetParts(s->patches, i);
        vplVec3 corners[3];
        float largest = 0;
        for (int k = 0; k < 9 * parts.count; k++) {
            if (k % 9 == 0) {
                vplPatchNode_GetCorners(s->patches, parts.nodes[k / 9], false, corners);
            }
            largest = fmaxf(largest, fabsf(vplComponent(corners[k % 9 / 3], k % 3)));
        }
        s->heights[i] = vplMaxf((float)sqrt(area / parts.count) * 0x1p-10f, largest * 0x1p-20f);
        total += area;
    }
    s->meanArea = s->patches->patchCount > 0 ? total / s->patches->patchCount : 0;
}

static vplResult reserve(vplArena* scratch, vplLitSearch* s)
{
    const size_t patches = (size_t)s->patches->patchCount,
                 tasks = patches / VPL_LIT_TASK_PATCHES + 1 + VPL_LIT_PARTICLE_TASKS;
    s->heights = vplArena_Alloc(scratch, patches, sizeof *s->heights);
    s->open = vplArena_AllocZero(scratch, 2 * patches, sizeof *s->open);
    s->nextOpen = vplArena_AllocZero(scratch, 2 * patches, sizeof *s->nextOpen);
    s->fromEye = vplArena_AllocZero(scratch, 2 * patches, 1);
    s->nextFromEye = vplArena_AllocZero(scratch, 2 * patches, 1);
    s->darkShare = vplArena_Alloc(scratch, 2 * patches, sizeof *s->darkShare);
    s->found = vplArena_Alloc(scratch, 2 * patches, sizeof *s->found);
    s->hits = vplArena_AllocZero(scratch, 2 * patches, sizeof *s->hits);
    s->litPoint = vplArena_Alloc(scratch, 2 * patches, sizeof *s->litPoint);
    s->nextLitPoint = vplArena_Alloc(scratch, 2 * patches, sizeof *s->nextLitPoint);
    s->taskRays = vplArena_AllocZero(scratch, tasks, sizeof *s->taskRays);
    return vplArena_Check(scratch);
}

// Keeps all cells of a triangle's side where light reaches some.
static void openWholeTriangles(vplLitSearch* s)
{
    const vplPatches* p = s->patches;
    for (int first = 0, end; first < p->patchCount; first = end) {
        const int triangle = p->nodes[p->patches[first]].triangle;
        bool lit[2] = {false, false};
        for (end = first; end < p->patchCount && p->nodes[p->patches[end]].triangle == triangle; end++) {
            lit[0] = lit[0] || s->open[2 * end] != 0;
            lit[1] = lit[1] || s->open[2 * end + 1] != 0;
        }
        for (int i = 2 * first; i < 2 * end; i++) {
            s->open[i] = lit[i & 1] ? VPL_ALL_CELLS : 0;
        }
    }
}

// Allocates what stays in `arena`.
static vplResult search(vplLitSearch* s, vplArena* arena)
{
    findHeights(s);
    const bool hasSources = s->emission->sourceCount > 0;
    if (hasSources) {
        TRY(vplLitSearch_ShootParticles(s));
    }
    if (hasSources || s->def->viewpointCount > 0) {
        TRY(vplLitSearch_FindSides(s));
    }
    if (s->def->leaveFaint) {
        TRY(vplLitSearch_LeaveFaint(s));
    }
    if (s->darkBoxCount > 0) {
        s->dark = vplArena_AllocZero(arena, (size_t)s->geometry->triangleCount, 1);
        TRY(vplArena_Check(arena));
    }
    TRY(vplLitSearch_FindCells(s));
    if (s->def->wholeTriangles) {
        openWholeTriangles(s);
    }
    return VPL_SUCCESS;
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

// Sets what is a mean over the triangles of a group.
static void meanOfGroup(const vplPatches* patches, int patch, bool back, vplPatchSide* side)
{
    const vplGeometry* g = patches->geometry;
    const vplPatchParts parts = vplPatches_GetParts(patches, patch);
    double normal[3] = {0}, centre[3] = {0}, reflected[3] = {0}, all = 0;
    for (int i = 0; i < parts.count; i++) {
        vplVec3 c[3];
        const double area = vplGeometry_TriangleArea(g, parts.nodes[i]);
        vplPatchNode_GetCorners(patches, parts.nodes[i], back, c);
        for (int k = 0; k < 3; k++) {
            normal[k] += area * (double)vplComponent(g->normals[parts.nodes[i]], k);
            for (int corner = 0; corner < 3; corner++) {
                centre[k] += area / 3 * (double)vplComponent(c[corner], k);
            }
        }
        vplAddRgb(reflected, area, vplReflectanceOfTriangle(g, parts.nodes[i]));
        all += area;
    }
    const double length = (back ? -1 : 1) * sqrt(vplDot3(normal, normal));
    side->normal =
        vplVec((float)(normal[0] / length), (float)(normal[1] / length), (float)(normal[2] / length));
    side->incentre = vplVec((float)(centre[0] / all), (float)(centre[1] / all), (float)(centre[2] / all));
    side->reflectance = vplDivideRgb(reflected, all);
}

static vplPatchSide makeSide(const vplPatches* patches, int patch, bool back, unsigned open)
{
    const vplGeometry* g = patches->geometry;
    const int triangle = vplPatches_TriangleOf(patches, patch);
    const vplMaterialDef* material = &g->materials[g->triangleMaterials[triangle]];
    vplPatchSide side = {
        .patch = patch, .back = back, .open = (uint16_t)open, .reflectance = material->diffuse};
    const double area = vplPatches_Area(patches, patch) * __builtin_popcount(open) / VPL_PATCH_CELLS;
    side.area = fmaxf(vplClampToFloat(area), FLT_MIN); // others divide by it
    side.normal = back ? vplNegate(g->normals[triangle]) : g->normals[triangle];
    vplPatchNode_GetCorners(patches, patches->patches[patch], back, side.corners);
    side.incentre = incentreOf(side.corners);
    if (!back) {
        side.emission = vplScaleRadiometric(VPL_PI, material->emission);
    }
    if (g->paint != NULL) {
        side.reflectance = vplPaint_MeanOfPart(g, triangle, side.corners);
    }
    if (g->cutOuts != NULL) { // the rest of the light goes through
        side.reflectance = vplRgbScale(vplGeometry_MeanOpacity(g, triangle, side.corners), side.reflectance);
    }
    if (vplPatches_IsGroup(patches, patch)) {
        meanOfGroup(patches, patch, back, &side);
    }
    return side;
}

static vplResult listSides(const vplLitSearch* s, vplPatchSides* sides)
{
    const int patchCount = s->patches->patchCount;
    int count = 0;
    for (int i = 0; i < 2 * patchCount; i++) {
        count += s->open[i] != 0;
    }
    vplPatchSide* list = vplArena_Alloc(sides->arena, (size_t)count, sizeof *list);
    int *ofPatch = vplArena_Alloc(sides->arena, 2 * (size_t)patchCount, sizeof *ofPatch),
        *hits = vplArena_Alloc(sides->arena, (size_t)count, sizeof *hits);
    TRY(vplArena_Check(sides->arena));
    for (int i = 0; i < 2 * patchCount; i++) {
        ofPatch[i] = -1;
        if (s->open[i] != 0) {
            list[sides->count] = makeSide(s->patches, i / 2, i & 1, s->open[i]);
            hits[sides->count] = s->hits[i];
            ofPatch[i] = sides->count++;
        }
    }
    sides->sides = list;
    sides->ofPatch = ofPatch;
    sides->hits = hits;
    sides->dark = s->dark;
    sides->faintCount = s->faintCount;
    sides->rays = s->rays;
    return VPL_SUCCESS;
}

static vplResult findSides(const vplPatchSidesDef* def, vplArena* scratch, vplPatchSides* sides)
{
    const vplPatches* patches = sides->patches;
    vplBox darkBoxes[VPL_DARK_BOXES];
    vplLitSearch s = {.patches = patches,
                      .geometry = patches->geometry,
                      .def = def,
                      .darkBoxes = darkBoxes,
                      .scratch = scratch,
                      .context = sides->context};
    TRY(reserve(scratch, &s));
    vplEmission* emission = NULL;
    TRY(vplEmission_Create(s.geometry, def->emitters, def->emitterCount, &emission));
    s.emission = emission;
    const vplResult result = search(&s, sides->arena);
    vplEmission_Destroy(emission);
    TRY(result);
    return listSides(&s, sides);
}

vplResult vplPatchSides_Create(const vplPatches* patches, const vplPatchSidesDef* def,
                               vplPatchSides** sidesOut)
{
    REQUIRE(CONTEXT_OF(patches), patches, def, sidesOut);
    vplContext* context = patches->context;
    TRY(checkDef(context, def));
    vplArena *arena = vplArena_Create(context), *scratch = vplArena_Create(context);
    vplPatchSides* sides = vplArena_AllocZero(arena, 1, sizeof *sides);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *sides = (vplPatchSides){.patches = patches, .arena = arena, .context = context};
        result = findSides(def, scratch, sides);
    }
    vplArena_Destroy(scratch);
    return vplArena_Deliver(arena, result, sides, sidesOut);
}

void vplPatchSides_Destroy(vplPatchSides* sides)
{
    vplArena_Destroy(sides != NULL ? sides->arena : NULL);
}
