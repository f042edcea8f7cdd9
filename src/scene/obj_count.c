// SPDX-License-Identifier: MIT
// The first sweep over an OBJ file: counts, so that each array is allocated once and at its size, and
// materials, because a face may use one before the file that defines it is named.
#include "scene/obj.h"
#include "base/file.h"

#include <string.h>

enum { MOST_MISSING = 8 }; // warnings about missing MTL files

// Counts the triangles of a face and notes whether a corner names a normal.
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
    if (corners > VPL_MAX_CORNERS) {
        return vplText_FailAt(&obj->text, keyword.start, "found a face of %d corners, expected at most %d",
                              corners, VPL_MAX_CORNERS);
    }
    if (corners < 3) {
        vplTally_Add(&obj->thin, keyword.start);
    } else {
        obj->triangleCount += corners - 2;
        obj->smooths = obj->smooths || obj->group != 0;
    }
    return VPL_SUCCESS;
}

// Reads the MTL file of this name, unless it was read before; *foundOut says whether there is one.
static vplResult readLibraryAt(vplObj* obj, const char* path, vplWord name, bool warn, bool* foundOut)
{
    int number;
    const size_t length = strlen(path);
    *foundOut = vplIsRegularFile(obj->text.context, path); // a pipe or device would make us wait
    if ((!*foundOut && !warn) || vplNames_Find(&obj->libraries, path, length) >= 0) {
        return VPL_SUCCESS;
    }
    if (!*foundOut && obj->libraries.index.count < MOST_MISSING) {
        vplText_WarnAt(&obj->text, name.start, "there is no file %s; its materials are grey", path);
    }
    TRY(vplNames_Add(&obj->libraries, path, length, &number));
    return *foundOut ? vplMtl_Read(obj->text.context, path, &obj->materials) : VPL_SUCCESS;
}

static vplResult readLibrary(vplObj* obj, vplWord name, bool warn, bool* foundOut)
{
    char* path =
        vplPathBeside(obj->text.context, obj->text.file, name.start, (size_t)(name.end - name.start));
    if (path == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const vplResult result = readLibraryAt(obj, path, name, warn, foundOut);
    vplFree(obj->text.context, path);
    return result;
}

// Reads the rest of the line as one name, which may have blanks; if there is no such file, as several names.
static vplResult readLibraries(vplObj* obj, vplWord line)
{
    vplWord all = vplRestOfLine(line), name;
    if (all.start == all.end) {
        vplTally_Add(&obj->nameless, all.start);
        return VPL_SUCCESS;
    }
    bool found = false, several = memchr(all.start, ' ', (size_t)(all.end - all.start)) != NULL;
    TRY(readLibrary(obj, all, !several, &found));
    while (several && !found && vplNextWord(&line, &name)) {
        bool ignored;
        TRY(readLibrary(obj, name, true, &ignored));
    }
    return VPL_SUCCESS;
}

static vplResult noteMaterial(vplObj* obj, vplWord line)
{
    int number;
    vplWord name = vplRestOfLine(line);
    if (name.start == name.end) {
        vplTally_Add(&obj->nameless, name.start);
        return VPL_SUCCESS;
    }
    return vplObjMaterials_Get(&obj->materials, name, &number);
}

static vplResult countLine(vplObj* obj, vplWord line)
{
    static const char* const ignored[] = {"g", "o", NULL}; // irrelevant to a mesh
    vplWord keyword;
    vplNextWord(&line, &keyword);
    if (vplWord_Is(keyword, "v")) {
        obj->pointCount++;
    } else if (vplWord_Is(keyword, "f")) {
        return countFace(obj, line, keyword);
    } else if (vplWord_Is(keyword, "vn")) {
        obj->normalCount++;
    } else if (vplWord_Is(keyword, "vt")) {
        obj->texcoordCount++;
    } else if (vplWord_Is(keyword, "usemtl")) {
        return noteMaterial(obj, line);
    } else if (vplWord_Is(keyword, "s")) {
        obj->group = vplObj_ReadGroup(line);
    } else if (vplWord_Is(keyword, "mtllib")) {
        return readLibraries(obj, line);
    } else if (!vplWord_IsAmong(keyword, ignored)) {
        vplText_WarnOnce(&obj->text, &obj->unknown, keyword);
    }
    return VPL_SUCCESS;
}

vplResult vplObj_Count(vplObj* obj)
{
    const char* at = NULL;
    vplWord line;
    while (vplText_NextLine(&obj->text, &at, &line)) {
        TRY(vplText_Ask(&obj->text, line, at));
        TRY(countLine(obj, line));
    }
    vplText_WarnTally(&obj->text, &obj->thin, "a face of fewer than three corners is left out", "faces");
    vplText_WarnTally(&obj->text, &obj->nameless, "the name is missing: this line has no effect", "lines");
    obj->smooths = obj->smooths && !obj->hasNormals;
    obj->hasNormals = obj->hasNormals || obj->smooths;
    obj->group = 0;
    for (uint32_t i = 0; obj->texcoordCount > 0 && i < obj->materials.names.index.count; i++) {
        obj->hasTexcoords = obj->hasTexcoords || vplObj_HasPicture(obj, (int)i);
    }
    if (obj->pointCount > VPL_MAX_TRIANGLES || obj->triangleCount > VPL_MAX_TRIANGLES) {
        return vplFail(obj->text.context, VPL_LIMIT,
                       "%s: %lld points (v) and %lld triangles, at most %d are allowed", obj->text.file,
                       (long long)obj->pointCount, (long long)obj->triangleCount, VPL_MAX_TRIANGLES);
    }
    return VPL_SUCCESS;
}
