// SPDX-License-Identifier: MIT
// The second sweep over an OBJ file: points and normals. Points of the same coordinates become one.
#include "scene/obj.h"
#include "math/vec.h"

#include <float.h>
#include <string.h>

enum { MOST_NUMBERS = 7 }; // x y z and a weight, or x y z r g b, or both

static vplResult readThree(const vplObj* obj, vplWord* line, const char* what, float limit, vplVec3* out)
{
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < 3 && result == VPL_SUCCESS; i++) {
        result = vplText_Number(&obj->text, line, what, -limit, limit, &out->x + i);
    }
    return result;
}

// Weights and colours behind the coordinates are checked and forgotten.
static vplResult skipExtras(vplObj* obj, vplWord line)
{
    vplResult result = VPL_SUCCESS;
    vplWord ahead = line, word;
    for (int i = 3; i < MOST_NUMBERS && result == VPL_SUCCESS && vplNextWord(&ahead, &word); i++) {
        float ignored;
        result = vplText_Number(&obj->text, &line, "a number", -FLT_MAX, FLT_MAX, &ignored);
    }
    return result == VPL_SUCCESS ? vplText_RequireEnd(&obj->text, line) : result;
}

// The number of a point among the different ones.
static vplResult weld(vplObj* obj, vplHashIndex* index, vplVec3 p, uint32_t* out)
{
    uint32_t words[3];
    memcpy(words, &p, sizeof words);
    uint32_t hash = vplHashKey(words, 3);
    uint32_t i = vplHashIndex_First(index, hash);
    while (i != VPL_NO_ENTRY && memcmp(&obj->points[i], &p, sizeof p) != 0) {
        i = vplHashIndex_Next(index, i);
    }
    if (i == VPL_NO_ENTRY) {
        i = index->count;
        obj->points[i] = p;
        vplResult result = vplHashIndex_Add(index, hash);
        if (result != VPL_SUCCESS) {
            return result;
        }
    }
    *out = i;
    return VPL_SUCCESS;
}

static vplResult readAll(vplObj* obj, vplHashIndex* index)
{
    const char* at = NULL;
    vplWord line, keyword;
    vplVec3 v = {0, 0, 0};
    vplResult result = VPL_SUCCESS;
    size_t point = 0, normal = 0;
    while (result == VPL_SUCCESS && vplText_NextLine(&obj->text, &at, &line)) {
        if (line.start[0] != 'v') { // most lines of most files are faces
            continue;
        }
        vplObjStatement statement = vplObj_ReadKeyword(&line, &keyword);
        if (statement == VPL_OBJ_POINT) {
            result = readThree(obj, &line, "a coordinate", VPL_MAX_MAGNITUDE, &v);
            result = result == VPL_SUCCESS ? skipExtras(obj, line) : result;
            result = result == VPL_SUCCESS ? weld(obj, index, v, &obj->pointOf[point++]) : result;
        } else if (statement == VPL_OBJ_NORMAL) {
            result = readThree(obj, &line, "a normal's component", 3.4e38f, &v);
            result = result == VPL_SUCCESS ? vplText_RequireEnd(&obj->text, line) : result;
            obj->normals[normal++] = vplNormalize(v);
        }
    }
    obj->differentPoints = index->count;
    return result;
}

vplResult vplObj_ReadPoints(vplObj* obj)
{
    vplContext* context = obj->context;
    vplHashIndex index = {.context = context};
    obj->points = vplAlloc(context, (size_t)obj->pointCount, sizeof *obj->points);
    obj->pointOf = vplAlloc(context, (size_t)obj->pointCount, sizeof *obj->pointOf);
    obj->normals = vplAlloc(context, (size_t)obj->normalCount, sizeof *obj->normals);
    vplResult result = VPL_OUT_OF_MEMORY;
    if (obj->points && obj->pointOf && obj->normals) {
        result = vplHashIndex_Reserve(&index, (size_t)obj->pointCount);
    }
    if (result == VPL_SUCCESS) {
        result = readAll(obj, &index);
    }
    vplHashIndex_Close(&index);
    return result;
}
