// SPDX-License-Identifier: MIT
// What the methods share: checked options, the frozen geometry, progress and statistics.
#ifndef VPL_RENDER_RENDER_H
#define VPL_RENDER_RENDER_H

#include <vpl/render.h>

#include "base/context.h"

// One render under way. Methods fill image and stats.
typedef struct vplJob {
    vplContext* context;
    const vplScene* scene;
    vplRenderOptions options;
    vplGeometry* geometry;
    vplCameraDef camera; // the scene's, posed
    vplView view;
    vplEmitterDef* emitters; // of the scene, posed; NULL where there are none
    int emitterCount;
    vplImage* image;
    vplRenderStats stats;
    double stepFrom, stepTo;         // share of the whole that the running step has
    double progressFrom, progressTo; // share of the step that the running stage has
    double stageStart;
    vplClampLoss loss; // of all passes
    int stepsDone;
    bool progressive;   // the picture is a mean of passes
    bool last;          // no more steps follow: what they would need may be given away
    float nearDistance; // see vplJob_FindNear; 0: not asked for yet
    void* state;        // the method's own
} vplJob;

// A method, step by step.
typedef struct vplMethodFcns {
    vplResult (*begin)(vplJob* job);               // what all steps share
    vplResult (*step)(vplJob* job, bool* doneOut); // done: the options name a count, and it is reached
    vplResult (*resolve)(vplJob* job);             // job->image, a new one, and the error estimates
    void (*end)(vplJob* job);                      // after begin, whether it succeeded or not
} vplMethodFcns;

// Paths per pixel in a step, large enough that threads seldom wait for each other.
enum { VPL_PATH_PASS = 32 };

extern const vplMethodFcns vplVirtualLightMethod, vplPathMethod;

// Whether the picture asks for virtual lights, and whether it does for what light comes without them.
bool vplNeedsLights(const vplRenderOptions* options);
bool vplNeedsDirect(const vplRenderOptions* options);

// Freezes the scene, poses what has a path and replaces options that are usual or automatic by those of the method.
// vplJob_End follows, whether it succeeded or not.
vplResult vplJob_Begin(const vplScene* scene, const vplRenderOptions* options, vplJob* job);
void vplJob_End(vplJob* job);

// Formulas of shading: Keller's lights are physical ones, also where particles lose light as printed.
vplLighting vplJob_GetShading(const vplJob* job);

// The usual shadows replaced by those of the method: none, map, ray, auto or cluster.
vplLightShadows vplJob_GetLightShadows(const vplJob* job);

// Times one stage and gives it a share of the progress, up to fraction `to`.
void vplJob_BeginStage(vplJob* job, double to);
void vplJob_EndStage(vplJob* job, const char* name);

// For stages that take a progress callback: pass vplJob_Progress and the job. NULL where nobody listens.
bool vplJob_Progress(void* job, double fraction);
vplProgressFcn* vplJob_GetProgress(const vplJob* job);

void vplJob_AddRaster(vplJob* job, const vplRasterStats* stats);

// The virtual lights as the options ask for them, of pass job->stepsDone.
vplResult vplJob_MakeLights(vplJob* job, vplLightSet** setOut);

// Adds the lights to the statistics.
void vplJob_CountLights(vplJob* job, const vplLightSet* set);

// The lights of such particles, placed as the options say.
vplResult vplJob_PlaceLights(vplJob* job, const vplEmitterDef* emitters, int emitterCount,
                             const vplParticleDef* particles, vplLightSet** setOut);

// Reflective maps of the emitters, options.rsmSize texels a side; those of no power need none, and stay NULL.
vplResult vplJob_DrawReflectiveMaps(vplJob* job, const vplEmitterDef* emitters, int emitterCount,
                                    vplReflectiveMap** maps);

// The bound of the geometry term for so many lights a pass, metres.
float vplJob_MinDistance(const vplJob* job, double lights);

// Whether something is between the eye and a point of the view.
bool vplView_IsHidden(const vplView* view, const vplGeometry* geometry, vplVec3 position);

// Emitters and eyes in the course of their paths.
typedef struct vplPoses {
    vplEmitterDef* emitters;
    vplVec3* eyes;
    int emitterCount, eyeCount;
} vplPoses;

// vplPoses_Free follows, whether it succeeded or not.
vplResult vplJob_FindPoses(const vplJob* job, vplPoses* posesOut);
void vplPoses_Free(vplContext* context, vplPoses* poses);

// Whether two poses of an emitter give the same light.
bool vplIsSameEmitter(const vplEmitterDef* a, const vplEmitterDef* b);

// Draws the lights over the picture.
void vplDrawLights(vplImage* image, const vplGeometry* geometry, const vplView* view, const vplLightSet* set);

// The cube map unfolded: +y above, -x +z +x -z in a row, -y below.
vplResult vplUnfoldCubeMap(const vplCubeMap* map, vplImage** imageOut);

#endif
