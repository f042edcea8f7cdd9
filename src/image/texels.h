// SPDX-License-Identifier: MIT
// Pictures as their files hold them, for textures: codes of 8 bits with their alpha, not turned into linear light.
#ifndef VPL_IMAGE_TEXELS_H
#define VPL_IMAGE_TEXELS_H

#include "base/arena.h"

typedef struct vplTexels {
    vplArena* arena; // holds the codes
    int width, height, channels;
    uint8_t* codes;     // NULL: the picture cannot be read
    const char* reason; // why not
} vplTexels;

// Decodes PNG, JPEG, BMP or TGA. The size is checked before anything is decoded. vplTexels_Free frees the codes. A picture that
// cannot be read is VPL_SUCCESS without codes; running out of memory is VPL_OUT_OF_MEMORY.
vplResult vplTexels_Decode(vplContext* context, const uint8_t* bytes, size_t size, vplTexels* texelsOut);
void vplTexels_Free(vplTexels* texels);

#endif
