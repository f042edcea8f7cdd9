// SPDX-License-Identifier: MIT
// Based on: Ivan Sutherland and Gary Hodgman, Reentrant Polygon Clipping, CACM 1974, in homogeneous
// coordinates as in James Blinn and Martin Newell, Clipping Using Homogeneous Coordinates, SIGGRAPH 1978.
// Clipping comes before the divide, so that triangles behind the eye never flip to the front. An edge is
// always cut from its inner to its outer end, so that the two triangles that share it get the same point.
#include "raster/raster.h"

#include <string.h>

typedef struct Plane {
    double x, y, z, w; // inside when the dot product is >= 0
    int axis;          // the coordinate it bounds, as `limit` times w
    double limit;
} Plane;

static double distance(const Plane* p, const vplClipVertex* v)
{
    return p->x * v->x + p->y * v->y + p->z * v->z + p->w * v->w;
}

static vplClipVertex cut(const Plane* plane, const vplClipVertex* inside, const vplClipVertex* outside,
                         int varyings)
{
    double a = distance(plane, inside), b = distance(plane, outside);
    double t = a / (a - b);
    vplClipVertex v;
    v.x = inside->x + t * (outside->x - inside->x);
    v.y = inside->y + t * (outside->y - inside->y);
    v.z = inside->z + t * (outside->z - inside->z);
    v.w = inside->w + t * (outside->w - inside->w);
    // Puts the point exactly on the plane: with corners 1e15 apart the sums above would miss it by more than
    // a picture.
    *(plane->axis == 0 ? &v.x : plane->axis == 1 ? &v.y : &v.z) = plane->limit * v.w;
    for (int k = 0; k < varyings; k++) {
        v.varying[k] = (float)(inside->varying[k] + t * ((double)outside->varying[k] - inside->varying[k]));
    }
    return v;
}

static int clipAgainst(const Plane* plane, int varyings, const vplClipVertex* in, int count,
                       vplClipVertex* out)
{
    int made = 0;
    for (int i = 0; i < count; i++) {
        const vplClipVertex* a = &in[i];
        const vplClipVertex* b = &in[(i + 1) % count];
        bool aInside = distance(plane, a) >= 0, bInside = distance(plane, b) >= 0;
        if (aInside) {
            out[made++] = *a;
        }
        if (aInside != bInside) {
            out[made++] = aInside ? cut(plane, a, b, varyings) : cut(plane, b, a, varyings);
        }
    }
    return made;
}

int vplClipTriangle(const vplRaster* raster, int planes, int varyingCount, const vplClipVertex in[3],
                    vplClipVertex out[VPL_MAX_CLIPPED])
{
    // 32000 of 32768 pixels: the rest is room for rounding.
    double gx = 2 * 32000.0 / raster->framebuffer.width - 1,
           gy = 2 * 32000.0 / raster->framebuffer.height - 1;
    const Plane all[6] = {{0, 0, 1, 0, 2, 0},    {0, 0, -1, 1, 2, 1},   {1, 0, 0, gx, 0, -gx},
                          {-1, 0, 0, gx, 0, gx}, {0, 1, 0, gy, 1, -gy}, {0, -1, 0, gy, 1, gy}};
    const int bits[6] = {VPL_OUT_NEAR,  VPL_OUT_FAR,   VPL_OUT_GUARD,
                         VPL_OUT_GUARD, VPL_OUT_GUARD, VPL_OUT_GUARD};
    vplClipVertex buffers[2][VPL_MAX_CLIPPED];
    memcpy(buffers[0], in, 3 * sizeof *in);
    int count = 3, from = 0;
    for (int p = 0; p < 6 && count > 0; p++) {
        if (planes & bits[p]) {
            count = clipAgainst(&all[p], varyingCount, buffers[from], count, buffers[1 - from]);
            from = 1 - from;
        }
    }
    memcpy(out, buffers[from], (size_t)count * sizeof *out);
    return count < 3 ? 0 : count;
}
