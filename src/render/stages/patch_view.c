// SPDX-License-Identifier: MIT
// Draws patches on pictures, as smooth indirect light or as a stage to look at, and writes them as a mesh.
#include "math/scalar.h"
#include "math/vec.h"
#include "render/stages/make.h"
#include "render/stages/results.h"
#include "shading/pixel_paint.h"

#include <math.h>

static vplResult findSums(const vplTransport* transport, vplRgb* values)
{
    for (int i = 0; i < transport->sides->count; i++) {
        const float sum = transport->factors != NULL ? transport->factors->rowSums[i] : 1;
        values[i] = (vplRgb){sum, sum, sum};
    }
    return transport->factors != NULL ? VPL_SUCCESS : vplGatherRadiosity(transport, values, values);
}

// Finds the value of each side that --show asks for. The values are zero before.
static vplResult findValues(const vplRun* run, vplShow show, vplRgb* values)
{
    const vplPatchSides* sides = run->results[VPL_STAGE_SIDES];
    const vplPatchLight* light = run->results[VPL_STAGE_PATCH_LIGHT];
    const vplSolution* s = run->results[VPL_STAGE_SOLUTION];
    const float scale = (float)(1 / VPL_PI);
    if (show == VPL_SHOW_PATCHES) {
        for (int i = 0; i < sides->count; i++) {
            values[i] = sides->sides[i].reflectance;
        }
        return VPL_SUCCESS;
    }
    if (show == VPL_SHOW_PATCH_RADIOSITY) {
        for (int i = 0; i < sides->count; i++) {
            values[i] = vplRgbScale(scale, s->radiosity[i]);
        }
        return VPL_SUCCESS;
    }
    const vplTransport transport = vplTransportOf(run);
    if (show == VPL_SHOW_FORM_FACTOR_SUMS) {
        return findSums(&transport, values);
    }
    TRY(vplRadiosityResidual(&transport, light->source, s->radiosity, values));
    for (int i = 0; i < sides->count; i++) {
        const vplRgb v = values[i];
        values[i] = vplRgbScale(scale, (vplRgb){fabsf(v.r), fabsf(v.g), fabsf(v.b)});
    }
    return VPL_SUCCESS;
}

typedef struct SeenFrom {
    const vplGeometry* geometry;
    const vplView* view;
} SeenFrom;

static vplRgb reflectanceSeen(const void* user, int triangle, int x, int y)
{
    const SeenFrom* from = user;
    return vplReflectanceInPixel(from->geometry, from->view, triangle, x, y);
}

static vplResult draw(const vplRun* run, const vplView* view, vplArena* scratch, vplImage* image)
{
    const vplRenderOptions* o = &run->plan->options;
    const vplPatchMesh* mesh = run->results[VPL_STAGE_PATCH_MESH];
    const vplPatchSides* sides = run->results[VPL_STAGE_SIDES];
    const vplSolution* solution = run->results[VPL_STAGE_SOLUTION];
    const vplRgb* corners = run->results[VPL_STAGE_VERTEX_LIGHT];
    const bool light = o->output.show == VPL_SHOW_PICTURE || o->output.show == VPL_SHOW_INDIRECT;
    const bool smooth = light && o->radiosity.interpolation == VPL_INTERPOLATION_GOURAUD;
    float(*clip)[4] = vplArena_Alloc(scratch, (size_t)mesh->vertexCount, sizeof *clip);
    vplRgb* values = vplArena_AllocZero(scratch, light ? 0 : (size_t)sides->count, sizeof *values);
    TRY(vplArena_Check(scratch));
    if (!light) {
        TRY(findValues(run, o->output.show, values));
    }
    const SeenFrom from = {sides->patches->geometry, view};
    const vplPatchDraw def = {.mesh = mesh,
                              .vertexValues = smooth ? corners : NULL,
                              .values = light ? solution->irradiance : values,
                              .reflect = light,
                              .reflectance = from.geometry->paint != NULL ? reflectanceSeen : NULL,
                              .user = &from,
                              .outlines = o->output.show == VPL_SHOW_PATCHES};
    vplRasterStats stats = {0};
    vplView_ToClip(view, mesh->positions, mesh->vertexCount, clip);
    const vplResult result = vplDrawPatches(&def, (const float(*)[4])clip, NULL, NULL, image, &stats);
    vplRun_AddRaster(run, &stats);
    return result;
}

vplResult vplDrawPatchView(const vplRun* run, const vplView* view, vplImage* image)
{
    vplArena* scratch = vplArena_Create(run->context);
    const vplResult result = draw(run, view, scratch, image);
    vplArena_Destroy(scratch);
    return result;
}

// The mesh has all light. Direct light is the mean over each patch, too.
vplResult vplWritePatchMesh(const vplRun* run, vplArena* scratch, float scale, const char* path)
{
    const vplRadiosityOptions* o = &run->plan->options.radiosity;
    const vplPatchMesh* mesh = run->results[VPL_STAGE_PATCH_MESH];
    const vplSolution* s = run->results[VPL_STAGE_SOLUTION];
    vplRgb* all = vplArena_Alloc(scratch, (size_t)mesh->sides->count, sizeof *all);
    vplRgb* vertices = vplArena_Alloc(scratch, 2 * (size_t)mesh->vertexCount, sizeof *vertices);
    TRY(vplArena_Check(scratch));
    TRY(vplReceive(run, s->radiosity, all));
    TRY(vplPatchMesh_Interpolate(mesh, o->vertexWeight, all, vertices));
    TRY(vplPatchMesh_Sharpen(mesh, o->vertexWeight, all, o->sharpen, vertices));
    return vplPatchMesh_WritePly(mesh, vertices, scale, path);
}
