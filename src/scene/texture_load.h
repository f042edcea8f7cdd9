// SPDX-License-Identifier: MIT
// Textures from picture files.
#ifndef VPL_SCENE_TEXTURE_LOAD_H
#define VPL_SCENE_TEXTURE_LOAD_H

#include <vpl/scenetools.h>

typedef struct vplTextureFile {
    const char* path;     // of the picture, or with `bytes` a label that names it
    const uint8_t* bytes; // its contents; NULL: the file at `path` is read
    size_t size;
    const char* where; // the place that refers to it, "file:line:column", for the warning
    vplTextureWrap wrapU, wrapV;
    float otherwise; // the grey that replaces a picture that cannot be read
} vplTextureFile;

// Adds a picture as a texture, unless the scene has it already. A picture that is missing or broken is replaced by one
// grey texel, with one warning. VPL_OUT_OF_MEMORY.
vplResult vplScene_LoadTexture(vplScene* scene, const vplTextureFile* file, int* indexOut);

#endif
