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

// AVX-512 uses the AVX2 kernels: eight lanes fill no 512-bit register (bench/rays on Zen 4: AVX2 traces 1.05x
// the rays).
#if defined(__x86_64__)
#define DECLARE(field, type, name) extern type name##_scalar, name##_sse2, name##_avx2;
#define AVX2(field, type, name)    name##_avx2,
#else
#define DECLARE(field, type, name) extern type name##_scalar, name##_sse2;
#define AVX2(field, type, name)    name##_sse2,
#endif
#define SSE2(field, type, name)   name##_sse2,
#define SCALAR(field, type, name) name##_scalar,

VPL_RAY_KERNELS(DECLARE)

const vplRayKernels* vplGetRayKernels(vplIsa isa)
{
    static const vplRayKernels kernels[VPL_ISA_COUNT] = {[VPL_ISA_AUTO] = {VPL_RAY_KERNELS(SSE2)},
                                                         [VPL_ISA_SCALAR] = {VPL_RAY_KERNELS(SCALAR)},
                                                         [VPL_ISA_SSE2] = {VPL_RAY_KERNELS(SSE2)},
                                                         [VPL_ISA_AVX2] = {VPL_RAY_KERNELS(AVX2)},
                                                         [VPL_ISA_AVX512] = {VPL_RAY_KERNELS(AVX2)}};
    return &kernels[isa];
}
