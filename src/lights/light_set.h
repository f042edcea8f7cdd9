// SPDX-License-Identifier: MIT
// Making sets of virtual lights, and preparing lights and points for kernels.
#ifndef VPL_LIGHTS_LIGHT_SET_H
#define VPL_LIGHTS_LIGHT_SET_H

#include <vpl/lights.h>

#include "math/vec.h"
#include "visibility/blocks.h"
#include "visibility/hemi_map.h"

#include <stddef.h>
#include <string.h>

// The arrays of a set, to be written until the set is given away.
typedef struct vplLightArrays {
    vplVirtualLight* lights;
    int *stepCounts, *lightsInStep;
} vplLightArrays;

// A set with room for so many lights and steps; all but the lights is 0, and so is lightCount.
vplResult vplLightSet_Make(vplContext* context, int capacity, int stepCount, vplLightArrays* arraysOut,
                           vplLightSet** setOut);

// A set for some lights of another one: the same steps, statistics and N.
vplResult vplLightSet_MakeSubset(const vplLightSet* from, int capacity, vplLightArrays* arraysOut,
                                 vplLightSet** setOut);

// The lights of two sets that each stand for light of their own: those of `a`, then those of `b`. Steps are
// kept. N is that of `a`, and the weights of `b` are adapted to it, unless `a` has none.
vplResult vplLightSet_Join(const vplLightSet* a, const vplLightSet* b, vplLightSet** setOut);

// Counts emitting faces: faces of quads and boxes, and single triangles of meshes.
int vplCountEmittingFaces(const vplEmission* emission);

// Writes about `count` samples on area lights: each emitting face has at least one, and the samples of a face share its power.
// Returns how many were written, at most count + vplCountEmittingFaces(emission).
int vplSampleEmittingFaces(const vplEmission* emission, int count, vplShadeLight* out);

// One light of N particles as kernels read it, see vplPrepareLights.
static inline vplShadeLight vplPrepareLight(const vplVirtualLight* v, int particleCount, vplLighting lighting)
{
    // A virtual light of flux P emits P/pi cos; its colour includes the 1/pi.
    const float scale = lighting == VPL_LIGHTING_PHYSICAL ? (float)(1 / VPL_PI) : 1;
    const vplRgb shown = vplRgbScale(scale * (v->weight / (float)particleCount), v->light);
    return (vplShadeLight){v->position.x, v->position.y, v->position.z, v->normal.x, v->normal.y,
                           v->normal.z,   shown.r,       shown.g,       shown.b};
}

// Writes one point of sixteen.
static inline void vplSurface_Put(vplSurface* surface, int lane, vplVec3 position, vplVec3 normal)
{
    surface->px[lane] = position.x;
    surface->py[lane] = position.y;
    surface->pz[lane] = position.z;
    surface->nx[lane] = normal.x;
    surface->ny[lane] = normal.y;
    surface->nz[lane] = normal.z;
}

static inline vplVec3 vplSurface_At(const vplSurface* surface, int lane)
{
    return vplVec(surface->px[lane], surface->py[lane], surface->pz[lane]);
}

// The direction to one virtual light from a point, as vplWayToLight gives it.
static inline vplVec3 vplWayTo(const vplShadeLight* light, vplVec3 from)
{
    return vplWayToLight(vplVec(light->px, light->py, light->pz), vplVec(light->nx, light->ny, light->nz),
                         from);
}

// Column k of six that a light has for kernels: its position, then its normal.
static inline float vplShadeLight_Column(const vplShadeLight* light, int k)
{
    float value;
    memcpy(&value, (const char*)light + (size_t)k * sizeof value, sizeof value);
    return value;
}

_Static_assert(offsetof(vplShadeLight, nz) == 5 * sizeof(float), "a light begins with its six columns");

#endif
