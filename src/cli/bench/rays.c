// SPDX-License-Identifier: MIT
// Stages of rays: building the tree, and tracing.
#include "cli/bench/bench.h"

#include <string.h>

vplResult runGeometry(Bench* b, const Stage* stage, Outcome* outcome)
{
    (void)stage;
    vplGeometry* geometry;
    TRY(needField(b));
    TRY(vplGeometry_Create(b->field, &geometry));
    hitPixels(geometry, vplScene_GetCamera(b->field, 0), 16, 16, outcome); // the hash tests the tree
    outcome->rays = 0;
    outcome->raster.trianglesIn = geometry->triangleCount;
    outcome->work = geometry->triangleCount;
    outcome->unit = "triangles";
    vplGeometry_Destroy(geometry);
    return VPL_SUCCESS;
}

void hitPixels(const vplGeometry* geometry, const vplCameraDef* camera, int width, int height,
               Outcome* outcome)
{
    const vplView v = vplView_Create(camera, width, height);
    for (int i = 0; i < width * height; i++) {
        float x = (float)((2 * (i % width + 0.5) / width - 1) / v.scaleX);
        float y = (float)((1 - 2 * (i / width + 0.5) / height) / v.scaleY);
        const vplVec3 way = {v.forward.x + x * v.right.x + y * v.up.x,
                             v.forward.y + x * v.right.y + y * v.up.y,
                             v.forward.z + x * v.right.z + y * v.up.z};
        const vplRay ray = {v.eye, way, {0, 0}};
        vplHit hit;
        uint64_t found = 0;
        if (vplGeometry_ClosestHit(geometry, &ray, &hit)) {
            uint32_t bits;
            memcpy(&bits, &hit.t, sizeof bits);
            found = (uint64_t)bits << 32 | (uint32_t)hit.triangle;
        }
        addHash(&outcome->hash, found);
    }
    outcome->rays = (int64_t)width * height;
    outcome->work = (double)outcome->rays;
    outcome->unit = "rays";
}

// Always on one thread: the stage measures the tree, not the scheduling.
vplResult runClosestHits(Bench* b, const Stage* stage, Outcome* outcome)
{
    (void)stage;
    TRY(needField(b));
    hitPixels(b->fieldGeometry, vplScene_GetCamera(b->field, 0), b->quarter->width, b->quarter->height,
              outcome);
    return VPL_SUCCESS;
}

vplResult runPath(Bench* b, const Stage* stage, Outcome* outcome)
{
    (void)stage;
    vplRenderOptions options = vplDefaultRenderOptions();
    options.method = VPL_METHOD_PATH;
    options.output.width = b->quarter->width;
    options.output.height = b->quarter->height;
    options.path.samples = 1;
    vplImage* image;
    vplRenderStats stats;
    TRY(vplRender(b->scene, &options, &image, &stats));
    outcome->rays = stats.rays;
    outcome->work = (double)stats.rays;
    outcome->unit = "rays";
    outcome->hash = stats.imageHash;
    vplImage_Destroy(image);
    return VPL_SUCCESS;
}
