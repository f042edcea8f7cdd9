// SPDX-License-Identifier: MIT
// Deferred shading: one pass writes position and triangle of every visible pixel, then each tile is lit by
// all lights while it is in cache. Depth, normals and shadow factors are shown from the same G-buffer.
#include "shading/shading.h"

#include <stddef.h>

// ---- the G-buffer

void vplOpenGbuffer(vplShading* shading, vplFramebuffer* framebuffer, vplTileFcn* tileTask)
{
    const vplShadeDef* def = shading->def;
    shading->tileTask = tileTask;
    const bool smooth = def->output == VPL_OUTPUT_RADIANCE || def->output == VPL_OUTPUT_BACKGROUND;
    framebuffer->samples = smooth ? shading->samples : 0;
    framebuffer->planeCount = VPL_PLANE_POSITION + 3;
    shading->smoothsRims = framebuffer->samples > 0 && shading->direct.emitterCount > 0 &&
                           shading->direct.tree == NULL; // noise has no rims
    framebuffer->scratchBytes =
        offsetof(vplTileSums, emitted) + (shading->smoothsRims ? sizeof((vplTileSums*)0)->emitted : 0);
    for (int k = 0; k < 3; k++) { // the plane of triangles says where something was written
        framebuffer->planes[VPL_PLANE_NORMAL + k].scratch = true;
        framebuffer->planes[VPL_PLANE_POSITION + k].scratch = true;
    }
}

vplResult vplRecordGbuffer(vplShading* shading, vplRaster* raster)
{
    for (int i = 0; i < shading->geometry->objectCount; i++) {
        vplPipeline pipeline = vplDefaultPipeline();
        vplSetCamera(shading, i, &pipeline);
        pipeline.surface = NULL; // normals are finished for visible pixels only, when they are lit
        pipeline.fragment = shading->kernels.gbuffer;
        pipeline.fragmentUniforms = &shading->objects[i];
        pipeline.planeMask = 15u << VPL_PLANE_TRIANGLE | (shading->smooth ? 7u << VPL_PLANE_NORMAL : 0);
        TRY(vplRaster_Draw(raster, &shading->meshes[i], &pipeline));
    }
    if (shading->geometry->cutOuts != NULL) {
        TRY(vplRaster_TileTask(raster, vplShowCutOuts, shading));
    }
    return vplRaster_TileTask(raster, shading->tileTask, shading);
}

// ---- strategies

static vplResult openShow(vplShading* shading, vplFramebuffer* framebuffer)
{
    vplOpenGbuffer(shading, framebuffer, shading->kernels.show);
    return VPL_SUCCESS;
}

static vplResult openDeferred(vplShading* shading, vplFramebuffer* framebuffer)
{
    vplOpenGbuffer(shading, framebuffer, shading->kernels.deferred);
    return vplMakeColumns(shading);
}

const vplStrategy vplShowStrategy = {.open = openShow, .record = vplRecordGbuffer};
const vplStrategy vplDeferredStrategy = {.open = openDeferred, .record = vplRecordGbuffer};
