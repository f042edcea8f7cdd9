// SPDX-License-Identifier: MIT
// Typed reading of a JSON file, with errors that name file, line, column and path.
#ifndef VPL_SCENE_JSON_READER_H
#define VPL_SCENE_JSON_READER_H

#include "base/context.h"
#include "scene/json_locate.h"

#include <jansson.h>

typedef struct vplJsonFile {
    vplContext* context;
    const char* name;
    const char* subject; // of sentences about the root; NULL: "the scene"
    char* text;
    size_t size;
    json_t* root;
    double origin[3]; // vplJson_ReadPosition subtracts it; 0 when the file is opened
} vplJsonFile;

// A value of a file and the way to it, linked on the caller's stack.
typedef struct vplJson {
    const vplJsonFile* file;
    json_t* value; // NULL: there is none
    vplJsonPath path;
} vplJson;

// Reads and parses a file. Duplicate keys, trailing text, NUL bytes and numbers beyond double are errors.
vplResult vplJsonFile_Open(vplContext* context, const char* name, vplJsonFile* fileOut);

// The same with a text in memory of the context, which becomes the file's, or is freed on failure.
vplResult vplJsonFile_FromText(vplContext* context, const char* name, char* text, size_t size,
                               vplJsonFile* fileOut);
void vplJsonFile_Close(vplJsonFile* file);

vplJson vplJson_Root(const vplJsonFile* file);

// A member of an object or an element of an array; `parent` must live at least as long. value is NULL if
// there is none.
vplJson vplJson_Member(const vplJson* parent, const char* key);
vplJson vplJson_Element(const vplJson* parent, int index);

// Logs "file:line:column: path message" and returns VPL_PARSE_ERROR.
vplResult vplJson_Fail(const vplJson* at, const char* format, ...) VPL_PRINTF(2, 3);

// Writes "file:line:column" of the value.
void vplJson_FormatPlace(const vplJson* at, char* out, size_t size);

// Fails unless the value has this type.
vplResult vplJson_RequireObject(const vplJson* at);
vplResult vplJson_RequireArray(const vplJson* at);

// Fails unless the value is an object that has all the keys marked "!" and no others than those listed. NULL
// ends the list.
vplResult vplJson_CheckKeys(const vplJson* object, const char* const* keys);

// Each reads the member `key` of an object. A missing member leaves *out as it is. Arrays must have `count`
// numbers. ReadFloats reads at most 16 of them, into an array of float, a vplVec3 or a vplRgb.
vplResult vplJson_ReadNumber(const vplJson* object, const char* key, double* out);
vplResult vplJson_ReadDoubles(const vplJson* object, const char* key, int count, double* out);
vplResult vplJson_ReadFloats(const vplJson* object, const char* key, int count, void* out);

// Reads a vplVec3 and subtracts the file's origin in double.
vplResult vplJson_ReadPosition(const vplJson* object, const char* key, void* out);
vplResult vplJson_ReadString(const vplJson* object, const char* key, const char** out);

#endif
