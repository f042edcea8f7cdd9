// SPDX-License-Identifier: MIT
// Based on: Eric Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997, chapter 9: light of emitting
// triangles is found by a point on one of them and by the path itself, and both are weighted by the power heuristic.
// Divided out for diffuse surfaces, everything hangs on one ratio of the two densities, and no term exceeds rho L:
// there is nothing that could overflow where a surface touches a light.
#include "geometry/emission.h"
#include "math/vec.h"
#include "reference/path.h"

#include <float.h>

// ---- both ways of finding a triangle's light

// Density of the point on the light over density of the reflected direction, both per solid angle.
static double densityRatio(const vplPathScene* s, vplRgb radiance, double squaredDistance,
                           double cosineAtLight, double cosine)
{
    double perArea = VPL_PI * ((double)radiance.r + radiance.g + radiance.b) / 3 / s->trianglePower;
    return perArea * squaredDistance / cosineAtLight * VPL_PI / cosine;
}

// What radiance 1 found by a point on a light adds to a surface of reflectance 1: weight / ratio.
static double valueOfPoint(vplPathLights lights, double ratio)
{
    switch (lights) {
    case VPL_PATH_BALANCE:
        return 1 / (1 + ratio);
    case VPL_PATH_POINTS:
        return 1 / ratio;
    case VPL_PATH_CHANCE:
        return 0;
    default: // ratio / (1 + ratio^2)
        return ratio < 1 ? ratio / (1 + ratio * ratio) : 1 / (ratio + 1 / ratio);
    }
}

// The same found by the path itself, whose directions have the right density.
static double valueOfChance(vplPathLights lights, double ratio)
{
    switch (lights) {
    case VPL_PATH_BALANCE:
        return 1 / (1 + ratio);
    case VPL_PATH_POINTS:
        return 0;
    case VPL_PATH_CHANCE:
        return 1;
    default:
        return 1 / (1 + ratio * ratio);
    }
}

double vplWeightOfChance(const vplPathScene* scene, const vplPathVertex* vertex, const vplHit* hit,
                         vplVec3 direction)
{
    const vplGeometry* g = scene->geometry;
    double cosine = vplDot(direction, vertex->shading), cosineAtLight = -vplDot(direction, hit->normal);
    if (!(cosine > 0 && cosineAtLight > 0)) {
        return 0; // after rounding only
    }
    vplRgb radiance = g->materials[g->triangleMaterials[hit->triangle]].emission;
    double ratio = densityRatio(scene, radiance, (double)hit->t * hit->t, cosineAtLight, cosine);
    return valueOfChance(scene->def.lights, ratio);
}

// ---- shadow rays

static float largestCoordinate(vplVec3 p)
{
    return fmaxf(fabsf(p.x), fmaxf(fabsf(p.y), fabsf(p.z)));
}

// Whether `place` is seen from the vertex. A shadow ray must not end at the light's own surface, which rounding
// puts before or behind the point: it stops short by the rounding of coordinates, stretched by grazing angles.
static bool sees(const vplPathScene* s, const vplPathVertex* v, vplVec3 place, double distance,
                 double cosineAtLight, int64_t* rays)
{
    vplVec3 way = vplSub(place, v->hit.position);
    double extent = fmaxf(largestCoordinate(place), largestCoordinate(v->hit.position));
    double shorter = 0x1p-20 + 0x1p-19 * extent / (distance * cosineAtLight);
    vplRay ray = vplGeometry_Leave(s->geometry, &v->hit, way);
    ++*rays;
    return !vplGeometry_IsOccluded(s->geometry, &ray, (float)(1 - (shorter < 0.5 ? shorter : 0.5)));
}

// Cosine of the vertex towards a unit vector; 0 below the surface.
static double cosineTowards(const vplPathVertex* v, const double way[3])
{
    double flat = v->normal.x * way[0] + v->normal.y * way[1] + v->normal.z * way[2];
    double cosine = v->shading.x * way[0] + v->shading.y * way[1] + v->shading.z * way[2];
    return flat > 0 && cosine > 0 ? cosine : 0;
}

// The unit vector from a to b in double, and the distance; 0 where they coincide.
static double wayFrom(vplVec3 a, vplVec3 b, double way[3])
{
    double x = (double)b.x - a.x, y = (double)b.y - a.y, z = (double)b.z - a.z;
    double distance = sqrt(x * x + y * y + z * z);
    double scale = distance > 0 ? 1 / distance : 0;
    way[0] = x * scale;
    way[1] = y * scale;
    way[2] = z * scale;
    return distance;
}

// ---- emitting triangles

