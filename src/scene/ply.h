// SPDX-License-Identifier: MIT
// PLY files: what the header declares, and values of the three formats.
// Based on: Greg Turk, The PLY Polygon File Format, 1994.
#ifndef VPL_SCENE_PLY_H
#define VPL_SCENE_PLY_H

#include "base/arena.h"
#include "scene/obj_text.h"

typedef enum vplPlyType {
    VPL_PLY_INT8,
    VPL_PLY_UINT8,
    VPL_PLY_INT16,
    VPL_PLY_UINT16,
    VPL_PLY_INT32,
    VPL_PLY_UINT32,
    VPL_PLY_FLOAT,
    VPL_PLY_DOUBLE
} vplPlyType;

typedef struct vplPlyProperty {
    vplWord name;
    vplPlyType type; // of a list: of its elements
    bool list;
    vplPlyType countType; // of a list
} vplPlyProperty;

typedef struct vplPlyElement {
    vplWord name;
    int64_t count;
    int first, propertyCount; // in vplPly.properties
    const char* start;        // of the element's data, once that is known
} vplPlyElement;

enum { VPL_PLY_MAX_ELEMENTS = 32, VPL_PLY_MAX_PROPERTIES = 256 };

typedef enum vplPlyFormat { VPL_PLY_ASCII, VPL_PLY_LITTLE, VPL_PLY_BIG } vplPlyFormat;

typedef struct vplPly {
    vplText text; // the whole file, whose data may be binary
    vplPlyFormat format;
    vplPlyElement elements[VPL_PLY_MAX_ELEMENTS];
    vplPlyProperty properties[VPL_PLY_MAX_PROPERTIES];
    int elementCount, propertyCount;
    const char* data; // behind the header
    const char* at;   // where the next value is
} vplPly;

// Reads the header of a file. The first line, which ends as the others do, is "ply".
vplResult vplPly_ReadHeader(vplPly* ply);

// The place of the next value, for messages.
const char* vplPly_Place(vplPly* ply);

// Reads the next value. *out of an integer type is exact; a word for NaN or infinity in a text is read as NaN.
// `what` completes "expected ...".
vplResult vplPly_ReadValue(vplPly* ply, vplPlyType type, const char* what, double* out);

// Reads the number of elements of a list, none of which may be behind the end of the file.
vplResult vplPly_ReadCount(vplPly* ply, const vplPlyProperty* list, int64_t* out);

vplResult vplPly_SkipProperty(vplPly* ply, const vplPlyProperty* property);
vplResult vplPly_SkipElement(vplPly* ply, const vplPlyElement* element);

// Fails unless so many elements can be in the rest of the file.
vplResult vplPly_RequireRoom(const vplPly* ply, const vplPlyElement* element);

// Logs "file:line:column: sentence", in binary data "file: byte 123: sentence". Fail returns VPL_PARSE_ERROR.
vplResult vplPly_Fail(const vplPly* ply, const char* at, const char* format, ...) VPL_PRINTF(3, 4);
void vplPly_WarnTally(const vplPly* ply, const vplTally* tally, const char* sentence, const char* things);

#endif
