// SPDX-License-Identifier: MIT
// Materials of glTF files: what is diffuse of them. Surfaces of libvpl reflect diffusely only, so a metal, whose
// reflection is a mirror's, has the share METAL of its base colour as reflectance: the energy that a mirror reflects is
// between that of black and that of white paper.
#include "scene/gltf.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double METAL = 0.5;

static vplJson extensionOf(const vplJson* extensions, const char* name)
{
    return vplJson_Member(extensions, name);
}

// Reads a number in [0, 1].
static vplResult readShare(const vplJson* object, const char* key, double* out)
{
    const vplJson member = vplJson_Member(object, key);
    TRY(vplJson_ReadNumber(object, key, out));
    return *out >= 0 && *out <= 1 ? VPL_SUCCESS : vplJson_Fail(&member, "is %g, must be in [0, 1]", *out);
}

// Reads a colour of 3 or 4 channels in [0, most].
static vplResult readColour(const vplJson* object, const char* key, int channels, double most, double* out)
{
    const vplJson member = vplJson_Member(object, key);
    TRY(vplJson_ReadDoubles(object, key, channels, out));
    for (int k = 0; k < channels; k++) {
        if (!(out[k] >= 0 && out[k] <= most)) {
            const vplJson element = vplJson_Element(&member, k);
            return vplJson_Fail(&element, "is %g, must be in [0, %g]", out[k], most);
        }
    }
    return VPL_SUCCESS;
}

// Reads base colour and metalness, or the diffuse colour of KHR_materials_pbrSpecularGlossiness.
static vplResult readReflectance(vplGltf* g, const vplJson* material, const vplJson* extensions,
                                 vplMaterialDef* def, double* alphaOut)
{
    const vplJson glossy = extensionOf(extensions, "KHR_materials_pbrSpecularGlossiness");
    const vplJson metallic = vplJson_Member(material, "pbrMetallicRoughness");
    const bool old = glossy.value != NULL;
    double colour[4] = {1, 1, 1, 1}, metal = old ? 0 : 1;
    if (old) {
        TRY(vplJson_RequireObject(&glossy));
        TRY(readColour(&glossy, "diffuseFactor", 4, 1, colour));
    } else if (metallic.value != NULL) {
        TRY(vplJson_RequireObject(&metallic));
        TRY(readColour(&metallic, "baseColorFactor", 4, 1, colour));
        TRY(readShare(&metallic, "metallicFactor", &metal));
    }
    const vplJson* owner = old ? &glossy : &metallic;
    double mean[3] = {1, 1, 1};
    TRY(vplGltf_ReadTexture(g, owner, old ? "diffuseTexture" : "baseColorTexture", def));
    if (metal > 0) {
        TRY(vplGltf_ReadMean(g, owner, "metallicRoughnessTexture", false, mean));
        metal *= mean[2];
    }
    g->losses[VPL_GLTF_METALS] += metal > 0.01 && material->value != NULL;
    const double share = 1 - metal + METAL * metal;
    def->diffuse =
        (vplRgb){(float)(share * colour[0]), (float)(share * colour[1]), (float)(share * colour[2])};
    *alphaOut = colour[3];
    return VPL_SUCCESS;
}

static vplResult readEmission(vplGltf* g, const vplJson* material, const vplJson* extensions,
                              vplMaterialDef* def)
{
    const vplJson strong = extensionOf(extensions, "KHR_materials_emissive_strength");
    double colour[3] = {0, 0, 0}, strength = 1;
    TRY(readColour(material, "emissiveFactor", 3, VPL_MAX_MAGNITUDE_DOUBLE, colour));
    if (strong.value != NULL) {
        const vplJson member = vplJson_Member(&strong, "emissiveStrength");
        TRY(vplJson_RequireObject(&strong));
        TRY(vplJson_ReadNumber(&strong, "emissiveStrength", &strength));
        if (!(strength >= 0 && strength <= VPL_MAX_MAGNITUDE_DOUBLE)) {
            return vplJson_Fail(&member, "is %g, must be in [0, %g]", strength, VPL_MAX_MAGNITUDE_DOUBLE);
        }
    }
    double most = 0, mean[3] = {1, 1, 1};
    if (colour[0] + colour[1] + colour[2] > 0) {
        TRY(vplGltf_ReadMean(g, material, "emissiveTexture", true, mean));
    }
    for (int k = 0; k < 3; k++) {
        colour[k] *= strength * mean[k];
        most = fmax(most, colour[k]);
    }
    if (most > VPL_MAX_MAGNITUDE_DOUBLE) {
        const vplJson member = vplJson_Member(material, "emissiveFactor");
        return vplJson_Fail(&member, "times its strength is %g, must be at most %g", most,
                            VPL_MAX_MAGNITUDE_DOUBLE);
    }
    def->emission = (vplRgb){(float)colour[0], (float)colour[1], (float)colour[2]};
    g->losses[VPL_GLTF_EMISSIVE_TEXTURES] +=
        most > 0 && json_object_get(material->value, "emissiveTexture") != NULL;
    g->losses[VPL_GLTF_EMITS_ONE_SIDED] +=
        most > 0 && json_is_true(json_object_get(material->value, "doubleSided"));
    return VPL_SUCCESS;
}

