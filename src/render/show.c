// SPDX-License-Identifier: MIT
#include "render/show.h"

#include "render/stages/show.h"

static const char NO_PATHS[] = "the path tracer can show the picture, direct, indirect and bounce:K only";
static const char NO_LIGHTS[] = "radiosity has no virtual lights to show";
static const char NO_CLUSTERS[] = "only SSVP has maps, samples and clusters to show";
static const char NO_PATCHES[] = "only radiosity has patches and form factors to show";

enum {
    NOT_PATH = VPL_USE_ALL & ~VPL_USE_PATH,
    VIRTUAL = NOT_PATH & ~VPL_USE_RADIOSITY,
    SSVP = VPL_USE_SSVP,
    RADIOSITY = VPL_USE_RADIOSITY
};

#define MEAN .passes = true
// clang-format off
const vplShowRow VPL_SHOWS[] = {
    [VPL_SHOW_PICTURE] = {.direct = true, .lights = true, MEAN, .patches = VPL_PATCH_LIGHT, .methods = VPL_USE_ALL},
    [VPL_SHOW_DEPTH] = {.methods = NOT_PATH, .output = VPL_OUTPUT_DEPTH},
    [VPL_SHOW_NORMALS] = {.methods = NOT_PATH, .output = VPL_OUTPUT_NORMALS},
    [VPL_SHOW_SHADOW_MAP] = {.direct = true, .methods = NOT_PATH, .draw = vplShowCubeMap},
    [VPL_SHOW_SHADOW_FACTOR] = {.direct = true, .methods = NOT_PATH, .output = VPL_OUTPUT_SHADOW_FACTOR},
    [VPL_SHOW_DIRECT] = {.direct = true, .lights = true, MEAN, .methods = VPL_USE_ALL}, // lights: Keller's only
    [VPL_SHOW_INDIRECT] = {.lights = true, MEAN, .patches = VPL_PATCH_LIGHT, .methods = VPL_USE_ALL},
    [VPL_SHOW_LIGHT] = {.lights = true, MEAN, .methods = VIRTUAL, .otherwise = NO_LIGHTS},
    [VPL_SHOW_OVERLAY] = {.direct = true, .lights = true, MEAN, .methods = VIRTUAL, .otherwise = NO_LIGHTS,
                          .drawOver = vplDrawVirtualLights},
    [VPL_SHOW_BOUNCE] = {.direct = true, .methods = VPL_USE_ALL},
    [VPL_SHOW_RSM] = {.methods = SSVP, .otherwise = NO_CLUSTERS, .draw = vplShowReflectiveMaps},
    [VPL_SHOW_RSM_SAMPLES] = {.direct = true, .lights = true, .methods = SSVP, .otherwise = NO_CLUSTERS,
                              .drawOver = vplDrawFirstBounce},
    [VPL_SHOW_CLUSTERS] = {.direct = true, .lights = true, .methods = SSVP, .otherwise = NO_CLUSTERS,
                           .drawOver = vplDrawClusters},
    [VPL_SHOW_PARABOLOID] = {.lights = true, .methods = SSVP, .otherwise = NO_CLUSTERS, .draw = vplShowClusterMap},
    [VPL_SHOW_SECOND_BOUNCE] = {.direct = true, .lights = true, .methods = SSVP, .otherwise = NO_CLUSTERS,
                                .drawOver = vplDrawSecondBounce},
    [VPL_SHOW_GATHER] = {.lights = true, .methods = VIRTUAL, .otherwise = NO_LIGHTS, .output = VPL_OUTPUT_GATHER},
    [VPL_SHOW_DENOISED] = {.lights = true, .methods = VIRTUAL, .otherwise = NO_LIGHTS, .output = VPL_OUTPUT_DENOISED},
    [VPL_SHOW_PATCHES] = {.patches = VPL_PATCHES_ONLY, .methods = RADIOSITY, .otherwise = NO_PATCHES},
    [VPL_SHOW_PATCH_RADIOSITY] = {.patches = VPL_PATCH_LIGHT, .methods = RADIOSITY, .otherwise = NO_PATCHES},
    [VPL_SHOW_FORM_FACTOR_SUMS] = {.patches = VPL_PATCH_FACTORS, .methods = RADIOSITY, .otherwise = NO_PATCHES},
    [VPL_SHOW_RESIDUAL] = {.patches = VPL_PATCH_LIGHT, .methods = RADIOSITY, .otherwise = NO_PATCHES},
};
// clang-format on

const char* vplRefuseShow(const vplRenderOptions* o)
{
    const vplShowRow* row = &VPL_SHOWS[o->output.show];
    if ((row->methods & 1 << o->method) != 0) {
        return NULL;
    }
    const bool others = row->otherwise == NO_CLUSTERS || row->otherwise == NO_PATCHES;
    return o->method == VPL_METHOD_PATH && !others ? NO_PATHS : row->otherwise;
}
