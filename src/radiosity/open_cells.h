// SPDX-License-Identifier: MIT
// Where on the sides of patches light can be.
//
// A place is a point a hair above a side. Light reaches it if a particle comes there, or if nothing stands between it
// and another such place. All tests are between places, so light does not creep under what stands on a surface, nor
// through the rounding of a wall's position.
#ifndef VPL_RADIOSITY_OPEN_CELLS_H
#define VPL_RADIOSITY_OPEN_CELLS_H

#include <vpl/radiosity.h>

// Sides are numbered 2 * patch + back here.
typedef struct vplReach {
    const vplPatches* patches;
    const vplGeometry* geometry;
    const vplPatchSidesDef* def;
    const vplEmission* emission;
    float* heights;     // of places, per patch
    uint16_t* open;     // per side: 0: nothing is known; else it is reached, and in the end these cells are
    uint16_t* nextOpen; // what a sweep finds
    vplVec3* known;     // a place that is reached, per side; of no meaning where `open` is 0
    vplVec3* nextKnown;
    int64_t* taskRays;
    double meanArea; // of patches
    int sweep;       // for other random numbers each time
    int64_t rays;
    vplContext* context;
} vplReach;

// Tasks that vplReach.taskRays has room for: patches are examined by so many each, particles in so many tasks.
enum { VPL_REACH_PATCHES = 32, VPL_REACH_PARTICLE_TASKS = 32 };

// Triangles whose distance is this share of a place's height apart are in one place: their rounding decides which of
// them a ray meets. That triangle counts which has the lowest index.
#define VPL_SAME_PLACE 0x1p-6f

// A place that a ray came to.
typedef struct vplLanding {
    vplVec3 place;
    vplVec3 normal; // of the side
    int side;       // -1: none
} vplLanding;

// Unit; of a side.
vplVec3 vplReach_Normal(const vplReach* reach, int side);

// Follows a ray from a place. False where it meets nothing.
bool vplReach_Land(const vplReach* reach, vplVec3 from, vplVec3 direction, int64_t* rays,
                   vplLanding* landingOut);

// Of triangles in one place, the first is where light lands: turns a landing to that one's side.
void vplReach_Settle(const vplReach* reach, vplLanding* landing, int64_t* rays);

// The place above a point of a side. False where another surface is between them, or a triangle with a lower index is in
// the point's place.
bool vplReach_Rise(const vplReach* reach, int side, vplVec3 point, int64_t* rays, vplVec3* placeOut);

// A place moved by its height towards one that it is seen from, which it may still be seen from: if it was in the very
// plane of a wall, where nothing tells one side from the other, it is on that one's side now. At 205,824 patches one
// such place had lit the inside of a block of cornell-area.
vplVec3 vplReach_Pull(const vplReach* reach, int patch, vplVec3 place, vplVec3 towards);

// True where nothing stands between two places.
bool vplReach_IsFree(const vplReach* reach, vplVec3 a, vplVec3 b, int64_t* rays);

// A patch so small that its cells are not worth telling apart.
bool vplReach_IsSmall(const vplReach* reach, int patch);

// By particles from all that emits.
vplResult vplReach_ShootParticles(vplReach* reach);

// By rays from sides that no particle met.
vplResult vplReach_Explore(vplReach* reach);

// The cells of all sides that are reached.
vplResult vplReach_FindCells(vplReach* reach);

// Runs `examine` for all sides. What it finds counts for the next sweep only, so that the order of tasks is of no matter.
// *freshOut: how many sides are reached that were not.
typedef void vplExamineFcn(const vplReach* reach, int side, int64_t* rays);
vplResult vplReach_Sweep(vplReach* reach, vplExamineFcn* examine, double from, double to, int* freshOut);

// ---- of one side

// Random point `point`, [0, VPL_REACH_POINTS), of a cell, stratified; clear of the patch's edges, where walls meet.
enum { VPL_REACH_POINTS = 8 };
vplVec3 vplReach_PointOf(const vplReach* reach, int side, int cell, int point);

// Whether random ray `ray`, [0, 6), from the place above that point lands where light is; *landingOut: at which place.
bool vplReach_SeesLight(const vplReach* reach, int side, int cell, int point, int ray, vplVec3 place,
                        int64_t* rays, vplLanding* landingOut);

// Whether light comes straight to that place from one random source; *fromOut: from where.
bool vplReach_SeesSource(const vplReach* reach, int side, int cell, int point, vplVec3 place, int64_t* rays,
                         vplVec3* fromOut);

#endif
