// SPDX-License-Identifier: MIT
#include "base/context.h"
#include "math/sampling.h"
#include "visibility/kernels.h"

#include <math.h>

enum { SHADOW_COOKIE = 0x56504c51 };

vplShadowDef vplDefaultShadowDef(void)
{
    return (vplShadowDef){VPL_BIAS_AUTO, -1, -1, 16, -1, SHADOW_COOKIE};
}

// The document asks for S random offsets without a distribution. These are uniform on the disc: Hammersley
// points mapped concentrically to one half, and their opposites, so that a straight edge through the centre
// shadows exactly half of an even S. An odd S has one sample in the centre.
static void makeOffsets(vplShadow* shadow)
{
    int pairs = shadow->def.pcfSamples / 2;
    for (int i = 0; i < pairs; i++) {
        float x, y;
        vplSampleConcentricDisc(0.5f * (((float)i + 0.5f) / (float)pairs), vplVanDerCorput((uint32_t)i), &x,
                                &y);
        shadow->offsets[2 * i][0] = x;
        shadow->offsets[2 * i][1] = y;
        shadow->offsets[2 * i + 1][0] = -x;
        shadow->offsets[2 * i + 1][1] = -y;
    }
    if (shadow->def.pcfSamples % 2) {
        shadow->offsets[2 * pairs][0] = shadow->offsets[2 * pairs][1] = 0;
    }
}

vplResult vplShadow_Create(const vplCubeMap* map, const vplShadowDef* def, vplShadow* shadowOut)
{
    REQUIRE(CONTEXT_OF(map), map, def, shadowOut);
    vplContext* context = map->context;
    if (def->cookie != SHADOW_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplShadowDef was not made by vplDefaultShadowDef");
    }
    if (def->pcfSamples < 1 || def->pcfSamples > VPL_MAX_PCF_SAMPLES) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplShadowDef.pcfSamples is %d, must be in [1, %d]",
                       def->pcfSamples, VPL_MAX_PCF_SAMPLES);
    }
    if (!(isfinite(def->biasStatic) && isfinite(def->biasDynamic) && isfinite(def->pcfOffset))) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplShadowDef biases and pcfOffset are %g, %g, %g, must be finite",
                       (double)def->biasStatic, (double)def->biasDynamic, (double)def->pcfOffset);
    }
    vplShadow shadow = {.map = map, .def = *def};
    // Half a texel's diagonal at the middle of a face, where texels look largest.
    shadow.texelTangent = 1.41421356f / (float)map->size;
    if (shadow.def.pcfOffset < 0) {
        shadow.pcfTangent = shadow.texelTangent;
        shadow.def.pcfOffset = 0;
    }
    if (shadow.def.pcfSamples == 1) {
        shadow.def.pcfOffset = shadow.pcfTangent = 0;
    }
    if (shadow.def.biasStatic < 0) {
        shadow.def.biasStatic =
            map->farPlane * (shadow.texelTangent + shadow.pcfTangent) + shadow.def.pcfOffset;
    }
    if (shadow.def.biasDynamic < 0) {
        shadow.def.biasDynamic = 5.6f * shadow.def.biasStatic;
    }
    makeOffsets(&shadow);
    for (int i = 0; i < def->pcfSamples; i++) {
        const float x = shadow.offsets[i][0], y = shadow.offsets[i][1];
        // Slightly longer, for the rounding here and where a sample is placed.
        shadow.reach = fmaxf(shadow.reach, sqrtf(x * x + y * y) * 1.00001f);
    }
    *shadowOut = shadow;
    return VPL_SUCCESS;
}

float vplShadow_Bias(const vplShadow* shadow, float distance, float cosine)
{
    float distances[VPL_LANES], cosines[VPL_LANES], bias[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        distances[l] = distance;
        cosines[l] = cosine;
    }
    vplVisibilityKernels_Get(shadow->map->context->isa)->shadowBias(shadow, distances, cosines, bias);
    return bias[0];
}

void vplShadow_FactorBlock(const vplShadow* shadow, const vplSurface* surface, float factorOut[VPL_LANES])
{
    vplVisibilityKernels_Get(shadow->map->context->isa)->shadowFactor(shadow, surface, factorOut);
}

float vplShadow_Factor(const vplShadow* shadow, vplVec3 position, vplVec3 normal)
{
    if (isnan(position.x) || isnan(position.y) || isnan(position.z)) {
        return 0;
    }
    const vplSurface surface = vplSurface_OfPoint(position, normal);
    float factor[VPL_LANES];
    vplShadow_FactorBlock(shadow, &surface, factor);
    return factor[0];
}
