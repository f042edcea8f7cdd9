// SPDX-License-Identifier: MIT
// Finds the line and column of a value in a JSON text. jansson gives positions for syntax errors only.
#ifndef VPL_SCENE_JSON_LOCATE_H
#define VPL_SCENE_JSON_LOCATE_H

#include <stdbool.h>
#include <stddef.h>

// The way to a value through nested objects and arrays, innermost step first, linked on the caller's stack.
typedef struct vplJsonPath {
    const struct vplJsonPath* parent; // NULL at the root
    const char* key;                  // name of a member, or
    int index;                        // if key is NULL, index of an element
} vplJsonPath;

// A place in a text, both numbers from 1.
typedef struct vplJsonPlace {
    int line, column;
} vplJsonPlace;

// The place of the value at `path` in a syntactically valid text, or of its key. If the path leads nowhere,
// the place of the innermost value that exists.
vplJsonPlace vplJson_Locate(const char* text, size_t size, const vplJsonPath* path, bool atKey);

// The place of a byte in any text.
vplJsonPlace vplJson_PlaceOf(const char* text, size_t offset);

// Writes the path as "objects[2].scale" into buffer.
void vplJson_FormatPath(const vplJsonPath* path, char* buffer, size_t size);

#endif
