// SPDX-License-Identifier: MIT
// Textures of glTF files.
#include "scene/gltf.h"

vplResult vplGltf_ReadTextures(vplGltf* g, const vplJson* object, const char* key, vplMaterialDef* def,
                               double* metal)
{
    (void)g;
    (void)object;
    (void)key;
    (void)def;
    (void)metal;
    return VPL_SUCCESS;
}
