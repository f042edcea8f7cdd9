// SPDX-License-Identifier: MIT
// Decisions of radiosity: where patches end, groups of triangles, links, and whether pixels gather their light.
#include "render/options.h"
#include "render/plan.h"

#include "geometry/triangle.h"
#include "math/scalar.h"
#include "radiosity/factors/form_factors.h"
#include "radiosity/sides/side.h"
#include "render/show.h"
#include "render/stages/results.h"

#include <limits.h>
#include <stdio.h>

bool vplIsDocumented(const vplRadiosityOptions* o)
{
    return o->formFactors == VPL_FORM_FACTORS_INCENTRE || o->patchSize > 0;
}

// Decides whether patches end where surfaces meet, before patches are made.
static void chooseCuts(vplPlan* p)
{
    vplRadiosityOptions* o = &p->options.radiosity;
    const bool documented = vplIsDocumented(o);
    if (o->cuts == VPL_PATCH_CUTS_AUTO) {
        o->cuts = documented ? VPL_PATCH_CUTS_OFF : VPL_PATCH_CUTS_ON;
        vplDecide(p, "patch-cuts",
                  documented ? "as the document has it" : "no patch lies on both sides of a surface");
    }
}

// Decides whether faint sides are left out, before sides are found.
static void chooseFaintSides(vplPlan* p)
{
    vplRadiosityOptions* o = &p->options.radiosity;
    if (p->options.view != NULL) { // sides are found once for all frames, and this camera may move to others
        o->faintSides = VPL_FAINT_SIDES_KEEP;
    } else if (o->faintSides == VPL_FAINT_SIDES_AUTO) {
        o->faintSides = vplIsDocumented(o) ? VPL_FAINT_SIDES_KEEP : VPL_FAINT_SIDES_LEAVE;
    }
}

// Makes patches and finds those that light reaches.
static vplResult countPatches(vplRunner* r, vplPlan* p)
{
    TRY(vplRunner_RunStage(r, VPL_STAGE_PATCHES));
    TRY(vplRunner_RunStage(r, VPL_STAGE_SIDES));
    const vplPatches* patches = r->run.results[VPL_STAGE_PATCHES];
    const vplPatchSides* sides = r->run.results[VPL_STAGE_SIDES];
    p->patches = patches->patchCount;
    p->litPatches = vplPatchSides_CountPatches(sides);
    p->longestEdge = (double)patches->longestEdge;
    p->patchGroups = patches->groupCount;
    p->groupedTriangles = vplPatches_CountGrouped(patches);
    p->patchSides = sides->count;
    p->faintSides = sides->faintCount;
    return VPL_SUCCESS;
}

static bool arePatchesMade(const vplPlan* p)
{
    return p->options.radiosity.placement == VPL_PATCHES_UNIFORM && p->showsPatches;
}

// A triangle is small if its area is below 1/SMALL of the mean patch's. Small triangles share patches if there are more than MANY_SMALL
// of them, so that form factors of all pairs would not fit into memory, and more than one per SMALL_SHARE patches. A furnished flat with
// 100,000 patches took over half an hour of a processor and 4 GB without groups, and takes 76 s and 0.7 GB with them.
enum { SMALL = 16, MANY_SMALL = VPL_ALL_PAIRS / 2, SMALL_SHARE = 8 };

// Returns the number of small triangles if they share patches, otherwise 0.
static int countSmall(const vplGeometry* g, int patches)
{
    const int few = vplMaxi(MANY_SMALL, patches / SMALL_SHARE);
    const double most = vplGeometry_Area(g) / patches / SMALL;
    int count = 0;
    for (int i = 0; i < g->triangleCount && g->triangleCount > few; i++) {
        count += vplGeometry_TriangleArea(g, i) < most;
    }
    return count > few ? count : 0;
}