static void addTriangle(const vplPathScene* s, const vplPathVertex* v, const float u[2],
                        vplDirectLight* light, int64_t* rays)
{
    double rest, way[3];
    int source = vplEmission_Choose(s->emission, s->emission->firstTriangle, (double)u[0], &rest);
    int triangle = s->emission->sources[source].triangle;
    vplHit point = vplGeometry_SampleTriangle(s->geometry, triangle, (float)rest * 0x1.fffffep-1f, u[1]);
    double distance = wayFrom(v->hit.position, point.position, way);
    if (distance == 0) {
        return;
    }
    double cosineAtLight = -(point.normal.x * way[0] + point.normal.y * way[1] + point.normal.z * way[2]);
    double cosine = cosineTowards(v, way);
    if (!(cosineAtLight > 0 && cosine > 0)) {
        return;
    }
    vplRgb radiance = s->geometry->materials[s->geometry->triangleMaterials[triangle]].emission;
    double ratio = densityRatio(s, radiance, distance * distance, cosineAtLight, cosine);
    double value = valueOfPoint(s->def.lights, ratio);
    if (value > 0 && sees(s, v, point.position, distance, cosineAtLight, rays)) {
        light->r += value * v->rho.r * radiance.r;
        light->g += value * v->rho.g * radiance.g;
        light->b += value * v->rho.b * radiance.b;
    }
}

// ---- emitters

// Irradiance by an emitter as if nothing stood between, over pi times rho.
static vplDirectLight unshadowed(const vplEmitterDef* e, const vplPathVertex* v)
{
    double way[3] = {-(double)e->direction.x, -(double)e->direction.y, -(double)e->direction.z}, falloff = 1;
    if (e->type != VPL_EMITTER_DIRECTIONAL) {
        double distance = wayFrom(v->hit.position, e->position, way);
        if (distance == 0) {
            return (vplDirectLight){0, 0, 0};
        }
        falloff = 1 / (distance * distance);
    }
    double scale = cosineTowards(v, way) * falloff / VPL_PI;
    if (scale <= 0) {
        return (vplDirectLight){0, 0, 0};
    }
    vplRgb i = vplEmitter_Intensity(e, vplVec((float)-way[0], (float)-way[1], (float)-way[2]));
    return (vplDirectLight){scale * v->rho.r * i.r, scale * v->rho.g * i.g, scale * v->rho.b * i.b};
}

static bool seesEmitter(const vplPathScene* s, const vplPathVertex* v, const vplEmitterDef* e, int64_t* rays)
{
    if (e->type != VPL_EMITTER_DIRECTIONAL) {
        double way[3], distance = wayFrom(v->hit.position, e->position, way);
        return sees(s, v, e->position, distance, 1, rays);
    }
    vplRay ray = vplGeometry_Leave(s->geometry, &v->hit, vplNegate(e->direction));
    ++*rays;
    return !vplGeometry_IsOccluded(s->geometry, &ray, FLT_MAX);
}

static void addEmitter(const vplPathScene* s, const vplPathVertex* v, const vplEmitterDef* e,
                       vplDirectLight value, double scale, vplDirectLight* light, int64_t* rays)
{
    if (value.r + value.g + value.b > 0 && seesEmitter(s, v, e, rays)) {
        light->r += scale * value.r;
        light->g += scale * value.g;
        light->b += scale * value.b;
    }
}

// One emitter with probability by what it would send if nothing stood between: weighted reservoir sampling with
// one number that is stretched anew at every step.
static void addOneEmitter(const vplPathScene* s, const vplPathVertex* v, double choice, vplDirectLight* light,
                          int64_t* rays)
{
    const vplEmission* e = s->emission;
    vplDirectLight chosen = {0, 0, 0};
    double total = 0, chosenWeight = 0;
    int at = -1;
    for (int i = 0; i < e->emitterCount; i++) {
        vplDirectLight value = unshadowed(&e->emitters[i], v);
        double weight = value.r + value.g + value.b;
        if (weight <= 0) {
            continue;
        }
        total += weight;
        double share = weight / total;
        if (choice < share) {
            choice /= share;
            chosen = value;
            chosenWeight = weight;
            at = i;
        } else {
            choice = (choice - share) / (1 - share);
        }
    }
    if (at >= 0) {
        addEmitter(s, v, &e->emitters[at], chosen, total / chosenWeight, light, rays);
    }
}

vplDirectLight vplSampleDirect(const vplPathScene* scene, const vplPathVertex* vertex, const float u[2],
                               const vplPathNumbers* numbers, uint32_t set, int64_t* rays)
{
    const vplEmission* e = scene->emission;
    vplDirectLight light = {0, 0, 0};
    if (e->emitterCount > scene->def.allEmitters) {
        float more[4];
        vplPathNumbers_Get(numbers, set, more);
        addOneEmitter(scene, vertex, (double)more[0], &light, rays);
    } else {
        for (int i = 0; i < e->emitterCount; i++) {
            addEmitter(scene, vertex, &e->emitters[i], unshadowed(&e->emitters[i], vertex), 1, &light, rays);
        }
    }
    if (scene->trianglePower > 0) {
        addTriangle(scene, vertex, u, &light, rays);
    }
    return light;
}
