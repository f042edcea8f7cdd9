// SPDX-License-Identifier: MIT
// A triangle prepared for a tile: edges, depth, perspective-correct interpolation. Included by the tile kernel
// only, so that it is compiled for each instruction set.
// Based on: Juan Pineda, A Parallel Algorithm for Polygon Rasterization, SIGGRAPH 1988: edge functions. Ours
// are exact integers, so coverage cannot depend on where a block or a tile starts.
#ifndef VPL_RASTER_SETUP_H
#define VPL_RASTER_SETUP_H

#include "raster/raster.h"

// Edge i lies opposite corner i; its function is the area at that corner.
typedef struct Setup {
    int64_t e[3];       // at the centre of the tile's first pixel, with the bias below
    int32_t a[3], b[3]; // growth per sub-pixel in x and y
    double z, zx, zy;   // depth at the tile's first pixel centre, and its growth per pixel
    _Alignas(64) double laneZ[VPL_LANES];
    double leastZ, mostZ; // of laneZ
} Setup;

// Looks up the corners of a triangle; turned so that its area is positive.
static inline vplTriangle fetchTriangle(const vplRaster* r, const vplShaded* s, int ref)
{
    const uint32_t source = r->refs[ref].source;
    vplTriangle t;
    if (source & (uint32_t)VPL_CLIPPED) {
        const vplClippedTriangle* c = &r->clipped[source & ~(uint32_t)VPL_CLIPPED];
        t.primitive = c->primitive;
        for (int i = 0; i < 3; i++) {
            t.vertex[i] = c->vertex[i];
            t.v[i] = r->extraScreen[c->vertex[i] - (uint32_t)s->mesh.vertexCount];
        }
    } else {
        t.primitive = (int32_t)source - s->firstTriangle;
        for (int i = 0; i < 3; i++) {
            t.vertex[i] = s->mesh.indices[3 * (size_t)t.primitive + (size_t)i];
            t.v[i] = s->screen[t.vertex[i]];
        }
    }
    const int64_t area = (int64_t)(t.v[1].x - t.v[0].x) * (t.v[2].y - t.v[0].y) -
                         (int64_t)(t.v[2].x - t.v[0].x) * (t.v[1].y - t.v[0].y);
    t.clockwise = area > 0; // as seen, because y points down
    if (!t.clockwise) {
        const vplScreenVertex v = t.v[1];
        const uint32_t vertex = t.vertex[1];
        t.v[1] = t.v[2];
        t.vertex[1] = t.vertex[2];
        t.v[2] = v;
        t.vertex[2] = vertex;
    }
    return t;
}

static inline void setUp(const vplTriangle* t, const vplTile* tile, Setup* s)
{
    const int64_t px = (int64_t)tile->x * 256 + 128, py = (int64_t)tile->y * 256 + 128;
    for (int i = 0; i < 3; i++) {
        const vplScreenVertex* p = &t->v[(i + 1) % 3];
        const vplScreenVertex* q = &t->v[(i + 2) % 3];
        const int32_t dx = q->x - p->x, dy = q->y - p->y;
        s->a[i] = -dy;
        s->b[i] = dx;
        s->e[i] = (int64_t)dx * (py - p->y) - (int64_t)dy * (px - p->x);
    }
    // Sum of the three edge functions anywhere is the doubled area.
    const double inverse = 1 / (double)(s->e[0] + s->e[1] + s->e[2]);
    const double z1 = (double)t->v[1].z - t->v[0].z, z2 = (double)t->v[2].z - t->v[0].z;
    s->zx = 256 * inverse * (z1 * s->a[1] + z2 * s->a[2]);
    s->zy = 256 * inverse * (z1 * s->b[1] + z2 * s->b[2]);
    s->z = t->v[0].z + inverse * (z1 * (double)s->e[1] + z2 * (double)s->e[2]);
    for (int l = 0; l < VPL_LANES; l++) {
        s->laneZ[l] = s->zx * (l & 3) + s->zy * (l >> 2);
    }
    s->leastZ = (s->zx < 0 ? s->laneZ[3] : 0) + (s->zy < 0 ? s->laneZ[12] : 0);
    s->mostZ = (s->zx > 0 ? s->laneZ[3] : 0) + (s->zy > 0 ? s->laneZ[12] : 0);
    for (int i = 0; i < 3; i++) { // left and top edges own their centres, others leave them to the neighbour
        s->e[i] -= s->a[i] > 0 || (s->a[i] == 0 && s->b[i] > 0) ? 0 : 1;
    }
}