// Decides whether small triangles share patches, before patches are made: they do where there are more triangles than --patches
// asks for, where light reaches over 10 % more pieces of triangles than that, or where many triangles are small.
static vplResult chooseGroups(vplRunner* r, vplPlan* p)
{
    vplRadiosityOptions* o = &p->options.radiosity;
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    if (o->groups != VPL_PATCH_GROUPS_AUTO) {
        return VPL_SUCCESS;
    }
    o->groups = VPL_PATCH_GROUPS_OFF;
    if (vplIsDocumented(o)) {
        vplDecide(p, "patch-groups", "other options ask for a patch per triangle");
        return VPL_SUCCESS;
    }
    const bool many = g->triangleCount > o->patches;
    const int small = many ? 0 : countSmall(g, o->patches);
    if (!many && small == 0 && o->cuts == VPL_PATCH_CUTS_ON && arePatchesMade(p)) {
        TRY(countPatches(r, p));
    }
    const bool manyPieces = p->litPatches > o->patches + o->patches / 10;
    if (many || small > 0 || manyPieces) {
        o->groups = VPL_PATCH_GROUPS_ON;
    }
    vplDecide(p, "patch-groups",
              many         ? "%d triangles for %d patches"
              : small > 0  ? "%d triangles are small beside the mean of %d patches"
              : manyPieces ? "cuts leave pieces of %d triangles, more than %d patches"
                           : "no more triangles than patches",
              small > 0 ? small : g->triangleCount, o->patches);
    return VPL_SUCCESS;
}

// Decides whether patches exchange light in groups.
static vplResult chooseLinks(vplRunner* r, vplPlan* p)
{
    vplRadiosityOptions* o = &p->options.radiosity;
    p->linkAbove = o->hierarchy == VPL_HIERARCHY_ON    ? -1
                   : o->hierarchy == VPL_HIERARCHY_OFF ? INT_MAX
                                                       : VPL_ALL_PAIRS;
    p->patches = o->patches;
    p->patchSides = o->patches; // in rooms, which light fills from one side
    if (arePatchesMade(p)) {
        TRY(countPatches(r, p));
    }
    if (p->faintSides > 0) {
        vplDecide(p, "faint-sides", "%d of %d sides have hardly any light, and the camera sees none of them",
                  p->faintSides, p->faintSides + p->patchSides);
    }
    p->linked = p->patchSides > p->linkAbove;
    p->formFactorBytes = (int64_t)vplEstimateFactors(r, p).held;
    if (o->hierarchy == VPL_HIERARCHY_AUTO) {
        o->hierarchy = p->linked ? VPL_HIERARCHY_ON : VPL_HIERARCHY_OFF;
        vplDecide(p, "hierarchy",
                  "%d sides; form factors of all pairs are exact and fit into memory up to %d", p->patchSides,
                  VPL_ALL_PAIRS);
    }
    if (o->groups == VPL_PATCH_GROUPS_ON && o->formFactors == VPL_FORM_FACTORS_INCENTRE) {
        snprintf(
            p->problem, sizeof p->problem,
            "groups of triangles have no incentre; use --patch-groups off or --form-factors monte-carlo");
    }
    const int64_t most = vplMostFormFactorBytes(r->run.context);
    if (!p->linked && p->formFactorBytes > most && p->showsPatches) {
        p->refusal = VPL_LIMIT;
        snprintf(p->problem, sizeof p->problem,
                 "form factors of %d sides take %lld bytes, at most %lld are allowed; use --hierarchy on%s",
                 p->patchSides, (long long)p->formFactorBytes, (long long)most,
                 vplHasTeam(r->run.context) ? " or more processes" : "");
    }
    return VPL_SUCCESS;
}

