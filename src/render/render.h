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
    vplView view;
    vplImage* image;
    vplRenderStats stats;
    double progressFrom, progressTo; // share of the whole that the running stage has
    double stageStart;
} vplJob;

vplResult vplCheckOptions(const vplScene* scene, const vplRenderOptions* options);

// Times one stage and gives it a share of the progress, up to fraction `to`.
void vplJob_BeginStage(vplJob* job, double to);
void vplJob_EndStage(vplJob* job, const char* name);

// For stages that take a progress callback: pass vplJob_Progress and the job. NULL where nobody listens.
bool vplJob_Progress(void* job, double fraction);
vplProgressFcn* vplJob_GetProgress(const vplJob* job);

void vplJob_AddRaster(vplJob* job, const vplRasterStats* stats);

// The particle simulation as the options ask for it.
vplResult vplJob_MakeLights(vplJob* job, vplLightSet** setOut);

// Methods.
vplResult vplRenderInstantRadiosity(vplJob* job);
vplResult vplRenderPath(vplJob* job);

// Draws the lights over the picture.
void vplDrawLights(vplImage* image, const vplGeometry* geometry, const vplView* view, const vplLightSet* set);

// The cube map unfolded: +y above, -x +z +x -z in a row, -y below.
vplResult vplUnfoldCubeMap(const vplCubeMap* map, vplImage** imageOut);

#endif
