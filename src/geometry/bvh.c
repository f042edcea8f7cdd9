// SPDX-License-Identifier: MIT
#include "geometry/bvh.h"
#include "base/arena.h"
#include "geometry/triangle.h"

#include <math.h>

void vplBvh_Destroy(vplBvh* bvh)
{
    vplArena_Destroy(bvh != NULL ? bvh->arena : NULL);
}

// True where products of three lengths may leave float's range.
static bool isExtreme(const vplTriangleCorners* t)
{
    float longest = 0;
    for (int edge = 0; edge < 3; edge++) {
        longest = vplMaxf(longest, vplLargestOf(vplSub(t->corner[edge], t->corner[(edge + 1) % 3])));
    }
    return !(longest >= 0x1p-38f && longest <= 0x1p18f);
}

vplBlockMarks vplTriangleBlock_Fill(vplTriangleBlock* block, const vplGeometry* g, const int32_t* ids,
                                    int count)
{
    unsigned byFormula = 0, extreme = 0;
    for (int lane = 0; lane < VPL_BVH_WIDTH; lane++) {
        const bool used = lane < count;
        const vplTriangleCorners t = vplGeometry_Corners(g, ids[used ? lane : 0]);
        byFormula |= (unsigned)(used && g->objects[g->owners[ids[lane]]].byFormula) << lane;
        extreme |= (unsigned)(used && isExtreme(&t)) << lane;
        block->id[lane] = used ? ids[lane] : -1;
        for (int corner = 0; corner < 3; corner++) {
            block->p[corner][0][lane] = t.corner[corner].x;
            block->p[corner][1][lane] = t.corner[corner].y;
            block->p[corner][2][lane] = t.corner[corner].z;
        }
    }
    return (vplBlockMarks){(uint8_t)byFormula, (uint8_t)extreme};
}

VPL_KERNEL_TABLE(tables, vplRayKernels, VPL_RAY_KERNELS);

// AVX-512 uses the AVX2 kernels: eight lanes fill no 512-bit register (bench/rays on Zen 4: AVX2 traces 1.05x
// the rays).
const vplRayKernels* vplGetRayKernels(vplIsa isa)
{
    return &tables[isa == VPL_ISA_AVX512 ? VPL_ISA_AVX2 : isa];
}
