// SPDX-License-Identifier: MIT
// Draws the shadow map of a half space. Compiled once per instruction set; all give the same bits.
// Based on: Marc Olano and Trey Greer, Triangle Scan Conversion using 2D Homogeneous Coordinates, Graphics Hardware
// 1997: inside is where three planes through the eye say so, so that nothing is clipped. The planes are Pluecker's
// (as in Embree): they are exact negatives for both triangles at an edge, and no texel between them is lost.
//
// A texel at (u, v) in [-1, 1]^2 looks along d = (p, q, 1 - |p| - |q|), p = (u + v) / 2, q = (u - v) / 2, in the
// light's frame; where p and q keep their signs d is linear in u and v. A point t d lies on a triangle's plane where
// 1/t = n.d / n.corner, which is linear, too, and the nearest is the largest.
#include "base/isa.h"
#include "visibility/half_map.h"

#include <string.h>

vplDrawHalfMapFcn VPL_KERNEL(vplDrawHalfMap);

// ---- one triangle

// A function c + u cu + v cv of the texels of one quadrant.
typedef struct Linear {
    float c, cu, cv;
} Linear;

// e.d where p has the sign of `right` and q that of `up`.
static inline Linear linearOf(vplVec3 e, float right, float up)
{
    const float p = e.x - right * e.z, q = e.y - up * e.z;
    return (Linear){e.z, 0.5f * (p + q), 0.5f * (p - q)};
}

// Twice a x b.
static inline vplVec3 edgeOf(vplVec3 a, vplVec3 b)
{
    return vplCross(vplSub(a, b), vplAdd(a, b));
}

// Columns i0 to i1 and rows j0 to j1.
typedef struct Texels {
    int32_t i0, i1, j0, j1;
} Texels;

typedef struct Filling {
    Linear edge[3], near; // near: 1/t
    float right, up;      // signs of the quadrant
} Filling;

// False where the triangle is seen from its edge: then it hides nothing.
static inline bool setUp(const vplVec3 corner[3], float right, float up, Filling* f)
{
    const vplVec3 n = vplCross(vplSub(corner[1], corner[0]), vplSub(corner[2], corner[0]));
    const float x = n.x * corner[0].x, y = n.y * corner[0].y, z = n.z * corner[0].z;
    const float k = x + y + z;
    if (!(fabsf(k) > 0x1p-20f * (fabsf(x) + fabsf(y) + fabsf(z)))) {
        return false;
    }
    const float sign = k > 0 ? 1 : -1, inverse = 1 / k;
    f->near = linearOf(vplVec(n.x * inverse, n.y * inverse, n.z * inverse), right, up);
    for (int i = 0; i < 3; i++) {
        f->edge[i] = linearOf(vplScale(sign, edgeOf(corner[i], corner[(i + 1) % 3])), right, up);
    }
    f->right = right;
    f->up = up;
    return isfinite(inverse);
}

// `whole`: the triangle may reach into other quadrants, whose texels are not meant.
static inline void fillRow(const Filling* restrict f, float v, float scale, int32_t first, int32_t last,
                           bool whole, float* restrict row)
{
    const float e0 = f->edge[0].c + f->edge[0].cv * v, e1 = f->edge[1].c + f->edge[1].cv * v;
    const float e2 = f->edge[2].c + f->edge[2].cv * v, near = f->near.c + f->near.cv * v;
    const float u0 = f->edge[0].cu, u1 = f->edge[1].cu, u2 = f->edge[2].cu, nearU = f->near.cu;
    const float right = whole ? f->right : 0, up = whole ? f->up : 0;
    for (int32_t i = first; i <= last; i += VPL_LANES) {
        float old[VPL_LANES], now[VPL_LANES];
        memcpy(old, row + i, sizeof old);
        for (int l = 0; l < VPL_LANES; l++) {
            const float u = (float)(2 * (i + l) + 1) * scale - 1;
            const float a = e0 + u0 * u, b = e1 + u1 * u, c = e2 + u2 * u;
            const float p = right * (u + v), q = up * (u - v), value = near + nearU * u;
            const float ab = a < b ? a : b, pq = p < q ? p : q;
            const float abc = ab < c ? ab : c;
            const float before = old[l];
            const float nearer = value > before ? value : before;
            now[l] = (abc >= 0) & (pq >= 0) & (i + l <= last) ? nearer : before;
        }
        memcpy(row + i, now, sizeof now);
    }
}

