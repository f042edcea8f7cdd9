// SPDX-License-Identifier: MIT
// The data of textures and colours of vertices.
#ifndef VPL_GEOMETRY_PAINT_DATA_H
#define VPL_GEOMETRY_PAINT_DATA_H

#include <vpl/geometry.h>

// Maps texture coordinates of vertices to those of a material's textures; rows of a 2x3 matrix.
typedef struct vplTexturePlace {
    double m[2][3];
} vplTexturePlace;

typedef struct vplPaint {
    const float* texcoords;        // two per vertex; quads and boxes have none; NULL: no texture is shown
    const vplRgb* colours;         // one per vertex; NULL: none has any
    const vplTexturePlace* places; // one per material
    const vplRgb* means;           // reflectance, one per triangle
    struct vplTexture** textures;
    int textureCount;
    struct vplArena* arena; // owns the arrays
} vplPaint;

// Releases the textures, too. NULL is allowed.
void vplPaint_Destroy(const vplPaint* paint);

// Texture coordinates of the corners of a triangle, in its material's textures, and their barycentrics.
typedef struct vplTexturedTriangle {
    double u[3], v[3];
} vplTexturedTriangle;

vplTexturedTriangle vplPaint_Corners(const vplGeometry* geometry, int triangle);

#endif