// Reads how the alpha of the colour is used, and transmission as a share of light that passes.
static vplResult readOpacity(const vplJson* material, const vplJson* extensions, double alpha,
                             vplMaterialDef* def)
{
    const vplJson member = vplJson_Member(material, "alphaMode");
    const vplJson clear = extensionOf(extensions, "KHR_materials_transmission");
    const char* mode = "OPAQUE";
    double cutoff = 0.5, passes = 0;
    TRY(vplJson_ReadString(material, "alphaMode", &mode));
    const bool mask = strcmp(mode, "MASK") == 0, blend = strcmp(mode, "BLEND") == 0;
    if (!mask && !blend && strcmp(mode, "OPAQUE") != 0) {
        return vplJson_Fail(&member, "is \"%.40s\", must be \"OPAQUE\", \"MASK\" or \"BLEND\"", mode);
    }
    TRY(vplJson_ReadNumber(material, "alphaCutoff", &cutoff));
    if (clear.value != NULL) {
        TRY(vplJson_RequireObject(&clear));
        TRY(readShare(&clear, "transmissionFactor", &passes));
    }
    def->alphaFromTexture = (mask || blend) && def->texture >= 0;
    def->opacity = (float)((mask || blend ? alpha : 1) * (mask ? 1 : 1 - passes));
    // A cutoff of 0 or below cuts nothing; above 1 it cuts all, which opacity 0 says.
    if (mask && cutoff > 1) {
        def->opacity = 0;
    } else if (mask && cutoff > 0) {
        def->alphaCutoff = (float)cutoff;
    } else if (mask) {
        def->opacity = 1;
        def->alphaFromTexture = false;
    }
    return VPL_SUCCESS;
}

// A name that no other material of the scene has.
static vplResult makeName(vplGltf* g, const char* own, int index, const char** out)
{
    const size_t size = strlen(g->prefix) + (own != NULL ? strlen(own) : 0) + 40;
    char* name = vplArena_Alloc(g->scene->arena, size, 1);
    int number;
    TRY(name != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY);
    if (own != NULL && own[0] != 0) {
        snprintf(name, size, "%s%s", g->prefix, own);
    } else {
        snprintf(name, size, "%smaterial %d", g->prefix, index);
    }
    while (vplNames_Find(&g->names, name, strlen(name)) >= 0) {
        snprintf(name, size, "%s%s(%d)", g->prefix, own != NULL ? own : "", index++);
    }
    *out = name;
    return vplNames_Add(&g->names, name, strlen(name), &number);
}

static vplResult readMaterial(vplGltf* g, int index, vplMaterialDef* def)
{
    const vplJson none = {.file = &g->json};
    const vplJson material = index >= 0 ? vplGltf_Item(g, VPL_GLTF_MATERIALS, index) : none;
    const vplJson extensions = vplJson_Member(&material, "extensions");
    const char* own = index >= 0 ? NULL : "default";
    double alpha = 1;
    TRY(readReflectance(g, &material, &extensions, def, &alpha));
    TRY(readEmission(g, &material, &extensions, def));
    TRY(readOpacity(&material, &extensions, alpha, def));
    TRY(vplJson_ReadString(&material, "name", &own));
    return makeName(g, own, index, &def->name);
}

vplResult vplGltf_GetMaterial(vplGltf* g, int index, int* out)
{
    int* known = index >= 0 ? &g->materialOf[index] : &g->defaultMaterial;
    if (*known == VPL_GLTF_NOT_READ) {
        vplMaterialDef def = vplDefaultMaterialDef();
        TRY(readMaterial(g, index, &def));
        TRY(vplScene_AdoptMaterial(g->scene, &def, known));
    }
    *out = *known;
    return VPL_SUCCESS;
}
