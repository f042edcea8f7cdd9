// SPDX-License-Identifier: MIT
// Renders from the inside: stopping and going on, errors, patches and virtual lights.
#ifndef VPL_RENDERTOOLS_H
#define VPL_RENDERTOOLS_H

#include <vpl/render.h>
#include <vpl/lights.h>

VPL_HEADER_BEGIN

// Radiosity's patches as a mesh with colours at its vertices: the light that options.method
// VPL_METHOD_RADIOSITY finds, direct and indirect, for tools that draw. Written by vplPatchMesh_WritePly; its
// 8-bit colours are those of pictures of the same exposure (stops). statsOut may be NULL.
vplResult vplBake(const vplScene* scene, const vplRenderOptions* options, float exposure, const char* path,
                  vplRenderStats* statsOut);

// Gets an estimate of where the picture's error lies: an image with one value per block of 8x8 pixels, whose red, green
// and blue are the block's rmse, its noise and its bias, in W/(m^2 sr). Noise is measured (0 where there is one pass);
// the bias of the whole picture, where it is known, is shared out by the contrast of neighbouring pixels. Destroy it with
// vplImage_Destroy.
vplResult vplRenderer_GetErrorMap(vplRenderer* renderer, vplImage** mapOut);

// Saves the state between two steps to a file, whole or not at all, for renders of several passes and path
// tracing; VPL_INVALID_ARGUMENT for others and before the first step. Needs memory of the file's size: up to
// 60 bytes per pixel, and 96 for path-traced layers of light.
vplResult vplRenderer_Save(vplRenderer* renderer, const char* path);

// Goes on with a saved render: before its first step the renderer takes over the state, and then gives the
// bits of a render that was never stopped, on any machine. Scene and options must be those of the saved
// render, but for options that say when it ends (passes, spp, budget, max-error, quality);
// VPL_INVALID_ARGUMENT names what differs. VPL_PARSE_ERROR for files that are damaged, VPL_FILE_ERROR.
// *doneOut is that of vplRenderer_Step. A state that was saved where another plan had just begun has no picture yet:
// loading renders its first pass. Times, and counts of rays, lights and draw calls of virtual lights, are those since;
// statistics of passes and errors are of all. After a failure the renderer is as it was before.
vplResult vplRenderer_Load(vplRenderer* renderer, const char* path, bool* doneOut);

// Ends a render: gets the picture as vplRenderer_GetImage does or, if layersOut is not NULL, the layers as
// vplRenderer_GetLayers does (imageOut may then be NULL), and logs the error that remains. statsOut may be NULL. Needs no second picture in memory where the
// picture is no mean of passes. The renderer can only be destroyed after it.
vplResult vplRenderer_Finish(vplRenderer* renderer, vplImage** imageOut, vplLayers** layersOut,
                             vplRenderStats* statsOut);

// Writes the plan as vplPlan_Write does, with the counts of what was rendered so far instead of a time or an
// error that ends it: passes or spp, budget 0, max-error 0, quality none. So a render that a time ended can
// be replayed to the same bits. The time and memory that were used are in it, too.
vplResult vplRenderer_WritePlan(vplRenderer* renderer, const char* path);

// Makes the virtual lights that vplRender uses in its first pass; destroy them with vplLightSet_Destroy.
vplResult vplMakeLights(const vplScene* scene, const vplRenderOptions* options, vplLightSet** setOut);

VPL_HEADER_END

#endif