static inline void fill(const vplHalfMap* map, const vplVec3 corner[3], float right, float up, Texels box,
                        bool whole, float* texels)
{
    Filling f;
    if (box.i0 > box.i1 || box.j0 > box.j1 || !setUp(corner, right, up, &f)) {
        return;
    }
    const float scale = 1 / (float)map->size;
    for (int32_t j = box.j0; j <= box.j1; j++) {
        fillRow(&f, (float)(2 * j + 1) * scale - 1, scale, box.i0, box.i1, whole,
                texels + (size_t)j * (size_t)map->size);
    }
}

// ---- triangles that cross the horizon or the axes: cut for their bounds, then filled whole

enum { MAX_CUT = 6 };

// Cuts a polygon down to where side . point >= 0.
static int cut(double (*restrict points)[3], int count, const double side[3])
{
    double from[MAX_CUT][3];
    int kept = 0;
    memcpy(from, points, (size_t)count * sizeof *from);
    for (int i = 0; i < count; i++) {
        const double *a = from[i], *b = from[(i + 1) % count];
        const double da = side[0] * a[0] + side[1] * a[1] + side[2] * a[2];
        const double db = side[0] * b[0] + side[1] * b[1] + side[2] * b[2];
        if (da >= 0) {
            memcpy(points[kept++], a, sizeof from[0]);
        }
        if ((da >= 0) != (db >= 0)) {
            const double t = da / (da - db);
            for (int k = 0; k < 3; k++) {
                points[kept][k] = a[k] + t * (b[k] - a[k]);
            }
            kept++;
        }
    }
    return kept;
}

// Bounds are wider by this much of a texel, which covers the rounding of projected corners.
static const float MARGIN = 0x1p-9f;

static Texels boundsOf(double (*points)[3], int count, int size)
{
    double low[2] = {2, 2}, high[2] = {-2, -2};
    for (int i = 0; i < count; i++) {
        const double x = points[i][0], y = points[i][1], w = fabs(x) + fabs(y) + fabs(points[i][2]);
        if (!(w > 0)) { // the eye itself: in every direction
            return (Texels){0, size - 1, 0, size - 1};
        }
        const double at[2] = {(x + y) / w, (x - y) / w};
        for (int k = 0; k < 2; k++) {
            low[k] = at[k] < low[k] ? at[k] : low[k];
            high[k] = at[k] > high[k] ? at[k] : high[k];
        }
    }
    const double half = 0.5 * size, least = 0.5 - (double)MARGIN, most = 0.5 + (double)MARGIN;
    return (Texels){(int32_t)((low[0] + 1) * half + least), (int32_t)((high[0] + 1) * half + most) - 1,
                    (int32_t)((low[1] + 1) * half + least), (int32_t)((high[1] + 1) * half + most) - 1};
}

static void fillCut(const vplHalfMap* map, const vplVec3 corner[3], float* texels)
{
    for (int quadrant = 0; quadrant < 4; quadrant++) {
        const double right = quadrant & 1 ? -1 : 1, up = quadrant & 2 ? -1 : 1;
        double points[MAX_CUT][3];
        for (int i = 0; i < 3; i++) {
            points[i][0] = (double)corner[i].x;
            points[i][1] = (double)corner[i].y;
            points[i][2] = (double)corner[i].z;
        }
        int count = cut(points, 3, (const double[]){0, 0, 1});
        count = count > 0 ? cut(points, count, (const double[]){right, 0, 0}) : 0;
        count = count > 0 ? cut(points, count, (const double[]){0, up, 0}) : 0;
        if (count > 0) {
            fill(map, corner, (float)right, (float)up, boundsOf(points, count, map->size), true, texels);
        }
    }
}

