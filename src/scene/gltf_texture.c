// SPDX-License-Identifier: MIT
// Textures of glTF files: pictures in buffers, in data URIs and beside the file.
#include "scene/gltf.h"

#include <vpl/imagetools.h>

#include "base/file.h"
#include "image/texels.h"
#include "math/scalar.h"
#include "scene/texture_load.h"

#include <stdio.h>
#include <string.h>

// ---- pictures

// The picture of a texture. Bytes are NULL if it is a file beside that is not there.
typedef struct Picture {
    const char* label; // its path, or the place in the glTF file
    const uint8_t* bytes;
    size_t size;
} Picture;

// Finds the picture of an image. One that cannot be found has no bytes.
static vplResult findPicture(vplGltf* g, int index, Picture* out)
{
    const vplJson image = vplGltf_Item(g, VPL_GLTF_IMAGES, index);
    const char* uri = NULL;
    int view = -1;
    size_t stride;
    *out = (Picture){0};
    TRY(vplJson_ReadString(&image, "uri", &uri));
    TRY(vplGltf_ReadIndex(&image, "bufferView", vplGltf_Count(g, VPL_GLTF_VIEWS), &view));
    char* label = vplArena_Alloc(g->scratch, strlen(g->path) + 40, 1);
    TRY(vplArena_Check(g->scratch));
    snprintf(label, strlen(g->path) + 40, "%s: images[%d]", g->path, index);
    out->label = label;
    if (view >= 0) {
        return vplGltf_ReadView(g, view, &out->bytes, &out->size, &stride);
    }
    if (uri == NULL) {
        return vplJson_Fail(&image, "lacks the keys \"uri\" and \"bufferView\"");
    }
    return strncmp(uri, "data:", 5) == 0 ? vplGltf_ReadUri(g, &image, &out->bytes, &out->size)
                                         : vplGltf_FindBeside(g, uri, &out->label);
}

// The image of a texture that `object` names under `key`; -1 if there is none that can be read.
static vplResult findImage(vplGltf* g, const vplJson* object, const char* key, int* textureOut, int* imageOut)
{
    const vplJson info = vplJson_Member(object, key);
    *textureOut = *imageOut = -1;
    if (info.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_RequireObject(&info));
    TRY(vplGltf_ReadIndex(&info, "index", vplGltf_Count(g, VPL_GLTF_TEXTURES), textureOut));
    if (*textureOut < 0) {
        return vplJson_Fail(&info, "lacks the key \"index\"");
    }
    const vplJson texture = vplGltf_Item(g, VPL_GLTF_TEXTURES, *textureOut);
    TRY(vplGltf_ReadIndex(&texture, "source", vplGltf_Count(g, VPL_GLTF_IMAGES), imageOut));
    g->losses[VPL_GLTF_NO_PICTURE] += *imageOut < 0;
    return VPL_SUCCESS;
}

// ---- means

// The mean of a picture: its colours as linear light, or the codes of a map of numbers. *meanOut stays 1 for a picture
// that cannot be read.
static vplResult findMean(vplContext* context, const Picture* p, bool colours, double meanOut[3])
{
    double valueOf[256], sum[3] = {0, 0, 0};
    meanOut[0] = meanOut[1] = meanOut[2] = 1;
    vplTexels t = {0};
    if (p->bytes != NULL) {
        TRY(vplTexels_Decode(context, p->bytes, p->size, &t));
    }
    if (t.codes == NULL) {
        return VPL_SUCCESS;
    }
    for (int code = 0; code < 256; code++) {
        valueOf[code] = colours ? (double)vplSrgb_Decode((float)code / 255.0f) : code / 255.0;
    }
    const size_t count = (size_t)t.width * (size_t)t.height;
    for (size_t i = 0; i < count; i++) {
        const uint8_t* texel = t.codes + i * (size_t)t.channels;
        for (int k = 0; k < 3; k++) {
            sum[k] += valueOf[texel[t.channels < 3 ? 0 : k]];
        }
    }
    for (int k = 0; k < 3; k++) {
        meanOut[k] = sum[k] / (double)count;
    }
    vplTexels_Free(&t);
    return VPL_SUCCESS;
}

