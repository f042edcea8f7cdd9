// SPDX-License-Identifier: MIT
// Where in a JSON text a value stands. jansson gives positions for syntax errors only.
#ifndef VPL_SCENE_JSON_LOCATE_H
#define VPL_SCENE_JSON_LOCATE_H

#include <stddef.h>

// A way through nested objects and arrays, innermost step first, linked on the caller's stack.
typedef struct vplJsonPath {
    const struct vplJsonPath* parent; // NULL at the root
    const char* key;                  // step into this member, or
    int index;                        // if key is NULL, into this element
} vplJsonPath;

// Line and column (from 1) of the value at `path` in a syntactically valid text; of its key if `atKey`.
// A path that leads nowhere gives the innermost value that exists.
void vplJson_Locate(const char* text, size_t size, const vplJsonPath* path, int atKey, int* line,
                    int* column);

// Line and column of a byte of any text.
void vplJson_CountLines(const char* text, size_t offset, int* line, int* column);

// Writes the path as "objects[2].scale" into buffer.
void vplJson_FormatPath(const vplJsonPath* path, char* buffer, size_t size);

#endif
