// SPDX-License-Identifier: MIT
// The table of options, for programs that show or check them, and options for languages that do not know the struct.
#ifndef VPL_OPTIONTOOLS_H
#define VPL_OPTIONTOOLS_H

#include <vpl/options.h>

VPL_HEADER_BEGIN

// Options on the heap, at their defaults, for languages that do not know the struct: they are read and written by the
// functions below. vplRenderOptions_Create returns NULL when out of memory; NULL may be destroyed.
vplRenderOptions* vplRenderOptions_Create(vplContext* context);
void vplRenderOptions_Destroy(vplContext* context, vplRenderOptions* options);

// The same as assigning vplRenderOptions.progress and progressUser.
void vplRenderOptions_SetProgress(vplRenderOptions* options, vplProgressFcn* progress, void* user);

// vplRenderOptions.problem.
const char* vplRenderOptions_GetProblem(const vplRenderOptions* options);

// The inverse of vplRenderOptions_Set: writes the value of an option as vplRenderOptions_Set reads it.
// VPL_INVALID_ARGUMENT if there is no such option or `size` bytes are too few.
vplResult vplRenderOptions_Get(const vplRenderOptions* options, const char* name, char* textOut, size_t size);

// Tells whether the method and pipeline of `options` use an option. If not, and reasonOut is not NULL, it
// gets the setting because of which the option has no effect, such as "--method keller".
bool vplRenderOptions_IsUsed(const vplRenderOptions* options, const char* name, char* reasonOut, size_t size);

// ---- the table

// Methods and pipelines that use an option. An option without a pipeline's bit is used by all pipelines.
enum {
    VPL_USE_INSTANT_RADIOSITY = 1 << VPL_METHOD_INSTANT_RADIOSITY,
    VPL_USE_DIRECT = 1 << VPL_METHOD_DIRECT,
    VPL_USE_PATH = 1 << VPL_METHOD_PATH,
    VPL_USE_KELLER = 1 << VPL_METHOD_KELLER,
    VPL_USE_SSVP = 1 << VPL_METHOD_SSVP,
    VPL_USE_RADIOSITY = 1 << VPL_METHOD_RADIOSITY,
    VPL_USE_ALL = (1 << (VPL_METHOD_RADIOSITY + 1)) - 1,
    VPL_USE_PARTICLES = VPL_USE_INSTANT_RADIOSITY | VPL_USE_KELLER,
    VPL_USE_VIRTUAL_LIGHTS = VPL_USE_PARTICLES | VPL_USE_SSVP,
    VPL_USE_SHADOW_MAPS = VPL_USE_PARTICLES | VPL_USE_DIRECT | VPL_USE_RADIOSITY,
    VPL_USE_BATCHED = 256 << VPL_ACCUMULATE_BATCHED,
    VPL_USE_INTERLEAVED = 256 << VPL_ACCUMULATE_INTERLEAVED,
    VPL_USE_LIGHTCUTS = 256 << VPL_ACCUMULATE_LIGHTCUTS
};

typedef enum vplOptionKind {
    VPL_OPTION_INT,
    VPL_OPTION_INT_AUTO,
    VPL_OPTION_FLOAT,
    VPL_OPTION_DOUBLE,
    VPL_OPTION_FLOAT_AUTO,
    VPL_OPTION_BELOW_AUTO,
    VPL_OPTION_CHOICE,
    VPL_OPTION_SEED,
    VPL_OPTION_SIZE,
    VPL_OPTION_SHOW,
    VPL_OPTION_BIAS,
    VPL_OPTION_SET,
    VPL_OPTION_PRESET,
    VPL_OPTION_PART
} vplOptionKind;

// One row of vpl/options.def.
typedef struct vplOption {
    const char* name;
    const char* value; // what it takes: "N", or its choices: "a|b|c"
    const char* group; // a heading, such as "Particles"
    const char* help;
    const char* field; // as in "vplRenderOptions.particles.count"
    vplOptionKind kind;
    int users;
    double low, high;
    size_t offset; // of the field in vplRenderOptions
} vplOption;

// All options, in the order of the groups.
const vplOption* vplGetOptions(int* countOut);

// NULL if there is none of that name.
const vplOption* vplFindOption(const char* name);

VPL_HEADER_END

#endif
