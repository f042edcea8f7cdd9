// SPDX-License-Identifier: MIT
// Decoded textures: linear texels in a mip pyramid, and their filtered lookup.
#ifndef VPL_SCENE_TEXTURE_H
#define VPL_SCENE_TEXTURE_H

#include <vpl/scenetools.h>

// Halving VPL_MAX_IMAGE_SIZE 14 times gives 1.
enum { VPL_TEXTURE_LEVELS = 15, VPL_TEXTURE_CHANNELS = 4, VPL_TEXTURE_PROBES = 4 };

typedef struct vplTextureLevel {
    uint16_t* texels; // RGBA, linear, 65535 is 1; the first row is the top one
    int width, height;
} vplTextureLevel;

// Read only once it is made. Scenes and geometries share it.
typedef struct vplTexture {
    vplTextureLevel levels[VPL_TEXTURE_LEVELS]; // each half as large as the one before, down to 1 x 1
    int levelCount;
    vplTextureWrap wrapU, wrapV;
    int users; // scenes and geometries that hold it; they are of one context, which one thread at a time uses
    struct vplArena* arena; // owns the levels and the texture itself
} vplTexture;

// Decodes a checked def, for one user.
vplResult vplTexture_Create(vplContext* context, const vplTextureDef* def, vplTexture** textureOut);

void vplTexture_Retain(vplTexture* texture);

// Destroys the texture when its last user releases it.
void vplTexture_Release(vplTexture* texture);

// The part of the texture that a lookup averages over: a parallelogram of texture coordinates around a point.
typedef struct vplTextureArea {
    double u, v;
    float longU, longV;   // the longer side
    float shortU, shortV; // the shorter side
} vplTextureArea;

// The filtered red, green, blue and alpha.
void vplTexture_Lookup(const vplTexture* texture, const vplTextureArea* area, float rgbaOut[4]);

#endif
