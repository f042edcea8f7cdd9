// SPDX-License-Identifier: MIT
// SSVP's lights and clusters for eyes, as the document's figure 1 draws them.
#include "image/draw.h"
#include "math/vec.h"
#include "render/show_maps.h"
#include "render/ssvp.h"

#include <math.h>

static const vplRgb RED = {1, 0.05f, 0.03f}, GREEN = {0.05f, 0.9f, 0.1f}, BLUE = {0.05f, 0.2f, 1};

static float squareOf(const vplJob* job)
{
    return fmaxf(2, 0.005f * (float)job->view.height);
}

// What the camera cannot see is drawn small.
static void drawAt(const vplJob* job, vplVec3 position, float half, vplRgb colour)
{
    float x, y;
    if (vplView_Project(&job->view, position, &x, &y)) {
        const bool hidden = vplView_IsHidden(&job->view, job->geometry, position);
        vplDrawSquare(job->image, x, y, hidden ? 0.5f * half : half, colour);
    }
}

static void drawLights(const vplJob* job, const vplLightSet* set, vplRgb colour)
{
    for (int i = 0; i < set->lightCount; i++) {
        drawAt(job, set->lights[i].position, squareOf(job), colour);
    }
}

// Hues that differ from those of the next clusters: a golden section of the circle apart.
static vplRgb colourOf(int cluster)
{
    const float hue = 6 * fmodf(0.618034f * (float)cluster, 1);
    const float r = fabsf(hue - 3) - 1, g = 2 - fabsf(hue - 2), b = 2 - fabsf(hue - 4);
    return (vplRgb){fminf(fmaxf(r, 0.02f), 1), fminf(fmaxf(g, 0.02f), 1), fminf(fmaxf(b, 0.02f), 1)};
}

// Each first-bounce light in its cluster's colour, then where clusters look from.
static void drawClusters(const vplJob* job, const vplSsvpBounce* first)
{
    const vplLightClusters* clusters = first->clusters;
    for (int i = 0; i < first->lights->lightCount; i++) {
        drawAt(job, first->lights->lights[i].position, squareOf(job), colourOf(clusters->of[i]));
    }
    for (int i = 0; i < clusters->count; i++) {
        const vplVec3 place = first->maps ? first->maps->maps[i].position : clusters->clusters[i].position;
        drawAt(job, place, 2 * squareOf(job), GREEN);
    }
}

vplResult vplSsvp_ShowLights(vplJob* job, const vplSsvpState* state)
{
    const vplShow show = job->options.output.show;
    if ((show != VPL_SHOW_RSM_SAMPLES && show != VPL_SHOW_CLUSTERS && show != VPL_SHOW_SECOND_BOUNCE) ||
        state->lights == NULL) {
        return VPL_SUCCESS;
    }
    vplResult result = vplGeometry_PrepareRays(job->geometry);
    if (result != VPL_SUCCESS) {
        return result;
    }
    const vplSsvpBounce* bounce = state->lights->bounce;
    if (show == VPL_SHOW_CLUSTERS) {
        drawClusters(job, &bounce[0]);
    } else if (show == VPL_SHOW_RSM_SAMPLES) {
        drawLights(job, bounce[0].lights, RED);
    } else if (bounce[1].lights != NULL) {
        drawLights(job, bounce[1].lights, BLUE);
    }
    return VPL_SUCCESS;
}

vplResult vplSsvp_ShowMap(vplJob* job, const vplSsvpState* state)
{
    const vplRenderOptions* o = &job->options;
    if (o->output.show == VPL_SHOW_PARABOLOID) {
        const vplParaboloidMaps* maps = state->lights ? state->lights->bounce[0].maps : NULL;
        const int count = maps ? maps->count : 0;
        return o->output.showIndex < count
                   ? vplShowParaboloidMap(&maps->maps[o->output.showIndex], job->geometry, &job->image)
                   : vplFail(job->context, VPL_INVALID_ARGUMENT,
                             "cluster %d does not exist, there are %d (from 0)", o->output.showIndex, count);
    }
    for (int i = 0; i < state->emitterCount; i++) {
        if (state->maps[i] != NULL) {
            return vplShowReflectiveMap(state->maps[i], job->geometry, &job->image);
        }
    }
    return vplFail(job->context, VPL_INVALID_ARGUMENT, "the scene has no light with a reflective map");
}
