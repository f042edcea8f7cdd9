// SPDX-License-Identifier: MIT
// Draws a hemisphere of a paraboloid map: down a tree of triangles as far as they lie above the plane,
// sixteen side by side. Compiled once per instruction set; all give the same bits.
#include "math/scalar.h"
#include "visibility/kernels.h"
#include "visibility/paraboloid_fill.h"

static inline float pick(bool second, bool third, float a, float b, float c)
{
    const float other = third ? c : a;
    return second ? b : other;
}

static inline vplVec3 pickCorner(bool second, bool third, vplVec3 a, vplVec3 b, vplVec3 c)
{
    return vplVec(pick(second, third, a.x, b.x, c.x), pick(second, third, a.y, b.y, c.y),
                  pick(second, third, a.z, b.z, c.z));
}

// Turns the corners round so that the nearest comes first: from there a plane's normal and distance are right
// to rounding, while from a corner 1000 times as far even its side may be wrong.
static inline void nearestFirst(vplVec3 p[3])
{
    const vplVec3 a = p[0], b = p[1], c = p[2];
    const float aa = vplDot(a, a), bb = vplDot(b, b), cc = vplDot(c, c);
    const bool second = (bb < aa) & (bb <= cc), third = (cc < aa) & (cc < bb);
    p[0] = pickCorner(second, third, a, b, c);
    p[1] = pickCorner(second, third, b, c, a);
    p[2] = pickCorner(second, third, c, a, b);
}

static void setUpAll(const Sixteen* restrict s, Fillings* restrict all)
{
    for (int l = 0; l < VPL_LANES; l++) {
        Planes p;
        const int32_t was = all->kind[l];
        vplVec3 corner[3] = {cornerOf(s, 0, l), cornerOf(s, 1, l), cornerOf(s, 2, l)};
        nearestFirst(corner);
        const int32_t seen = planesOf(corner[0], corner[1], corner[2], edgeOf, &p);
        const Filling f = {{quadricOf(p.edge[0]), quadricOf(p.edge[1]), quadricOf(p.edge[2])},
                           quadricOf(p.near)};
        storeFilling(&f, l, all);
        all->kind[l] = seen ? was : UNSEEN;
    }
}

// Nearer to the horizon than this (1 degree), or below it, a triangle is bounded exactly, unless it is SMALL
// and no lower than DEEP (6 degrees).
static const float LOW = 0x1p-6f, DEEP = 0.1f, SMALL = 0.5f;

// Bounds of triangles above the horizon. The image of an edge is at most half a circle: inside of the disk
// because a great circle's image meets the rim in opposite points; further out because a chord of 1/2 stands
// for less than a radian, of which each grows at most 2.3 times, while half of the smallest circle is pi
// long. Such an arc of chord c leaves its chord by at most c^2 / 4R, R at least 1, at right angles to it: (w
// + h) h / 4 to the sides of a box of w x h, which is nothing for most triangles. Large ones are bounded
// again.
static void bound(const Canvas* c, const Sixteen* restrict s, Fillings* restrict all)
{
    const int32_t last = c->size - 1;
    const float half = 0.5f * (float)c->size, least = 0.5f - MARGIN, most = 0.5f + MARGIN, slack = c->slack;
    for (int l = 0; l < VPL_LANES; l++) {
        float lowX = 2, highX = -2, lowY = 2, highY = -2;
        int32_t above = 0, high = 1, low = 1;
        for (int k = 0; k < 3; k++) {
            const float x = s->x[k][l], y = s->y[k][l], z = s->z[k][l];
            const float length = sqrtf(x * x + y * y + z * z), inverse = 1 / vplMaxf(length + z, 1e-37f);
            const float atX = x * inverse, atY = y * inverse;
            lowX = vplMinf(lowX, atX);
            highX = vplMaxf(highX, atX);
            lowY = vplMinf(lowY, atY);
            highY = vplMaxf(highY, atY);
            above |= z > -slack * length;
            high &= z > LOW * length;
            low &= z > -DEEP * length;
        }
        const float w = highX - lowX, h = highY - lowY, bulge = 0.25f * (w + h);
        const float x0 = (lowX - bulge * h + 1) * half + least, x1 = (highX + bulge * h + 1) * half + most;
        const float y0 = (lowY - bulge * w + 1) * half + least, y1 = (highY + bulge * w + 1) * half + most;
        const int32_t i0 = (int32_t)vplClampf(x0, 0, 16384), i1 = (int32_t)vplClampf(x1, 0, 16384) - 1;
        const int32_t j0 = (int32_t)vplClampf(y0, 0, 16384), j1 = (int32_t)vplClampf(y1, 0, 16384) - 1;
        const int32_t right = i1 < last ? i1 : last, top = j1 < last ? j1 : last;
        const int32_t some = (i0 <= right) & (j0 <= top), whole = high | (low & (w + h <= SMALL));
        all->box[0][l] = i0;
        all->box[1][l] = right;
        all->box[2][l] = j0;
        all->box[3][l] = top;
        all->kind[l] = (above & (s->id[l] >= 0)) ? (whole ? some : CROSSING) : UNSEEN;
    }
}

// From this many texels on a triangle is bounded again.
enum { LARGE = 256 };

