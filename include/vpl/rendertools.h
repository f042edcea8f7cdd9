// SPDX-License-Identifier: MIT
// Renders from the inside: layers for files, stopping and going on, errors and virtual lights.
#ifndef VPL_RENDERTOOLS_H
#define VPL_RENDERTOOLS_H

#include <vpl/render.h>
#include <vpl/imagetools.h>
#include <vpl/lights.h>

VPL_HEADER_BEGIN

enum { VPL_MAX_LAYERS = 7 };

// The picture of a render and its layers, in the order of vplAov, for vplImage_WriteLayers. Names of objects
// are the scene's, which must outlive them.
typedef struct vplLayers {
    vplLayer layers[VPL_MAX_LAYERS]; // the first is the picture
    int count;
    vplImage* images[VPL_MAX_LAYERS]; // owned; those of the layers and others
    const char** objectNames;         // owned; NULL where no object has a name
    vplContext* context;
} vplLayers;

// Renders the picture of vplRender, with the same bits, and the layers of options.output.aovs. Destroy them
// with vplLayers_Destroy. statsOut may be NULL; its imageHash is that of the picture.
vplResult vplRenderLayers(const vplScene* scene, const vplRenderOptions* options, vplLayers** layersOut,
                          vplRenderStats* statsOut);

// NULL is allowed.
void vplLayers_Destroy(vplLayers* layers);

// Gets the picture so far and its layers, as vplRenderer_GetImage does; destroy them with vplLayers_Destroy. statsOut may be
// NULL.
vplResult vplRenderer_GetLayers(vplRenderer* renderer, vplLayers** layersOut, vplRenderStats* statsOut);

// Gets an estimate of where the picture's error lies: an image with one value per block of 8x8 pixels, whose red, green
// and blue are the block's rmse, its noise and its bias, in W/(m^2 sr). Noise is measured (0 where there is one pass);
// the bias of the whole picture, where it is known, is shared out by the contrast of neighbouring pixels. Destroy it with
// vplImage_Destroy.
vplResult vplRenderer_GetErrorMap(vplRenderer* renderer, vplImage** mapOut);

// Returns true if the render has a state that can be saved: it has several passes, or traces paths, or VPL_METHOD_AUTO with
// a time or an error may go on from a picture that is drawn at once. False for NULL.
bool vplRenderer_HasState(const vplRenderer* renderer);

// Saves the state between two steps to a file, whole or not at all. VPL_INVALID_ARGUMENT before the first step and
// where vplRenderer_HasState is false. Needs memory of the file's size: up to
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
// vplRenderer_GetLayers does (imageOut may then be NULL), and logs the error that remains. statsOut may be NULL. Needs no
// second picture in memory where the picture is no mean of passes. The renderer can only be destroyed after it.
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
