// SPDX-License-Identifier: MIT
// The first sweep over an OBJ file: counts, so that every array is allocated once and at its size, and materials,
// which may be used before the file that defines them is named.
#include "scene/obj.h"
#include "base/file.h"

#include <string.h>

enum { MOST_MISSING = 8 }; // MTL files told one by one

vplObjStatement vplObj_ReadKeyword(vplWord* line, vplWord* keywordOut)
{
    static const struct {
        const char* word;
        vplObjStatement statement;
    } known[] = {{"v", VPL_OBJ_POINT},    {"f", VPL_OBJ_FACE},          {"vn", VPL_OBJ_NORMAL},
                 {"vt", VPL_OBJ_IGNORED}, {"g", VPL_OBJ_IGNORED},       {"o", VPL_OBJ_IGNORED},
                 {"s", VPL_OBJ_IGNORED},  {"usemtl", VPL_OBJ_MATERIAL}, {"mtllib", VPL_OBJ_LIBRARY}};
    vplNextWord(line, keywordOut);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (vplWord_Is(*keywordOut, known[i].word)) {
            return known[i].statement;
        }
    }
    return VPL_OBJ_UNSUPPORTED;
}

// Corners of a face; whether one of them names a normal.
static vplResult countFace(vplObj* obj, vplWord line, vplWord keyword)
{
    int corners = 0;
    vplWord word;
    while (vplNextWord(&line, &word)) {
        corners++;
        const char* slash = memchr(word.start, '/', (size_t)(word.end - word.start));
        obj->hasNormals = obj->hasNormals ||
                          (slash != NULL && memchr(slash + 1, '/', (size_t)(word.end - slash - 1)) != NULL);
    }
    if (corners < 3 || corners > VPL_MAX_CORNERS) {
        return vplText_FailAt(&obj->text, keyword.start, VPL_PARSE_ERROR,
                              "found a face of %d corners, expected 3 to %d", corners, VPL_MAX_CORNERS);
    }
    obj->triangleCount += corners - 2;
    return VPL_SUCCESS;
}

// Reads one MTL file unless it was read before.
static vplResult readLibrary(vplObj* obj, const char* path)
{
    int number;
    size_t length = strlen(path);
    if (vplNames_Find(&obj->libraries, path, length) >= 0) {
        return VPL_SUCCESS;
    }
    vplResult result = vplNames_Add(&obj->libraries, path, length, &number);
    return result == VPL_SUCCESS ? vplMtl_Read(obj->context, path, &obj->materials) : result;
}

static vplResult warnOfMissing(vplObj* obj, vplWord name, const char* path)
{
    int number;
    size_t length = strlen(path);
    if (vplNames_Find(&obj->libraries, path, length) >= 0) {
        return VPL_SUCCESS;
    }
    if (obj->libraries.index.count < MOST_MISSING) {
        vplText_WarnAt(&obj->text, name.start, "there is no file %s; its materials are grey", path);
    }
    return vplNames_Add(&obj->libraries, path, length, &number);
}

// Reads the MTL file of this name; *foundOut says whether there is one.
static vplResult tryLibrary(vplObj* obj, vplWord name, bool warn, bool* foundOut)
{
    char* path = vplPathBeside(obj->context, obj->text.file, name.start, (size_t)(name.end - name.start));
    if (path == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    *foundOut = vplIsRegularFile(path); // no pipe or device: an mtllib must not make us wait
    vplResult result = *foundOut ? readLibrary(obj, path)
                       : warn    ? warnOfMissing(obj, name, path)
                                 : VPL_SUCCESS;
    vplFree(obj->context, path);
    return result;
}

// One name with blanks in it or several names: what the files in the folder say.
static vplResult readLibraries(vplObj* obj, vplWord line)
{
    vplWord all = vplRestOfLine(line), name;
    if (all.start == all.end) {
        return vplText_FailWord(&obj->text, all, "the name of an MTL file");
    }
    bool found = false, several = memchr(all.start, ' ', (size_t)(all.end - all.start)) != NULL;
    vplResult result = tryLibrary(obj, all, !several, &found);
    while (result == VPL_SUCCESS && several && !found && vplNextWord(&line, &name)) {
        bool ignored;
        result = tryLibrary(obj, name, true, &ignored);
    }
    return result;
}

static vplResult noteMaterial(vplObj* obj, vplWord line)
{
    int number;
    vplWord name = vplRestOfLine(line);
    return name.start == name.end ? vplText_FailWord(&obj->text, name, "the name of a material")
                                  : vplObjMaterials_Get(&obj->materials, name, &number);
}

static vplResult countLine(vplObj* obj, vplWord line)
{
    vplWord keyword;
    switch (vplObj_ReadKeyword(&line, &keyword)) {
    case VPL_OBJ_POINT:
        obj->pointCount++;
        break;
    case VPL_OBJ_NORMAL:
        obj->normalCount++;
        break;
    case VPL_OBJ_FACE:
        return countFace(obj, line, keyword);
    case VPL_OBJ_MATERIAL:
        return noteMaterial(obj, line);
    case VPL_OBJ_LIBRARY:
        return readLibraries(obj, line);
    case VPL_OBJ_IGNORED:
        break;
    case VPL_OBJ_UNSUPPORTED:
        vplText_WarnOnce(&obj->text, &obj->unknown, keyword);
        break;
    }
    return VPL_SUCCESS;
}

vplResult vplObj_Count(vplObj* obj)
{
    const char* at = NULL;
    vplWord line;
    vplResult result = VPL_SUCCESS;
    while (result == VPL_SUCCESS && vplText_NextLine(&obj->text, &at, &line)) {
        result = countLine(obj, line);
    }
    if (result != VPL_SUCCESS) {
        return result;
    }
    if (obj->pointCount > VPL_MAX_TRIANGLES || obj->triangleCount > VPL_MAX_TRIANGLES) {
        return vplFail(obj->context, VPL_LIMIT,
                       "%s: %lld points (v) and %lld triangles, at most %d are allowed", obj->text.file,
                       (long long)obj->pointCount, (long long)obj->triangleCount, VPL_MAX_TRIANGLES);
    }
    return VPL_SUCCESS;
}
