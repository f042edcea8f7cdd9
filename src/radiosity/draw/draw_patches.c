// SPDX-License-Identifier: MIT
// Draws patches with the rasterizer, flat or with interpolated vertex values.
// Based on: Hemgren, Radiosity in Realtime Rendering, 4; Gouraud, Continuous Shading of Curved Surfaces, IEEE
// Transactions on Computers 1971. Departs: interpolation is correct in perspective, and light is multiplied
// by the reflectance after it, so that colours do not bleed into each other.
#include "base/arena.h"
#include "radiosity/radiosity_kernels.h"
#include "radiosity/sides/side.h"

static void patchVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const vplPatchFace* u = uniforms;
    for (int i = 0; i < count; i++) {
        const float* clip = u->clip[first + i];
        out->x[i] = clip[0];
        out->y[i] = clip[1];
        out->z[i] = clip[2];
        out->w[i] = clip[3];
    }
    for (int i = 0; u->draw->vertexValues != NULL && i < count; i++) {
        const vplRgb value = u->draw->vertexValues[2 * (size_t)(first + i) + (size_t)u->face];
        out->varying[0][i] = value.r;
        out->varying[1][i] = value.g;
        out->varying[2][i] = value.b;
    }
}

static vplResult checkDraw(const vplPatchDraw* draw)
{
    const vplPatchMesh* mesh = draw->mesh;
    if (draw->vertexValues != NULL) {
        return vplCheckRgb(mesh->context, "vplPatchDraw.vertexValues", draw->vertexValues,
                           2 * (size_t)mesh->vertexCount);
    }
    if (draw->values == NULL) {
        return vplFail(mesh->context, VPL_INVALID_ARGUMENT,
                       "vplPatchDraw has neither values nor vertexValues");
    }
    return vplCheckRgb(mesh->context, "vplPatchDraw.values", draw->values, (size_t)mesh->sides->count);
}

// Records the draw of one face. Flat draws of both faces share their vertices, which saves 5 %
// (bench/patch_mesh).
static vplResult recordFace(vplRaster* raster, const vplMesh* mesh, const vplPatchFace* faces, int index)
{
    const vplPatchFace* face = &faces[index];
    vplPipeline pipeline = vplDefaultPipeline();
    pipeline.vertex = patchVertices;
    pipeline.vertexUniforms = face->draw->vertexValues != NULL ? face : &faces[0];
    pipeline.varyingCount = face->draw->vertexValues != NULL ? 3 : 0;
    pipeline.fragment = vplGetRadiosityKernels(face->draw->mesh->context->isa)->shadePatch;
    pipeline.fragmentUniforms = face;
    pipeline.cull = face->face == 0 ? VPL_CULL_BACK : VPL_CULL_FRONT;
    return vplRaster_Draw(raster, mesh, &pipeline);
}

// Both faces, and the task that adds the tiles to the image.
static vplResult recordAll(vplRaster* raster, const vplPatchFace faces[2], vplImage* image)
{
    const vplPatchMesh* mesh = faces[0].draw->mesh;
    const vplMesh triangles = {mesh->indices, mesh->vertexCount, mesh->triangleCount};
    TRY(recordFace(raster, &triangles, faces, 0));
    TRY(recordFace(raster, &triangles, faces, 1));
    return vplRaster_TileTask(raster, vplGetRadiosityKernels(mesh->context->isa)->addPatchTile, image);
}

vplResult vplDrawPatches(const vplPatchDraw* draw, const float (*clip)[4], vplProgressFcn* progress,
                         void* user, vplImage* image, vplRasterStats* statsOut)
{
    REQUIRE(CONTEXT_OF(image), draw, clip, image);
    TRY(checkDraw(draw));
    vplPatchFace faces[2];
    for (int face = 0; face < 2; face++) {
        faces[face] = (vplPatchFace){draw, clip, face, image->width, image->height};
    }
    vplFramebuffer framebuffer = vplDefaultFramebuffer(image->width, image->height);
    framebuffer.reversedDepth = true;
    framebuffer.planeCount = 3;
    vplRaster* raster = NULL;
    TRY(vplRaster_Create(draw->mesh->context, &framebuffer, &raster));
    vplResult result = recordAll(raster, faces, image);
    if (result == VPL_SUCCESS) {
        result = vplRaster_Run(raster, progress, user, statsOut);
    }
    vplRaster_Destroy(raster);
    return result;
}
