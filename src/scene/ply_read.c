// SPDX-License-Identifier: MIT
// Reads a PLY file as one mesh: elements "vertex", "face" and "tristrips"; all others are left out.
#include "base/file_kind.h"
#include "scene/ear_clipping.h"
#include "scene/model.h"
#include "scene/ply.h"

#include <vpl/imagetools.h>

#include <math.h>
#include <string.h>

// What a property of a vertex stands for.
enum { X, Y, Z, NX, NY, NZ, RED, GREEN, BLUE, SLOTS };

typedef struct Reader {
    vplPly ply;
    vplContext* context;
    vplArena* scratch;
    vplRawMesh raw;
    int slotOf[VPL_PLY_MAX_PROPERTIES]; // of the properties of a vertex; -1: none
    int material;                       // of the scene
    float linear[256];                  // of 8-bit codes
    vplEarClipper* polygon;
    int64_t* corners; // of the list that is being read
    size_t cornerCapacity;
    vplTally thin, crossing;
} Reader;

static bool isNamed(const vplPlyElement* element, const char* name)
{
    return vplWord_Is(element->name, name);
}

// ---- vertices

static int slotOf(const vplPlyProperty* p)
{
    static const char* const names[][2] = {[X] = {"x", "x"},
                                           [Y] = {"y", "y"},
                                           [Z] = {"z", "z"},
                                           [NX] = {"nx", "nx"},
                                           [NY] = {"ny", "ny"},
                                           [NZ] = {"nz", "nz"},
                                           [RED] = {"red", "diffuse_red"},
                                           [GREEN] = {"green", "diffuse_green"},
                                           [BLUE] = {"blue", "diffuse_blue"}};
    for (int i = 0; i < SLOTS && !p->list; i++) {
        if (vplWord_Is(p->name, names[i][0]) || vplWord_Is(p->name, names[i][1])) {
            return i;
        }
    }
    return -1;
}

// Finds the slots of an element's properties; *presentOut has a bit for each slot.
static void findSlots(Reader* r, const vplPlyElement* e, unsigned* presentOut)
{
    *presentOut = 0;
    for (int i = 0; i < e->propertyCount; i++) {
        const int slot = slotOf(&r->ply.properties[e->first + i]);
        const bool first = slot >= 0 && (*presentOut >> slot & 1) == 0;
        r->slotOf[i] = first ? slot : -1;
        *presentOut |= first ? 1u << slot : 0;
    }
}

static bool hasAll(unsigned present, int first)
{
    return (present >> first & 7) == 7;
}

// The reflectance of a channel: integers are sRGB codes, real numbers are linear.
static float decodeColour(const Reader* r, vplPlyType type, double value)
{
    if (type >= VPL_PLY_FLOAT) {
        return value > 0 ? (float)fmin(value, 1) : 0; // NaN is black
    }
    if (type == VPL_PLY_UINT16) {
        return vplSrgb_Decode((float)(value / 65535));
    }
    return r->linear[value < 0 ? 0 : value > 255 ? 255 : (int)value];
}

static vplResult readVertex(Reader* r, const vplPlyElement* e, size_t index)
{
    double values[SLOTS] = {0};
    float colour[3] = {0};
    for (int i = 0; i < e->propertyCount; i++) {
        const vplPlyProperty* p = &r->ply.properties[e->first + i];
        const int slot = r->slotOf[i];
        const char* at = vplPly_Place(&r->ply);
        if (slot < 0) {
            TRY(vplPly_SkipProperty(&r->ply, p));
            continue;
        }
        TRY(vplPly_ReadValue(&r->ply, p->type, slot <= Z ? "a coordinate" : "a number", &values[slot]));
        if (slot <= Z && !(fabs(values[slot]) <= VPL_MAX_MAGNITUDE_DOUBLE)) {
            return vplPly_Fail(&r->ply, at, "found %g in vertex %zu, expected a coordinate in [%g, %g]",
                               values[slot], index, -VPL_MAX_MAGNITUDE_DOUBLE, VPL_MAX_MAGNITUDE_DOUBLE);
        }
        if (slot >= RED) {
            colour[slot - RED] = decodeColour(r, p->type, values[slot]);
        }
    }
    r->raw.positions[index] = (vplVec3){(float)values[X], (float)values[Y], (float)values[Z]};
    if (r->raw.normals != NULL) {
        r->raw.normals[index] = (vplVec3){(float)values[NX], (float)values[NY], (float)values[NZ]};
    }
    if (r->raw.colors != NULL) {
        r->raw.colors[index] = (vplRgb){colour[0], colour[1], colour[2]};
    }
    return VPL_SUCCESS;
}

