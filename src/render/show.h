// SPDX-License-Identifier: MIT
// What --show can show: one row each.
#ifndef VPL_RENDER_SHOW_H
#define VPL_RENDER_SHOW_H

#include "render/stage.h"

// How far radiosity must go.
typedef enum vplPatchNeed {
    VPL_NO_PATCHES,
    VPL_PATCHES_ONLY,
    VPL_PATCH_FACTORS,
    VPL_PATCH_LIGHT
} vplPatchNeed;

typedef struct vplShowRow {
    bool direct;           // emission, and light from emitters and area lights
    bool lights;           // light of virtual lights
    bool passes;           // it may be the mean of passes
    vplPatchNeed patches;  // of radiosity
    vplShadeOutput output; // of the picture stage
    int methods;           // that have it
    const char* otherwise; // what other methods are told
    // Draws a result instead of the picture, or over it; NULL: not.
    vplResult (*draw)(const vplRun* run, vplImage** imageOut);
    vplResult (*drawOver)(const vplRun* run, vplImage* image);
} vplShowRow;

// One row per vplShow.
extern const vplShowRow VPL_SHOWS[];

// Why the method has nothing of the kind to show; NULL: it has.
const char* vplRefuseShow(const vplRenderOptions* options);

// Whether only patches are seen, without light of pixels.
static inline bool vplShowsPatchesAlone(vplShow show)
{
    return show >= VPL_SHOW_PATCHES && show <= VPL_SHOW_RESIDUAL;
}

#endif
