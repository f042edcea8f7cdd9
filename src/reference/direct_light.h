// SPDX-License-Identifier: MIT
// Direct light at the vertices of a path, by three techniques.
#ifndef VPL_REFERENCE_DIRECT_LIGHT_H
#define VPL_REFERENCE_DIRECT_LIGHT_H

#include "reference/path_scene.h"

// Radiance that the vertex reflects from one point on a triangle, one emitter and one direction of the environment,
// weighted as light sampling. u chooses the point; set `set` of the path's numbers the emitter, where there are several,
// and the direction.
vplRadiance vplSampleDirect(vplPathState* path, const vplPathVertex* vertex, const float u[2], uint32_t set);

// Radiance of a triangle that a path from `vertex` has hit, weighted as BSDF sampling.
vplRadiance vplHitEmission(const vplPathScene* scene, const vplPathVertex* vertex, const vplHit* hit,
                           vplVec3 direction);

// Radiance of the environment where a path from `vertex` has left the scene, weighted as BSDF sampling.
vplRadiance vplMissEmission(const vplPathScene* scene, const vplPathVertex* vertex, vplVec3 direction);

// A point on a light.
typedef struct vplLightPoint {
    int emitter,
        triangle; // index of one, -1 for the other; both -1: the environment, whose normal is where light travels
    vplVec3 position, normal;
} vplLightPoint;

// A particle from a light, where it has landed.
typedef struct vplLandedParticle {
    bool landed;
    vplLightPoint light;
    vplHit hit;
} vplLandedParticle;

vplLandedParticle vplShootParticle(vplPathState* path, double choice, const float u[4]);

// Radiance that is reflected where the particle has landed and again at the vertex, weighted as particle
// sampling.
vplRadiance vplConnectToParticle(vplPathState* path, const vplPathVertex* vertex,
                                 const vplLandedParticle* particle);

#endif
