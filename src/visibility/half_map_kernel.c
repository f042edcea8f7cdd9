// SPDX-License-Identifier: MIT
// Draws the shadow map of a half space: down a tree of triangles as far as they lie above the light's plane, sixteen
// side by side. Compiled once per instruction set; all give the same bits.
#include "base/isa.h"
#include "math/scalar.h"
#include "visibility/half_fill.h"

#include <string.h>

vplDrawHalfMapFcn VPL_KERNEL(vplDrawHalfMap);

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

// Which texels' centres may lie in each triangle, and how it lies.
static void bound(const vplHalfMap* map, const Sixteen* restrict s, int32_t box[restrict 4][VPL_LANES],
                  int32_t kind[restrict VPL_LANES])
{
    const float half = 0.5f * (float)map->size, least = 0.5f - MARGIN, most = 0.5f + MARGIN;
    for (int l = 0; l < VPL_LANES; l++) {
        float lowU = 2, highU = -2, lowV = 2, highV = -2;
        for (int k = 0; k < 3; k++) {
            const float x = s->x[k][l], y = s->y[k][l], z = s->z[k][l];
            const float w = vplMaxf(fabsf(x) + fabsf(y) + fabsf(z), 1e-37f);
            const float inverse = 1 / w, u = (x + y) * inverse, v = (x - y) * inverse;
            lowU = vplMinf(lowU, u);
            highU = vplMaxf(highU, u);
            lowV = vplMinf(lowV, v);
            highV = vplMaxf(highV, v);
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

static inline vplVec3 cornerOf(const Sixteen* s, int k, int l)
{
    return vplVec(s->x[k][l], s->y[k][l], s->z[k][l]);
}

// The numbers of a Filling, side by side.
typedef struct Fillings {
    float edge[3][3][VPL_LANES], near[3][VPL_LANES];
} Fillings;

static void setUpAll(const Sixteen* restrict s, int32_t kind[restrict VPL_LANES], Fillings* restrict all)
{
    for (int l = 0; l < VPL_LANES; l++) {
        Filling f;
        const vplVec3 p0 = cornerOf(s, 0, l), p1 = cornerOf(s, 1, l), p2 = cornerOf(s, 2, l);
        const int32_t was = kind[l];
        const int32_t seen = setUp(p0, p1, p2, p0.x >= 0 ? 1.0f : -1.0f, p0.y >= 0 ? 1.0f : -1.0f, &f);
        for (int e = 0; e < 3; e++) {
            all->edge[e][0][l] = f.edge[e].c;
            all->edge[e][1][l] = f.edge[e].cu;
            all->edge[e][2][l] = f.edge[e].cv;
        }
        all->near[0][l] = f.near.c;
        all->near[1][l] = f.near.cu;
        all->near[2][l] = f.near.cv;
        kind[l] = (was == INSIDE) & !seen ? UNSEEN : was;
    }
}

static void draw(const vplHalfMap* map, Sixteen* s, float* texels)
{
    int32_t box[4][VPL_LANES], kind[VPL_LANES];
    Fillings all;
    turn(map, s);
    bound(map, s, box, kind);
    setUpAll(s, kind, &all);
    for (int l = 0; l < VPL_LANES; l++) {
        if (kind[l] == CROSSING) {
            const vplVec3 corner[3] = {cornerOf(s, 0, l), cornerOf(s, 1, l), cornerOf(s, 2, l)};
            fillCut(map, corner, texels);
        } else if (kind[l] == INSIDE) {
            Filling f = {.near = {all.near[0][l], all.near[1][l], all.near[2][l]}};
            for (int e = 0; e < 3; e++) {
                f.edge[e] = (Linear){all.edge[e][0][l], all.edge[e][1][l], all.edge[e][2][l]};
            }
            fill(map, &f, (Texels){box[0][l], box[1][l], box[2][l], box[3][l]}, false, texels);
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
            for (uint32_t above = vplChildrenAbove(node, map->position, map->forward); above != 0;
                 above &= above - 1) {
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
