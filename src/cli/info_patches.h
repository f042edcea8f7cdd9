// SPDX-License-Identifier: MIT
#ifndef VPL_CLI_INFO_PATCHES_H
#define VPL_CLI_INFO_PATCHES_H

#include <vpl/vpl.h>

// What --method radiosity would divide a scene into.
typedef struct PatchInfo {
    int patches, sides;      // the sides are those that light reaches, of two per patch
    double longestEdge;      // metres
    bool linked;             // by links between groups
    int64_t formFactorBytes; // of all pairs
} PatchInfo;

// The patches themselves are made, because what light reaches is told by nothing else; adaptive ones as if uniform.
vplResult measurePatches(const vplScene* scene, const vplRenderOptions* options, const vplGeometry* geometry,
                         PatchInfo* infoOut);

#endif
