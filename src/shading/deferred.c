// SPDX-License-Identifier: MIT
// Deferred shading: one pass writes position and triangle of every visible pixel, then each tile is lit by
// all lights while it is in cache. Depth, normals and shadow factors are shown from the same G-buffer.
#include "shading/shading.h"

#include <stddef.h>

// ---- the G-buffer

void vplPrepareGbuffer(const vplShadeDef* def, vplFramebuffer* framebuffer)
{
    framebuffer->samples = def->output == VPL_OUTPUT_RADIANCE && def->samples > 1 ? def->samples : 0;
    framebuffer->planeCount = VPL_PLANE_POSITION + 3;
    framebuffer->scratchBytes = offsetof(vplTileSums, irradiance);
    for (int k = 0; k < 3; k++) { // the plane of triangles says where something was written
        framebuffer->planes[VPL_PLANE_NORMAL + k].scratch = true;
        framebuffer->planes[VPL_PLANE_POSITION + k].scratch = true;
    }
}

vplResult vplRecordGbuffer(vplShading* shading, vplRaster* raster, vplTileFcn* task)
{
    for (int i = 0; i < shading->geometry->objectCount; i++) {
        vplPipeline pipeline = vplCameraPipeline(shading, i);
        pipeline.surface = NULL; // normals are finished for visible pixels only, when they are lit
        pipeline.fragment = shading->kernels.gbuffer;
        pipeline.fragmentUniforms = &shading->objects[i];
        pipeline.planeMask = 15u << VPL_PLANE_TRIANGLE | (shading->smooth ? 7u << VPL_PLANE_NORMAL : 0);
        TRY(vplRaster_Draw(raster, &shading->meshes[i], &pipeline));
    }
    return vplRaster_TileTask(raster, task, shading);
}

// ---- strategies

static vplResult openShow(vplShading* shading, vplFramebuffer* framebuffer)
{
    vplPrepareGbuffer(shading->def, framebuffer);
    return VPL_SUCCESS;
}

static vplResult recordShow(vplShading* shading, vplRaster* raster)
{
    return vplRecordGbuffer(shading, raster, shading->kernels.show);
}

static vplResult openDeferred(vplShading* shading, vplFramebuffer* framebuffer)
{
    vplPrepareGbuffer(shading->def, framebuffer);
    return vplMakeColumns(shading);
}

static vplResult recordDeferred(vplShading* shading, vplRaster* raster)
{
    return vplRecordGbuffer(shading, raster, shading->kernels.deferred);
}

const vplStrategy vplShowStrategy = {.open = openShow, .tile = recordShow};
const vplStrategy vplDeferredStrategy = {.open = openDeferred, .tile = recordDeferred};
