// SPDX-License-Identifier: MIT
// The reference: path tracing of diffuse scenes, free of bias, in passes that end in the same bits however they
// are cut.
#ifndef VPL_REFERENCE_PATH_TRACE_H
#define VPL_REFERENCE_PATH_TRACE_H

#include <vpl/geometry.h>
#include <vpl/image.h>

// How light from emitting triangles is found at each vertex of a path; the last two are there to be measured.
typedef enum vplPathLights {
    VPL_PATH_BOTH = 0, // by a point on a light and by the path itself, weighted by Veach's power heuristic
    VPL_PATH_BALANCE,  // the same by his balance heuristic
    VPL_PATH_POINTS,   // by points on lights alone
    VPL_PATH_CHANCE    // by the path alone
} vplPathLights;

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
    vplPathLights lights;
    bool random;         // independent random numbers instead of Sobol's points
    double rouletteFrom; // a path whose throughput is below this may end; larger ends sooner
    int allEmitters;     // up to so many emitters are all asked at each vertex, of more only one
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
