// SPDX-License-Identifier: MIT
#include "base/isa.h"

const char* vplIsa_GetName(vplIsa isa)
{
    static const char* const names[VPL_ISA_COUNT] = {"auto", "scalar", "sse2", "avx2", "avx512"};
    return isa >= 0 && isa < VPL_ISA_COUNT ? names[isa] : "unknown";
}

bool vplHasIsa(vplIsa isa)
{
    switch (isa) {
    case VPL_ISA_SCALAR:
    case VPL_ISA_SSE2:
        return true;
#ifdef VPL_WIDE
    case VPL_ISA_AVX2:
        return __builtin_cpu_supports("avx2");
    case VPL_ISA_AVX512: // the subset common to AVX-512 servers and Zen 4
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#endif
    default:
        return false;
    }
}

vplIsa vplBestIsa(void)
{
    return vplHasIsa(VPL_ISA_AVX512) ? VPL_ISA_AVX512 : vplHasIsa(VPL_ISA_AVX2) ? VPL_ISA_AVX2 : VPL_ISA_SSE2;
}
