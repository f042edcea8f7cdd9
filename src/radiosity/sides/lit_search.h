// SPDX-License-Identifier: MIT
// The search for the sides of patches, and their cells, that light can reach: the lit sides and the open
// cells.
//
// All visibility tests run between offset points, which lie a small height above a side. An offset point is
// lit if a particle comes there, or if nothing blocks the segment to another lit point. Light therefore
// neither creeps under what stands on a surface nor leaks through a wall whose position is rounded.
#ifndef VPL_RADIOSITY_LIT_SEARCH_H
#define VPL_RADIOSITY_LIT_SEARCH_H

#include "base/arena.h"
#include "geometry/box.h"
#include "math/vec.h"

#include <vpl/radiosity.h>

// Sides are numbered 2 * patch + back here.
typedef struct vplLitSearch {
    const vplPatches* patches;
    const vplGeometry* geometry;
    const vplPatchSidesDef* def;
    const vplEmission* emission;
    float* heights;     // of offset points, per patch, metres
    uint16_t* open;     // per side: 0 if it is not lit yet, else all cells or, at the end, its open cells
    int* hits;          // per side: hits of particles, but not the starts of their paths
    vplVec3* litPoint;  // per side: an offset point that is lit; undefined where `open` is 0
    uint16_t* nextOpen; // the results of the current pass
    vplVec3* nextLitPoint;
    uint8_t *fromEye,
        *nextFromEye; // per side: 1 if a viewpoint sees it, or a side that one sees, but light was not found
    int64_t* taskRays;
    double meanArea;     // of patches
    int pass;            // selects other random numbers in each pass
    uint16_t* darkShare; // per side: passes that give a dark side its share of the samples; else undefined
    int* found;          // sides that count as dark until a pass of closeDarkRooms found light on them
    int foundCount;
    int darkPass;      // passes over dark sides so far
    bool spreads;      // the last of them found light, so that other dark sides may have it from there
    uint8_t* dark;     // vplPatchSides.dark
    vplBox* darkBoxes; // of dark rooms, where triangles are in groups
    int darkBoxCount;
    uint8_t* isSeen;   // per side: 1 if a viewpoint sees it; NULL until vplLitSearch_LeaveFaint
    float* level;      // per side that is seen or may be faint: the light that its rays meet
    float seenDensity; // hits of particles per square metre of what viewpoints see
    int faintCount;    // sides that are left out because they are faint
    int64_t rays;
    vplArena* scratch;
    vplContext* context;
} vplLitSearch;

// Patches per task of a pass, and tasks per batch of particles: taskRays has room for either.
enum { VPL_LIT_TASK_PATCHES = 32, VPL_LIT_PARTICLE_TASKS = 32, VPL_DARK_BOXES = 16 };

// Triangles overlap if their distance is at most this fraction of an offset point's height. Rounding decides
// which of them a ray hits, so the triangle with the lowest index stands for all.
#define VPL_COPLANAR 0x1p-6f

// ---- the steps (lit_particles.c, lit_sides.c, faint_sides.c, lit_cells.c)

// Marks the sides that particles from all light sources hit.
vplResult vplLitSearch_ShootParticles(vplLitSearch* search);

// Finds lit sides among those that no particle hit.
vplResult vplLitSearch_FindSides(vplLitSearch* search);

// Closes sides that hardly any light reaches and no viewpoint sees, where they are many and nothing that is seen is dim.
vplResult vplLitSearch_LeaveFaint(vplLitSearch* search);

// Finds the open cells of all lit sides, and the dark triangles of their groups.
vplResult vplLitSearch_FindCells(vplLitSearch* search);

// Runs `examine` for all sides in parallel; progress runs over range[0] .. range[1]. Results take effect
// after the pass, so the order of tasks does not matter. *newOut: how many sides became lit.
typedef void vplExamineFcn(const vplLitSearch* search, int side, int64_t* rays);
vplResult vplLitSearch_ForAllSides(vplLitSearch* search, vplExamineFcn* examine, const double range[2],
                                   int* newOut);

