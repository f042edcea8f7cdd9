// SPDX-License-Identifier: MIT
// Typed reading of a JSON tree with errors that name file, line, column and path.
#ifndef VPL_SCENE_JSON_READER_H
#define VPL_SCENE_JSON_READER_H

#include "base/context.h"
#include "scene/json_locate.h"

#include <jansson.h>

typedef struct vplJsonReader {
    vplContext* context;
    const char* file;
    char* text;
    size_t size;
    json_t* root;
} vplJsonReader;

// Reads and parses a file; duplicate keys, trailing text and numbers beyond double are errors.
vplResult vplJsonReader_Open(vplContext* context, const char* file, vplJsonReader* readerOut);
void vplJsonReader_Close(vplJsonReader* reader);

// "file:line:column: path message"; returns VPL_PARSE_ERROR. `path` NULL means the whole file.
vplResult vplJsonReader_Fail(const vplJsonReader* reader, const vplJsonPath* path, const char* format, ...)
    VPL_PRINTF(3, 4);

// The object must have the keys marked "!" and no others than those listed (NULL ends the list).
vplResult vplJsonReader_CheckKeys(const vplJsonReader* reader, const json_t* object, const vplJsonPath* path,
                                  const char* const* keys);

// Each reads member `key` of an object. A missing member leaves *out untouched. `count` numbers fill v.
vplResult vplJsonReader_Number(const vplJsonReader* reader, const json_t* object, const vplJsonPath* path,
                               const char* key, double* out);
vplResult vplJsonReader_Floats(const vplJsonReader* reader, const json_t* object, const vplJsonPath* path,
                               const char* key, int count, float* out);
vplResult vplJsonReader_Doubles(const vplJsonReader* reader, const json_t* object, const vplJsonPath* path,
                                const char* key, int count, double* out);
vplResult vplJsonReader_String(const vplJsonReader* reader, const json_t* object, const vplJsonPath* path,
                               const char* key, const char** out);

// The value must be an object or array; says what it is instead.
vplResult vplJsonReader_RequireObject(const vplJsonReader* reader, const json_t* value,
                                      const vplJsonPath* path);
vplResult vplJsonReader_RequireArray(const vplJsonReader* reader, const json_t* value,
                                     const vplJsonPath* path);

#endif
