// SPDX-License-Identifier: MIT
// The surface shader of all camera passes: from a triangle and interpolated positions to a vplSurface.
#include "base/isa.h"
#include "shading/normals.h"

#include <string.h>

vplFragmentFcn VPL_KERNEL(vplShadeSurface);

void VPL_KERNEL(vplShadeSurface)(const void* uniforms, vplFragments* f)
{
    const vplObjectUniforms* u = uniforms;
    const vplShading* s = u->shading;
    const int triangle = s->geometry->objects[u->object].firstTriangle + f->primitive;
    const vplVec3 n = vplGetFacet(s, triangle).normal; // one triangle for all lanes
    vplSurface* surface = (vplSurface*)f->varying[0];
    if (!s->smooth) {
        vplSetNormals(n, surface);
        return;
    }
    vplSurface* plane = (vplSurface*)f->varying[VPL_SURFACE_VARYINGS];
    memcpy(plane, surface, 3 * sizeof f->varying[0]);
    vplSetNormals(n, plane);
    int32_t smooth[VPL_LANES];
    memset(smooth, u->normals != NULL ? 0xff : 0, sizeof smooth);
    vplFinishNormals(plane, smooth, surface);
}
