// SPDX-License-Identifier: MIT
// Deferred shading: one pass writes position and triangle of every visible pixel, then each tile is lit by all
// lights while it is in cache. Also where depth, normals and shadow factors can be seen, because they need
// nothing but that G-buffer.
#include "shading/shading.h"

vplResult vplRecordDeferred(const vplShading* shading, vplRaster* raster)
{
    const vplShadingKernels kernels = vplGetShadingKernels(shading->geometry->context->isa);
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < shading->geometry->objectCount && result == VPL_SUCCESS; i++) {
        vplPipeline pipeline = vplCameraPipeline(shading, i);
        pipeline.surface = NULL; // of what is visible only, when it is lit
        pipeline.fragment = kernels.gbuffer;
        pipeline.fragmentUniforms = &shading->objects[i];
        pipeline.planeMask = 15u << VPL_PLANE_TRIANGLE | (shading->smooth ? 7u << VPL_PLANE_NORMAL : 0);
        result = vplRaster_Draw(raster, &shading->meshes[i], &pipeline);
    }
    if (result != VPL_SUCCESS) {
        return result;
    }
    const bool light = vplShowsLight(shading->def->output);
    vplTileFcn* lights = shading->interleave != NULL  ? kernels.interleaved
                         : shading->lightcuts != NULL ? kernels.cut
                                                      : kernels.light;
    return vplRaster_TileTask(raster, light ? lights : kernels.show, (void*)shading);
}
