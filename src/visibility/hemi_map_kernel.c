// SPDX-License-Identifier: MIT
// Draws a hemi-octahedral map: down a tree of triangles as far as they lie above the light's plane,
// sixteen side by side. Compiled once per instruction set; all give the same bits.
#include "math/scalar.h"
#include "visibility/kernels.h"
#include "visibility/hemi_fill.h"

// ---- sixteen triangles

// Which texels' centres may lie in each triangle, and how it lies.
static void bound(const vplHemiMap* map, const Sixteen* restrict s, Fillings* restrict all)
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
        all->box[0][l] = i0;
        all->box[1][l] = i1;
        all->box[2][l] = j0;
        all->box[3][l] = j1;
        all->kind[l] = (above & (s->id[l] >= 0)) ? (one ? some : CROSSING) : UNSEEN;
    }
}

static void setUpAll(const Sixteen* restrict s, Fillings* restrict all)
{
    for (int l = 0; l < VPL_LANES; l++) {
        Filling f;
        const vplVec3 p0 = cornerOf(s, 0, l), p1 = cornerOf(s, 1, l), p2 = cornerOf(s, 2, l);
        const int32_t was = all->kind[l];
        const int32_t seen = setUp(p0, p1, p2, p0.x >= 0 ? 1.0f : -1.0f, p0.y >= 0 ? 1.0f : -1.0f, &f);
        storeFilling(&f, l, all);
        all->kind[l] = ((was == INSIDE) & !seen) ? UNSEEN : was;
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
    Fillings all;
    turn((Eye){map->position, map->right, map->up, map->forward}, s);
    bound(map, s, &all);
    setUpAll(s, &all);
    for (int l = 0; l < VPL_LANES; l++) {
        if (all.kind[l] == CROSSING) {
            const vplVec3 corner[3] = {cornerOf(s, 0, l), cornerOf(s, 1, l), cornerOf(s, 2, l)};
            fillCut(map, corner, texels);
        } else if (all.kind[l] == INSIDE) {
            const Filling f = loadFilling(&all, l);
            fill(map, &f, (Texels){all.box[0][l], all.box[1][l], all.box[2][l], all.box[3][l]},
                 (Quadrant){0, 0}, texels);
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
