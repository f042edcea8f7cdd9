// SPDX-License-Identifier: MIT
// The third sweep over an OBJ file: faces, which are cut into triangles.
#include "scene/obj.h"
#include "scene/obj_number.h"

#include <string.h>

// The state of the sweep.
typedef struct Sweep {
    vplObj* obj;
    vplObjMesh* mesh;
    int64_t points, normals,
        texcoords; // counts of v, vn and vt so far: negative indices count back from them
    int material;
    vplEarClipper polygon;
    vplObjIndices corners[VPL_MAX_CORNERS];
    vplVec3 positions[VPL_MAX_CORNERS];
    vplTally crossing; // faces whose outline crosses itself
} Sweep;

// Reads one index of a corner, up to the next '/'. False if it is no integer.
static bool readInteger(vplWord* word, vplWord* numberOut, int64_t* out)
{
    const char* p = word->start;
    const bool good = vplReadInteger(&p, word->end, out) && (p == word->end || *p == '/');
    while (p < word->end && *p != '/') {
        p++;
    }
    *numberOut = (vplWord){word->start, p};
    word->start = p;
    return good;
}

// The elements that an index may refer to.
typedef struct Range {
    const char* kind;
    int64_t before; // those before the line of the face
    int64_t total;
} Range;

// Reads an index of a corner into a number from 0.
static vplResult readIndex(const Sweep* s, vplWord corner, vplWord* word, Range range, int64_t* out)
{
    int64_t index;
    vplWord number;
    bool good = readInteger(word, &number, &index);
    int64_t place = index > 0 ? index - 1 : range.before + index;
    if (good && index != 0 && place >= 0 && place < range.total) {
        *out = place;
        return VPL_SUCCESS;
    }
    number = number.start == number.end ? corner : number; // "/3" or "3//": there is no index
    if (range.total == 0) {
        return vplText_FailWord(&s->obj->text, number, "no index of a %s: there are none", range.kind);
    }
    return vplText_FailWord(&s->obj->text, number, "an index of a %s: 1 to %lld, or -1 to -%lld", range.kind,
                            (long long)range.total, (long long)range.before);
}

// Reads an index of a texture coordinate. One that refers to none counts as none.
static bool readTexcoord(Sweep* s, vplWord* word, vplWord* number, int64_t* out)
{
    int64_t index = 0;
    const char* start = word->start;
    if (!readInteger(word, number, &index)) {
        return false;
    }
    const int64_t place = index > 0 ? index - 1 : s->texcoords + index;
    if (index != 0 && place >= 0 && place < s->obj->texcoordCount) {
        *out = place;
    } else {
        vplTally_Add(&s->obj->unplaced, start);
    }
    return true;
}

// Reads v, v/vt, v//vn or v/vt/vn.
static vplResult readCorner(Sweep* s, vplWord corner, int i)
{
    const vplObj* obj = s->obj;
    vplWord word = corner, number;
    int64_t point = 0;
    vplObjIndices* to = &s->corners[i];
    *to = (vplObjIndices){0, -1, -1};
    TRY(readIndex(s, corner, &word, (Range){"point (v)", s->points, obj->pointCount}, &point));
    to->point = obj->pointOf[point];
    if (word.start == word.end) {
        return VPL_SUCCESS;
    }
    word.start++;
    bool noTexture = word.start < word.end && *word.start == '/';
    if (!noTexture && !readTexcoord(s, &word, &number, &to->texcoord)) {
        return vplText_FailWord(&obj->text, number.start < number.end ? number : corner,
                                "an index of a texture coordinate (vt)");
    }
    if (word.start == word.end) {
        return VPL_SUCCESS;
    }
    word.start++;
    TRY(readIndex(s, corner, &word, (Range){"normal (vn)", s->normals, obj->normalCount}, &to->normal));
    return word.start < word.end ? vplText_FailWord(&obj->text, word, "the end of the corner") : VPL_SUCCESS;
}

static vplResult addTriangle(Sweep* s, int a, int b, int c)
{
    const vplObjIndices corners[3] = {s->corners[a], s->corners[b], s->corners[c]};
    return vplObjMesh_AddTriangle(s->obj, s->mesh, corners, s->material);
}

