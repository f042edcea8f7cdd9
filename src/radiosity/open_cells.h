// SPDX-License-Identifier: MIT
// Where on the sides of patches light can be.
//
// A place is a point a hair above a side. Light reaches it if a particle comes there, or if nothing stands between it and
// another such place. All tests are between places, so light does not creep under what stands on a surface, nor through
// the rounding of a wall's position.
#ifndef VPL_RADIOSITY_OPEN_CELLS_H
#define VPL_RADIOSITY_OPEN_CELLS_H

#include <vpl/radiosity.h>

// Sides are numbered 2 * patch + back here.
typedef struct vplReach {
    const vplPatches* patches;
    const vplGeometry* geometry;
    const vplPatchSidesDef* def;
    float* heights;     // of places, per patch
    uint16_t* open;     // cells that are known to be reached, per side
    uint16_t* nextOpen; // what a sweep adds
    vplVec3* known;     // a place that is reached, per side; of no meaning where `open` is 0
    vplVec3* nextKnown;
    int64_t* taskRays;
    double meanArea; // of patches
    int sweep;       // for other random numbers each time
    int64_t rays;
    vplContext* context;
} vplReach;

// A place that a ray came to.
typedef struct vplLanding {
    vplVec3 place;
    vplVec3 normal; // of the side
    int side;       // -1: nowhere
    int cell;
} vplLanding;

// Follows a ray from a place. False where it meets nothing, or what it meets cannot be seen from there: points on edges
// may round to the wrong side of a wall.
bool vplReach_Land(const vplReach* reach, vplVec3 from, vplVec3 direction, int64_t* rays,
                   vplLanding* landingOut);

// The place above a point of a side. False where another surface is between them, or in the point's place.
bool vplReach_Rise(const vplReach* reach, int side, vplVec3 point, int64_t* rays, vplVec3* placeOut);

// True where nothing stands between two places.
bool vplReach_IsFree(const vplReach* reach, vplVec3 a, vplVec3 b, int64_t* rays);

// Marks what is reached.
void vplReach_Mark(vplReach* reach, const vplLanding* landing);

// A patch so small that its cells are not worth telling apart.
bool vplReach_IsSmall(const vplReach* reach, int patch);

// By particles from all that emits.
vplResult vplReach_ShootParticles(vplReach* reach, const vplEmission* emission);

// By rays from sides that no particle met, and from cells of the others.
vplResult vplReach_Explore(vplReach* reach);

#endif
