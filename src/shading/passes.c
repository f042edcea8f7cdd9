// SPDX-License-Identifier: MIT
// Based on: Franchi and Ferrante, Virtual Point Lights, "Rendering": the scene lit by the point light with
// depth LESS, then the whole scene once per virtual light with depth EQUAL, additive, without shadows. Batched:
// "Improving the Rendering", m lights in one pass.
// Departs: passes add irradiance, and the reflectance is multiplied once at the end (three multiplications
// less per pixel and light); of coplanar surfaces at equal depth only the one that won the depth test is lit,
// where EQUAL alone would add the light twice.
#include "shading/shading.h"

#include <string.h>

typedef struct PassUniforms {
    const vplShading* shading;
    int object;
    int first, count; // virtual lights of this pass
} PassUniforms;

static void directFragments(const void* uniforms, vplFragments* f)
{
    const PassUniforms* u = uniforms;
    const vplShading* s = u->shading;
    vplTileSums* sums = f->scratch;
    vplPoints points;
    vplPoints_FromFragments(s, u->object, f, &points);
    vplDirectIrradiance(s, &points, f->plane, &sums->shadowRays);
    const int id = s->geometry->objects[u->object].firstTriangle + f->primitive + 1;
    for (int l = 0; l < VPL_LANES; l++) {
        memcpy(&f->plane[VPL_PLANE_TRIANGLE][l], &id, sizeof id);
    }
}

static void oneLightFragments(const void* uniforms, vplFragments* f)
{
    const PassUniforms* u = uniforms;
    const vplShading* s = u->shading;
    vplTileSums* sums = f->scratch;
    vplPoints points;
    vplPoints_FromFragments(s, u->object, f, &points);
    memset(f->plane, 0, 3 * sizeof f->plane[0]);
    vplIndirectIrradiance(s, &points, u->first, 1, f->plane, &sums->shadowRays);
}

// Several lights in one pass. The framebuffer's part of the group goes through the kernel as its starting
// value, and full groups are folded here, so that each light is added in the same order as one by one.
static void lightBatchFragments(const void* uniforms, vplFragments* f)
{
    const PassUniforms* u = uniforms;
    const vplShading* s = u->shading;
    vplTileSums* sums = f->scratch;
    vplPoints points;
    vplPoints_FromFragments(s, u->object, f, &points);
    const int end = u->first + u->count;
    for (int first = u->first; first < end;) {
        int groupEnd = (first / VPL_LIGHT_GROUP + 1) * VPL_LIGHT_GROUP;
        int next = groupEnd < end ? groupEnd : end;
        vplIndirectIrradiance(s, &points, first, next - first, f->plane, &sums->shadowRays);
        first = next;
        for (int c = 0; next == groupEnd && c < 3; c++) {
            for (int l = 0; l < VPL_LANES; l++) {
                double* sum = &sums->irradiance[c][f->element + l];
                *sum += f->covered[l] ? (double)f->plane[c][l] : 0.0;
                f->plane[c][l] = 0;
            }
        }
    }
}

// One pass over all objects.
static vplResult recordPass(const vplShading* s, vplRaster* raster, vplPipeline state, PassUniforms* uniforms,
                            int first, int count)
{
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < s->geometry->objectCount && result == VPL_SUCCESS; i++) {
        uniforms[i] = (PassUniforms){s, i, first, count};
        const vplPipeline own = vplCameraPipeline(s, i); // smooth objects have more varyings than flat ones
        state.vertex = own.vertex;
        state.vertexUniforms = own.vertexUniforms;
        state.varyingCount = own.varyingCount;
        state.fragmentUniforms = &uniforms[i];
        result = vplRaster_Draw(raster, &s->meshes[i], &state);
    }
    return result;
}

vplResult vplRecordPasses(const vplShading* shading, vplRaster* raster, void** uniformsOut)
{
    const vplShadeDef* def = shading->def;
    const bool one = def->accumulation == VPL_ACCUMULATE_MULTIPASS;
    const int batch = one ? 1 : def->batch;
    const size_t objects = (size_t)shading->geometry->objectCount;
    const size_t passes = 1 + ((size_t)def->lightCount + (size_t)batch - 1) / (size_t)batch;
    PassUniforms* uniforms = vplAlloc(shading->geometry->context, objects * passes, sizeof *uniforms);
    if (uniforms == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    *uniformsOut = uniforms;
    vplPipeline less = vplDefaultPipeline();
    less.fragment = directFragments;
    vplResult result = recordPass(shading, raster, less, uniforms, 0, 0);
    if (result == VPL_SUCCESS) {
        result = vplRaster_TileTask(raster, vplFoldTile, NULL);
    }
    vplPipeline equal = vplDefaultPipeline();
    equal.fragment = one ? oneLightFragments : lightBatchFragments;
    equal.depthCompare = VPL_DEPTH_EQUAL;
    equal.depthWrite = false;
    equal.ownerTest = true;
    equal.blend = one ? VPL_BLEND_ADD : VPL_BLEND_REPLACE;
    equal.readsPlanes = !one;
    equal.planeMask = 7u << VPL_PLANE_IRRADIANCE;
    for (int first = 0; first < def->lightCount && result == VPL_SUCCESS; first += batch) {
        int count = def->lightCount - first < batch ? def->lightCount - first : batch;
        uniforms += objects;
        result = recordPass(shading, raster, equal, uniforms, first, count);
        bool last = first + count == def->lightCount;
        if (result == VPL_SUCCESS && (last || (one && (first + 1) % VPL_LIGHT_GROUP == 0))) {
            result = vplRaster_TileTask(raster, vplFoldTile, NULL);
        }
    }
    return result == VPL_SUCCESS ? vplRaster_TileTask(raster, vplResolveTile, (void*)shading) : result;
}