// ---- sixteen triangles

typedef struct Sixteen {
    float x[3][VPL_LANES], y[3][VPL_LANES],
        z[3][VPL_LANES]; // corners: in the world, then as the light sees them
    int32_t id[VPL_LANES];
} Sixteen;

enum { UNSEEN = 0, INSIDE, CROSSING };

// Corners in the light's frame.
static void turn(const vplHalfMap* map, Sixteen* restrict s)
{
    const vplVec3 o = map->position, r = map->right, u = map->up, f = map->forward;
    for (int k = 0; k < 3; k++) {
        for (int l = 0; l < VPL_LANES; l++) {
            const float x = s->x[k][l] - o.x, y = s->y[k][l] - o.y, z = s->z[k][l] - o.z;
            s->x[k][l] = x * r.x + y * r.y + z * r.z;
            s->y[k][l] = x * u.x + y * u.y + z * u.z;
            s->z[k][l] = x * f.x + y * f.y + z * f.z;
        }
    }
}

static inline float smaller(float a, float b)
{
    return a < b ? a : b;
}

static inline float larger(float a, float b)
{
    return a > b ? a : b;
}

// Which texels' centres may lie in each triangle, and how it lies.
static void bound(const vplHalfMap* map, const Sixteen* restrict s, int32_t box[restrict 4][VPL_LANES],
                  int32_t kind[restrict VPL_LANES])
{
    const float half = 0.5f * (float)map->size, least = 0.5f - MARGIN, most = 0.5f + MARGIN;
    for (int l = 0; l < VPL_LANES; l++) {
        float lowU = 2, highU = -2, lowV = 2, highV = -2;
        for (int k = 0; k < 3; k++) {
            const float x = s->x[k][l], y = s->y[k][l], z = s->z[k][l];
            const float w = larger(fabsf(x) + fabsf(y) + fabsf(z), 1e-37f);
            const float inverse = 1 / w, u = (x + y) * inverse, v = (x - y) * inverse;
            lowU = smaller(lowU, u);
            highU = larger(highU, u);
            lowV = smaller(lowV, v);
            highV = larger(highV, v);
        }
        const float x0 = s->x[0][l], x1 = s->x[1][l], x2 = s->x[2][l];
        const float y0 = s->y[0][l], y1 = s->y[1][l], y2 = s->y[2][l];
        const float z0 = s->z[0][l], z1 = s->z[1][l], z2 = s->z[2][l];
        const int32_t i0 = (int32_t)((lowU + 1) * half + least),
                      i1 = (int32_t)((highU + 1) * half + most) - 1;
        const int32_t j0 = (int32_t)((lowV + 1) * half + least),
                      j1 = (int32_t)((highV + 1) * half + most) - 1;
        const int32_t above = (z0 > 0) | (z1 > 0) | (z2 > 0);
        const int32_t whole = (z0 > 0) & (z1 > 0) & (z2 > 0);
        const int32_t sameX = ((x0 >= 0) == (x1 >= 0)) & ((x1 >= 0) == (x2 >= 0));
        const int32_t sameY = ((y0 >= 0) == (y1 >= 0)) & ((y1 >= 0) == (y2 >= 0));
        const int32_t one = whole & sameX & sameY, some = (i0 <= i1) & (j0 <= j1);
        box[0][l] = i0;
        box[1][l] = i1;
        box[2][l] = j0;
        box[3][l] = j1;
        kind[l] = above & (s->id[l] >= 0) ? (one ? some : CROSSING) : UNSEEN;
    }
}

