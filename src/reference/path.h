// SPDX-License-Identifier: MIT
// One path, and the light that reaches its vertices directly.
#ifndef VPL_REFERENCE_PATH_H
#define VPL_REFERENCE_PATH_H

#include "math/sobol.h"
#include "reference/path_trace.h"

// What all paths read.
typedef struct vplPathScene {
    const vplGeometry* geometry;
    vplEmission* emission;
    vplPathDef def;
    vplSobol sobol;
    vplVec3 right, up, forward;  // of the camera
    double scaleX, scaleY;       // tangents of its half-angles
    double power, trianglePower; // W, of all sources and of the triangles among them
} vplPathScene;

// Where the numbers of one path come from.
typedef struct vplPathNumbers {
    const vplPathScene* scene;
    uint64_t stream; // a pixel's half of the samples
    uint32_t index;  // of the path in it
} vplPathNumbers;

// Four numbers in [0, 1), the `set`-th of the path.
void vplPathNumbers_Get(const vplPathNumbers* numbers, uint32_t set, float out[4]);

// A point where a path is reflected.
typedef struct vplPathVertex {
    vplHit hit;
    vplVec3 normal;  // of the surface, on the side the path came from
    vplVec3 shading; // to shade with, turned the same way
    vplRgb rho;
    double density; // with which a reflection leads here, per square metre; infinite for what the eye sees
} vplPathVertex;

vplPathVertex vplPathVertex_Make(const vplPathScene* scene, const vplHit* hit, vplVec3 direction);

// Radiance, or a share of it.
typedef struct vplLight3 {
    double r, g, b;
} vplLight3;

// A point on a light.
typedef struct vplLightPoint {
    int emitter, triangle; // index of one, -1 for the other
    vplVec3 position, normal;
} vplLightPoint;

// The way from a vertex to a point on a light, as if nothing stood between.
typedef struct vplLightWay {
    vplLight3 value;         // what the vertex reflects, over the density of choosing the point
    double chance, particle; // densities of finding the same path in the other ways, over that of choosing it
    double distance, cosineAtLight; // 0: there is no way
} vplLightWay;

vplLightWay vplFindWay(const vplPathScene* scene, const vplPathVertex* vertex, const vplLightPoint* light);

// Weights of a path that was found by choosing the point, by chance, and by a particle; the last over its density.
double vplWeightOfPoint(const vplPathScene* scene, const vplLightWay* way);
double vplWeightOfChance(const vplPathScene* scene, const vplLightWay* way);
double vplWeightOfParticle(const vplPathScene* scene, const vplLightWay* way);

// Whether `place` is seen from the vertex; the cosine is the place's own towards the vertex.
bool vplSees(const vplPathScene* scene, const vplPathVertex* vertex, vplVec3 place, double distance,
             double cosineAtPlace, int64_t* rays);

// Radiance that the sources send to the vertex and it reflects. u picks the place on an emitting triangle, the first
// number of `set` the emitter where there are many.
vplLight3 vplSampleDirect(const vplPathScene* scene, const vplPathVertex* vertex, const float u[2],
                          const vplPathNumbers* numbers, uint32_t set, int64_t* rays);

// Where a particle from a light has landed.
typedef struct vplLanding {
    bool landed;
    vplLightPoint light;
    vplHit hit;
} vplLanding;

vplLanding vplShootParticle(const vplPathScene* scene, double choice, const float u[4], int64_t* rays);

// Radiance that reaches the vertex by one reflection where the particle has landed, and is reflected again.
vplLight3 vplConnect(const vplPathScene* scene, const vplPathVertex* vertex, const vplLanding* landing,
                     int64_t* rays);

// Follows one path through pixel (x, y) and adds the radiance it brings to sum.
void vplFollowPath(const vplPathScene* scene, int x, int y, const vplPathNumbers* numbers, double sum[3],
                   int64_t* rays);

#endif
