// SPDX-License-Identifier: MIT
// Draws a hemisphere of a paraboloid map: down a tree of triangles as far as they lie above the plane, sixteen side by
// side. Compiled once per instruction set; all give the same bits.
#include "base/isa.h"
#include "math/scalar.h"
#include "visibility/paraboloid_fill.h"

vplDrawParaboloidFcn VPL_KERNEL(vplDrawParaboloid);

// The numbers of sixteen Fillings, side by side, and which texels each may cover.
typedef struct Fillings {
    float edge[3][3][VPL_LANES], near[3][VPL_LANES];
    int32_t box[4][VPL_LANES], kind[VPL_LANES];
} Fillings;

// Turns the corners round so that the nearest comes first: from there a plane's normal and distance are right to
// rounding, while from a corner 1000 times as far even its side may be wrong.
static inline void nearestFirst(vplVec3 p[3])
{
    const vplVec3 a = p[0], b = p[1], c = p[2];
    const float aa = vplDot(a, a), bb = vplDot(b, b), cc = vplDot(c, c);
    const bool second = (bb < aa) & (bb <= cc), third = (cc < aa) & (cc < bb);
    p[0] = vplVec(second  ? b.x
                  : third ? c.x
                          : a.x,
                  second  ? b.y
                  : third ? c.y
                          : a.y,
                  second  ? b.z
                  : third ? c.z
                          : a.z);
    p[1] = vplVec(second  ? c.x
                  : third ? a.x
                          : b.x,
                  second  ? c.y
                  : third ? a.y
                          : b.y,
                  second  ? c.z
                  : third ? a.z
                          : b.z);
    p[2] = vplVec(second  ? a.x
                  : third ? b.x
                          : c.x,
                  second  ? a.y
                  : third ? b.y
                          : c.y,
                  second  ? a.z
                  : third ? b.z
                          : c.z);
}

static void setUpAll(const Sixteen* restrict s, Fillings* restrict all)
{
    for (int l = 0; l < VPL_LANES; l++) {
        Planes p;
        const int32_t was = all->kind[l];
        vplVec3 corner[3] = {cornerOf(s, 0, l), cornerOf(s, 1, l), cornerOf(s, 2, l)};
        nearestFirst(corner);
        const int32_t seen = planesOf(corner[0], corner[1], corner[2], edgeOf, &p);
        for (int e = 0; e < 3; e++) {
            const Quadric q = quadricOf(p.edge[e]);
            all->edge[e][0][l] = q.a;
            all->edge[e][1][l] = q.b;
            all->edge[e][2][l] = q.c;
        }
        const Quadric near = quadricOf(p.near);
        all->near[0][l] = near.a;
        all->near[1][l] = near.b;
        all->near[2][l] = near.c;
        all->kind[l] = seen ? was : UNSEEN;
    }
}

// Nearer to the horizon than this, or below it, a triangle is bounded exactly: 1 degree.
static const float LOW = 0x1p-6f;

// Bounds of triangles above the horizon. An arc leaves the box of its ends by less than a quarter of the chord's
// length (of a half circle, half; its ends are on the rim), and across the chord: (w + h) h / 4 to the sides of a box
// of w x h, which is nothing for most triangles. Large ones are bounded again.
static void bound(const Canvas* c, const Sixteen* restrict s, Fillings* restrict all)
{
    const int32_t last = c->size - 1;
    const float half = 0.5f * (float)c->size, least = 0.5f - MARGIN, most = 0.5f + MARGIN, slack = c->slack;
    for (int l = 0; l < VPL_LANES; l++) {
        float lowX = 2, highX = -2, lowY = 2, highY = -2;
        int32_t above = 0, whole = 1;
        for (int k = 0; k < 3; k++) {
            const float x = s->x[k][l], y = s->y[k][l], z = s->z[k][l];
            const float length = sqrtf(x * x + y * y + z * z), inverse = 1 / vplMaxf(length + z, 1e-37f);
            const float atX = x * inverse, atY = y * inverse;
            lowX = vplMinf(lowX, atX);
            highX = vplMaxf(highX, atX);
            lowY = vplMinf(lowY, atY);
            highY = vplMaxf(highY, atY);
            above |= z > -slack * length;
            whole &= z > LOW * length;
        }
        const float w = highX - lowX, h = highY - lowY, bulge = 0.25f * (w + h);
        const float x0 = (lowX - bulge * h + 1) * half + least, x1 = (highX + bulge * h + 1) * half + most;
        const float y0 = (lowY - bulge * w + 1) * half + least, y1 = (highY + bulge * w + 1) * half + most;
        const int32_t i0 = (int32_t)vplClampf(x0, 0, 16384), i1 = (int32_t)vplClampf(x1, 0, 16384) - 1;
        const int32_t j0 = (int32_t)vplClampf(y0, 0, 16384), j1 = (int32_t)vplClampf(y1, 0, 16384) - 1;
        const int32_t some = (i0 <= i1) & (j0 <= j1);
        all->box[0][l] = i0;
        all->box[1][l] = i1 < last ? i1 : last;
        all->box[2][l] = j0;
        all->box[3][l] = j1 < last ? j1 : last;
        all->kind[l] = above & (s->id[l] >= 0) ? (whole ? some : CROSSING) : UNSEEN;
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
    Filling f = {.near = {all->near[0][l], all->near[1][l], all->near[2][l]}, .triangle = s->id[l]};
    for (int e = 0; e < 3; e++) {
        f.edge[e] = (Quadric){all->edge[e][0][l], all->edge[e][1][l], all->edge[e][2][l]};
    }
    fill(c, &f, box);
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

// Row `row` of the drawn texels; what lies outside of the rim is gone.
static void finishRow(const Canvas* c, int32_t row, float* restrict texels, int32_t* restrict triangles)
{
    const float scale = 1 / (float)c->size, rim2 = c->rim * c->rim;
    const float y = (float)(2 * row + 1) * scale - 1, yy = y * y;
    const size_t from = (size_t)vplHalfMap_Place(vplHalfMap_Blocks(c->size), 0, row);
    for (int32_t i = 0; i < c->size; i++) {
        const size_t at = from + (size_t)(i / SIDE) * VPL_LANES + (size_t)(i % SIDE);
        const float x = (float)(2 * i + 1) * scale - 1, r2 = x * x + yy;
        const float value = r2 <= rim2 ? c->texels[at] / (1 + r2) : 0;
        texels[i + 1] = value;
        if (triangles != NULL) {
            triangles[i + 1] = value > 0 ? c->triangles[at] : -1;
        }
    }
    texels[0] = texels[1];
    texels[c->size + 1] = texels[c->size];
}

static void finish(const Canvas* c, vplParaboloidTexels out)
{
    const size_t stride = (size_t)vplParaboloidMap_Stride(c->size), size = (size_t)c->size;
    for (int32_t row = 0; row < c->size; row++) {
        const size_t at = (size_t)(row + 1) * stride;
        finishRow(c, row, out.texels + at, out.triangles != NULL ? out.triangles + at : NULL);
    }
    memcpy(out.texels, out.texels + stride, stride * sizeof *out.texels);
    memcpy(out.texels + (size + 1) * stride, out.texels + size * stride, stride * sizeof *out.texels);
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
    memset(scratch.texels, 0, vplParaboloidMap_Drawn(map->size) * sizeof *scratch.texels);
    walk(bvh, chooseReaching, draw, &canvas);
    finish(&canvas, out);
}
