// SPDX-License-Identifier: MIT
// Offset points above sides, and the rays between them.
#include "base/rng.h"
#include "geometry/bvh.h"
#include "geometry/emission.h"
#include "geometry/triangle.h"
#include "math/sampling.h"
#include "math/vec.h"
#include "radiosity/sides/lit_search.h"
#include "radiosity/sides/side.h"

enum { STREAM = 0x5ead1000 }; // of random numbers

// Samples move towards the patch's centre by this fraction of the way: about four heights of an offset point.
static const float INSET = 0x1p-6f;

bool vplLitSearch_IsVisible(const vplLitSearch* s, vplVec3 a, vplVec3 b, int64_t* rays)
{
    const vplRay ray = {a, vplSub(b, a), {0, 0}};
    const vplVec3 d = ray.direction;
    if (d.x == 0 && d.y == 0 && d.z == 0) {
        return true;
    }
    ++*rays;
    return !vplGeometry_IsOccluded(s->geometry, &ray, 1);
}

vplVec3 vplLitSearch_MoveTowards(const vplLitSearch* s, int patch, vplVec3 offset, vplVec3 towards)
{
    const vplVec3 way = vplSub(towards, offset);
    const float length = vplLength(way), height = s->heights[patch];
    return vplAdd(offset, vplScale(length > 2 * height ? height / length : 0.5f, way));
}

// ---- overlapping triangles

// The first of all triangles that overlap `triangle` below an offset point.
static int firstBelow(const vplLitSearch* s, vplVec3 offset, vplVec3 down, int triangle, int64_t* rays)
{
    const vplRay ray = {offset, down, {triangle, s->geometry->triangleCount - triangle}};
    vplHit hit;
    ++*rays;
    const bool found = vplClosestHit(s->geometry, &ray, 1 + VPL_COPLANAR, NULL, &hit);
    return found && hit.t > 1 - VPL_COPLANAR ? hit.triangle : triangle;
}

bool vplLitSearch_Offset(const vplLitSearch* s, int side, int triangle, vplVec3 point, int64_t* rays,
                         vplVec3* offsetOut)
{
    const vplVec3 up = vplScale(s->heights[side / 2], vplLitSearch_Normal(s, side, triangle));
    const vplRay ray = {vplAdd(point, up), vplNegate(up), {triangle, 1}};
    vplHit hit;
    *offsetOut = ray.origin;
    ++*rays;
    if (!vplClosestHit(s->geometry, &ray, 1 + VPL_COPLANAR, NULL, &hit)) {
        return true;
    }
    return hit.t > 1 - VPL_COPLANAR && hit.triangle > triangle &&
           firstBelow(s, ray.origin, ray.direction, triangle, rays) == triangle;
}

bool vplLitSearch_Trace(const vplLitSearch* s, vplVec3 from, vplVec3 direction, int64_t* rays,
                        vplLitHit* hitOut)
{
    const vplRay ray = {from, direction, {0, 0}};
    vplHit hit;
    ++*rays;
    if (!vplGeometry_ClosestHit(s->geometry, &ray, &hit)) {
        return false;
    }
    const bool back = vplDot(direction, hit.normal) > 0;
    const vplVec3 normal = back ? vplNegate(hit.normal) : hit.normal;
    const int patch = vplPatches_Find(s->patches, hit.triangle, hit.position);
    *hitOut = (vplLitHit){.point = vplAdd(hit.position, vplScale(s->heights[patch], normal)),
                          .normal = normal,
                          .side = 2 * patch + back,
                          .triangle = hit.triangle};
    return true;
}

void vplLitSearch_ResolveOverlap(const vplLitSearch* s, vplLitHit* hit, int64_t* rays)
{
    const vplVec3 down = vplScale(-s->heights[hit->side / 2], hit->normal);
    const int first = firstBelow(s, hit->point, down, hit->triangle, rays);
    if (first != hit->triangle) {
        const int patch = vplPatches_Find(s->patches, first, vplAdd(hit->point, down));
        hit->side = 2 * patch + (vplDot(hit->normal, s->geometry->normals[first]) < 0);
    }
}

