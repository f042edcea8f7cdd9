// SPDX-License-Identifier: MIT
#include "base/file_kind.h"

#include <string.h>

typedef struct Kind {
    const char *begin, *name, *ending;
} Kind;

// Beginnings that no other file has. A binary STL file begins with 80 bytes of any text: its reader asks only where its size is
// not that of an STL file.
static const Kind kinds[] = {
    {"\x89PNG", "a PNG picture", ".png"},
    {"\xFF\xD8\xFF", "a JPEG picture", ".jpg"},
    {"GIF8", "a GIF picture", NULL},
    {"#?RADIANCE", "a Radiance HDR picture", ".hdr"},
    {"#?RGBE", "a Radiance HDR picture", ".hdr"},
    {"PF\n", "a PFM picture", ".pfm"},
    {"Pf\n", "a PFM picture", ".pfm"},
    {"\x76\x2F\x31\x01", "an OpenEXR picture", ".exr"},
    {"glTF", "a binary glTF file", ".glb"},
    {"ply\n", "a PLY model", ".ply"},
    {"ply\r", "a PLY model", ".ply"},
    {"solid ", "an STL model", ".stl"},
    {"Kaydara FBX", "an FBX file", NULL},
    {"; FBX", "an FBX file", NULL},
    {"BLENDER", "a Blender file", NULL},
    {"#usda", "a USD file", NULL},
    {"PXR-USDC", "a USD file", NULL},
    {"<?xml", "an XML file", NULL},
    {"\x1F\x8B", "a gzip archive", NULL},
    {"PK\x03\x04", "a zip archive", NULL},
    {"%PDF", "a PDF document", NULL},
    {"VPLSTATE", "the state of a render", NULL},
    {"VPLPIECE", "a part of a picture", NULL},
};

// Beginnings of the first line of a text that is no comment.
static const Kind lines[] = {
    {"{", "a JSON file", ".json"},  {"mtllib ", "an OBJ model", ".obj"}, {"usemtl ", "an OBJ model", ".obj"},
    {"v ", "an OBJ model", ".obj"}, {"vn ", "an OBJ model", ".obj"},     {"o ", "an OBJ model", ".obj"},
    {"g ", "an OBJ model", ".obj"}, {"newmtl ", "an MTL file", ".mtl"},
};

static const Kind* find(const Kind* among, size_t count, const char* bytes, size_t size)
{
    for (size_t i = 0; i < count; i++) {
        const size_t length = strlen(among[i].begin);
        if (size >= length && memcmp(bytes, among[i].begin, length) == 0) {
            return &among[i];
        }
    }
    return NULL;
}

// Skips blanks, empty lines and lines that begin with #.
static const char* skipComments(const char* at, const char* end)
{
    bool comment = false;
    for (; at < end && (comment || strchr("# \t\r\n", *at) != NULL) && *at != 0; at++) {
        comment = *at != '\n' && (comment || *at == '#');
    }
    return at;
}

const char* vplFileKindOf(const void* bytes, size_t size, const char** endingOut)
{
    const char *text = bytes, *end = text + size;
    const Kind* kind = find(kinds, sizeof kinds / sizeof *kinds, text, size);
    if (kind == NULL) {
        const char* line = skipComments(text, end);
        kind = find(lines, sizeof lines / sizeof *lines, line, (size_t)(end - line));
    }
    *endingOut = kind != NULL ? kind->ending : NULL;
    return kind != NULL ? kind->name : NULL;
}

vplResult vplCheckFileKind(vplContext* context, const char* path, const void* bytes, size_t size,
                           const char* endings, const char* expected)
{
    const char* ending;
    const char* kind = vplFileKindOf(bytes, size, &ending);
    if (kind == NULL || (ending != NULL && strstr(endings, ending) != NULL)) {
        return VPL_SUCCESS;
    }
    return vplFail(context, VPL_PARSE_ERROR, "%s:1:1: found %s, expected %s%s%s", path, kind, expected,
                   ending != NULL ? "; names of such files end in " : "", ending != NULL ? ending : "");
}
