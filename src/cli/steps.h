// SPDX-License-Identifier: MIT
// Renders of one picture that can be interrupted.
#ifndef VPL_CLI_STEPS_H
#define VPL_CLI_STEPS_H

#include "cli/cli.h"

// A finished or interrupted render.
typedef struct Picture {
    vplImage* image;    // or
    vplLayers* layers;  // where --aov asks for them
    vplImage* errorMap; // where --error-map asks for it
    vplRenderStats stats;
    // Of an interrupted render; 0 where no count was asked for; negative: it was not interrupted.
    int passesAsked;
    bool saved;   // the state was saved at the end
    bool unsaved; // some state could not be saved
} Picture;

// Renders with the bits of vplRender, and does what --resume, --checkpoint and --plan-out ask for. Returns an
// exit code after complaining about these, and the result of rendering in *resultOut. An interrupted render
// has the picture of the passes before, unless there is none or --no-partial is given: then the result is
// VPL_CANCELLED.
int renderPicture(const Arguments* arguments, const vplScene* scene, const vplRenderOptions* options,
                  Picture* pictureOut, vplResult* resultOut);
void freePicture(Picture* picture);

bool isPartial(const Picture* picture);

// Says what an interrupted render wrote to `path`. `before` says how many frames were written before, or is
// empty. `checkpoint` is the file that it can be continued from, or NULL.
void sayPartial(const Picture* picture, const char* before, const char* path, const char* checkpoint);

#endif
