// SPDX-License-Identifier: MIT
// Based on: Ivan Sutherland and Gary Hodgman, Reentrant Polygon Clipping, CACM 1974, in homogeneous
// coordinates as in James Blinn and Martin Newell, Clipping Using Homogeneous Coordinates, SIGGRAPH 1978.
// Clipping comes before the divide, so that triangles behind the eye never flip to the front. An edge is
// always cut from its inner to its outer end, so that the two triangles that share it get the same point.
#include "raster/raster.h"

#include <string.h>

// Bounds one coordinate by `limit` times w: from below where sign is 1, from above where it is -1.
typedef struct Plane {
    int bit; // of the outcode
    int axis;
    double sign, limit;
} Plane;

// Not negative inside.
static double distance(const Plane* p, const vplClipVertex* v)
{
    return p->sign * (v->at[p->axis] - p->limit * v->at[3]);
}

static vplClipVertex cut(const Plane* plane, const vplClipVertex* inside, const vplClipVertex* outside,
                         int varyings)
{
    double a = distance(plane, inside), b = distance(plane, outside);
    double t = a / (a - b);
    vplClipVertex v;
    for (int k = 0; k < 4; k++) {
        v.at[k] = inside->at[k] + t * (outside->at[k] - inside->at[k]);
    }
    // Puts the point exactly on the plane: with corners 1e15 apart the sums above would miss it by more than
    // a picture.
    v.at[plane->axis] = plane->limit * v.at[3];
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
    const Plane all[6] = {{VPL_OUT_NEAR, 2, 1, 0},    {VPL_OUT_FAR, 2, -1, 1},    {VPL_OUT_GUARD, 0, 1, -gx},
                          {VPL_OUT_GUARD, 0, -1, gx}, {VPL_OUT_GUARD, 1, 1, -gy}, {VPL_OUT_GUARD, 1, -1, gy}};
    vplClipVertex buffers[2][VPL_MAX_CLIPPED];
    memcpy(buffers[0], in, 3 * sizeof *in);
    int count = 3, from = 0;
    for (int p = 0; p < 6 && count > 0; p++) {
        if (planes & all[p].bit) {
            count = clipAgainst(&all[p], varyingCount, buffers[from], count, buffers[1 - from]);
            from = 1 - from;
        }
    }
    memcpy(out, buffers[from], (size_t)count * sizeof *out);
    return count < 3 ? 0 : count;
}
