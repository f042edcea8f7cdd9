// SPDX-License-Identifier: MIT
// Options that tests and benchmarks start from, whatever the defaults are.
#ifndef VPL_TESTS_PLAIN_OPTIONS_H
#define VPL_TESTS_PLAIN_OPTIONS_H

#include <vpl/stages.h>

// Ten particles whose lights have no shadows (Franchi and Ferrante, physical lighting), deferred shading, and one
// sample per pixel: the smallest pictures in which every stage takes part.
static inline vplRenderOptions plainOptions(void)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    o.method = VPL_METHOD_INSTANT_RADIOSITY;
    o.output.antialias = 1;
    o.particles.count = 10;
    o.particles.reflectivity = 0.5;
    return o;
}

#endif
