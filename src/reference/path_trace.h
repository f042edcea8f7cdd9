// SPDX-License-Identifier: MIT
// The reference: unbiased path tracing of diffuse scenes, in passes. However the samples are divided into
// passes, the picture has the same bits.
#ifndef VPL_REFERENCE_PATH_TRACE_H
#define VPL_REFERENCE_PATH_TRACE_H

#include <vpl/imagetools.h>

#include "reference/path_scene.h"

typedef struct vplPathStats {
    int64_t rays;
    double errorEstimate;         // RMSE of the picture; negative after less than two samples
    double relativeErrorEstimate; // the same divided by the picture's mean
} vplPathStats;

typedef struct vplPathTracer vplPathTracer;

// The geometry and the trees of the def must outlive the tracer.
vplResult vplPathTracer_Create(const vplGeometry* geometry, const vplPathDef* def, vplPathTracer** tracerOut);

// NULL is allowed.
void vplPathTracer_Destroy(vplPathTracer* tracer);

// Adds `samples` paths to each pixel, with fractions of progress from `from` to `to`. A pass that fails, for
// example because `progress` cancels it, leaves the tracer as it was before. Where `progress` is not NULL and
// paths were traced before, the tracer therefore holds a second copy of its sums.
vplResult vplPathTracer_Pass(vplPathTracer* tracer, int samples, vplProgressFcn* progress, void* user,
                             double from, double to);

// Takes back the last pass, which had a `progress` and succeeded.
void vplPathTracer_Undo(vplPathTracer* tracer);

// The state of a tracer between passes, for saving it. A loaded state replaces all three parts: the sums in
// place, and the counts by the functions below.
typedef struct vplPathSums {
    double* values; // sums of the radiance of each pixel's even and odd samples: r, g, b, r, g, b
    size_t count;
    int samples; // per pixel
} vplPathSums;

vplPathSums vplPathTracer_GetSums(vplPathTracer* tracer);
void vplPathTracer_SetSamples(vplPathTracer* tracer, int samples);
int64_t vplPathTracer_CountRays(const vplPathTracer* tracer);
void vplPathTracer_SetRays(vplPathTracer* tracer, int64_t rays);

// Stores the mean of all paths so far in an image of the def's size.
void vplPathTracer_Resolve(const vplPathTracer* tracer, vplImage* image, vplPathStats* statsOut);

#endif
