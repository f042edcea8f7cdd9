// SPDX-License-Identifier: MIT
// Windows that show several triangles, for the kernel that gathers. A pixel belongs to the surface of a window's middle
// where it faces about the same way and lies near its plane.
//
// Most such windows lie on one surface all the same: of the runs of 16 windows that show several triangles in Sponza at
// 1920x1080 42 % pass all their tests. So rows of a band of windows are measured against one plane first. Where what a
// row is apart from it and what the middles are apart from it leave no doubt, their sums, which windows share, are
// taken, in the bits that the tests would give.
#ifndef VPL_SHADING_GATHER_MIXED_H
#define VPL_SHADING_GATHER_MIXED_H

#include "shading/gather.h"
#include "shading/resolve.h"

#include <math.h>

#define MIN_NORMALS  0.9f    // least product of two normals of one surface
#define MAX_TILT     0.447f  // their difference is at most this long then: below sqrt(2 - 2 * 0.9) = 0.4472
#define MAX_DISTANCE 0.01f   // from the tangent plane, as a share of the distance along the view axis
#define SAFE_SHARE   0.0099f // of the bounds of this, which are rounded
#define FAR_AWAY     1e30f   // metres: distance of planes that the eye lies in

enum { BAND = 4, BAND_ROWS = BAND + 2 * VPL_MAX_INTERLEAVE };

// The part of the picture that a task writes, and the rows and columns that its windows reach.
typedef struct Part {
    int x, y, width, height;
    int rows, columns;
    bool mixed; // some window shows several triangles, or a triangle and nothing
    bool any;
} Part;

// Pixels along a window, and the weight of pixel i.
static inline int tapsOf(int side)
{
    return 2 * side - 1;
}

static inline float weightOf(int side, int i)
{
    return (float)(i < side ? i + 1 : 2 * side - 1 - i);
}

// ---- planes

static inline void findSight(const vplView* view, const Part* part, int reach, vplGatherRoom* room)
{
    for (int i = 0; i < part->columns; i++) {
        const double x = (2 * (part->x - reach + i) + 1) / (double)view->width - 1 - view->offsetX;
        room->right[i] = (float)(x / view->scaleX);
    }
    for (int i = 0; i < part->rows; i++) {
        const double y = 1 - (2 * (part->y - reach + i) + 1) / (double)view->height - view->offsetY;
        room->up[i] = (float)(y / view->scaleY);
    }
}

// The planes of the triangles in a row, and where the lines of sight meet these.
static inline void findPlanes(const vplShading* s, int row, int columns, vplGatherRoom* room)
{
    const int32_t* triangles = room->triangle[row];
    float *nx = room->normal[0][row], *ny = room->normal[1][row], *nz = room->normal[2][row];
    for (int i = 0; i < columns;) {
        const int32_t triangle = triangles[i];
        const vplSeenFacet* facet = triangle == 0 ? NULL : vplSee(s, triangle - 1, &room->seen);
        const vplVec3 n = facet ? facet->normal : (vplVec3){0, 0, 0};
        const float offset = facet ? facet->offset : 0;
        for (; i < columns && triangles[i] == triangle; i++) {
            nx[i] = n.x;
            ny[i] = n.y;
            nz[i] = n.z;
            room->offset[row][i] = offset;
        }
    }
    const vplView* v = s->view;
    const float up = room->up[row];
    const vplVec3 r = v->right;
    const vplVec3 f = {v->forward.x + up * v->up.x, v->forward.y + up * v->up.y, v->forward.z + up * v->up.z};
    for (int i = 0; i < columns; i++) {
        const float right = room->right[i];
        const float ahead =
            nx[i] * (f.x + right * r.x) + ny[i] * (f.y + right * r.y) + nz[i] * (f.z + right * r.z);
        const float w = room->offset[row][i] / ahead;
        room->distance[row][i] = w < FAR_AWAY && w > -FAR_AWAY ? w : FAR_AWAY; // also where nothing is: 0 / 0
    }
}

// ---- rows that lie on the surface of all middles

// What rows of BAND runs of windows, one below the other, show beside a pixel in the middle: the largest differences of
// any of their pixels.
typedef struct Band {
    float apart[BAND_ROWS]; // from its plane, metres
    float tilt[BAND_ROWS];  // of normals
    float deep[BAND_ROWS];  // of distances along the view axis, metres
    float distance;         // along the view axis, metres
    float longest, span;    // lines of sight: no longer, and no further apart, per metre along the view axis
} Band;

static inline int32_t largestBits(const float values[VPL_LANES])
{
    int32_t bits[VPL_LANES], largest = 0;
    memcpy(bits, values, sizeof bits);
    for (int l = 0; l < VPL_LANES; l++) {
        largest = bits[l] > largest ? bits[l] : largest;
    }
    return largest;
}