// Perspective-correct interpolation. Based on: Marc Olano and Trey Greer, Triangle Scan Conversion Using 2D
// Homogeneous Coordinates, Graphics Hardware 1997: with corners (X, Y, w) in homogeneous pixels, share i of
// the point seen at pixel p is proportional to (corner j x corner k) . (p, 1). No corner is divided by its w,
// and none is snapped: snapping decides coverage only, and moves no surface.
typedef struct Shares {
    double x[3], y[3], c[3];                // the three planes over pixel indices; their sum is 1/w
    _Alignas(64) double lane[3][VPL_LANES]; // growth from lane 0
    float v0[VPL_MAX_VARYINGS], d1[VPL_MAX_VARYINGS],
        d2[VPL_MAX_VARYINGS]; // corner 0 and differences from it
} Shares;

static inline void crossPlanes(const double p[3][3], Shares* s)
{
    for (int i = 0; i < 3; i++) {
        const double *u = p[(i + 1) % 3], *v = p[(i + 2) % 3];
        s->x[i] = u[1] * v[2] - u[2] * v[1];
        s->y[i] = u[2] * v[0] - u[0] * v[2];
        s->c[i] = u[0] * v[1] - u[1] * v[0];
    }
}

static inline void setUpShares(const vplRaster* r, const vplTriangle* t, const vplShaded* shaded, Shares* s)
{
    double p[3][3];
    float varyings[3][VPL_MAX_VARYINGS];
    for (int i = 0; i < 3; i++) {
        float clip[3];
        vplFetchVertex(r, shaded, t->vertex[i], clip, varyings[i]);
        p[i][0] = 0.5 * r->framebuffer.width * ((double)clip[2] + clip[0]);
        p[i][1] = 0.5 * r->framebuffer.height * ((double)clip[2] - clip[1]);
        p[i][2] = clip[2];
    }
    crossPlanes(p, s);
    double determinant = p[0][0] * s->x[0] + p[0][1] * s->y[0] + p[0][2] * s->c[0];
    if (!(determinant > 0)) {
        // Only snapping gave it an area: then the snapped corners are the triangle.
        for (int i = 0; i < 3; i++) {
            p[i][0] = t->v[i].x / 256.0 * p[i][2];
            p[i][1] = t->v[i].y / 256.0 * p[i][2];
        }
        crossPlanes(p, s);
        determinant = p[0][0] * s->x[0] + p[0][1] * s->y[0] + p[0][2] * s->c[0];
    }
    // Scaled so that floats hold the planes whatever the unit of w.
    const double scale = 1 / determinant;
    for (int i = 0; i < 3; i++) {
        s->x[i] *= scale;
        s->y[i] *= scale;
        s->c[i] = s->c[i] * scale + 0.5 * (s->x[i] + s->y[i]); // pixel centres
        for (int l = 0; l < VPL_LANES; l++) {
            s->lane[i][l] = s->x[i] * (l & 3) + s->y[i] * (l >> 2);
        }
    }
    for (int k = 0; k < shaded->varyingCount; k++) {
        s->v0[k] = varyings[0][k];
        s->d1[k] = varyings[1][k] - varyings[0][k];
        s->d2[k] = varyings[2][k] - varyings[0][k];
    }
}

// Shares of the corners in a block, not yet divided by their sum. Clamped at 0: that keeps points of the outline
// within the triangle, and lanes that are not covered finite.
static inline void sharesOf(const Shares* s, int x, int y, float share[3][VPL_LANES])
{
    for (int i = 0; i < 3; i++) {
        const double at = s->x[i] * x + (s->y[i] * y + s->c[i]);
        for (int l = 0; l < VPL_LANES; l++) {
            const float v = (float)(at + s->lane[i][l]);
            share[i][l] = v > 0 ? v : 0;
        }
    }
}

static inline void interpolate(const Shares* s, int varyingCount, int x, int y, vplFragments* f)
{
    float share[3][VPL_LANES], b1[VPL_LANES], b2[VPL_LANES];
    sharesOf(s, x, y, share);
    for (int l = 0; l < VPL_LANES; l++) {
        const float w = 1 / (share[0][l] + share[1][l] + share[2][l]);
        f->w[l] = w;
        b1[l] = share[1][l] * w;
        b2[l] = share[2][l] * w;
    }
    for (int k = 0; k < varyingCount; k++) {
        // From corner 0, so that what is equal at all corners stays equal in every bit.
        const float v0 = s->v0[k], d1 = s->d1[k], d2 = s->d2[k];
        for (int l = 0; l < VPL_LANES; l++) {
            f->varying[k][l] = v0 + (b1[l] * d1 + b2[l] * d2);
        }
    }
}

#endif
