// SPDX-License-Identifier: MIT
// The table of the values of --show.
#ifndef VPL_RENDER_SHOW_H
#define VPL_RENDER_SHOW_H

#include "render/stage.h"

// The last result of radiosity that a picture needs.
typedef enum vplPatchNeed {
    VPL_NO_PATCHES,
    VPL_PATCHES_ONLY,
    VPL_PATCH_FACTORS,
    VPL_PATCH_LIGHT
} vplPatchNeed;

typedef struct vplShowRow {
    bool direct;           // emission, and light from emitters and area lights
    bool lights;           // light of virtual lights
    bool passes;           // the picture may be the mean of passes
    vplPatchNeed patches;  // of radiosity
    vplShadeOutput output; // of the picture stage
    int methods;           // VPL_USE_... of the methods that have it
    const char* otherwise; // the sentence for other methods
    // Draws a result instead of the picture, or over it; NULL: not.
    vplResult (*draw)(const vplRun* run, vplImage** imageOut);
    vplResult (*drawOver)(const vplRun* run, vplImage* image);
} vplShowRow;

// One row per vplShow.
extern const vplShowRow VPL_SHOWS[];

// Returns the reason why the method cannot show it, or NULL if it can.
const char* vplRefuseShow(const vplRenderOptions* options);

// Pictures of light have errors, and coarse forms that are better than nothing.
static inline bool vplShowsLight(vplShow show)
{
    return show == VPL_SHOW_PICTURE || show == VPL_SHOW_DIRECT || show == VPL_SHOW_INDIRECT;
}

// True if the picture shows only values of patches, and no direct light of pixels.
static inline bool vplShowsPatchesAlone(vplShow show)
{
    return show >= VPL_SHOW_PATCHES && show <= VPL_SHOW_RESIDUAL;
}

#endif