static void draw(const vplHalfMap* map, Sixteen* s, float* texels)
{
    int32_t box[4][VPL_LANES], kind[VPL_LANES];
    turn(map, s);
    bound(map, s, box, kind);
    for (int l = 0; l < VPL_LANES; l++) {
        if (kind[l] == UNSEEN) {
            continue;
        }
        vplVec3 corner[3];
        for (int k = 0; k < 3; k++) {
            corner[k] = vplVec(s->x[k][l], s->y[k][l], s->z[k][l]);
        }
        if (kind[l] == CROSSING) {
            fillCut(map, corner, texels);
        } else {
            fill(map, corner, corner[0].x >= 0 ? 1 : -1, corner[0].y >= 0 ? 1 : -1,
                 (Texels){box[0][l], box[1][l], box[2][l], box[3][l]}, false, texels);
        }
    }
}

// ---- the tree

// Two blocks of eight become sixteen; `second` may be NULL.
static void drawBlocks(const vplHalfMap* map, const vplTriangleBlock* first, const vplTriangleBlock* second,
                       float* texels)
{
    Sixteen s;
    const vplTriangleBlock* other = second != NULL ? second : first;
    for (int k = 0; k < 3; k++) {
        memcpy(s.x[k], first->p[k][0], sizeof first->p[k][0]);
        memcpy(s.y[k], first->p[k][1], sizeof first->p[k][1]);
        memcpy(s.z[k], first->p[k][2], sizeof first->p[k][2]);
        memcpy(s.x[k] + VPL_BVH_WIDTH, other->p[k][0], sizeof other->p[k][0]);
        memcpy(s.y[k] + VPL_BVH_WIDTH, other->p[k][1], sizeof other->p[k][1]);
        memcpy(s.z[k] + VPL_BVH_WIDTH, other->p[k][2], sizeof other->p[k][2]);
    }
    memcpy(s.id, first->id, sizeof first->id);
    memcpy(s.id + VPL_BVH_WIDTH, other->id, sizeof other->id);
    draw(map, &s, texels);
}

// Bit i: some of child i lies above the light's plane.
static uint32_t childrenAbove(const vplHalfMap* map, const vplBvhNode* node)
{
    const vplVec3 o = map->position, n = map->forward;
    uint32_t above = 0;
    for (int i = 0; i < node->count; i++) {
        const float x = (node->planes[n.x > 0 ? 3 : 0][i] - o.x) * n.x;
        const float y = (node->planes[n.y > 0 ? 4 : 1][i] - o.y) * n.y;
        const float z = (node->planes[n.z > 0 ? 5 : 2][i] - o.z) * n.z;
        above |= (uint32_t)(x + y + z > 0) << i;
    }
    return above;
}

void VPL_KERNEL(vplDrawHalfMap)(const vplBvh* bvh, const vplHalfMap* map, float* texels)
{
    const vplTriangleBlock* waiting = NULL;
    int32_t stack[VPL_BVH_DEPTH * VPL_BVH_WIDTH];
    int depth = 0;
    for (int i = 0; bvh->nodes == NULL && i < bvh->blockCount; i++) {
        stack[depth++] = ~i;
    }
    if (bvh->nodes != NULL) {
        stack[depth++] = 0;
    }
    while (depth > 0) {
        const int32_t at = stack[--depth];
        if (at >= 0) {
            const vplBvhNode* node = &bvh->nodes[at];
            for (uint32_t above = childrenAbove(map, node); above != 0; above &= above - 1) {
                stack[depth++] = node->child[__builtin_ctz(above)];
            }
        } else if (waiting == NULL) {
            waiting = &bvh->blocks[~at];
        } else {
            drawBlocks(map, waiting, &bvh->blocks[~at], texels);
            waiting = NULL;
        }
    }
    if (waiting != NULL) {
        drawBlocks(map, waiting, NULL, texels);
    }
}
