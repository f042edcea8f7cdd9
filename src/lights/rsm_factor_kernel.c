// SPDX-License-Identifier: MIT
// The shadow of 16 points from a reflective shadow map. Compiled once per instruction set; all give the same
// bits.
// Based on: William Reeves, David Salesin and Robert Cook, Rendering Antialiased Shadows with Depth Maps,
// SIGGRAPH 1987: depths are compared first, then the results of neighbouring texels are interpolated.
// Departs: each of four texels is compared with the point's own plane at the texel's centre or with the point
// itself, whichever is nearer to the emitter, so that no plane shadows itself at any angle.
//
// Over the map, a plane's depth is linear in parallel views, and its inverse is linear in others. `near` is
// either: negated depth or 1 / depth, larger nearer to the emitter.
#include "lights/kernels.h"
#include "math/scalar.h"
#include "visibility/map_gather.h"

// Points and their planes in the frame of the face that shows them.
typedef struct FacePoints {
    float x[VPL_LANES], y[VPL_LANES], z[VPL_LANES];    // right, up, forward, metres
    float nx[VPL_LANES], ny[VPL_LANES], nz[VPL_LANES]; // unit
    float rounding[VPL_LANES]; // metres: distance of points from their planes by rounding
    int32_t first[VPL_LANES];  // texel of the face
} FacePoints;

// A plane over the map.
typedef struct Slope {
    float column[VPL_LANES], row[VPL_LANES]; // of the point, in texels; 0 is the first one's centre
    float near[VPL_LANES], across[VPL_LANES], down[VPL_LANES]; // there, and its gradient per texel
    float slack[VPL_LANES];     // how much nearer the plane may have been drawn
    int32_t covered[VPL_LANES]; // -1 where the map reaches
} Slope;

// Four units in the last place of coordinates.
static inline float roundingOf(vplVec3 o, float px, float py, float pz)
{
    return 0x1p-22f * (fabsf(px) + fabsf(py) + fabsf(pz) + fabsf(o.x) + fabsf(o.y) + fabsf(o.z));
}

// Centres of texels may lie 1/256 texel outside the triangles that they show.
static inline float slackOf(float across, float down, float rounding)
{
    return 0x1p-8f * (fabsf(across) + fabsf(down)) + fabsf(rounding);
}

// ---- frames

static inline void turnToFace(const vplReflectiveMap* map, const vplSurface* restrict s,
                              FacePoints* restrict out)
{
    const vplVec3 o = map->origin, r = map->right[0], u = map->up[0], f = map->forward[0];
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = s->px[l] - o.x, y = s->py[l] - o.y, z = s->pz[l] - o.z;
        const float nx = s->nx[l], ny = s->ny[l], nz = s->nz[l];
        out->x[l] = x * r.x + y * r.y + z * r.z;
        out->y[l] = x * u.x + y * u.y + z * u.z;
        out->z[l] = x * f.x + y * f.y + z * f.z;
        out->nx[l] = nx * r.x + ny * r.y + nz * r.z;
        out->ny[l] = nx * u.x + ny * u.y + nz * u.z;
        out->nz[l] = nx * f.x + ny * f.y + nz * f.z;
        out->rounding[l] = roundingOf(o, s->px[l], s->py[l], s->pz[l]);
        out->first[l] = 0;
    }
}

// The frames of vplCube_GetFrame; ties go to z, then y, then x.
static inline void turnToCube(const vplReflectiveMap* map, const vplSurface* restrict s,
                              FacePoints* restrict out)
{
    const vplVec3 o = map->origin;
    const int32_t texels = map->size * map->size;
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = s->px[l] - o.x, y = s->py[l] - o.y, z = s->pz[l] - o.z;
        const float nx = s->nx[l], ny = s->ny[l], nz = s->nz[l];
        const float ax = fabsf(x), ay = fabsf(y), az = fabsf(z);
        const int32_t isZ = (az >= ax) & (az >= ay), isY = !isZ & (ay >= ax);
        const float side = isZ ? z : isY ? y : x, sideN = isZ ? nz : isY ? ny : nx;
        const float right = isZ ? x : isY ? x : -z, rightN = isZ ? nx : isY ? nx : -nz;
        const float up = isY ? -z : y, upN = isY ? -nz : ny;
        const float sign = side < 0 ? -1.0f : 1.0f, signY = isY ? sign : 1.0f, signX = isY ? 1.0f : sign;
        out->x[l] = signX * right;
        out->y[l] = signY * up;
        out->z[l] = sign * side;
        out->nx[l] = signX * rightN;
        out->ny[l] = signY * upN;
        out->nz[l] = sign * sideN;
        out->rounding[l] = roundingOf(o, s->px[l], s->py[l], s->pz[l]);
        out->first[l] = ((isZ ? 4 : isY ? 2 : 0) + (side < 0)) * texels;
    }
}

// ---- planes

// Keeps the divisor of a plane away from 0.
static inline float leastOf(float facing)
{
    return fabsf(facing) > 1e-30f ? facing : 1e-30f;
}

