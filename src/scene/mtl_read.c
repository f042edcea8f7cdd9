// SPDX-License-Identifier: MIT
// Reads MTL files: Kd and map_Kd are the reflectance, Ke the emission, d and map_d the opacity. libvpl's surfaces have
// no other property.
#include "math/scalar.h"
#include "scene/obj.h"
#include "scene/obj_number.h"

typedef struct Mtl {
    vplText text;
    vplObjMaterials* materials;
    int current;       // material being defined; -1: none yet, or defined before
    bool started;      // a newmtl was read
    vplTally bright;   // Kd above 1
    vplTally repeated; // newmtl with a name that has a definition already
    vplTally early;    // statements before the first newmtl
    vplTally nameless; // newmtl without a name
    vplTally unread;   // colours that are no colours
    vplTally opaque;   // d that is no opacity
    vplUnknownWords unknown;
} Mtl;

vplResult vplObjMaterials_Get(vplObjMaterials* materials, vplWord name, int* out)
{
    const size_t length = (size_t)(name.end - name.start);
    const size_t count = materials->names.index.count;
    *out = vplNames_Find(&materials->names, name.start, length);
    if (*out < 0) {
        TRY(vplArena_Reserve(materials->names.index.arena, &materials->list, &materials->capacity, count + 1,
                             sizeof *materials->list));
        TRY(vplNames_Add(&materials->names, name.start, length, out));
        const vplMaterialDef grey = vplDefaultMaterialDef();
        materials->list[*out] = (vplObjMaterial){
            .diffuse = grey.diffuse, .emission = grey.emission, .opacity = 1, .sceneIndex = -1};
    }
    return VPL_SUCCESS;
}

static vplResult beginMaterial(Mtl* m, vplWord line)
{
    const vplWord name = vplRestOfLine(line);
    int number;
    m->started = true;
    m->current = -1;
    if (name.start == name.end) {
        vplTally_Add(&m->nameless, name.start);
        return VPL_SUCCESS;
    }
    TRY(vplObjMaterials_Get(m->materials, name, &number));
    m->current = number;
    if (m->materials->list[number].defined) {
        m->current = -1;
        vplTally_Add(&m->repeated, name.start);
    }
    m->materials->list[number].defined = true;
    return VPL_SUCCESS;
}

// Reads one number for all channels, or three. False if there is none, or one is out of range.
static bool readNumbers(vplWord line, vplRgb* out)
{
    vplWord word;
    float v[3];
    int count = 0;
    while (count < 3 && vplNextWord(&line, &word)) {
        if (!vplReadNumber(word.start, word.end, &v[count]) ||
            !(v[count] >= 0 && v[count] <= VPL_MAX_MAGNITUDE)) {
            return false;
        }
        count++;
    }
    *out = count == 1 ? (vplRgb){v[0], v[0], v[0]} : (vplRgb){v[0], v[1], v[2]};
    return count == 1 || count == 3;
}

// Reads Kd or Ke. A colour that is no RGB colour has no effect.
static void readColour(Mtl* m, vplWord line, vplWord keyword)
{
    const bool reflectance = vplWord_Is(keyword, "Kd");
    vplWord ahead = line, word;
    vplRgb colour;
    vplNextWord(&ahead, &word);
    if (vplWord_Is(word, "spectral") || vplWord_Is(word, "xyz")) {
        vplText_WarnOnce(&m->text, &m->unknown, word);
        return;
    }
    if (!readNumbers(line, &colour)) {
        vplTally_Add(&m->unread, keyword.start);
        return;
    }
    if (reflectance && (colour.r > 1 || colour.g > 1 || colour.b > 1)) {
        vplTally_Add(&m->bright, keyword.start);
        colour = (vplRgb){vplMinf(colour.r, 1), vplMinf(colour.g, 1), vplMinf(colour.b, 1)};
    }
    if (m->current >= 0) {
        vplObjMaterial* material = &m->materials->list[m->current];
        *(reflectance ? &material->diffuse : &material->emission) = colour;
    }
}

// Reads d, which "-halo" may precede. Numbers out of range have no effect.
static void readOpacity(Mtl* m, vplWord line)
{
    vplWord word;
    float d;
    vplNextWord(&line, &word);
    if (vplWord_Is(word, "-halo")) {
        vplNextWord(&line, &word);
    }
    if (!vplReadNumber(word.start, word.end, &d) || !(d >= 0 && d <= 1)) {
        vplTally_Add(&m->opaque, word.start);
    } else if (m->current >= 0) {
        m->materials->list[m->current].opacity = d;
    }
}

static vplResult readMap(Mtl* m, vplWord line, bool colour)
{
    if (m->current < 0) {
        return VPL_SUCCESS;
    }
    vplObjMaterial* material = &m->materials->list[m->current];
    return vplMtl_ReadMap(m->materials->names.index.arena, &m->text, line,
                          colour ? &material->colourMap : &material->opacityMap);
}

static vplResult readLine(Mtl* m, vplWord line)
{
    // Constants of shading models with highlights and refraction, which nearly every file has.
    static const char* const ignored[] = {"Ka", "Ks", "Ns", "Ni", "Tf", "Tr", "illum", NULL};
    vplWord keyword;
    vplNextWord(&line, &keyword);
    if (vplWord_Is(keyword, "newmtl")) {
        return beginMaterial(m, line);
    }
    if (!m->started) {
        vplTally_Add(&m->early, keyword.start);
    } else if (vplWord_Is(keyword, "Kd") || vplWord_Is(keyword, "Ke")) {
        readColour(m, line, keyword);
    } else if (vplWord_Is(keyword, "map_Kd") || vplWord_Is(keyword, "map_d")) {
        return readMap(m, line, vplWord_Is(keyword, "map_Kd"));
    } else if (vplWord_Is(keyword, "d")) {
        readOpacity(m, line);
    } else if (!vplWord_IsAmong(keyword, ignored)) {
        vplText_WarnOnce(&m->text, &m->unknown, keyword);
    }
    return VPL_SUCCESS;
}

static vplResult readLines(Mtl* m)
{
    const char* at = NULL;
    vplWord line;
    while (vplText_NextLine(&m->text, &at, &line)) {
        TRY(readLine(m, line));
    }
    vplText_WarnTally(&m->text, &m->bright, "Kd above 1 is taken as 1", "lines");
    vplText_WarnTally(&m->text, &m->repeated, "this material has a definition already, which stays",
                      "materials");
    vplText_WarnTally(&m->text, &m->early, "this line has no effect: it belongs to no material (newmtl)",
                      "lines");
    vplText_WarnTally(&m->text, &m->nameless, "this material has no name and is left out", "materials");
    vplText_WarnTally(&m->text, &m->unread,
                      "this line has no effect: it has neither one nor three numbers in [0, 1e+15]", "lines");
    vplText_WarnTally(&m->text, &m->opaque, "this opacity has no effect: it is no number in [0, 1]", "lines");
    return VPL_SUCCESS;
}

vplResult vplMtl_Read(vplContext* context, const char* path, vplObjMaterials* materials)
{
    Mtl m = {.materials = materials, .current = -1};
    TRY(vplText_Open(context, path, &m.text));
    const vplResult result = readLines(&m);
    vplText_Close(&m.text);
    return result;
}