// Rays from each pixel where a seventh of the patches are groups of triangles. At 160x90 and 5,000 patches they bring relmse
// from 0.89 to 0.19 in Sponza (55 % groups), from 0.0218 to 0.0189 in a furnished flat (21 %), in 0.7 and 1.0 times the time.
// They leave 0.0019 by themselves: twice what patches leave around a bunny (2 % groups). More rays follow while they take about a quarter
// of the time of the form factors: 64 instead of 16 bring relmse from 0.030 to 0.014 in Sibenik, from 0.15 to 0.063 in Conference and from
// 0.0093 to 0.0059 in the flat, in 1.13 times the time; 128, which fewer pixels share, bring 0.0093, 0.032 and 0.0060 in 1.2 times.
enum { GROUP_RAYS = 16, MOST_GROUP_RAYS = 128, GROUP_RAYS_PER_SIDE = 500, GROUP_SHARE = 7 };

// Returns the number of rays for the size of the picture.
static int groupRays(const vplPlan* p)
{
    const double pixels = vplCountPixels(&p->options.output),
                 most = (double)GROUP_RAYS_PER_SIDE * p->patchSides / pixels;
    int rays = GROUP_RAYS;
    while (rays < MOST_GROUP_RAYS && 2 * rays <= most) {
        rays *= 2;
    }
    return rays;
}

// The share of all surfaces that is in groups.
static double areaInGroups(const vplPatches* p)
{
    double area = 0;
    for (int i = 0; i < p->groupCount; i++) {
        area += p->areaUpTo[p->firstMember[i + 1] - 1];
    }
    return area / p->geometry->area;
}

// With many patches groups are few, but may still be large: 13 % of the area in Conference with 20,000 patches, where rays bring relmse
// from 0.11 to 0.030 and energy from 0.971 to 0.986. In the furnished flat they are 4 %, and rays bring 0.0060 to 0.0074.
static const double LARGE_GROUPS = 1.0 / 16;

// Decides whether pixels gather their light, when the patches are known. A pixel of a triangle that goes through the wall of a dark room
// would have the light of its lit part.
static void chooseGather(const vplRunner* r, vplPlan* p)
{
    vplRadiosityOptions* o = &p->options.radiosity;
    if (o->gather >= 0) {
        return;
    }
    const vplPatchSides* sides = arePatchesMade(p) ? r->run.results[VPL_STAGE_SIDES] : NULL;
    const bool light = p->showsPatches && vplShowsLight(p->options.output.show),
               many = p->patchGroups > 0 && GROUP_SHARE * (int64_t)p->patchGroups >= p->patches,
               large = sides != NULL && areaInGroups(sides->patches) >= LARGE_GROUPS,
               dark = sides != NULL && sides->dark != NULL;
    p->gathers = light && (many || large || dark);
    o->gather = p->gathers ? groupRays(p) : 0;
    if (p->gathers && (many || large)) {
        vplDecide(p, "gather", "%d of %d patches are groups, whose light differs more than a mean tells",
                  p->patchGroups, p->patches);
    } else if (p->gathers) {
        vplDecide(p, "gather", "triangles may go through the wall of a dark room");
    }
    vplDecidePipeline(p);
}

static void chooseRadiosity(vplPlan* p)
{
    vplRadiosityOptions* o = &p->options.radiosity;
    const bool incentre = o->formFactors == VPL_FORM_FACTORS_INCENTRE;
    if (o->rowSums == VPL_ROW_SUMS_USUAL && o->hierarchy == VPL_HIERARCHY_OFF &&
        o->groups == VPL_PATCH_GROUPS_OFF) {
        o->rowSums = incentre ? VPL_ROW_SUMS_KEEP : VPL_ROW_SUMS_CLAMP;
        vplDecide(p, "row-sums",
                  incentre ? "as the document has it" : "no patch sends more light than it has");
    }
    if (o->lightSamples == 0) {
        o->lightSamples = incentre ? 1 : VPL_PATCH_CELLS;
        vplDecide(p, "patch-light", incentre ? "as the document has it" : "the mean over the patch");
    }
}

vplResult vplDecidePatches(vplRunner* r, vplPlan* p)
{
    chooseCuts(p);
    chooseFaintSides(p);
    TRY(chooseGroups(r, p));
    TRY(chooseLinks(r, p));
    chooseGather(r, p);
    chooseRadiosity(p);
    return VPL_SUCCESS;
}
