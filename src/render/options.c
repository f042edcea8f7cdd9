// SPDX-License-Identifier: MIT
// The option table, defaults and checks, all made from vpl/options.def.
#include "render/options.h"

#include "base/arena.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

enum { OPTIONS_COOKIE = 0x56504c70 };

// clang-format off
static const vplOption OPTIONS[] = {
#define VPL_OPTION_ROW(heading, prefix, KIND, type, member, default_, least, most, option, values, used, text) \
    {.name = option, .value = values, .group = heading, .help = text, .field = #prefix #member, \
     .kind = VPL_OPTION_##KIND, .users = used, .low = least, .high = most, \
     .offset = offsetof(vplRenderOptions, prefix member)},
#include <vpl/options.def>
};
// clang-format on

enum { OPTION_COUNT = sizeof OPTIONS / sizeof *OPTIONS };

vplRenderOptions vplDefaultRenderOptions(void)
{
    vplRenderOptions o = {0};
#define VPL_OPTION_ROW(heading, prefix, kind, type, member, default_, ...) o.prefix member = default_;
#include <vpl/options.def>
    o.cookie = OPTIONS_COOKIE;
    return o;
}

vplRenderOptions* vplRenderOptions_Create(vplContext* context)
{
    if (context == NULL) {
        return NULL;
    }
    vplRenderOptions* options = vplAlloc(context, 1, sizeof *options);
    if (options != NULL) {
        *options = vplDefaultRenderOptions();
    }
    return options;
}

void vplRenderOptions_Destroy(vplContext* context, vplRenderOptions* options)
{
    if (context != NULL) {
        vplFree(context, options);
    }
}

void vplRenderOptions_SetProgress(vplRenderOptions* options, vplProgressFcn* progress, void* user)
{
    if (options == NULL) {
        return;
    }
    options->progress = progress;
    options->progressUser = user;
}

const char* vplRenderOptions_GetProblem(const vplRenderOptions* options)
{
    return options != NULL ? options->problem : "";
}

const vplOption* vplGetOptions(int* countOut)
{
    if (countOut == NULL) {
        return NULL;
    }
    *countOut = OPTION_COUNT;
    return OPTIONS;
}

const vplOption* vplFindOption(const char* name)
{
    if (name == NULL) {
        return NULL;
    }
    for (int i = 0; i < OPTION_COUNT; i++) {
        if (strcmp(OPTIONS[i].name, name) == 0) {
            return &OPTIONS[i];
        }
    }
    return NULL;
}

vplAccumulation vplUsualPipeline(const vplRenderOptions* o)
{
    const bool particles = o->method == VPL_METHOD_KELLER || o->method == VPL_METHOD_INSTANT_RADIOSITY;
    const bool many =
        o->method == VPL_METHOD_KELLER && (o->particles.count < 0 || o->particles.count >= 1000);
    const bool shared = many || (particles && o->pipeline.interleave > 1);
    const bool gathers = o->method == VPL_METHOD_RADIOSITY && o->radiosity.gather > 0;
    return shared || gathers || o->method == VPL_METHOD_SSVP ? VPL_ACCUMULATE_INTERLEAVED
                                                             : VPL_ACCUMULATE_DEFERRED;
}

int vplRenderedWidth(const vplOutputOptions* o)
{
    return (o->width + o->pixelSize - 1) / o->pixelSize;
}

int vplRenderedHeight(const vplOutputOptions* o)
{
    return (o->height + o->pixelSize - 1) / o->pixelSize;
}

double vplCountPixels(const vplOutputOptions* o)
{
    return (double)vplRenderedWidth(o) * vplRenderedHeight(o);
}

// Each pixel keeps eight lights or more.
// With 4000 particles a side of 16 takes a third of the time of 8 (room, 1280x720), but blurs light near
// corners in small pictures (256x256: error 2.9 % instead of 2.3 %).
int vplUsualSquare(const vplRenderOptions* o)
{
    const bool large = vplCountPixels(&o->output) >= 300000;
    if (o->method != VPL_METHOD_KELLER || o->particles.count < 500) {
        return 4;
    }
    return large && o->particles.count >= 2000 ? 16 : 8;
}

// ---- checks

double vplOption_GetNumber(const vplOption* option, const vplRenderOptions* o)
{
    const char* field = (const char*)o + option->offset;
    float single;
    double wide;
    int whole; // enums are ints
    switch (option->kind) {
    case VPL_OPTION_FLOAT:
    case VPL_OPTION_FLOAT_AUTO:
    case VPL_OPTION_BIAS:
        memcpy(&single, field, sizeof single);
        return (double)single;
    case VPL_OPTION_DOUBLE:
    case VPL_OPTION_BELOW_AUTO:
        memcpy(&wide, field, sizeof wide);
        return wide;
    case VPL_OPTION_SEED:
        return 0;
    default:
        memcpy(&whole, field, sizeof whole);
        return whole;
    }
}

static vplResult checkOption(const vplContext* context, const vplRenderOptions* o, const vplOption* option)
{
    const double value = vplOption_GetNumber(option, o);
    const bool automatic = option->kind == VPL_OPTION_INT_AUTO || option->kind == VPL_OPTION_FLOAT_AUTO ||
                           option->kind == VPL_OPTION_BELOW_AUTO || option->kind == VPL_OPTION_BIAS;
    const bool below = option->kind == VPL_OPTION_BELOW_AUTO;
    const bool chosen = automatic && (option->kind == VPL_OPTION_INT_AUTO ? value == -1 : isfinite(value));
    const bool low = value >= (double)(float)option->low || chosen;
    const bool high = below ? value < option->high : value <= option->high;
    if (low && high) {
        return VPL_SUCCESS;
    }
    return vplFail(context, VPL_INVALID_ARGUMENT, "vplRenderOptions.%s is %.9g, must be in [%.9g, %.9g%s%s",
                   option->field, value, option->low, option->high, below ? ")" : "]",
                   option->kind == VPL_OPTION_INT_AUTO ? " or -1 for automatic"
                   : automatic                         ? " or negative for automatic"
                                                       : "");
}

vplResult vplCheckOptions(const vplScene* scene, const vplRenderOptions* o)
{
    const vplContext* context = vplScene_GetContext(scene);
    const int cameras = vplScene_GetCameraCount(scene);
    if (o->cookie != OPTIONS_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions was not made by vplDefaultRenderOptions");
    }
    for (int i = 0; i < OPTION_COUNT; i++) {
        TRY(checkOption(context, o, &OPTIONS[i]));
    }
    if (o->view != NULL) {
        return vplScene_CheckCamera(scene, "vplRenderOptions.view->", o->view);
    }
    if (cameras == 0) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "the scene has no camera");
    }
    if (o->output.camera >= cameras) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions.output.camera is %d, must be in [0, %d]", o->output.camera,
                       cameras - 1);
    }
    return VPL_SUCCESS;
}
