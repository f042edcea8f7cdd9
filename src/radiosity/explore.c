// SPDX-License-Identifier: MIT
// Sides that particles missed: what sees a side that light reaches is reached.
#include "base/context.h"
#include "base/rng.h"
#include "geometry/emission.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "radiosity/cells.h"
#include "radiosity/open_cells.h"

enum {
    QUARTERS = 4, // of a side: a point in each
    GATHERS = 4,  // rays from each point
    SWEEPS = 16,  // rooms behind rooms that no particle came to
    STREAM = 0x5ead1000
};

// Of the way to the centre: some four heights of a place.
static const float INSET = 0x1p-6f;

// ---- one side

// Random numbers of point `point` of cell `cell` of a side, and of the rays from it.
static vplRandom4 dice(const vplReach* reach, int side, int cell, int point, int ray)
{
    const uint64_t index =
        ((uint64_t)side * VPL_PATCH_CELLS + (uint64_t)cell) * 64 + (uint64_t)(point * 8 + ray);
    return vplRandomAt(reach->def->seed, STREAM + (uint32_t)reach->sweep, index);
}

vplVec3 vplReach_PointOf(const vplReach* reach, int side, int cell, int point)
{
    const vplRandom4 r = dice(reach, side, cell, point, 0);
    vplVec3 corners[3];
    const int stratum = point * 5 % VPL_REACH_POINTS; // the first four are all over the cell, too
    const float u = ((float)stratum + vplUnitFloat(r.v[0])) / VPL_REACH_POINTS,
                v = vplUnitFloat(r.v[1]) + vplVanDerCorput((uint32_t)point);
    vplSide_GetCorners(reach->patches, side / 2, side & 1, corners);
    const vplVec3 at = vplCell_Point(corners, cell, u, v < 1 ? v : v - 1),
                  centre = vplScale(1 / 3.0f, vplAdd(corners[0], vplAdd(corners[1], corners[2])));
    return vplAdd(at, vplScale(INSET, vplSub(centre, at)));
}

// From where the ray lands the known place of that side must be free to go to, or the floor under a box would be light
// because it is so beside it.
bool vplReach_SeesLight(const vplReach* reach, int side, int cell, int point, int ray, vplVec3 place,
                        int64_t* rays, vplLanding* landing)
{
    const vplRandom4 r = dice(reach, side, cell, point, 1 + ray);
    const vplVec3 direction =
        vplSampleCosineAround(vplReach_Normal(reach, side), vplUnitFloat(r.v[0]), vplUnitFloat(r.v[1]));
    return vplReach_Land(reach, place, direction, rays, landing) && reach->open[landing->side] != 0 &&
           vplReach_IsFree(reach, place, landing->place, rays) &&
           vplReach_IsFree(reach, landing->place, reach->known[landing->side], rays);
}

// A side that is reached is known by the first of its places that sees light.
static void note(const vplReach* reach, int side, vplVec3 place, vplVec3 from)
{
    reach->nextOpen[side] = 0xffff;
    reach->nextKnown[side] = vplReach_Pull(reach, side / 2, place, from);
}

bool vplReach_SeesSource(const vplReach* reach, int side, int cell, int point, vplVec3 place, int64_t* rays,
                         vplVec3* from)
{
    const vplEmission* e = reach->emission;
    const vplRandom4 r = dice(reach, side, cell, point, 7);
    if (e->sourceCount == 0) {
        return false;
    }
    double rest;
    const int chosen = r.v[1] & 1 ? (int)((uint64_t)r.v[0] * (uint32_t)e->sourceCount >> 32)
                                  : vplEmission_Choose(e, 0, (double)vplUnitFloat(r.v[0]), &rest);
    const vplEmissionSource* source = &e->sources[chosen];
    const vplEmitterDef* emitter = source->emitter >= 0 ? &e->emitters[source->emitter] : NULL;
    if (emitter == NULL) {
        const vplHit hit = vplGeometry_SampleTriangle(reach->geometry, source->triangle, vplUnitFloat(r.v[2]),
                                                      vplUnitFloat(r.v[3]));
        const int patch = vplPatches_Find(reach->patches, source->triangle, hit.position);
        *from = vplAdd(hit.position, vplScale(reach->heights[patch], hit.normal));
        if (!(vplDot(vplSub(place, *from), hit.normal) > 0)) {
            return false;
        }
    } else if (emitter->type == VPL_EMITTER_DIRECTIONAL) {
        *from = vplSub(place, vplScale(2.5f * (float)e->radius, emitter->direction));
    } else {
        const vplVec3 away = vplNormalize(vplSub(place, emitter->position));
        *from = emitter->position;
        if (emitter->type == VPL_EMITTER_SPOT &&
            !(vplSpot_Falloff(emitter, (double)vplDot(away, emitter->direction)) > 0)) {
            return false;
        }
    }
    return vplDot(vplSub(*from, place), vplReach_Normal(reach, side)) > 0 &&
           vplReach_IsFree(reach, place, *from, rays);
}