static vplResult readVertices(Reader* r, const vplPlyElement* e)
{
    unsigned present;
    findSlots(r, e, &present);
    if (!hasAll(present, X)) {
        return vplPly_Fail(&r->ply, e->name.start,
                           "found no properties x, y and z, expected them of a vertex");
    }
    TRY(vplPly_RequireRoom(&r->ply, e));
    if (e->count > VPL_MAX_TRIANGLES) {
        return vplFail(r->context, VPL_LIMIT, "%s: %lld vertices, at most %d are allowed", r->raw.file,
                       (long long)e->count, VPL_MAX_TRIANGLES);
    }
    const size_t count = r->raw.vertexCount = (size_t)e->count;
    r->raw.positions = vplArena_Alloc(r->raw.arena, count, sizeof *r->raw.positions);
    if (hasAll(present, NX)) {
        r->raw.normals = vplArena_Alloc(r->raw.arena, count, sizeof *r->raw.normals);
    }
    if (hasAll(present, RED)) {
        r->raw.colors = vplArena_Alloc(r->raw.arena, count, sizeof *r->raw.colors);
    }
    TRY(vplArena_Check(r->raw.arena));
    for (size_t i = 0; i < count; i++) {
        TRY(i % 65536 == 65535 ? vplAsk(r->context) : VPL_SUCCESS);
        TRY(readVertex(r, e, i));
    }
    return VPL_SUCCESS;
}

// ---- faces

static vplResult addTriangle(Reader* r, int a, int b, int c)
{
    const uint32_t corners[3] = {(uint32_t)r->corners[a], (uint32_t)r->corners[b], (uint32_t)r->corners[c]};
    return vplRawMesh_AddTriangle(&r->raw, r->context, corners, r->material);
}

static vplResult addFace(Reader* r, int64_t count, const char* at)
{
    vplVec3 positions[VPL_MAX_CORNERS];
    if (count < 3) {
        vplTally_Add(&r->thin, at);
        return VPL_SUCCESS;
    }
    if (count > VPL_MAX_CORNERS) {
        return vplPly_Fail(&r->ply, at, "found a face of %lld corners, expected at most %d", (long long)count,
                           VPL_MAX_CORNERS);
    }
    if (count == 3) {
        return addTriangle(r, 0, 1, 2);
    }
    for (int i = 0; i < (int)count; i++) {
        positions[i] = r->raw.positions[r->corners[i]];
    }
    vplEarClipper_Triangulate(r->polygon, positions, (int)count);
    if (!r->polygon->simple) {
        vplTally_Add(&r->crossing, at);
    }
    for (int i = 0; i < r->polygon->triangleCount; i++) {
        const int* t = r->polygon->triangles[i];
        TRY(addTriangle(r, t[0], t[1], t[2]));
    }
    return VPL_SUCCESS;
}

// Adds the triangles of strips, which -1 separates; every second one turns the other way round.
static vplResult addStrips(Reader* r, int64_t count)
{
    int64_t start = 0;
    for (int64_t i = 0; i < count && count <= INT32_MAX; i++) {
        if (r->corners[i] < 0) {
            start = i + 1;
        } else if (i >= start + 2) {
            const int at = (int)i, odd = (int)((i - start) % 2);
            TRY(addTriangle(r, at - 2 + odd, at - 1 - odd, at));
        }
    }
    return VPL_SUCCESS;
}

// Reads the indices of a list. Only strips may have -1.
static vplResult readCorners(Reader* r, const vplPlyProperty* p, bool strips, int64_t* countOut)
{
    TRY(vplPly_ReadCount(&r->ply, p, countOut));
    TRY(vplArena_Reserve(r->scratch, &r->corners, &r->cornerCapacity, (size_t)*countOut, sizeof *r->corners));
    for (int64_t i = 0; i < *countOut; i++) {
        double index = 0;
        const char* at = vplPly_Place(&r->ply);
        TRY(vplPly_ReadValue(&r->ply, p->type, "an index of a vertex", &index));
        const bool good = index >= 0 && index < (double)r->raw.vertexCount && index == floor(index);
        if (!good && !(strips && index == -1)) {
            return vplPly_Fail(&r->ply, at, "found %g, expected an index of a vertex: 0 to %lld", index,
                               (long long)r->raw.vertexCount - 1);
        }
        r->corners[i] = (int64_t)index;
    }
    return VPL_SUCCESS;
}

