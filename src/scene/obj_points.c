// SPDX-License-Identifier: MIT
// The second sweep over an OBJ file: points, normals and texture coordinates. Points with equal coordinates are merged.
#include "scene/obj.h"
#include "math/vec.h"
#include "scene/obj_number.h"

#include <float.h>
#include <string.h>

enum { MOST_NUMBERS = 7 }; // x y z and a weight, or x y z r g b, or both

static vplResult readThree(const vplObj* obj, vplWord* line, const char* what, float limit, vplVec3* out)
{
    float v[3];
    for (int i = 0; i < 3; i++) {
        TRY(vplText_Number(&obj->text, line, what, -limit, limit, &v[i]));
    }
    *out = vplVec(v[0], v[1], v[2]);
    return VPL_SUCCESS;
}

// Checks and ignores weights and colours behind the coordinates.
static vplResult skipExtras(const vplObj* obj, vplWord line)
{
    vplWord ahead = line, word;
    for (int i = 3; i < MOST_NUMBERS && vplNextWord(&ahead, &word); i++) {
        float ignored;
        TRY(vplText_Number(&obj->text, &line, "a number", -FLT_MAX, FLT_MAX, &ignored));
    }
    return vplText_RequireEnd(&obj->text, line);
}

// Finds or adds a point; *out is its number.
static vplResult weld(vplObj* obj, vplHashIndex* index, vplVec3 p, uint32_t* out)
{
    uint32_t words[3];
    memcpy(words, &p, sizeof words);
    uint32_t hash = vplHashKey(words, 3);
    uint32_t i = vplHashIndex_First(index, hash);
    while (i != VPL_NO_ENTRY && memcmp(&obj->points[i], &p, sizeof p) != 0) {
        i = vplHashIndex_Next(index, i);
    }
    *out = i == VPL_NO_ENTRY ? index->count : i;
    obj->points[*out] = p;
    return i == VPL_NO_ENTRY ? vplHashIndex_Add(index, hash) : VPL_SUCCESS;
}

// Reads u and v, and leaves 0 where there is no number: surfaces matter more than what is on them.
static void readTexcoord(vplObj* obj, vplWord line, vplTexcoord* out)
{
    float* const parts[2] = {&out->u, &out->v};
    *out = (vplTexcoord){0, 0};
    for (int i = 0; i < 2; i++) {
        vplWord word;
        float x;
        const bool any = vplNextWord(&line, &word);
        if (any && vplReadNumber(word.start, word.end, &x) && x >= -VPL_MAX_MAGNITUDE &&
            x <= VPL_MAX_MAGNITUDE) {
            *parts[i] = x;
        } else if (any || i == 0) { // v may be left out
            vplTally_Add(&obj->unplaced, any ? word.start : line.start);
        }
    }
}

static vplResult readLines(vplObj* obj, vplHashIndex* index)
{
    const char* at = NULL;
    vplWord line, keyword;
    vplVec3 v;
    size_t point = 0, normal = 0, texcoord = 0;
    while (vplText_NextLine(&obj->text, &at, &line)) {
        TRY(vplText_Ask(&obj->text, line, at));
        if (line.start[0] != 'v') { // most lines of most files are faces
            continue;
        }
        vplNextWord(&line, &keyword);
        if (vplWord_Is(keyword, "v")) {
            TRY(readThree(obj, &line, "a coordinate", VPL_MAX_MAGNITUDE, &v));
            TRY(skipExtras(obj, line));
            TRY(weld(obj, index, v, &obj->pointOf[point++]));
        } else if (vplWord_Is(keyword, "vn")) {
            TRY(readThree(obj, &line, "a normal's component", 3.4e38f, &v));
            TRY(vplText_RequireEnd(&obj->text, line));
            obj->normals[normal++] = vplNormalize(v);
        } else if (obj->hasTexcoords && vplWord_Is(keyword, "vt")) {
            readTexcoord(obj, line, &obj->texcoords[texcoord++]);
        }
    }
    obj->differentPoints = index->count;
    return VPL_SUCCESS;
}

vplResult vplObj_ReadPoints(vplObj* obj)
{
    vplHashIndex index = {.arena = obj->scratch};
    obj->points = vplArena_Alloc(obj->scratch, (size_t)obj->pointCount, sizeof *obj->points);
    obj->pointOf = vplArena_Alloc(obj->scratch, (size_t)obj->pointCount, sizeof *obj->pointOf);
    obj->normals = vplArena_Alloc(obj->scratch, (size_t)obj->normalCount, sizeof *obj->normals);
    if (obj->hasTexcoords) {
        obj->texcoords = vplArena_Alloc(obj->scratch, (size_t)obj->texcoordCount, sizeof *obj->texcoords);
    }
    TRY(vplArena_Check(obj->scratch));
    TRY(vplHashIndex_Reserve(&index, (size_t)obj->pointCount));
    TRY(readLines(obj, &index));
    vplHashIndex_Close(&index); // the largest part of the scratch memory
    return VPL_SUCCESS;
}
