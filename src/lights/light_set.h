// SPDX-License-Identifier: MIT
// Sets of virtual lights being made.
#ifndef VPL_LIGHTS_LIGHT_SET_H
#define VPL_LIGHTS_LIGHT_SET_H

#include <vpl/lights.h>

// Room for so many lights and steps, all 0; lights, stepCounts and lightsInStep may be written until the set is given
// away.
vplResult vplLightSet_Make(vplContext* context, int lightCount, int stepCount, vplLightSet** setOut);

// One set of the lights of two that each stand for light of its own, those of `b` behind those of `a`. Steps are kept; N
// is that of `a`, and the weights of `b` make up for it, unless `a` has none.
vplResult vplLightSet_Join(const vplLightSet* a, const vplLightSet* b, vplLightSet** setOut);

#endif