// ---- rays between offset points (lit_rays.c)

// The unit normal of a side of a triangle.
static inline vplVec3 vplLitSearch_Normal(const vplLitSearch* search, int side, int triangle)
{
    const vplVec3 n = search->geometry->normals[triangle];
    return side & 1 ? vplNegate(n) : n;
}

// The offset point above a point of a side, which is on a triangle. False if another surface is between the two, or if
// an overlapping triangle has a lower index.
bool vplLitSearch_Offset(const vplLitSearch* search, int side, int triangle, vplVec3 point, int64_t* rays,
                         vplVec3* offsetOut);

// Moves an offset point of a patch by its height towards a point that it sees. An offset point that lies
// exactly in the plane of a wall, where its side of the wall is undefined, is then on the right side. (At
// 205,824 patches one such point lit the inside of a block of cornell-area.)
vplVec3 vplLitSearch_MoveTowards(const vplLitSearch* search, int patch, vplVec3 offset, vplVec3 towards);

bool vplLitSearch_IsVisible(const vplLitSearch* search, vplVec3 a, vplVec3 b, int64_t* rays);

// The point at which a ray hit a side.
typedef struct vplLitHit {
    vplVec3 point;  // the offset point there
    vplVec3 normal; // of the side
    int side;       // -1: none
    int triangle;
    bool isSure; // the side was not lit before, and the path up to this hit was confirmed
} vplLitHit;

// False if the ray hits nothing.
bool vplLitSearch_Trace(const vplLitSearch* search, vplVec3 from, vplVec3 direction, int64_t* rays,
                        vplLitHit* hitOut);

// Moves a hit to the first of the triangles that overlap there.
void vplLitSearch_ResolveOverlap(const vplLitSearch* search, vplLitHit* hit, int64_t* rays);

// The box of a node of the patches.
vplBox vplLitSearch_BoxOf(const vplLitSearch* search, int node);

// Returns the first of the search's darkBoxes that overlaps a box, or darkBoxCount.
int vplLitSearch_FindDarkBox(const vplLitSearch* search, vplBox box);

// ---- random points of sides (lit_rays.c)

enum { VPL_LIT_SAMPLES = 8 }; // per cell

// Sample `index`, in [0, VPL_LIT_SAMPLES), of a cell.
typedef struct vplLitSample {
    int side, cell, index;
    int triangle;  // set by vplLitSample_OnSide
    vplVec3 point; // the offset point
    bool fromEye;  // set by vplLitSample_IsLit: the side that sends light was found from a viewpoint alone
} vplLitSample;

// The sample's point on the side: stratified, and clear of the patch's edges, where walls meet.
vplVec3 vplLitSample_OnSide(const vplLitSearch* search, vplLitSample* sample);

// Tests whether the lit point of a random side of search->found is visible from the sample. *fromOut: that point.
bool vplLitSample_SeesFound(const vplLitSearch* search, const vplLitSample* sample, int64_t* rays,
                            vplVec3* fromOut);

// Fills sample->point. False as in vplLitSearch_Offset.
bool vplLitSample_Offset(const vplLitSearch* search, vplLitSample* sample, int64_t* rays);

// The first viewpoint that is visible from the sample; -1: none.
int vplLitSample_SeesViewpoint(const vplLitSearch* search, const vplLitSample* sample, int64_t* rays);

// Traces random ray `ray` from the sample, distributed by the cosine. False if it hits nothing.
bool vplLitSample_Trace(const vplLitSearch* search, const vplLitSample* sample, int ray, int64_t* rays,
                        vplLitHit* hitOut);

// Tests whether light reaches the sample, from one random point of one light source or along one of `gathers`
// rays from other sides. *fromOut: the point that sends the light.
bool vplLitSample_IsLit(const vplLitSearch* search, vplLitSample* sample, int gathers, int64_t* rays,
                        vplVec3* fromOut);

#endif