vplBox vplLitSearch_BoxOf(const vplLitSearch* s, int node)
{
    vplVec3 corners[3];
    vplPatchNode_GetCorners(s->patches, node, false, corners);
    return vplBoundCorners(corners);
}

int vplLitSearch_FindDarkBox(const vplLitSearch* s, vplBox box)
{
    int found = 0;
    while (found < s->darkBoxCount && !vplBox_Overlaps(box, s->darkBoxes[found])) {
        found++;
    }
    return found;
}

// ---- samples

// A sample's random numbers are numbered by their use: its position, up to five rays, the side of `found` that it looks at, and the
// light source.
enum { POSITION = 0, FIRST_RAY = 1, FOUND = 6, LIGHT_SOURCE = 7 };

static vplRandom4 randomOf(const vplLitSearch* s, const vplLitSample* sample, int use)
{
    const uint64_t index = ((uint64_t)sample->side * VPL_PATCH_CELLS + (uint64_t)sample->cell) * 64 +
                           (uint64_t)(sample->index * 8 + use);
    return vplRandomAt(s->def->seed, STREAM + (uint32_t)s->pass, index);
}

vplVec3 vplLitSample_OnSide(const vplLitSearch* s, vplLitSample* sample)
{
    const vplRandom4 r = randomOf(s, sample, POSITION);
    const int patch = sample->side / 2;
    const bool group = vplPatches_IsGroup(s->patches, patch);
    vplVec3 corners[3];
    const int stratum = sample->index * 5 % VPL_LIT_SAMPLES; // spreads the first four over the cell, too
    const float u = ((float)stratum + vplUnitFloat(r.v[0])) / VPL_LIT_SAMPLES,
                sum = vplUnitFloat(r.v[1]) + vplVanDerCorput((uint32_t)sample->index),
                v = sum < 1 ? sum : sum - 1;
    float place = u;
    sample->triangle = group ? vplGroup_SampleTriangle(s->patches, patch, sample->cell, u, &place)
                             : vplPatches_TriangleOf(s->patches, patch);
    vplPatchNode_GetCorners(s->patches, group ? sample->triangle : s->patches->patches[patch],
                            sample->side & 1, corners);
    const vplVec3 at = group ? vplTriangle_Point(corners, place, v)
                             : vplCell_Point(corners, sample->cell, u, v),
                  centre = vplScale(1 / 3.0f, vplAdd(corners[0], vplAdd(corners[1], corners[2])));
    return vplAdd(at, vplScale(INSET, vplSub(centre, at)));
}

bool vplLitSample_Offset(const vplLitSearch* s, vplLitSample* sample, int64_t* rays)
{
    const vplVec3 at = vplLitSample_OnSide(s, sample);
    return vplLitSearch_Offset(s, sample->side, sample->triangle, at, rays, &sample->point);
}

int vplLitSample_SeesViewpoint(const vplLitSearch* s, const vplLitSample* sample, int64_t* rays)
{
    for (int k = 0; k < s->def->viewpointCount; k++) {
        const vplVec3 viewpoint = s->def->viewpoints[k],
                      n = vplLitSearch_Normal(s, sample->side, sample->triangle);
        if (vplDot(vplSub(viewpoint, sample->point), n) > 0 &&
            vplLitSearch_IsVisible(s, sample->point, viewpoint, rays)) {
            return k;
        }
    }
    return -1;
}

bool vplLitSample_Trace(const vplLitSearch* s, const vplLitSample* sample, int ray, int64_t* rays,
                        vplLitHit* hitOut)
{
    const vplRandom4 r = randomOf(s, sample, FIRST_RAY + ray);
    const vplVec3 direction = vplSampleCosineAround(vplLitSearch_Normal(s, sample->side, sample->triangle),
                                                    vplUnitFloat(r.v[0]), vplUnitFloat(r.v[1]));
    return vplLitSearch_Trace(s, sample->point, direction, rays, hitOut);
}

