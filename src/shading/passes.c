// SPDX-License-Identifier: MIT
// Based on: Franchi and Ferrante, Virtual Point Lights, "Rendering": the scene lit by the point light with
// depth LESS, then the whole scene once per virtual light with depth EQUAL, additive, without shadows. Batched:
// "Improving the Rendering", m lights in one pass.
// Departs: passes add irradiance, and the reflectance is multiplied once at the end (three multiplications
// less per pixel and light); of coplanar surfaces at equal depth only the one that won the depth test is lit,
// where EQUAL alone would add the light twice.
#include "shading/shading.h"

// One pass over all objects.
static vplResult recordPass(const vplShading* s, vplRaster* raster, vplPipeline state,
                            vplPassUniforms* uniforms, int first, int count)
{
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < s->geometry->objectCount && result == VPL_SUCCESS; i++) {
        uniforms[i] = (vplPassUniforms){s, i, first, count};
        const vplPipeline own = vplCameraPipeline(s, i); // smooth objects have more varyings than flat ones
        state.vertex = own.vertex;
        state.vertexUniforms = own.vertexUniforms;
        state.varyingCount = own.varyingCount;
        state.surface = own.surface;
        state.surfaceCount = own.surfaceCount;
        state.fragmentUniforms = &uniforms[i];
        result = vplRaster_Draw(raster, &s->meshes[i], &state);
    }
    return result;
}

vplResult vplRecordPasses(const vplShading* shading, vplRaster* raster, void** uniformsOut)
{
    const vplShadeDef* def = shading->def;
    const vplShadingKernels kernels = vplGetShadingKernels(shading->geometry->context->isa);
    const int batch = def->accumulation == VPL_ACCUMULATE_MULTIPASS ? 1 : def->batch;
    const size_t objects = (size_t)shading->geometry->objectCount;
    const size_t passes = 1 + ((size_t)def->lightCount + (size_t)batch - 1) / (size_t)batch;
    vplPassUniforms* uniforms = vplAlloc(shading->geometry->context, objects * passes, sizeof *uniforms);
    if (uniforms == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    *uniformsOut = uniforms;
    vplPipeline less = vplDefaultPipeline();
    less.fragment = kernels.direct;
    vplResult result = recordPass(shading, raster, less, uniforms, 0, 0);
    if (result == VPL_SUCCESS) {
        result = vplRaster_TileTask(raster, kernels.fold, NULL);
    }
    vplPipeline equal = vplDefaultPipeline();
    equal.passes = kernels.lights;
    equal.depthCompare = VPL_DEPTH_EQUAL;
    equal.depthWrite = false;
    equal.ownerTest = true;
    equal.blend = VPL_BLEND_ADD;
    equal.planeMask = 7u << VPL_PLANE_IRRADIANCE;
    for (int first = 0; first < def->lightCount && result == VPL_SUCCESS; first += batch) {
        int count = def->lightCount - first < batch ? def->lightCount - first : batch;
        uniforms += objects;
        result = recordPass(shading, raster, equal, uniforms, first, count);
    }
    if (result == VPL_SUCCESS && def->lightCount > 0) {
        result = vplRaster_TileTask(raster, kernels.fold, NULL);
    }
    return result == VPL_SUCCESS ? vplRaster_TileTask(raster, kernels.resolve, (void*)shading) : result;
}
