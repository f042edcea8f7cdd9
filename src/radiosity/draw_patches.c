// SPDX-License-Identifier: MIT
// Patches through the rasterizer, each in its own colour or with those of its corners interpolated.
// Based on: Hemgren, Radiosity in Realtime Rendering, 4; Gouraud, Continuous Shading of Curved Surfaces, IEEE
// Transactions on Computers 1971. Departs: interpolation is in perspective, and light is multiplied by the reflectance
// after it, so that colours do not run into each other.
#include "radiosity/draw_patches.h"

#include "base/context.h"
#include "base/isa.h"

VPL_KERNEL_TABLE(PATCH, vplFragmentFcn, vplShadePatch);
VPL_KERNEL_TABLE(ADD_TILE, vplTileFcn, vplAddPatchTile);

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

// One draw of what shows this face. Flat draws share their vertices: 1 of 19 ms at 51,456 patches.
static vplResult recordFace(vplRaster* raster, const vplMesh* mesh, const vplPatchFace* faces, int index)
{
    const vplPatchFace* face = &faces[index];
    vplPipeline pipeline = vplDefaultPipeline();
    pipeline.vertex = patchVertices;
    pipeline.vertexUniforms = face->draw->vertexValues != NULL ? face : &faces[0];
    pipeline.varyingCount = face->draw->vertexValues != NULL ? 3 : 0;
    pipeline.fragment = PATCH[face->draw->mesh->context->isa];
    pipeline.fragmentUniforms = face;
    pipeline.cull = face->face == 0 ? VPL_CULL_BACK : VPL_CULL_FRONT;
    return vplRaster_Draw(raster, mesh, &pipeline);
}

vplResult vplDrawPatches(const vplPatchDraw* draw, const float (*clip)[4], vplProgressFcn* progress,
                         void* user, vplImage* image, vplRasterStats* statsOut)
{
    vplResult result = checkDraw(draw);
    if (result != VPL_SUCCESS) {
        return result;
    }
    const vplPatchMesh* mesh = draw->mesh;
    const vplMesh triangles = {mesh->indices, mesh->vertexCount, mesh->triangleCount};
    vplPatchFace faces[2];
    for (int face = 0; face < 2; face++) {
        faces[face] = (vplPatchFace){draw, clip, face, image->width, image->height};
    }
    vplFramebuffer framebuffer = vplDefaultFramebuffer(image->width, image->height);
    framebuffer.planeCount = 3;
    vplRaster* raster = NULL;
    result = vplRaster_Create(mesh->context, &framebuffer, &raster);
    for (int face = 0; face < 2 && result == VPL_SUCCESS; face++) {
        result = recordFace(raster, &triangles, faces, face);
    }
    if (result == VPL_SUCCESS) {
        result = vplRaster_TileTask(raster, ADD_TILE[mesh->context->isa], image);
    }
    if (result == VPL_SUCCESS) {
        result = vplRaster_Run(raster, progress, user, statsOut);
    }
    vplRaster_Destroy(raster);
    return result;
}