static inline __attribute__((always_inline)) void
project(const vplReflectiveMap* map, const FacePoints* restrict s, bool parallel, Slope* restrict out)
{
    const float sideX = (float)(2 * map->extent[0] / map->size),
                sideY = (float)(2 * map->extent[1] / map->size);
    const float inverseX = 1 / sideX, inverseY = 1 / sideY, middle = 0.5f * (float)(map->size - 1);
    const float inverse = 1 / map->unit;
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = s->x[l], y = s->y[l], z = s->z[l], nx = s->nx[l], ny = s->ny[l], nz = s->nz[l];
        const float scale = parallel ? 1 : 1 / vplMaxf(z, 1e-30f); // from metres to the plane at distance 1
        const float rate = parallel ? inverse / leastOf(nz) : 1 / leastOf(x * nx + y * ny + z * nz);
        out->column[l] = middle + x * scale * inverseX;
        out->row[l] = middle - y * scale * inverseY;
        out->near[l] = parallel ? -z * inverse : scale;
        const float across = nx * rate * sideX, down = -ny * rate * sideY;
        out->across[l] = across;
        out->down[l] = down;
        out->slack[l] = slackOf(across, down, s->rounding[l] * rate * scale);
        out->covered[l] = parallel ? -1 : z > 0;
    }
}

// ---- texels

// One coordinate: the two texels around it, the offsets of their centres from it, and the weight of the
// second.
typedef struct Pair {
    int32_t at[2][VPL_LANES];
    float away[2][VPL_LANES], weight[VPL_LANES];
} Pair;

// Beyond the last centre both are the last one. Clears `covered` where the map does not reach.
static inline void findPair(const float coordinate[restrict VPL_LANES], int32_t size,
                            int32_t covered[restrict VPL_LANES], Pair* restrict out)
{
    const float end = (float)size - 0.5f;
    const int32_t last = size - 1;
    for (int l = 0; l < VPL_LANES; l++) {
        const float c = coordinate[l], within = vplMinf(vplMaxf(c, -0.5f), end);
        const int32_t before = (int32_t)(within + 1) - 1;
        const int32_t first = before > 0 ? before : 0, after = before + 1,
                      second = after < last ? after : last;
        out->at[0][l] = first;
        out->at[1][l] = second;
        out->away[0][l] = (float)first - within;
        out->away[1][l] = (float)second - within;
        out->weight[l] = within - (float)before;
        covered[l] &=
            fabsf(c - within) < 0x1p-8f ? -1 : 0; // at a cube's edges rounding may move it outside both faces
    }
}

// 1 where a texel shows something nearer than the plane there and the point.
static inline void compare(const vplReflectiveMap* map, const Slope* restrict s,
                           const float away[2][VPL_LANES], const float stored[restrict VPL_LANES],
                           float hides[restrict VPL_LANES])
{
    const bool parallel = map->emitter.type == VPL_EMITTER_DIRECTIONAL;
    const float larger = (float)(map->extent[0] > map->extent[1] ? map->extent[0] : map->extent[1]);
    const float side = 2 * larger / (float)map->size / map->unit;
    const float tolerance = VPL_REFLECTIVE_TOLERANCE * side + 0x1p-16f;
    for (int l = 0; l < VPL_LANES; l++) {
        const float across = s->across[l], down = s->down[l], near = s->near[l], slack = s->slack[l];
        const float depth = stored[l];
        const float plane = near + (across * away[0][l] + down * away[1][l]);
        const float nearest = vplMaxf(near, plane);
        const float parallelLimit = -(nearest + slack + tolerance),
                    coneLimit = nearest * (1 + tolerance) + slack;
        const float left = parallel ? depth : depth * coneLimit, right = parallel ? parallelLimit : 1;
        hides[l] = left < right ? 1.0f : 0.0f;
    }
}

void VPL_KERNEL(vplReflectiveFactor)(const vplReflectiveMap* map, const vplSurface* surface,
                                     float factor[restrict VPL_LANES])
{
    FacePoints points;
    Slope slope;
    Pair columns, rows;
    float hides[4][VPL_LANES];
    if (map->emitter.type == VPL_EMITTER_POINT) {
        turnToCube(map, surface, &points);
    } else {
        turnToFace(map, surface, &points);
    }
    if (map->emitter.type == VPL_EMITTER_DIRECTIONAL) {
        project(map, &points, true, &slope);
    } else {
        project(map, &points, false, &slope);
    }
    findPair(slope.column, map->size, slope.covered, &columns);
    findPair(slope.row, map->size, slope.covered, &rows);
    for (int k = 0; k < 4; k++) {
        const int i = k & 1, j = k >> 1;
        int32_t place[VPL_LANES];
        float stored[VPL_LANES], away[2][VPL_LANES];
        for (int l = 0; l < VPL_LANES; l++) {
            place[l] = points.first[l] + rows.at[j][l] * map->size + columns.at[i][l];
            away[0][l] = columns.away[i][l];
            away[1][l] = rows.away[j][l];
        }
        vplGather(map->depth, place, stored);
        compare(map, &slope, away, stored, hides[k]);
    }
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = columns.weight[l], y = rows.weight[l];
        const float above = hides[0][l] + x * (hides[1][l] - hides[0][l]);
        const float below = hides[2][l] + x * (hides[3][l] - hides[2][l]);
        const float mixed = above + y * (below - above);
        factor[l] = slope.covered[l] ? mixed : 0.0f;
    }
}
