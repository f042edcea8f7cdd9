// SPDX-License-Identifier: MIT
#include "geometry/bvh.h"
#include "base/arena.h"
#include "geometry/triangle.h"

void vplBvh_Destroy(vplBvh* bvh)
{
    vplArena_Destroy(bvh != NULL ? bvh->arena : NULL);
}

void vplTriangleBlock_Fill(vplTriangleBlock* block, const vplGeometry* g, const int32_t* ids, int count)
{
    for (int lane = 0; lane < VPL_BVH_WIDTH; lane++) {
        const bool used = lane < count;
        const vplTriangleCorners t = vplGeometry_Corners(g, ids[used ? lane : 0]);
        block->id[lane] = used ? ids[lane] : -1;
        for (int corner = 0; corner < 3; corner++) {
            block->p[corner][0][lane] = t.corner[corner].x;
            block->p[corner][1][lane] = t.corner[corner].y;
            block->p[corner][2][lane] = t.corner[corner].z;
        }
    }
}

VPL_KERNEL_TABLE(tables, vplRayKernels, VPL_RAY_KERNELS);

// AVX-512 uses the AVX2 kernels: eight lanes fill no 512-bit register (bench/rays on Zen 4: AVX2 traces 1.05x
// the rays).
const vplRayKernels* vplGetRayKernels(vplIsa isa)
{
    return &tables[isa == VPL_ISA_AVX512 ? VPL_ISA_AVX2 : isa];
}