// Tests whether random ray `ray` hits a lit side, and whether the hit sees that side's lit point; otherwise
// floor under a box inherits light from the floor beside it.
static bool seesLitSide(const vplLitSearch* s, vplLitSample* sample, int ray, int64_t* rays, vplVec3* from)
{
    vplLitHit hit;
    if (!vplLitSample_Trace(s, sample, ray, rays, &hit)) {
        return false;
    }
    *from = hit.point;
    sample->fromEye = s->fromEye[hit.side] != 0;
    return s->open[hit.side] != 0 && vplLitSearch_IsVisible(s, sample->point, hit.point, rays) &&
           vplLitSearch_IsVisible(s, hit.point, s->litPoint[hit.side], rays);
}

// Chooses a random point of a light source. Returns whether it can send light to `point`.
static bool sampleLightSource(const vplLitSearch* s, const vplRandom4* r, vplVec3 point, vplVec3* from)
{
    const vplEmission* e = s->emission;
    double rest;
    const int chosen = r->v[1] & 1 ? (int)((uint64_t)r->v[0] * (uint32_t)e->sourceCount >> 32)
                                   : vplEmission_Choose(e, 0, (double)vplUnitFloat(r->v[0]), &rest);
    const vplEmissionSource* source = &e->sources[chosen];
    if (chosen == e->environment) {
        const vplEnvironmentSample sky = vplEnvironment_Sample(
            s->geometry->environment, (double)vplUnitFloat(r->v[2]), (double)vplUnitFloat(r->v[3]));
        *from = vplAdd(point, vplScale(2.5f * (float)e->radius, sky.direction));
        return true;
    }
    if (source->emitter < 0) {
        const vplHit hit = vplGeometry_SampleTriangle(s->geometry, source->triangle, vplUnitFloat(r->v[2]),
                                                      vplUnitFloat(r->v[3]));
        const int patch = vplPatches_Find(s->patches, source->triangle, hit.position);
        *from = vplAdd(hit.position, vplScale(s->heights[patch], hit.normal));
        return vplDot(vplSub(point, *from), hit.normal) > 0;
    }
    const vplEmitterDef* emitter = &e->emitters[source->emitter];
    if (emitter->type == VPL_EMITTER_DIRECTIONAL) {
        *from = vplSub(point, vplScale(2.5f * (float)e->radius, emitter->direction));
        return true;
    }
    const vplVec3 away = vplNormalize(vplSub(point, emitter->position));
    *from = emitter->position;
    return emitter->type != VPL_EMITTER_SPOT ||
           vplSpot_Falloff(emitter, (double)vplDot(away, emitter->direction)) > 0;
}

bool vplLitSample_IsLit(const vplLitSearch* s, vplLitSample* sample, int gathers, int64_t* rays,
                        vplVec3* from)
{
    if (s->emission->sourceCount > 0) {
        const vplRandom4 r = randomOf(s, sample, LIGHT_SOURCE);
        sample->fromEye = false;
        if (sampleLightSource(s, &r, sample->point, from) &&
            vplDot(vplSub(*from, sample->point), vplLitSearch_Normal(s, sample->side, sample->triangle)) >
                0 &&
            vplLitSearch_IsVisible(s, sample->point, *from, rays)) {
            return true;
        }
    }
    for (int ray = 0; ray < gathers; ray++) {
        if (seesLitSide(s, sample, ray, rays, from)) {
            return true;
        }
    }
    return false;
}

bool vplLitSample_SeesFound(const vplLitSearch* s, const vplLitSample* sample, int64_t* rays, vplVec3* from)
{
    if (s->foundCount == 0) {
        return false;
    }
    const uint64_t r = randomOf(s, sample, FOUND).v[0];
    *from = s->litPoint[s->found[r * (uint64_t)s->foundCount >> 32]];
    return vplDot(vplSub(*from, sample->point), vplLitSearch_Normal(s, sample->side, sample->triangle)) > 0 &&
           vplLitSearch_IsVisible(s, sample->point, *from, rays);
}
