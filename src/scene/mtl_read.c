// SPDX-License-Identifier: MIT
// MTL files: Kd is the reflectance, Ke the emission. All else describes surfaces that libvpl does not have.
#include "scene/obj.h"

typedef struct Mtl {
    vplText text;
    vplObjMaterials* materials;
    int current;               // material being defined; -1: none so far, or defined before
    bool started;              // a newmtl was met
    const char* firstBright;   // Kd above 1
    const char* firstRepeated; // newmtl of a name that has a definition
    long long brightCount, repeatedCount;
    vplUnknownWords unknown;
} Mtl;

vplResult vplObjMaterials_Get(vplObjMaterials* materials, vplWord name, int* out)
{
    size_t length = (size_t)(name.end - name.start);
    size_t count = materials->names.index.count;
    int number = vplNames_Find(&materials->names, name.start, length);
    if (number < 0) {
        vplResult result = vplReserve(materials->names.index.context, &materials->list, &materials->capacity,
                                      count + 1, sizeof *materials->list);
        if (result == VPL_SUCCESS) {
            result = vplNames_Add(&materials->names, name.start, length, &number);
        }
        if (result != VPL_SUCCESS) {
            return result;
        }
        vplMaterialDef grey = vplDefaultMaterialDef();
        materials->list[number] = (vplObjMaterial){grey.diffuse, grey.emission, false, -1};
    }
    *out = number;
    return VPL_SUCCESS;
}

void vplObjMaterials_Close(vplObjMaterials* materials)
{
    vplFree(materials->names.index.context, materials->list);
    vplNames_Close(&materials->names);
    materials->list = NULL;
    materials->capacity = 0;
}

static vplResult beginMaterial(Mtl* m, vplWord line)
{
    vplWord name = vplRestOfLine(line);
    int number;
    if (name.start == name.end) {
        return vplText_FailWord(&m->text, name, "the name of a material");
    }
    vplResult result = vplObjMaterials_Get(m->materials, name, &number);
    if (result != VPL_SUCCESS) {
        return result;
    }
    m->started = true;
    m->current = number;
    if (m->materials->list[number].defined) {
        m->current = -1;
        m->firstRepeated = m->repeatedCount++ == 0 ? name.start : m->firstRepeated;
    }
    m->materials->list[number].defined = true;
    return VPL_SUCCESS;
}

// One number for all channels or three. False in *understoodOut for a colour that is not RGB.
static vplResult readColour(Mtl* m, vplWord line, const char* what, vplRgb* out, bool* understoodOut)
{
    vplWord ahead = line, word;
    float v[3];
    int count = 0;
    vplNextWord(&ahead, &word);
    *understoodOut = !vplWord_Is(word, "spectral") && !vplWord_Is(word, "xyz");
    if (!*understoodOut) {
        vplText_WarnOnce(&m->text, &m->unknown, word);
        return VPL_SUCCESS;
    }
    ahead = line;
    while (count < 3 && (vplNextWord(&ahead, &word) || count != 1)) {
        vplResult result = vplText_Number(&m->text, &line, what, 0, VPL_MAX_MAGNITUDE, &v[count++]);
        if (result != VPL_SUCCESS) {
            return result;
        }
    }
    *out = count == 1 ? (vplRgb){v[0], v[0], v[0]} : (vplRgb){v[0], v[1], v[2]};
    return vplText_RequireEnd(&m->text, line);
}

static vplResult readReflectance(Mtl* m, vplWord line, vplWord keyword)
{
    vplRgb kd;
    bool understood;
    vplResult result = readColour(m, line, "a reflectance", &kd, &understood);
    if (result != VPL_SUCCESS || !understood) {
        return result;
    }
    if (kd.r > 1 || kd.g > 1 || kd.b > 1) {
        m->firstBright = m->brightCount++ == 0 ? keyword.start : m->firstBright;
        kd = (vplRgb){kd.r > 1 ? 1 : kd.r, kd.g > 1 ? 1 : kd.g, kd.b > 1 ? 1 : kd.b};
    }
    if (m->current >= 0) {
        m->materials->list[m->current].diffuse = kd;
    }
    return VPL_SUCCESS;
}

static vplResult readEmission(Mtl* m, vplWord line)
{
    vplRgb ke;
    bool understood;
    vplResult result = readColour(m, line, "a radiance", &ke, &understood);
    if (result == VPL_SUCCESS && understood && m->current >= 0) {
        m->materials->list[m->current].emission = ke;
    }
    return result;
}

// Constants of shading models with highlights and transparency, found in nearly every file.
static bool isConstant(vplWord keyword)
{
    static const char* const words[] = {"Ka", "Ks", "Ns", "Ni", "Tf", "Tr", "d", "illum"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        if (vplWord_Is(keyword, words[i])) {
            return true;
        }
    }
    return false;
}

static vplResult readLine(Mtl* m, vplWord line)
{
    vplWord keyword;
    vplNextWord(&line, &keyword);
    if (vplWord_Is(keyword, "newmtl")) {
        return beginMaterial(m, line);
    }
    if (!m->started) {
        return vplText_FailWord(&m->text, keyword, "newmtl");
    }
    if (vplWord_Is(keyword, "Kd")) {
        return readReflectance(m, line, keyword);
    }
    if (vplWord_Is(keyword, "Ke")) {
        return readEmission(m, line);
    }
    if (!isConstant(keyword)) {
        vplText_WarnOnce(&m->text, &m->unknown, keyword);
    }
    return VPL_SUCCESS;
}

static void warn(const Mtl* m)
{
    if (m->brightCount > 0) {
        vplText_WarnAt(&m->text, m->firstBright, "Kd above 1 is taken as 1 (%lld such lines)",
                       m->brightCount);
    }
    if (m->repeatedCount > 0) {
        vplText_WarnAt(&m->text, m->firstRepeated,
                       "this material has a definition already, which stays (%lld such materials)",
                       m->repeatedCount);
    }
}

vplResult vplMtl_Read(vplContext* context, const char* path, vplObjMaterials* materials)
{
    Mtl m = {.materials = materials, .current = -1};
    vplResult result = vplText_Open(context, path, &m.text);
    if (result != VPL_SUCCESS) {
        return result;
    }
    const char* at = NULL;
    vplWord line;
    while (result == VPL_SUCCESS && vplText_NextLine(&m.text, &at, &line)) {
        result = readLine(&m, line);
    }
    if (result == VPL_SUCCESS) {
        warn(&m);
    }
    vplText_Close(&m.text);
    return result;
}
