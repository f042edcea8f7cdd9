// SPDX-License-Identifier: MIT
// Reads an STL file, text or binary, as one mesh. Its normals are left out: they say what the corners say.
// Based on: 3D Systems, StereoLithography Interface Specification, 1988.
#include "base/file_kind.h"
#include "scene/model.h"

#include "base/bytes.h"

#include <math.h>
#include <string.h>

enum { HEAD_BYTES = 84, TRIANGLE_BYTES = 50 }; // of a binary file

typedef struct Stl {
    const vplText* text;
    vplRawMesh* raw;
    size_t capacity; // of positions
    int material;
} Stl;

// Adds a corner, and with every third one a triangle.
static vplResult addCorner(Stl* s, vplVec3 p)
{
    const size_t count = s->raw->vertexCount;
    if (count == UINT32_MAX) {
        return vplFail(s->text->context, VPL_LIMIT, "%s: more than %u corners", s->text->file, UINT32_MAX);
    }
    TRY(vplArena_Reserve(s->raw->arena, &s->raw->positions, &s->capacity, count + 1, sizeof p));
    s->raw->positions[s->raw->vertexCount++] = p;
    const uint32_t c = (uint32_t)count;
    return count % 3 < 2 ? VPL_SUCCESS
                         : vplRawMesh_AddTriangle(s->raw, s->text->context, (uint32_t[3]){c - 2, c - 1, c},
                                                  s->material);
}

static vplResult readBinary(Stl* s, uint32_t triangles)
{
    for (size_t i = 0; i < 3 * (size_t)triangles; i++) {
        const size_t at = HEAD_BYTES + i / 3 * TRIANGLE_BYTES + 12 * (i % 3 + 1);
        const unsigned char* b = (const unsigned char*)s->text->bytes + at;
        float p[3];
        for (int k = 0; k < 3; k++, b += 4) {
            const uint32_t bits = vplTakeWord(b);
            memcpy(&p[k], &bits, sizeof bits);
            if (!(fabsf(p[k]) <= VPL_MAX_MAGNITUDE)) {
                return vplFail(s->text->context, VPL_PARSE_ERROR,
                               "%s: byte %zu: found %g, expected a coordinate in [%g, %g]", s->text->file,
                               at + 4 * (size_t)k, (double)p[k], -(double)VPL_MAX_MAGNITUDE,
                               (double)VPL_MAX_MAGNITUDE);
            }
        }
        TRY(i % 65536 == 65535 ? vplAsk(s->text->context) : VPL_SUCCESS);
        TRY(addCorner(s, (vplVec3){p[0], p[1], p[2]}));
    }
    return VPL_SUCCESS;
}

// Reads the lines "vertex x y z"; the words between them are always the same.
static vplResult readLines(Stl* s)
{
    const char* at = NULL;
    vplWord line, word;
    while (vplText_NextLine(s->text, &at, &line)) {
        float p[3];
        vplNextWord(&line, &word);
        if (!vplWord_Is(word, "vertex")) {
            continue;
        }
        for (int k = 0; k < 3; k++) {
            TRY(vplText_Number(s->text, &line, "a coordinate", -VPL_MAX_MAGNITUDE, VPL_MAX_MAGNITUDE, &p[k]));
        }
        TRY(vplText_Ask(s->text, line, at));
        TRY(addCorner(s, (vplVec3){p[0], p[1], p[2]}));
    }
    return s->raw->vertexCount % 3 == 0
               ? VPL_SUCCESS
               : vplText_FailAt(s->text, s->text->bytes + s->text->size,
                                "found the end of the file, expected three corners (vertex) of a triangle");
}

vplResult vplReadStl(vplText* bytes, vplArena* scratch, int material, vplRawMesh* out)
{
    (void)scratch;
    const unsigned char* b = (const unsigned char*)bytes->bytes + HEAD_BYTES - 4;
    const size_t size = bytes->size;
    const uint32_t triangles = size < HEAD_BYTES ? 0 : vplTakeWord(b);
    const bool text = size >= 5 && memcmp(bytes->bytes, "solid", 5) == 0;
    Stl s = {bytes, out, 0, material};
    // Some programs begin binary files with "solid", too: their size tells.
    if (size >= HEAD_BYTES && (size - HEAD_BYTES) / TRIANGLE_BYTES >= triangles &&
        (!text || size == HEAD_BYTES + (uint64_t)triangles * TRIANGLE_BYTES)) {
        return readBinary(&s, triangles);
    }
    if (!text) {
        TRY(vplCheckFileKind(bytes->context, bytes->file, bytes->bytes, size, ".stl", "an STL file"));
        return vplFail(
            bytes->context, VPL_PARSE_ERROR,
            "%s: byte %d: found %zu bytes for %u triangles, expected an STL file, which has %d bytes "
            "and %d more for each triangle, or begins with \"solid\"",
            bytes->file, HEAD_BYTES - 4, size, triangles, HEAD_BYTES, TRIANGLE_BYTES);
    }
    TRY(vplText_Normalise(bytes));
    return readLines(&s);
}