// Numbers that are not negative are ordered as their bits are, and whole numbers have a largest in any order.
static inline float largestOf(const float values[VPL_LANES])
{
    const int32_t bits = largestBits(values);
    float largest;
    memcpy(&largest, &bits, sizeof largest);
    return largest;
}

// Along one line of sight, n.x: ahead + right along.
typedef struct Slope {
    float ahead, along;
} Slope;

static inline Slope slopeOf(const vplView* v, float nx, float ny, float nz, float up)
{
    const float f = nx * v->forward.x + ny * v->forward.y + nz * v->forward.z;
    const float u = nx * v->up.x + ny * v->up.y + nz * v->up.z;
    return (Slope){f + up * u, nx * v->right.x + ny * v->right.y + nz * v->right.z};
}

static inline void measureRow(const vplView* view, const vplGatherRoom* room, int row, int x, int count,
                              int row0, int x0, Band* band, int at)
{
    const float mx = room->normal[0][row0][x0], my = room->normal[1][row0][x0],
                mz = room->normal[2][row0][x0];
    const float offset = room->offset[row0][x0], distance = band->distance;
    const Slope slope = slopeOf(view, mx, my, mz, room->up[row]);
    float apart[VPL_LANES] = {0}, tilt[VPL_LANES] = {0}, deep[VPL_LANES] = {0};
    for (int first = 0; first < count; first += VPL_LANES) {
        // The last 16 overlap those before.
        const int i = x + (first + VPL_LANES <= count ? first : count - VPL_LANES);
        const float *nx = room->normal[0][row] + i, *ny = room->normal[1][row] + i,
                    *nz = room->normal[2][row] + i;
        const float *w = room->distance[row] + i, *right = room->right + i;
        for (int l = 0; l < VPL_LANES; l++) {
            const float dx = nx[l] - mx, dy = ny[l] - my, dz = nz[l] - mz;
            const float square = dx * dx + dy * dy + dz * dz;
            const float above = fabsf(w[l] * (slope.ahead + right[l] * slope.along) - offset);
            const float further = fabsf(w[l] - distance);
            tilt[l] = square > tilt[l] ? square : tilt[l];
            apart[l] = above > apart[l] ? above : apart[l];
            deep[l] = further > deep[l] ? further : deep[l];
        }
    }
    band->apart[at] = largestOf(apart);
    band->tilt[at] = sqrtf(largestOf(tilt));
    band->deep[at] = largestOf(deep);
}

// Of the windows of pixels x .. x + 15 of `count` rows from `row` on.
static inline void measureBand(const vplShading* s, const vplGatherRoom* room, int row, int x, int count,
                               Band* band)
{
    const int side = s->interleave->side, reach = side - 1, columns = VPL_LANES + 2 * reach;
    const int row0 = row + reach + count / 2, x0 = x + reach + VPL_LANES / 2;
    const vplView* v = s->view;
    const float right = (float)(1 / v->scaleX), up = (float)(1 / v->scaleY);
    band->distance = room->distance[row0][x0];
    band->longest =
        sqrtf(1 + 2 * (right * right + up * up)); // twice, for offsets and what is outside the picture
    band->span =
        2 * (right * (float)columns / (float)v->width + up * (float)(count + 2 * reach) / (float)v->height);
    for (int i = 0; i < count + 2 * reach; i++) {
        measureRow(v, room, row + i, x, columns, row0, x0, band, i);
    }
}

// Whether each pixel of row i passes the tests of each of 16 middles in row m: points of rows are w d, d their line of
// sight. n.(p - q) for a middle q with normal n is N.(p - q) for the band's normal N, but for tilt |p - q|.
static inline bool rowAgrees(const Band* b, int m, int i)
{
    const float between = (b->deep[m] + b->deep[i]) * b->longest + b->distance * b->span;
    const float apart = b->apart[m] + b->apart[i] + b->tilt[m] * between;
    return b->tilt[m] + b->tilt[i] <= MAX_TILT && apart <= SAFE_SHARE * (b->distance - b->deep[m]);
}

// ---- rows whose pixels are tested

// 16 middles of windows.
typedef struct Middles {
    float nx[VPL_LANES], ny[VPL_LANES], nz[VPL_LANES];
    float forward[VPL_LANES], up[VPL_LANES],
        right[VPL_LANES];                      // their normals' components along the view's axes
    float offset[VPL_LANES], slack[VPL_LANES]; // of their planes, and how far from these their surfaces reach
} Middles;

