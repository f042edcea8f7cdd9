// SPDX-License-Identifier: MIT
// Multipass: the scene is drawn once with direct light and depth LESS, then once per virtual light with depth
// EQUAL, additive. Batched: m lights per pass.
// Based on: Franchi and Ferrante, Virtual Point Lights, "Rendering" and "Improving the Rendering". Departs:
// passes add irradiance, which is multiplied by the reflectance once at the end (three multiplications less
// per pixel and light); of coplanar surfaces at equal depth only the winner of the depth test is lit, where
// EQUAL alone would light both.
#include "shading/shading.h"

static vplResult openPasses(vplShading* shading, vplFramebuffer* framebuffer)
{
    (void)shading;
    framebuffer->planeCount = VPL_PLANE_TRIANGLE + 1;
    framebuffer->scratchBytes = sizeof(vplTileSums);
    return VPL_SUCCESS;
}

// One pass over all objects, with `uniforms` for each.
static vplResult recordPass(const vplShading* s, vplRaster* raster, vplPipeline state, int first, int count,
                            vplPassUniforms* uniforms)
{
    for (int i = 0; i < s->geometry->objectCount; i++) {
        uniforms[i] = (vplPassUniforms){s, i, first, count};
        vplSetCamera(s, i, &state);
        state.fragmentUniforms = &uniforms[i];
        TRY(vplRaster_Draw(raster, &s->meshes[i], &state));
    }
    return VPL_SUCCESS;
}

static vplResult recordPasses(vplShading* shading, vplRaster* raster)
{
    const vplShadeDef* def = shading->def;
    const int batch = def->accumulation == VPL_ACCUMULATE_MULTIPASS ? 1 : def->batch;
    const size_t objects = (size_t)shading->geometry->objectCount;
    const size_t passes = 1 + ((size_t)def->lightCount + (size_t)batch - 1) / (size_t)batch;
    vplPassUniforms* uniforms = vplArena_Alloc(shading->arena, objects * passes, sizeof *uniforms);
    TRY(vplArena_Check(shading->arena));
    vplPipeline less = vplDefaultPipeline();
    less.fragment = shading->kernels.direct;
    TRY(recordPass(shading, raster, less, 0, 0, uniforms));
    TRY(vplRaster_TileTask(raster, shading->kernels.flush, NULL));
    vplPipeline equal = vplDefaultPipeline();
    equal.passes = shading->kernels.lights;
    equal.depthCompare = VPL_DEPTH_EQUAL;
    equal.depthWrite = false;
    equal.ownerTest = true;
    equal.blend = VPL_BLEND_ADD;
    equal.planeMask = 7u << VPL_PLANE_IRRADIANCE;
    for (int first = 0; first < def->lightCount; first += batch) {
        const int left = def->lightCount - first;
        uniforms += objects;
        TRY(recordPass(shading, raster, equal, first, left < batch ? left : batch, uniforms));
    }
    if (def->lightCount > 0) {
        TRY(vplRaster_TileTask(raster, shading->kernels.flush, NULL));
    }
    return vplRaster_TileTask(raster, shading->kernels.resolve, shading);
}

const vplStrategy vplPassesStrategy = {.open = openPasses, .record = recordPasses};
