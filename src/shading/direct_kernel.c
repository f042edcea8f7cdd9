// SPDX-License-Identifier: MIT
// The light of emitters with their shadows. Compiled once per instruction set, because what one kernel writes
// in whole vectors another should read in vectors of the same width: processors forward nothing wider than was
// stored.
#include "base/isa.h"
#include "shading/shading.h"

extern vplEmitterKernelFcn VPL_KERNEL(vplEmitterCosine);
vplAddEmittersFcn VPL_KERNEL(vplAddEmitters);

// Multiplies `amount` by what the emitter's shadow leaves of it.
static void shadowEmitter(const vplShading* s, const vplPoints* points, int index, float amount[VPL_LANES],
                          int64_t* rays)
{
    const vplEmitterRay* emitter = &s->emitters[index];
    const vplReflectiveMap* map = vplEmitterMapOf(s->def, index);
    if (map == NULL && (emitter->parallel || s->def->shadows[index].map == NULL)) {
        vplCastEmitterRays(s, points, emitter, amount, rays);
        return;
    }
    float factor[VPL_LANES];
    if (s->smooth) { // a shadow belongs to the plane of the triangle, and so does its far side
        float cosine[VPL_LANES];
        VPL_KERNEL(vplEmitterCosine)(points->plane, emitter, cosine);
        for (int l = 0; l < VPL_LANES; l++) {
            amount[l] = cosine[l] > 0 ? amount[l] : 0;
        }
    }
    if (map != NULL) {
        vplReflectiveMap_FactorBlock(map, points->plane, factor);
    } else {
        vplShadow_FactorBlock(&s->def->shadows[index], points->plane, factor);
    }
    for (int l = 0; l < VPL_LANES; l++) {
        amount[l] *= 1 - factor[l];
    }
}

void VPL_KERNEL(vplAddEmitters)(const vplShading* s, const vplPoints* points,
                                float irradiance[restrict 3][VPL_LANES], int64_t* rays)
{
    const vplShadeDef* def = s->def;
    const bool documented = def->lighting == VPL_LIGHTING_DOCUMENTED;
    const float weight = documented && def->particleCount > 0 ? 1 / (float)def->particleCount : 1;
    for (int i = 0; i < def->emitterCount; i++) {
        float amount[VPL_LANES];
        if (!VPL_KERNEL(vplEmitterCosine)(points->surface, &s->emitters[i], amount)) {
            continue;
        }
        shadowEmitter(s, points, i, amount, rays);
        const vplRgb intensity = def->emitters[i].intensity;
        const float colour[3] = {weight * intensity.r, weight * intensity.g, weight * intensity.b};
        for (int c = 0; c < 3; c++) {
            for (int l = 0; l < VPL_LANES; l++) {
                irradiance[c][l] += colour[c] * amount[l];
            }
        }
    }
}