static inline void findMiddles(const vplView* v, const vplGatherRoom* room, int row, int x, Middles* m)
{
    memcpy(m->nx, room->normal[0][row] + x, sizeof m->nx);
    memcpy(m->ny, room->normal[1][row] + x, sizeof m->ny);
    memcpy(m->nz, room->normal[2][row] + x, sizeof m->nz);
    memcpy(m->offset, room->offset[row] + x, sizeof m->offset);
    const vplVec3 f = v->forward, u = v->up, r = v->right;
    for (int l = 0; l < VPL_LANES; l++) {
        const float w = room->distance[row][x + l], most = MAX_DISTANCE * w;
        m->slack[l] = most > 0 && w < FAR_AWAY ? most : 0;
        m->forward[l] = m->nx[l] * f.x + m->ny[l] * f.y + m->nz[l] * f.z;
        m->up[l] = m->nx[l] * u.x + m->ny[l] * u.y + m->nz[l] * u.z;
        m->right[l] = m->nx[l] * r.x + m->ny[l] * r.y + m->nz[l] * r.z;
    }
}

// Sums a row of 16 windows.
static inline void sumRow(const vplGatherRoom* room, int side, int row, int x, const Middles* middles,
                          float count[VPL_LANES], float sum[3][VPL_LANES])
{
    const Middles m = *middles;
    const float up = room->up[row];
    float ahead[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        ahead[l] = m.forward[l] + up * m.up[l];
    }
    float n[VPL_LANES] = {0}, red[VPL_LANES] = {0}, green[VPL_LANES] = {0}, blue[VPL_LANES] = {0};
    for (int i = 0; i < tapsOf(side); i++) {
        const float weight = weightOf(side, i);
        const float *nx = room->normal[0][row] + x + i, *ny = room->normal[1][row] + x + i,
                    *nz = room->normal[2][row] + x + i;
        const float *w = room->distance[row] + x + i, *right = room->right + x + i;
        const float *r = room->indirect[0][row] + x + i, *g = room->indirect[1][row] + x + i,
                    *b = room->indirect[2][row] + x + i;
        for (int l = 0; l < VPL_LANES; l++) {
            const float cosine =
                m.nx[l] * nx[l] + m.ny[l] * ny[l] + m.nz[l] * nz[l]; // normals of nothing are 0
            const float above = fabsf(w[l] * (ahead[l] + right[l] * m.right[l]) - m.offset[l]);
            const float apart = cosine >= MIN_NORMALS ? above : INFINITY;
            const float taken = apart <= m.slack[l] ? weight : 0;
            n[l] += taken;
            red[l] += taken * r[l];
            green[l] += taken * g[l];
            blue[l] += taken * b[l];
        }
    }
    memcpy(count, n, sizeof n);
    memcpy(sum[0], red, sizeof red);
    memcpy(sum[1], green, sizeof green);
    memcpy(sum[2], blue, sizeof blue);
}

// The same where all windows take the whole row.
static inline void takeRow(const vplGatherRoom* room, int side, int row, int x, float count[VPL_LANES],
                           float sum[3][VPL_LANES])
{
    for (int l = 0; l < VPL_LANES; l++) {
        count[l] = (float)(side * side);
        sum[0][l] = room->rowSums[0][row][x + l];
        sum[1][l] = room->rowSums[1][row][x + l];
        sum[2][l] = room->rowSums[2][row][x + l];
    }
}

// Means over those pixels of 16 windows that lie on the surface of their middle. `at`: in the band.
static inline void meanOfMixed(const vplShading* s, const vplGatherRoom* room, int row, int x,
                               const Band* band, int at, float mean[3][VPL_LANES])
{
    const int side = s->interleave->side, reach = side - 1;
    float count[VPL_LANES] = {0}, total[3][VPL_LANES] = {{0}};
    Middles middles;
    findMiddles(s->view, room, row + reach, x + reach, &middles);
    for (int i = 0; i < tapsOf(side); i++) {
        const float weight = weightOf(side, i);
        float sum[3][VPL_LANES], rowCount[VPL_LANES];
        if (rowAgrees(band, at + reach, at + i)) {
            takeRow(room, side, row + i, x, rowCount, sum);
        } else {
            sumRow(room, side, row + i, x, &middles, rowCount, sum);
        }
        for (int l = 0; l < VPL_LANES; l++) {
            count[l] += weight * rowCount[l];
            total[0][l] += weight * sum[0][l];
            total[1][l] += weight * sum[1][l];
            total[2][l] += weight * sum[2][l];
        }
    }
    for (int c = 0; c < 3; c++) {
        const float* own = room->indirect[c][row + reach] + x + reach;
        for (int l = 0; l < VPL_LANES; l++) {
            const float alone = own[l]; // nothing, or seen from within its plane
            const float inverse = 1 / count[l];
            mean[c][l] = count[l] > 0 ? total[c][l] * inverse : alone;
        }
    }
}

#endif
