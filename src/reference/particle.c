// SPDX-License-Identifier: MIT
// Based on: Eric P. Lafortune and Yves D. Willems, Bi-directional Path Tracing, Compugraphics 1993, cut down to light
// paths of one step: where a particle lands, light is bright, and a path from the eye may hardly find the place by
// itself (the ceiling above a point light, the spot that a spotlight makes).
#include "math/vec.h"
#include "reference/path.h"

vplLanding vplShootParticle(const vplPathScene* scene, double choice, const float u[4], int64_t* rays)
{
    vplLanding l = {.landed = false};
    vplParticle particle;
    if (!vplEmission_SampleParticle(scene->emission, choice, u, &particle)) {
        return l;
    }
    const vplEmissionSource* source = &scene->emission->sources[particle.source];
    l.light = (vplLightPoint){source->emitter, source->triangle, particle.ray.origin, particle.normal};
    ++*rays;
    l.landed = vplGeometry_ClosestHit(scene->geometry, &particle.ray, &l.hit);
    return l;
}

vplLight3 vplConnect(const vplPathScene* scene, const vplPathVertex* vertex, const vplLanding* landing,
                     int64_t* rays)
{
    const vplLight3 none = {0, 0, 0};
    vplVec3 between = vplSub(landing->hit.position, vertex->hit.position);
    double distance = (double)vplLength(between);
    if (!(distance > 0)) {
        return none;
    }
    // As if the path from the eye had been reflected to this place.
    vplPathVertex there = vplPathVertex_Make(scene, &landing->hit, between);
    double cosine = vplDot(between, vertex->shading) / distance,
           flat = vplDot(between, vertex->normal) / distance;
    double cosineThere = -vplDot(between, there.normal) / distance;
    if (!(cosine > 0 && flat > 0 && cosineThere > 0)) {
        return none;
    }
    there.density = cosine * cosineThere / (VPL_PI * distance * distance);
    vplLightWay way = vplFindWay(scene, &there, &landing->light);
    if (way.distance == 0) {
        return none;
    }
    double weight = vplWeightOfParticle(scene, &way);
    vplLight3 value = {weight * vertex->rho.r * way.value.r, weight * vertex->rho.g * way.value.g,
                       weight * vertex->rho.b * way.value.b};
    bool any = value.r + value.g + value.b > 0;
    return any && vplSees(scene, vertex, landing->hit.position, distance, cosineThere, rays) ? value : none;
}
