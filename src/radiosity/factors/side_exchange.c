// SPDX-License-Identifier: MIT
// The unoccluded exchange of two sides that are near each other.
#include "radiosity/factors/analytic.h"
#include "radiosity/factors/form_factors.h"
#include "radiosity/sides/side.h"

// The fraction of the exchange of two whole sides that is between their open cells, estimated by the cells'
// centres.
static double openFraction(const vplPatchSide* a, const vplPatchSide* b)
{
    double all = 0, open = 0;
    for (int i = 0; i < VPL_PATCH_CELLS; i++) {
        const vplVec3 p = vplPatchSide_CellCentre(a, i);
        for (int k = 0; k < VPL_PATCH_CELLS; k++) {
            const vplVec3 q = vplPatchSide_CellCentre(b, k);
            const double x = (double)(q.x - p.x), y = (double)(q.y - p.y), z = (double)(q.z - p.z);
            const double square = x * x + y * y + z * z;
            const double ca = x * (double)a->normal.x + y * (double)a->normal.y + z * (double)a->normal.z;
            const double cb = -(x * (double)b->normal.x + y * (double)b->normal.y + z * (double)b->normal.z);
            const double part = ca > 0 && cb > 0 ? ca / square * (cb / square) : 0;
            all += part;
            open += (a->open >> i & 1) && (b->open >> k & 1) ? part : 0;
        }
    }
    return all > 0 ? open / all : 0;
}

float vplSideExchange(const vplPatchSide* a, const vplPatchSide* b)
{
    const double exchange = vplTriangleExchange(a->corners, b->corners, &vplEdgesQuick);
    const double fraction = (a->open & b->open) == VPL_ALL_CELLS ? 1 : openFraction(a, b);
    return vplClampToFloat(exchange * fraction / (double)a->area / (double)b->area);
}
