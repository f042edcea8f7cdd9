// SPDX-License-Identifier: MIT
// The reference: path tracing of diffuse scenes, free of bias, in passes that end in the same bits however they
// are cut.
#ifndef VPL_REFERENCE_PATH_TRACE_H
#define VPL_REFERENCE_PATH_TRACE_H

#include <vpl/geometry.h>
#include <vpl/image.h>

// Three ways in which a path can find its last steps to a light; where several can, their results are weighted.
enum {
    VPL_PATH_POINTS = 1,    // from a surface to a point on a light
    VPL_PATH_CHANCE = 2,    // a reflected path meets a light by itself
    VPL_PATH_PARTICLES = 4, // from a surface to where a particle from a light has landed
    VPL_PATH_ALL = 7
};

typedef struct vplPathDef {
    const vplCameraDef* camera;
    const vplEmitterDef* emitters; // NULL if there are none
    int emitterCount;
    int width, height; // pixels
    bool emission;     // surfaces that emit are seen to
    bool pixelCentres; // paths start at the centres of pixels, as the rasterizer samples them
    int firstBounce,
        lastBounce; // the picture adds up light after these numbers of reflections before the eye's
    uint64_t seed;
    int ways;     // VPL_PATH_POINTS | ...; points are taken for what cannot be met by chance, in any case
    bool balance; // weights by the balance heuristic instead of the power heuristic
    bool random;  // independent random numbers instead of Sobol's points
    double rouletteFrom; // a path whose throughput is below this may end; larger ends sooner
} vplPathDef;

vplPathDef vplDefaultPathDef(void);

typedef struct vplPathStats {
    int64_t rays;
    double errorEstimate;         // rmse of the picture; negative if there was but one sample
    double relativeErrorEstimate; // the same divided by the picture's mean
} vplPathStats;

typedef struct vplPathTracer vplPathTracer;

// The geometry, the camera and the emitters must stay until the tracer is destroyed.
vplResult vplPathTracer_Create(const vplGeometry* geometry, const vplPathDef* def, vplPathTracer** tracerOut);

// NULL is allowed.
void vplPathTracer_Destroy(vplPathTracer* tracer);

// Adds `samples` paths to each pixel, with fractions of progress from `from` to `to`.
vplResult vplPathTracer_Pass(vplPathTracer* tracer, int samples, vplProgressFcn* progress, void* user,
                             double from, double to);

// The mean of all paths so far, into an image of the def's size.
void vplPathTracer_Resolve(const vplPathTracer* tracer, vplImage* image, vplPathStats* statsOut);

#endif