static vplResult addPolygon(Sweep* s, int corners, const char* face)
{
    const int64_t emptyBefore = s->mesh->emptyCount;
    for (int i = 0; i < corners; i++) {
        s->positions[i] = s->obj->points[s->corners[i].point];
    }
    vplEarClipper_Triangulate(&s->polygon, s->positions, corners);
    for (int i = 0; i < s->polygon.triangleCount; i++) {
        const int* t = s->polygon.triangles[i];
        TRY(addTriangle(s, t[0], t[1], t[2]));
    }
    const bool hasArea = s->mesh->emptyCount < emptyBefore + s->polygon.triangleCount;
    if (!s->polygon.simple && hasArea) {
        vplTally_Add(&s->crossing, face);
    }
    return VPL_SUCCESS;
}

static vplResult readFace(Sweep* s, vplWord line, const char* face)
{
    int corners = 0;
    vplWord word;
    while (vplNextWord(&line, &word)) { // at most VPL_MAX_CORNERS: the first sweep checked
        TRY(readCorner(s, word, corners++));
    }
    if (corners < 3) {
        return VPL_SUCCESS; // the first sweep warned
    }
    return corners == 3 ? addTriangle(s, 0, 1, 2) : addPolygon(s, corners, face);
}

static vplResult readLine(Sweep* s, vplWord line)
{
    vplWord keyword;
    vplNextWord(&line, &keyword);
    if (vplWord_Is(keyword, "f")) {
        return readFace(s, line, keyword.start);
    }
    if (vplWord_Is(keyword, "usemtl")) {
        const vplWord name = vplRestOfLine(line);
        return name.start == name.end ? VPL_SUCCESS
                                      : vplObjMaterials_Get(&s->obj->materials, name, &s->material);
    }
    if (vplWord_Is(keyword, "s")) {
        s->obj->group = vplObj_ReadGroup(line);
    }
    s->points += vplWord_Is(keyword, "v");
    s->normals += vplWord_Is(keyword, "vn");
    s->texcoords += vplWord_Is(keyword, "vt");
    return VPL_SUCCESS;
}

static vplResult readLines(Sweep* s)
{
    const char* at = NULL;
    vplWord line;
    while (vplText_NextLine(&s->obj->text, &at, &line)) {
        TRY(vplText_Ask(&s->obj->text, line, at));
        TRY(readLine(s, line));
    }
    vplText_WarnTally(&s->obj->text, &s->crossing,
                      "the outline of this face crosses itself; its triangles may overlap", "faces");
    if (s->obj->hasTexcoords) {
        vplText_WarnTally(&s->obj->text, &s->obj->unplaced, "there is no such texture coordinate: 0 is taken",
                          "places");
    }
    return s->obj->smooths ? vplObjMesh_Smooth(s->obj, s->mesh) : VPL_SUCCESS;
}

vplResult vplObj_ReadFaces(vplObj* obj, vplObjMesh* mesh)
{
    if (obj->triangleCount == 0) {
        return vplText_FailAt(&obj->text, obj->text.bytes + obj->text.size,
                              "found the end of the file, expected a face (f)");
    }
    const size_t triangles = (size_t)obj->triangleCount;
    mesh->corners.arena = obj->scratch;
    mesh->indices = vplArena_Alloc(mesh->arena, triangles, 3 * sizeof *mesh->indices);
    mesh->materials = vplArena_Alloc(mesh->arena, triangles, sizeof *mesh->materials);
    TRY(vplArena_Check(mesh->arena));
    if (obj->smooths) {
        mesh->groups = vplArena_Alloc(obj->scratch, triangles, sizeof *mesh->groups);
        TRY(vplArena_Check(obj->scratch));
    }
    if (obj->smooths && obj->hasTexcoords) {
        mesh->waiting = vplArena_Alloc(obj->scratch, triangles, 3 * sizeof *mesh->waiting);
        TRY(vplArena_Check(obj->scratch));
    }
    if (!vplObj_HasCorners(obj)) {
        mesh->vertexOf = vplArena_Alloc(obj->scratch, obj->differentPoints, sizeof *mesh->vertexOf);
        TRY(vplArena_Check(obj->scratch));
        memset(mesh->vertexOf, 0xFF, obj->differentPoints * sizeof *mesh->vertexOf); // VPL_NO_ENTRY
    }
    Sweep* sweep = vplArena_AllocZero(obj->scratch, 1, sizeof *sweep);
    TRY(vplArena_Check(obj->scratch));
    sweep->obj = obj;
    sweep->mesh = mesh;
    sweep->material = -1;
    return readLines(sweep);
}