static void drawOne(const Canvas* c, const Sixteen* s, const Fillings* all, int l)
{
    Texels box = {all->box[0][l], all->box[1][l], all->box[2][l], all->box[3][l]};
    if (all->kind[l] == CROSSING || (box.i1 - box.i0 + 1) * (box.j1 - box.j0 + 1) >= LARGE) {
        const vplVec3 corner[3] = {cornerOf(s, 0, l), cornerOf(s, 1, l), cornerOf(s, 2, l)};
        box = boundsOf(corner, c->size);
        if (box.i0 > box.i1 || box.j0 > box.j1) {
            return;
        }
    }
    const Filling f = loadFilling(all, l);
    fill(c, &f, s->id[l], box);
}

static void draw(const void* data, Sixteen* s)
{
    const Canvas* c = data;
    Fillings all;
    turn(c->eye, s);
    bound(c, s, &all);
    int32_t any = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        any |= all.kind[l];
    }
    if (any == UNSEEN) {
        return;
    }
    setUpAll(s, &all);
    for (int l = 0; l < VPL_LANES; l++) {
        if (all.kind[l] != UNSEEN) {
            drawOne(c, s, &all, l);
        }
    }
}

// Bit i: some of child i may lie above the plane, or below it by no more than the slack.
static inline uint32_t chooseReaching(const void* data, const vplBvhNode* node)
{
    const Canvas* c = data;
    const vplVec3 o = c->eye.position, n = c->eye.forward;
    if (c->slack == 0) {
        return vplChildrenAbove(node, o, n);
    }
    uint32_t above = 0;
    for (int i = 0; i < node->count; i++) {
        float high = 0, far = 0;
        for (int axis = 0; axis < 3; axis++) {
            const float at = vplComponent(o, axis), up = vplComponent(n, axis);
            const float a = node->planes[axis][i] - at, b = node->planes[axis + 3][i] - at;
            high += (up > 0 ? b : a) * up;
            far += vplMaxf(fabsf(a), fabsf(b));
        }
        above |= (uint32_t)(high > -c->slack * far) << i;
    }
    return above;
}

// ---- from blocks to rows, and from 1/t to 1 / distance

// One block; what lies outside of the rim is gone.
static inline void finishBlock(const Canvas* c, int32_t column, int32_t row, float value[restrict VPL_LANES],
                               int32_t id[restrict VPL_LANES])
{
    const float scale = 1 / (float)c->size, rim2 = c->rim * c->rim;
    const size_t at = (size_t)vplHemiMap_Place(vplHemiMap_Blocks(c->size), column, row);
    memcpy(value, c->texels + at, VPL_LANES * sizeof *value);
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = (float)(2 * (column + l % SIDE) + 1) * scale - 1;
        const float y = (float)(2 * (row + l / SIDE) + 1) * scale - 1, r2 = x * x + y * y;
        const float kept = value[l] / (1 + r2);
        value[l] = r2 <= rim2 ? kept : 0.0f;
    }
    if (c->triangles != NULL) {
        memcpy(id, c->triangles + at, VPL_LANES * sizeof *id);
        for (int l = 0; l < VPL_LANES; l++) {
            const int32_t owner = id[l];
            id[l] = value[l] > 0 ? owner : -1;
        }
    }
}

// Doubles the first and the last of each row, and then the first and the last row.
static void doubleSides(int32_t size, float* texels)
{
    const size_t stride = (size_t)vplParaboloidMap_Stride(size), last = (size_t)size;
    for (size_t row = 1; row <= last; row++) {
        texels[row * stride] = texels[row * stride + 1];
        texels[row * stride + last + 1] = texels[row * stride + last];
    }
    memcpy(texels, texels + stride, stride * sizeof *texels);
    memcpy(texels + (last + 1) * stride, texels + last * stride, stride * sizeof *texels);
}

static void finish(const Canvas* c, vplParaboloidTexels out)
{
    const int32_t size = c->size;
    for (int32_t row = 0; row < size; row += SIDE) {
        for (int32_t column = 0; column < size; column += SIDE) {
            const int32_t rows = size - row < SIDE ? size - row : SIDE;
            const size_t columns = (size_t)(size - column < SIDE ? size - column : SIDE);
            float value[VPL_LANES];
            int32_t id[VPL_LANES];
            finishBlock(c, column, row, value, id);
            for (int32_t k = 0; k < rows; k++) {
                const size_t at = vplParaboloidMap_Place(size, column, row + k);
                memcpy(out.texels + at, value + k * SIDE, columns * sizeof *value);
                if (out.triangles != NULL) {
                    memcpy(out.triangles + at, id + k * SIDE, columns * sizeof *id);
                }
            }
        }
    }
    doubleSides(size, out.texels);
}

void VPL_KERNEL(vplDrawParaboloid)(const vplBvh* bvh, const vplParaboloidMap* map, int hemisphere,
                                   vplParaboloidTexels scratch, vplParaboloidTexels out)
{
    const float rim = vplParaboloidMap_Rim(map->size, map->hemispheres);
    const Canvas canvas = {
        map->size,
        rim,
        scratch.texels,
        scratch.triangles,
        {map->position, map->right, map->up, hemisphere == 0 ? map->forward : vplNegate(map->forward)},
        (rim * rim - 1) / (rim * rim + 1)};
    memset(scratch.texels, 0, vplHemiMap_Texels(map->size) * sizeof *scratch.texels);
    walk(bvh, chooseReaching, draw, &canvas);
    finish(&canvas, out);
}
