// SPDX-License-Identifier: MIT
// What a texel of a reflective shadow map sees.
#include "base/isa.h"
#include "lights/rsm.h"

#include <string.h>

vplFragmentFcn VPL_KERNEL(vplWriteReflective);

void VPL_KERNEL(vplWriteReflective)(const void* uniforms, vplFragments* f)
{
    const vplRsmUniforms* u = uniforms;
    const int32_t id = 1 + u->firstTriangle + f->primitive;
    const float inverseFar = u->inverseFar;
    int32_t ids[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        ids[l] = id;
        f->depth[l] = f->w[l] * inverseFar; // for perspective views: z/w would crowd where everything is
    }
    memcpy(f->plane[VPL_RSM_TRIANGLE], ids, sizeof ids);
    memcpy(f->plane[VPL_RSM_POSITION], f->varying[0], 3 * sizeof f->varying[0]);
    if (u->normals != NULL) {
        memcpy(f->plane[VPL_RSM_NORMAL], f->varying[3], 3 * sizeof f->varying[0]);
    } else {
        memset(f->plane[VPL_RSM_NORMAL], 0, 3 * sizeof f->varying[0]);
    }
}