vplResult vplGltf_ReadMean(vplGltf* g, const vplJson* object, const char* key, bool colours,
                           double meanOut[3])
{
    int texture, image;
    meanOut[0] = meanOut[1] = meanOut[2] = 1;
    TRY(findImage(g, object, key, &texture, &image));
    if (image < 0) {
        return VPL_SUCCESS;
    }
    vplGltfMean* known = &g->means[2 * image + colours];
    if (!known->known) {
        Picture p;
        char* read = NULL;
        TRY(findPicture(g, image, &p));
        if (p.bytes == NULL && vplIsRegularFile(g->context, p.label)) {
            TRY(vplReadFile(g->context, p.label, &read, &p.size));
            p.bytes = (const uint8_t*)read;
        }
        const vplResult result = findMean(g->context, &p, colours, known->mean);
        vplFree(g->context, read);
        TRY(result);
        known->known = true;
    }
    memcpy(meanOut, known->mean, sizeof known->mean);
    return VPL_SUCCESS;
}

// ---- textures

static vplTextureWrap wrapOf(int64_t code)
{
    return code == 33071 ? VPL_WRAP_CLAMP : code == 33648 ? VPL_WRAP_MIRROR : VPL_WRAP_REPEAT;
}

static vplResult loadTexture(vplGltf* g, const vplJson* info, int texture, int image, int* out)
{
    const vplJson item = vplGltf_Item(g, VPL_GLTF_TEXTURES, texture);
    int sampler = -1;
    int64_t wraps[2] = {0, 0};
    Picture p;
    TRY(vplGltf_ReadIndex(&item, "sampler", vplGltf_Count(g, VPL_GLTF_SAMPLERS), &sampler));
    if (sampler >= 0) {
        const vplJson s = vplGltf_Item(g, VPL_GLTF_SAMPLERS, sampler);
        TRY(vplGltf_ReadWhole(&s, "wrapS", &wraps[0]));
        TRY(vplGltf_ReadWhole(&s, "wrapT", &wraps[1]));
    }
    TRY(findPicture(g, image, &p));
    char where[1024];
    vplJson_FormatPlace(info, where, sizeof where);
    const vplTextureFile file = {.path = p.label,
                                 .bytes = p.bytes,
                                 .size = p.size,
                                 .where = where,
                                 .wrapU = wrapOf(wraps[0]),
                                 .wrapV = wrapOf(wraps[1]),
                                 .otherwise = 0.5f};
    return vplScene_LoadTexture(g->scene, &file, out);
}

// Reads KHR_texture_transform. Its v grows downwards: with F(u, v) = (u, 1 - v), F T F has the rotation the other way
// round, and this offset.
static vplResult readTransform(const vplJson* info, int64_t* set, vplMaterialDef* def)
{
    const vplJson extensions = vplJson_Member(info, "extensions");
    const vplJson t = vplJson_Member(&extensions, "KHR_texture_transform");
    double offset[2] = {0, 0}, scale[2] = {1, 1}, rotation = 0, sine, cosine;
    if (t.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_RequireObject(&t));
    TRY(vplJson_ReadDoubles(&t, "offset", 2, offset));
    TRY(vplJson_ReadDoubles(&t, "scale", 2, scale));
    TRY(vplJson_ReadNumber(&t, "rotation", &rotation));
    TRY(vplGltf_ReadWhole(&t, "texCoord", set));
    const double largest = fmax(fmax(fabs(offset[0]), fabs(offset[1])), fmax(fabs(scale[0]), fabs(scale[1])));
    if (!(largest <= 1e6 && fabs(rotation) <= 1e6)) {
        return vplJson_Fail(&t, "has the number %g, must be at most 1e6", fmax(largest, fabs(rotation)));
    }
    vplSinCos(rotation, &sine, &cosine);
    def->textureRotation = rotation;
    def->textureScale[0] = (float)scale[0];
    def->textureScale[1] = (float)scale[1];
    def->textureOffset[0] = (float)(offset[0] + sine * scale[1]);
    def->textureOffset[1] = (float)(1 - offset[1] - cosine * scale[1]);
    return VPL_SUCCESS;
}

vplResult vplGltf_ReadTexture(vplGltf* g, const vplJson* object, const char* key, vplMaterialDef* def)
{
    const vplJson info = vplJson_Member(object, key);
    int texture, image;
    int64_t set = 0;
    TRY(findImage(g, object, key, &texture, &image));
    if (image < 0) {
        return VPL_SUCCESS;
    }
    TRY(vplGltf_ReadWhole(&info, "texCoord", &set));
    TRY(readTransform(&info, &set, def));
    if (set != 0) {
        g->losses[VPL_GLTF_OTHER_SET]++;
        return VPL_SUCCESS;
    }
    if (g->textureOf[texture] == VPL_GLTF_NOT_READ) {
        TRY(loadTexture(g, &info, texture, image, &g->textureOf[texture]));
    }
    def->texture = g->textureOf[texture];
    return VPL_SUCCESS;
}
