// SPDX-License-Identifier: MIT
// What frames of a sequence hand on to each other.
#ifndef VPL_RENDER_HISTORY_H
#define VPL_RENDER_HISTORY_H

#include <vpl/render.h>

#include "base/context.h"

struct vplHistory {
    vplContext* context;
    uint64_t sceneStamp;   // of the scene as it was frozen; 0: none yet
    vplGeometry* geometry; // of that scene
    struct vplSsvpState* ssvp;
    void (*destroySsvp)(struct vplSsvpState* ssvp); // called where ssvp is not NULL
    struct vplRadiosityState* radiosity;
    void (*destroyRadiosity)(struct vplRadiosityState* radiosity); // called where radiosity is not NULL
};

// Begins a frame: the geometry of the scene, frozen by the first frame and owned by the history.
// VPL_INVALID_ARGUMENT if the scene, or the context, is another one than before, or was added to.
vplResult vplHistory_Open(vplHistory* history, const vplScene* scene, vplGeometry** geometryOut);

#endif
