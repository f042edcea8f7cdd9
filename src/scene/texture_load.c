// SPDX-License-Identifier: MIT
// Textures from picture files: read once per scene, whatever refers to them.
#include "scene/texture_load.h"

#include "base/arena.h" // TRY
#include "base/file.h"
#include "image/image_file.h"
#include "image/texels.h"
#include "math/scalar.h"
#include "scene/scene.h"

#include <string.h>
#include <strings.h>

static int findTexture(const vplScene* scene, const vplTextureFile* file)
{
    for (int i = 0; i < scene->textureCount; i++) {
        const vplSceneTexture* t = &scene->textures[i];
        if (t->otherwise == file->otherwise && t->def.wrapU == file->wrapU && t->def.wrapV == file->wrapV &&
            t->def.name != NULL && strcmp(t->def.name, file->path) == 0) {
            return i;
        }
    }
    return -1;
}

static bool endsWith(const char* path, const char* extension)
{
    const size_t length = strlen(path), n = strlen(extension);
    return length >= n && strcasecmp(path + length - n, extension) == 0;
}

// Adds one grey texel instead of a picture.
static vplResult addGrey(vplScene* scene, const vplTextureFile* file, vplTextureDef def, const char* reason,
                         int* indexOut)
{
    vplLog(scene->context, VPL_LOG_WARNING, "%s: cannot read the picture %s: %s; it is taken as %s",
           file->where, file->path, reason, file->otherwise < 1 ? "grey" : "white");
    def.linear = &file->otherwise;
    def.width = def.height = def.channels = 1;
    return vplScene_AddTexture(scene, &def, indexOut);
}

// Adds a picture of linear floats. Reflectances above 1 become 1.
static vplResult addLinear(vplScene* scene, const vplTextureFile* file, vplTextureDef def,
                           const uint8_t* bytes, size_t size, int* indexOut)
{
    vplDecodeFcn* decodeFloats = endsWith(file->path, ".hdr")   ? vplDecodeHdr
                                 : endsWith(file->path, ".pfm") ? vplDecodePfm
                                                                : vplDecodeExr;
    vplImage* image;
    const vplResult decoded = decodeFloats(scene->context, file->path, bytes, size, &image);
    if (decoded == VPL_OUT_OF_MEMORY) {
        return decoded;
    }
    if (decoded != VPL_SUCCESS) {
        return addGrey(scene, file, def, "see above", indexOut);
    }
    for (size_t i = 0; i < 3 * (size_t)image->width * (size_t)image->height; i++) {
        const float x = image->pixels[i];
        image->pixels[i] = x > 0 ? vplMinf(x, 1) : 0; // NaN becomes 0
    }
    def.linear = image->pixels;
    def.width = image->width;
    def.height = image->height;
    const vplResult result = vplScene_AddTexture(scene, &def, indexOut);
    vplImage_Destroy(image);
    return result;
}

static vplResult addPicture(vplScene* scene, const vplTextureFile* file, const uint8_t* bytes, size_t size,
                            int* indexOut)
{
    vplTextureDef def = vplDefaultTextureDef();
    def.name = file->path;
    def.wrapU = file->wrapU;
    def.wrapV = file->wrapV;
    if (bytes == NULL) {
        return addGrey(scene, file, def, "there is no such file", indexOut);
    }
    if (endsWith(file->path, ".hdr") || endsWith(file->path, ".pfm") || endsWith(file->path, ".exr")) {
        return addLinear(scene, file, def, bytes, size, indexOut);
    }
    vplTexels texels;
    TRY(vplTexels_Decode(scene->context, bytes, size, &texels));
    if (texels.codes == NULL) {
        return addGrey(scene, file, def, texels.reason, indexOut);
    }
    def.texels = texels.codes;
    def.width = texels.width;
    def.height = texels.height;
    def.channels = texels.channels;
    const vplResult result = vplScene_AddTexture(scene, &def, indexOut);
    vplTexels_Free(&texels);
    return result;
}

vplResult vplScene_LoadTexture(vplScene* scene, const vplTextureFile* file, int* indexOut)
{
    char* read = NULL;
    size_t size = file->size;
    const int known = findTexture(scene, file);
    if (known >= 0) {
        *indexOut = known;
        return VPL_SUCCESS;
    }
    if (file->bytes == NULL &&
        vplIsRegularFile(scene->context, file->path)) { // a pipe or device would make us wait
        TRY(vplReadFile(scene->context, file->path, &read, &size));
    }
    const uint8_t* bytes = file->bytes != NULL ? file->bytes : (const uint8_t*)read;
    int index = -1;
    const vplResult result = addPicture(scene, file, bytes, size, &index);
    vplFree(scene->context, read);
    if (result == VPL_SUCCESS) {
        scene->textures[index].otherwise = file->otherwise;
        *indexOut = index;
    }
    return result;
}
