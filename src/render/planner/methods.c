// SPDX-License-Identifier: MIT
// The methods that the options leave to choose from.
#include "render/options.h"
#include "render/planner/planner.h"
#include "render/show.h"

#include <string.h>

// True if the option is as in vplDefaultRenderOptions. All numbers, choices and bits are told apart by their value.
static bool isUsual(const vplRenderOptions* o, const vplRenderOptions* usual, const vplOption* option)
{
    return vplOption_GetNumber(option, o) == vplOption_GetNumber(option, usual);
}

int vplMethodsFor(const vplRenderOptions* o)
{
    const vplRenderOptions usual = vplDefaultRenderOptions();
    int count, methods = VPL_SHOWS[o->output.show].methods;
    const vplOption* options = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        methods &= isUsual(o, &usual, &options[i]) ? VPL_USE_ALL : options[i].users;
    }
    if (o->lighting == VPL_LIGHTING_DOCUMENTED) { // the others' documents print no formulas
        methods &= VPL_USE_PARTICLES | VPL_USE_DIRECT;
    }
    if (o->lights.shadows == VPL_LIGHT_SHADOWS_CLUSTER) {
        methods &= VPL_USE_SSVP;
    }
    return methods;
}

vplMethod vplFirstMethodFor(const vplRenderOptions* o)
{
    static const vplMethod ORDER[] = {VPL_METHOD_KELLER,
                                      VPL_METHOD_PATH,
                                      VPL_METHOD_SSVP,
                                      VPL_METHOD_RADIOSITY,
                                      VPL_METHOD_INSTANT_RADIOSITY,
                                      VPL_METHOD_DIRECT};
    const int methods = vplMethodsFor(o);
    for (size_t i = 0; i < sizeof ORDER / sizeof *ORDER; i++) {
        if ((methods & 1 << ORDER[i]) != 0) {
            return ORDER[i];
        }
    }
    return VPL_METHOD_KELLER;
}
