// SPDX-License-Identifier: MIT
// Helpers that the benchmarks share.
#ifndef VPL_BENCH_H
#define VPL_BENCH_H

#include "base/context.h"
#include "base/rng.h"
#include "cli/bench/measure.h"
#include "geometry/bvh.h"
#include "math/vec.h"

#include "../plain_options.h"

#include <vpl/stages.h>

#include <stdio.h>
#include <stdlib.h>

static inline void check(vplResult result)
{
    if (result != VPL_SUCCESS) {
        fprintf(stderr, "%s\n", vplResult_GetName(result));
        exit(1);
    }
}

static inline void say(void* user, vplLogLevel level, const char* message)
{
    (void)user;
    if (level == VPL_LOG_ERROR) {
        fprintf(stderr, "%s\n", message);
    }
}

// Opens a context and a scene. 0 workers: one per processor.
static inline void openScene(const char* path, int workers, vplIsa isa, vplContext** contextOut,
                             vplScene** sceneOut)
{
    vplContextDef def = vplDefaultContextDef();
    def.log = say;
    def.workerCount = workers;
    def.isa = isa;
    check(vplContext_Create(&def, contextOut));
    check(vplScene_Load(*contextOut, path, sceneOut));
}

// Returns the direction of the ray through the centre of a pixel.
static inline vplVec3 rayThrough(const vplView* v, int x, int y)
{
    float sx = (float)((2 * (x + 0.5) / v->width - 1) / v->scaleX);
    float sy = (float)((1 - 2 * (y + 0.5) / v->height) / v->scaleY);
    return (vplVec3){v->forward.x + sx * v->right.x + sy * v->up.x,
                     v->forward.y + sx * v->right.y + sy * v->up.y,
                     v->forward.z + sx * v->right.z + sy * v->up.z};
}

#endif