// A side that nothing reaches yet, seen from an eye?
static void lookAtSide(const vplReach* reach, int side, int64_t* rays)
{
    const vplVec3 n = vplReach_Normal(reach, side);
    for (int i = 0; i < QUARTERS && reach->open[side] == 0; i++) {
        vplVec3 place;
        if (!vplReach_Rise(reach, side, vplReach_PointOf(reach, side, 5 * i, 0), rays, &place)) {
            continue;
        }
        for (int k = 0; k < reach->def->eyeCount && reach->nextOpen[side] == 0; k++) {
            const vplVec3 eye = reach->def->eyes[k];
            if (vplDot(vplSub(eye, place), n) > 0 && vplReach_IsFree(reach, place, eye, rays)) {
                note(reach, side, place, eye);
            }
        }
    }
}

// Whether all that there is lies behind a side: so it is with the outsides of most walls, half of all sides.
static bool looksOut(const vplReach* reach, int side)
{
    const vplGeometry* g = reach->geometry;
    const vplVec3 n = vplReach_Normal(reach, side), low = g->boundsMin, high = g->boundsMax;
    const vplVec3 farthest =
        vplVec(n.x > 0 ? high.x : low.x, n.y > 0 ? high.y : low.y, n.z > 0 ? high.z : low.z);
    vplVec3 corners[3];
    vplSide_GetCorners(reach->patches, side / 2, side & 1, corners);
    return vplDot(vplSub(farthest, corners[0]), n) < reach->heights[side / 2];
}

// Whether light comes to a place above a side, by one try from a source and some from other sides.
static bool isLit(const vplReach* reach, int side, int cell, vplVec3 place, int64_t* rays, vplVec3* from)
{
    if (vplReach_SeesSource(reach, side, cell, 0, place, rays, from)) {
        return true;
    }
    for (int ray = 0; ray < GATHERS && !looksOut(reach, side); ray++) {
        vplLanding landing;
        if (vplReach_SeesLight(reach, side, cell, 0, ray, place, rays, &landing)) {
            *from = landing.place;
            return true;
        }
    }
    return false;
}

// A side that nothing reaches yet: does it see what is light? Other points each time.
static void exploreSide(const vplReach* reach, int side, int64_t* rays)
{
    for (int i = 0; i < QUARTERS && reach->open[side] == 0 && reach->nextOpen[side] == 0; i++) {
        const int cell = 4 * i + reach->sweep % 4;
        vplVec3 place, from;
        if (vplReach_Rise(reach, side, vplReach_PointOf(reach, side, cell, 0), rays, &place) &&
            isLit(reach, side, cell, place, rays, &from)) {
            note(reach, side, place, from);
        }
    }
}

// ---- all sides

typedef struct Sweep {
    vplReach* reach;
    vplExamineFcn* examine;
} Sweep;

static void examineSome(void* data, int task, int worker)
{
    (void)worker;
    const Sweep* sweep = data;
    vplReach* reach = sweep->reach;
    const int end = vplMini((task + 1) * VPL_REACH_PATCHES, reach->patches->patchCount);
    int64_t rays = 0;
    for (int side = 2 * task * VPL_REACH_PATCHES; side < 2 * end; side++) {
        sweep->examine(reach, side, &rays);
    }
    reach->taskRays[task] = rays;
}

static int adopt(vplReach* reach, int tasks)
{
    int fresh = 0;
    for (int side = 0; side < 2 * reach->patches->patchCount; side++) {
        if (reach->nextOpen[side] != 0) {
            fresh += reach->open[side] == 0;
            reach->known[side] = reach->open[side] == 0 ? reach->nextKnown[side] : reach->known[side];
            reach->open[side] = reach->nextOpen[side];
        }
    }
    for (int i = 0; i < tasks; i++) {
        reach->rays += reach->taskRays[i];
    }
    return fresh;
}

vplResult vplReach_Sweep(vplReach* reach, vplExamineFcn* examine, double from, double to, int* freshOut)
{
    const int tasks = (reach->patches->patchCount + VPL_REACH_PATCHES - 1) / VPL_REACH_PATCHES;
    Sweep sweep = {reach, examine};
    vplResult result = vplParallelForProgress(reach->context, tasks, examineSome, &sweep,
                                              reach->def->progress, reach->def->progressUser, from, to);
    if (result == VPL_SUCCESS) {
        *freshOut = adopt(reach, tasks);
        reach->sweep++;
    }
    return result;
}

static int countDark(const vplReach* reach)
{
    int dark = 0;
    for (int side = 0; side < 2 * reach->patches->patchCount; side++) {
        dark += reach->open[side] == 0;
    }
    return dark;
}

// At least four sweeps, 64 rays of each side that stays dark: the front of a block that faces out of the report's box sees
// it in one of ten directions, and 16 rays lost one patch of it in three thousand. More where one of 64 dark sides was
// found: as long as rooms open behind rooms. (Slivers go on for ever: half of the rays at 300,000 patches of Sponza.)
vplResult vplReach_Explore(vplReach* reach)
{
    int fresh = 1;
    vplResult result = VPL_SUCCESS;
    if (reach->def->eyeCount > 0) {
        result = vplReach_Sweep(reach, lookAtSide, 0.3, 0.4, &fresh);
    }
    for (int i = 0; i < SWEEPS && (i < 4 || fresh * INT64_C(64) > countDark(reach)) && result == VPL_SUCCESS;
         i++) {
        result =
            vplReach_Sweep(reach, exploreSide, 0.4 + 0.3 * i / SWEEPS, 0.4 + 0.3 * (i + 1) / SWEEPS, &fresh);
    }
    return result;
}
