// SPDX-License-Identifier: MIT
// Statements of MTL files that name pictures: their options and the file, which may lie elsewhere than they say.
#include "scene/mtl_maps.h"

#include "base/file.h"
#include "scene/obj_number.h"

#include <string.h>

// Cuts the next word off if it is a number; else *out stays what it is.
static bool nextNumber(vplWord* line, float* out)
{
    vplWord ahead = *line, word;
    float number;
    if (!vplNextWord(&ahead, &word) || !vplReadNumber(word.start, word.end, &number) ||
        !(number >= -VPL_MAX_MAGNITUDE && number <= VPL_MAX_MAGNITUDE)) {
        return false;
    }
    *out = number;
    *line = ahead;
    return true;
}

// Reads one to three numbers, of which the first two count.
static void readPair(vplWord* line, float pair[2])
{
    float third;
    if (nextNumber(line, &pair[0]) && nextNumber(line, &pair[1])) {
        nextNumber(line, &third);
    }
}

// Cuts the options off; the rest of the line names the file.
static void readOptions(vplWord* line, vplObjMap* map)
{
    static const char* const words[] = {"-blendu", "-blendv", "-cc", "-clamp", "-imfchan", "-type", NULL};
    static const char* const numbers[] = {"-bm", "-boost", "-mm", "-t", "-texres", NULL};
    vplWord ahead = *line, option, value;
    while (vplNextWord(&ahead, &option)) {
        float ignored[2];
        if (vplWord_Is(option, "-s")) {
            readPair(&ahead, map->scale);
        } else if (vplWord_Is(option, "-o")) {
            readPair(&ahead, map->offset);
        } else if (vplWord_IsAmong(option, words)) {
            vplNextWord(&ahead, &value);
            map->clamp = vplWord_Is(option, "-clamp") ? vplWord_Is(value, "on") : map->clamp;
        } else if (vplWord_IsAmong(option, numbers)) {
            readPair(&ahead, ignored);
        } else {
            break;
        }
        *line = ahead;
    }
}

// Tests a name, with '/' for each '\', relative to the MTL file. *pathOut is a copy in the arena, or NULL where there is
// no such file.
static vplResult find(vplArena* arena, const vplText* text, const char* name, size_t length, bool must,
                      char** pathOut)
{
    char* path = vplPathBeside(text->context, text->file, name, length);
    if (path == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const bool there = must || vplIsRegularFile(text->context, path);
    *pathOut = there ? vplArena_CopyString(arena, path) : NULL;
    vplFree(text->context, path);
    return there && *pathOut == NULL ? VPL_OUT_OF_MEMORY : VPL_SUCCESS;
}

// Looks for the file where the line says, then beside the MTL file: paths of other people's disks are common.
static vplResult findFile(vplArena* arena, const vplText* text, vplWord word, char** pathOut)
{
    const size_t length = (size_t)(word.end - word.start);
    char* name = vplArena_Alloc(arena, length + 1, 1);
    if (name == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    memcpy(name, word.start, length);
    name[length] = 0;
    for (size_t i = 0; i < length; i++) {
        if (name[i] == '\\') {
            name[i] = '/';
        }
    }
    const char* base = vplBaseName(name);
    TRY(find(arena, text, name, length, false, pathOut));
    if (*pathOut == NULL && base != name) {
        TRY(find(arena, text, base, strlen(base), false, pathOut));
    }
    return *pathOut == NULL ? find(arena, text, name, length, true, pathOut) : VPL_SUCCESS;
}

vplResult vplMtl_ReadMap(vplArena* arena, const vplText* text, vplWord line, vplObjMap* map)
{
    vplObjMap read = {.scale = {1, 1}};
    readOptions(&line, &read);
    const vplWord name = vplRestOfLine(line);
    if (name.start == name.end) {
        return VPL_SUCCESS; // as without the line
    }
    char where[512];
    vplText_Locate(text, name.start, where, sizeof where);
    read.where = vplArena_CopyString(arena, where);
    TRY(findFile(arena, text, name, &read.path));
    *map = read;
    return vplArena_Check(arena);
}