static bool isIndexList(const vplPlyProperty* p)
{
    return p->list && (vplWord_Is(p->name, "vertex_indices") || vplWord_Is(p->name, "vertex_index"));
}

static vplResult readFaces(Reader* r, const vplPlyElement* e)
{
    const bool strips = isNamed(e, "tristrips");
    int list = 0;
    while (list < e->propertyCount && !isIndexList(&r->ply.properties[e->first + list])) {
        list++;
    }
    if (list == e->propertyCount) {
        return vplPly_Fail(&r->ply, e->name.start, "found no list vertex_indices, expected it of a face");
    }
    TRY(vplPly_RequireRoom(&r->ply, e));
    for (int64_t i = 0; i < e->count; i++) {
        int64_t corners = 0;
        const char* at = vplPly_Place(&r->ply);
        TRY(i % 65536 == 65535 ? vplAsk(r->context) : VPL_SUCCESS);
        for (int p = 0; p < e->propertyCount; p++) {
            const vplPlyProperty* property = &r->ply.properties[e->first + p];
            TRY(p == list ? readCorners(r, property, strips, &corners)
                          : vplPly_SkipProperty(&r->ply, property));
        }
        TRY(strips ? addStrips(r, corners) : addFace(r, corners, at));
    }
    return VPL_SUCCESS;
}

// ---- the file

static bool isFaces(const vplPlyElement* e)
{
    return isNamed(e, "face") || isNamed(e, "tristrips");
}

// Reads the vertices first, because faces need them, and elements of faces in a second pass.
static vplResult readElements(Reader* r)
{
    vplPly* ply = &r->ply;
    int vertices = 0, faces = 0;
    while (vertices < ply->elementCount && !isNamed(&ply->elements[vertices], "vertex")) {
        vertices++;
    }
    for (int i = 0; i < ply->elementCount; i++) {
        faces += isFaces(&ply->elements[i]);
    }
    if (vertices == ply->elementCount || faces == 0) {
        return vplPly_Fail(ply, ply->text.bytes,
                           "found no element \"%s\", expected a mesh of vertices and faces",
                           faces == 0 ? "face" : "vertex");
    }
    for (int i = 0; i <= vertices; i++) {
        ply->elements[i].start = ply->at;
        TRY(i == vertices ? readVertices(r, &ply->elements[i]) : vplPly_SkipElement(ply, &ply->elements[i]));
    }
    const char* behind = ply->at;
    for (int i = 0; i < ply->elementCount && faces > 0; i++) {
        vplPlyElement* e = &ply->elements[i];
        ply->at = i < vertices ? e->start : i == vertices ? behind : ply->at;
        if (isFaces(e)) {
            TRY(readFaces(r, e));
            faces--;
        } else if (i > vertices) {
            TRY(vplPly_SkipElement(ply, e));
        }
    }
    return VPL_SUCCESS;
}

static vplResult readFile(Reader* r, vplRawMesh* out)
{
    r->polygon = vplArena_Alloc(r->scratch, 1, sizeof *r->polygon);
    TRY(vplArena_Check(r->scratch));
    for (int code = 0; code < 256; code++) {
        r->linear[code] = vplSrgb_Decode((float)code / 255.0f);
    }
    TRY(vplPly_ReadHeader(&r->ply));
    r->raw = *out;
    const vplResult result = readElements(r);
    *out = r->raw;
    vplPly_WarnTally(&r->ply, &r->thin, "a face of fewer than three corners is left out", "faces");
    vplPly_WarnTally(&r->ply, &r->crossing,
                     "the outline of this face crosses itself; its triangles may overlap", "faces");
    return result;
}

vplResult vplReadPly(vplText* bytes, vplArena* scratch, int material, vplRawMesh* out)
{
    TRY(vplCheckFileKind(bytes->context, bytes->file, bytes->bytes, bytes->size, ".ply", "a PLY file"));
    Reader* r = vplArena_AllocZero(scratch, 1, sizeof *r);
    TRY(vplArena_Check(scratch));
    r->ply.text = *bytes;
    r->context = bytes->context;
    r->scratch = scratch;
    r->material = material;
    return readFile(r, out);
}
