// SPDX-License-Identifier: MIT
// Draws a hemi-octahedral map: down a tree of triangles as far as they lie above the light's plane,
// sixteen side by side. Compiled once per instruction set; all give the same bits.
#include "math/scalar.h"
#include "visibility/kernels.h"
#include "visibility/hemi_fill.h"

// ---- sixteen triangles

// Which texels' centres may lie in each triangle, and how it lies.
static void bound(const vplHemiMap* map, const Sixteen* restrict s, int32_t box[restrict 4][VPL_LANES],
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
        kind[l] = (above & (s->id[l] >= 0)) ? (one ? some : CROSSING) : UNSEEN;
    }
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
        kind[l] = ((was == INSIDE) & !seen) ? UNSEEN : was;
    }
}

typedef struct Canvas {
    const vplHemiMap* map;
    float* texels;
} Canvas;

static void draw(const void* data, Sixteen* s)
{
    const vplHemiMap* map = ((const Canvas*)data)->map;
    float* texels = ((const Canvas*)data)->texels;
    int32_t box[4][VPL_LANES], kind[VPL_LANES];
    Fillings all;
    turn((Eye){map->position, map->right, map->up, map->forward}, s);
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

static inline uint32_t chooseAbove(const void* data, const vplBvhNode* node)
{
    const vplHemiMap* map = ((const Canvas*)data)->map;
    return vplChildrenAbove(node, map->position, map->forward);
}

void VPL_KERNEL(vplDrawHemiMap)(const vplBvh* bvh, const vplHemiMap* map, float* texels)
{
    const Canvas canvas = {map, texels};
    walk(bvh, chooseAbove, draw, &canvas);
}
