// SPDX-License-Identifier: MIT
// Textures and opacity of the materials of scene files.
#include "base/file.h"
#include "scene/scene_json.h"
#include "scene/texture_load.h"

#include <math.h>
#include <string.h>

static vplResult readWrap(const vplJson* texture, vplTextureWrap* out)
{
    static const char* const names[] = {"repeat", "clamp", "mirror", NULL};
    const vplJson member = vplJson_Member(texture, "wrap");
    const char* wrap = NULL;
    TRY(vplJson_ReadString(texture, "wrap", &wrap));
    for (int i = 0; wrap != NULL && names[i] != NULL; i++) {
        if (strcmp(wrap, names[i]) == 0) {
            *out = (vplTextureWrap)i;
            return VPL_SUCCESS;
        }
    }
    return wrap == NULL
               ? VPL_SUCCESS
               : vplJson_Fail(&member, "is \"%.80s\", must be \"repeat\", \"clamp\" or \"mirror\"", wrap);
}

// Checks what the def's own check would report under names that the file does not use.
static vplResult requirePlacing(const vplJson* texture, const char* key, const float values[2])
{
    const vplJson member = vplJson_Member(texture, key);
    for (int i = 0; i < 2; i++) {
        if (!(fabsf(values[i]) <= VPL_MAX_MAGNITUDE)) {
            return vplJson_Fail(&member, "has %g, must be in [%g, %g]", (double)values[i],
                                -(double)VPL_MAX_MAGNITUDE, (double)VPL_MAX_MAGNITUDE);
        }
    }
    return VPL_SUCCESS;
}

static vplResult readPlacing(const vplJson* texture, vplMaterialDef* def)
{
    TRY(vplJson_ReadFloats(texture, "scale", 2, def->textureScale));
    TRY(vplJson_ReadFloats(texture, "offset", 2, def->textureOffset));
    TRY(requirePlacing(texture, "scale", def->textureScale));
    TRY(requirePlacing(texture, "offset", def->textureOffset));
    return vplJson_ReadAngle(texture, "rotation", -360, 360, &def->textureRotation);
}

static vplResult load(vplSceneLoader* l, const vplJson* at, const char* name, vplTextureWrap wrap,
                      float otherwise, int* indexOut)
{
    char* path = vplPathBeside(l->scene->context, l->json.name, name, strlen(name));
    if (path == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    char where[512];
    vplJson_FormatPlace(at, where, sizeof where);
    const vplTextureFile file = {
        .path = path, .where = where, .wrapU = wrap, .wrapV = wrap, .otherwise = otherwise};
    const vplResult result = vplScene_LoadTexture(l->scene, &file, indexOut);
    vplFree(l->scene->context, path);
    return result;
}

// Reads a texture: a file name, or an object with one. Only the material's first texture places both.
static vplResult readTexture(vplSceneLoader* l, const vplJson* material, const char* key, bool places,
                             float otherwise, vplMaterialDef* def, int* indexOut)
{
    static const char* const all[] = {"!file", "scale", "offset", "rotation", "wrap", NULL};
    static const char* const some[] = {"!file", "wrap", NULL};
    const vplJson texture = vplJson_Member(material, key);
    const char* name = NULL;
    vplTextureWrap wrap = VPL_WRAP_REPEAT;
    if (texture.value == NULL) {
        return VPL_SUCCESS;
    }
    if (!json_is_object(texture.value)) {
        TRY(vplJson_ReadString(material, key, &name));
        return load(l, &texture, name, wrap, otherwise, indexOut);
    }
    TRY(vplJson_CheckKeys(&texture, places ? all : some));
    TRY(vplJson_ReadString(&texture, "file", &name));
    TRY(readWrap(&texture, &wrap));
    TRY(places ? readPlacing(&texture, def) : VPL_SUCCESS);
    const vplJson file = vplJson_Member(&texture, "file");
    return load(l, &file, name, wrap, otherwise, indexOut);
}

static vplResult readBoolean(const vplJson* object, const char* key, bool* out)
{
    const vplJson member = vplJson_Member(object, key);
    if (member.value != NULL && !json_is_boolean(member.value)) {
        return vplJson_Fail(&member, "is no true or false, must be one");
    }
    *out = member.value != NULL ? json_is_true(member.value) : *out;
    return VPL_SUCCESS;
}

static vplResult readShare(const vplJson* object, const char* key, float* out)
{
    double value = (double)*out;
    TRY(vplJson_ReadNumber(object, key, &value));
    *out = (float)value;
    return VPL_SUCCESS;
}

vplResult vplSceneLoader_ReadTextures(vplSceneLoader* l, const vplJson* material, vplMaterialDef* def)
{
    const bool coloured = vplJson_Member(material, "texture").value != NULL;
    TRY(readTexture(l, material, "texture", true, 0.5f, def, &def->texture));
    TRY(readTexture(l, material, "alpha_texture", !coloured, 1, def, &def->alphaTexture));
    TRY(readBoolean(material, "alpha_from_texture", &def->alphaFromTexture));
    TRY(readShare(material, "opacity", &def->opacity));
    return readShare(material, "alpha_cutoff", &def->alphaCutoff);
}
