// SPDX-License-Identifier: MIT
// Results of stages as pictures, and lights as marks on a picture.
#include "render/stages/show.h"

#include "image/draw.h"
#include "math/vec.h"
#include "render/stages/results.h"

#include <math.h>

// ---- maps

vplResult vplShowCubeMap(const vplRun* run, vplImage** imageOut)
{
    // Column and row of each face in the cross: +x, -x, +y, -y, +z, -z.
    static const int columns[6] = {2, 0, 1, 1, 1, 3}, rows[6] = {1, 1, 0, 2, 1, 1};
    const vplEmitterMaps* maps = run->results[VPL_STAGE_EMITTER_MAPS];
    const vplCubeMap* map = maps->maps[0];
    if (4 * map->size > VPL_MAX_IMAGE_SIZE) {
        return vplFail(run->context, VPL_LIMIT, "a shadow map of %d texels is too large to show, at most %d",
                       map->size, VPL_MAX_IMAGE_SIZE / 4);
    }
    vplImage* image;
    TRY(vplImage_Create(run->context, 4 * map->size, 3 * map->size, &image));
    const size_t size = (size_t)map->size;
    for (size_t face = 0; face < 6; face++) {
        for (size_t i = 0; i < size * size; i++) {
            const size_t x = (size_t)columns[face] * size + i % size,
                         y = (size_t)rows[face] * size + i / size;
            float* pixel = image->pixels + 3 * (y * (size_t)image->width + x);
            const float stored = map->texels[face * size * size + i];
            pixel[0] = pixel[1] = pixel[2] = isfinite(stored) ? stored * map->farPlane : 0;
        }
    }
    *imageOut = image;
    return VPL_SUCCESS;
}

vplResult vplShowReflectiveMaps(const vplRun* run, vplImage** imageOut)
{
    const vplReflectiveMaps* maps = run->results[VPL_STAGE_REFLECTIVE_MAPS];
    for (int i = 0; maps != NULL && i < maps->count; i++) {
        if (maps->maps[i] != NULL) {
            return vplShowReflectiveMap(maps->maps[i], run->results[VPL_STAGE_GEOMETRY], imageOut);
        }
    }
    return vplFail(run->context, VPL_INVALID_ARGUMENT, "the scene has no light with a reflective map");
}

vplResult vplShowClusterMap(const vplRun* run, vplImage** imageOut)
{
    const vplBounceMaps* maps = run->results[VPL_STAGE_PARABOLOIDS];
    const int index = run->plan->options.output.showIndex, count = maps != NULL ? maps->count : 0;
    return index < count
               ? vplShowParaboloidMap(&maps->maps->maps[index], run->results[VPL_STAGE_GEOMETRY], imageOut)
               : vplFail(run->context, VPL_INVALID_ARGUMENT,
                         "cluster %d does not exist, there are %d (from 0)", index, count);
}

// ---- marks

static bool isHidden(const vplView* view, const vplGeometry* geometry, vplVec3 position)
{
    const vplVec3 way = vplSub(position, view->eye);
    const float begin = (float)view->nearPlane / vplDot(view->forward, way); // at the near plane
    const vplRay ray = {vplAdd(view->eye, vplScale(begin, way)), vplScale(1 - begin, way), {0, 0}};
    return vplGeometry_IsOccluded(geometry, &ray, 0.9999f);
}

typedef void MarkFcn(vplImage* image, float x, float y, float radius, vplRgb colour);

static void mark(const vplRun* run, vplImage* image, MarkFcn* fcn, vplVec3 position, float radius,
                 vplRgb colour)
{
    const vplView* view = &run->plan->view;
    float x, y;
    if (vplView_Project(view, position, &x, &y)) {
        const bool hidden = isHidden(view, run->results[VPL_STAGE_GEOMETRY], position);
        fcn(image, x, y, hidden ? 0.5f * radius : radius, colour);
    }
}

vplResult vplDrawVirtualLights(const vplRun* run, vplImage* image)
{
    static const vplRgb colours[4] = {
        {1, 0.8f, 0.05f}, {1, 0.15f, 0.05f}, {0.1f, 0.4f, 1}, {0.7f, 0.1f, 0.9f}};
    const vplVirtualLights* lights = run->results[VPL_STAGE_VIRTUAL_LIGHTS];
    const float radius = fmaxf(3, 0.009f * (float)run->plan->view.height);
    for (int i = 0; lights != NULL && i < lights->set->lightCount; i++) {
        const vplVirtualLight* light = &lights->set->lights[i];
        mark(run, image, vplDrawDisc, light->position, radius, colours[light->step < 3 ? light->step : 3]);
    }
    return VPL_SUCCESS;
}

// The document's figure 1: red for first-bounce lights, green for clusters, blue for second-bounce lights.
static const vplRgb RED = {1, 0.05f, 0.03f}, GREEN = {0.05f, 0.9f, 0.1f}, BLUE = {0.05f, 0.2f, 1};

static float squareOf(const vplRun* run)
{
    return fmaxf(2, 0.005f * (float)run->plan->view.height);
}

static vplResult markBounce(const vplRun* run, const vplBounceLights* bounce, vplRgb colour, vplImage* image)
{
    for (int i = 0; bounce != NULL && i < bounce->lights->lightCount; i++) {
        mark(run, image, vplDrawSquare, bounce->lights->lights[i].position, squareOf(run), colour);
    }
    return VPL_SUCCESS;
}

vplResult vplDrawFirstBounce(const vplRun* run, vplImage* image)
{
    return markBounce(run, run->results[VPL_STAGE_FIRST_BOUNCE], RED, image);
}

vplResult vplDrawSecondBounce(const vplRun* run, vplImage* image)
{
    return markBounce(run, run->results[VPL_STAGE_SECOND_BOUNCE], BLUE, image);
}

// The hues of successive clusters are a golden section of the colour circle apart, so they differ.
static vplRgb colourOf(int cluster)
{
    const float hue = 6 * fmodf(0.618034f * (float)cluster, 1);
    const float r = fabsf(hue - 3) - 1, g = 2 - fabsf(hue - 2), b = 2 - fabsf(hue - 4);
    return (vplRgb){fminf(fmaxf(r, 0.02f), 1), fminf(fmaxf(g, 0.02f), 1), fminf(fmaxf(b, 0.02f), 1)};
}

vplResult vplDrawClusters(const vplRun* run, vplImage* image)
{
    const vplBounceLights* bounce = run->results[VPL_STAGE_FIRST_BOUNCE];
    const vplBounceClusters* clusters = run->results[VPL_STAGE_CLUSTERS];
    const vplBounceMaps* maps = run->results[VPL_STAGE_PARABOLOIDS];
    for (int i = 0; clusters != NULL && i < bounce->lights->lightCount; i++) {
        mark(run, image, vplDrawSquare, bounce->lights->lights[i].position, squareOf(run),
             colourOf(clusters->clusters->of[i]));
    }
    for (int i = 0; clusters != NULL && i < clusters->clusters->count; i++) {
        const vplVec3 place =
            maps != NULL ? maps->maps->maps[i].position : clusters->clusters->clusters[i].position;
        mark(run, image, vplDrawSquare, place, 2 * squareOf(run), GREEN);
    }
    return VPL_SUCCESS;
}
