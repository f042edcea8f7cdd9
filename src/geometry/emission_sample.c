// SPDX-License-Identifier: MIT
// Based on: Eric Heitz, A Low-Distortion Map Between Triangle and Square, 2019, for points on triangles;
// Alexander Keller, Instant Radiosity, SIGGRAPH 1997, for particles that start where light does.
#include "geometry/emission.h"
#include "geometry/triangle.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec.h"

vplHit vplGeometry_SampleTriangle(const vplGeometry* geometry, int triangle, float u, float v)
{
    // Folds the square along its diagonal onto the triangle, so that strata stay compact.
    float b, c;
    if (v > u) {
        b = 0.5f * u;
        c = v - b;
    } else {
        c = 0.5f * v;
        b = u - c;
    }
    float a = 1 - b - c;
    vplTriangleCorners t = vplGeometry_Corners(geometry, triangle);
    vplHit hit = {.object = geometry->owners[triangle],
                  .face = vplGeometry_FaceOf(geometry, triangle),
                  .triangle = triangle,
                  .u = b,
                  .v = c,
                  .normal = geometry->normals[triangle]};
    hit.position =
        vplAdd(vplScale(a, t.corner[0]), vplAdd(vplScale(b, t.corner[1]), vplScale(c, t.corner[2])));
    return hit;
}

static vplVec3 directionAround(vplVec3 axis, double cosine, float v)
{
    double sine2 = 1 - cosine * cosine, along, across;
    float radius = (float)sqrt(sine2 > 0 ? sine2 : 0);
    vplSinCosQuarters(4.0 * v, &across, &along);
    return vplTurnTo(axis, vplVec(radius * (float)along, radius * (float)across, (float)cosine));
}

// A point on a disc just outside the sphere around the geometry.
static vplVec3 startOutside(const vplEmission* e, vplVec3 direction, float u, float v)
{
    float x, y, radius = (float)e->radius;
    vplVec3 tangent, bitangent;
    vplSampleConcentricDisc(u, v, &x, &y);
    vplTangentFrame(direction, &tangent, &bitangent);
    vplVec3 onDisc = vplAdd(vplScale(radius * x, tangent), vplScale(radius * y, bitangent));
    return vplAdd(e->centre, vplSub(onDisc, vplScale(1.001f * radius, direction)));
}

static void startFromEmitter(const vplEmission* e, const vplEmitterDef* emitter, const float u[4],
                             vplParticle* p)
{
    p->ray.origin = emitter->position;
    p->ray.skip = (vplSkip){0, 0};
    if (emitter->type == VPL_EMITTER_POINT) {
        p->ray.direction = vplSampleSphere(u[2], u[3]);
    } else if (emitter->type == VPL_EMITTER_SPOT) {
        p->ray.direction = directionAround(emitter->direction, vplSpot_SampleCosine(emitter, u[2]), u[3]);
    } else {
        p->ray.direction = emitter->direction;
        p->ray.origin = startOutside(e, emitter->direction, u[0], u[1]);
    }
    p->normal = p->ray.direction;
}

// Light of one direction covers the disc with its irradiance over the density of the direction.
static void startFromEnvironment(const vplEmission* e, const float u[4], double factor, vplParticle* p)
{
    const vplEnvironment* environment = e->geometry->environment;
    const vplEnvironmentSample sky = vplEnvironment_Sample(environment, (double)u[2], (double)u[3]);
    p->ray.direction = vplNegate(sky.direction);
    p->ray.origin = startOutside(e, p->ray.direction, u[0], u[1]);
    p->ray.skip = (vplSkip){0, 0};
    p->normal = p->ray.direction;
    p->flux = vplScaleRadiometric(factor * VPL_PI * e->radius * e->radius / sky.density, sky.light);
}

bool vplEmission_SampleParticle(const vplEmission* emission, double choice, const float u[4],
                                vplParticle* particleOut)
{
    if (emission->sourceCount == 0) {
        return false;
    }
    double rest;
    int chosen = vplEmission_Choose(emission, 0, choice, &rest);
    const vplEmissionSource* source = &emission->sources[chosen];
    const double* sums = emission->cumulative + chosen;
    vplParticle p = {.source = chosen};
    p.flux = vplScaleRadiometric(vplEmission_Power(emission) / (sums[1] - sums[0]), source->power);
    if (source->triangle >= 0) {
        vplHit start = vplGeometry_SampleTriangle(emission->geometry, source->triangle, u[0], u[1]);
        vplVec3 direction = vplSampleCosineAround(start.normal, u[2], u[3]);
        p.ray = vplGeometry_Leave(emission->geometry, &start, direction);
        p.position = start.position;
        p.normal = start.normal;
    } else if (source->emitter < 0) {
        startFromEnvironment(emission, u, vplEmission_Power(emission) / (sums[1] - sums[0]), &p);
        p.position = p.ray.origin;
    } else {
        startFromEmitter(emission, &emission->emitters[source->emitter], u, &p);
        p.position = p.ray.origin;
    }
    *particleOut = p;
    return true;
}
