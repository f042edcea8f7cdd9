// SPDX-License-Identifier: MIT
// Direct light at the vertices of a path, by light sampling and BSDF sampling.
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

// The unobstructed connection of a vertex with a point on a light.
typedef struct vplConnection {
    vplRadiance value; // that the vertex reflects, over the density of choosing the point
    // Densities with which BSDF sampling finds the point, and with which a light path begins there and goes to the vertex, over
    // that of choosing the point.
    double bsdfRatio, particleRatio;
    double edges;                   // of the vertex
    double distance, cosineAtLight; // distance 0: they cannot see each other
} vplConnection;

// As light sampling chooses the point, if it does.
vplConnection vplConnectToLight(const vplPathScene* scene, const vplPathVertex* vertex,
                                const vplLightPoint* light);

// The sum of the weights of light sampling and BSDF sampling, before they are normalized.
double vplConnection_Weights(const vplPathScene* scene, const vplConnection* connection);

// Tests whether a point on a surface is visible from the vertex; the cosine is at the point.
bool vplPathVertex_Sees(vplPathState* path, const vplPathVertex* vertex, vplVec3 point, double distance,
                        double cosine);

#endif
