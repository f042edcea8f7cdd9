// SPDX-License-Identifier: MIT
// The header of a PLY file: lines that declare elements and their properties.
#include "scene/ply.h"

#include "scene/obj_number.h"

#include <string.h>

typedef struct Header {
    vplPly* ply;
    const char* at;   // the next line
    const char* mark; // the end of a line: "\n", "\r\n" or "\r"
    bool hasFormat;
    vplTally unknown; // lines
} Header;

// Cuts the next line off the header; false at the end of the file.
static bool nextLine(Header* h, vplWord* line)
{
    const vplText* t = &h->ply->text;
    const char* end = t->bytes + t->size;
    const size_t length = strlen(h->mark);
    for (const char* p = h->at; p + length <= end; p++) {
        if (memcmp(p, h->mark, length) == 0) {
            *line = (vplWord){h->at, p};
            h->at = p + length;
            return true;
        }
    }
    *line = (vplWord){end, end};
    return false;
}

static bool readType(vplWord word, vplPlyType* out)
{
    static const char* const names[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                           {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                           {"float", "float32"}, {"double", "float64"}};
    for (int i = 0; i <= VPL_PLY_DOUBLE; i++) {
        if (vplWord_Is(word, names[i][0]) || vplWord_Is(word, names[i][1])) {
            *out = (vplPlyType)i;
            return true;
        }
    }
    return false;
}

static vplResult readFormat(Header* h, vplWord line)
{
    static const char* const names[] = {"ascii", "binary_little_endian", "binary_big_endian", NULL};
    vplWord name, version;
    vplNextWord(&line, &name);
    vplNextWord(&line, &version);
    for (int i = 0; names[i] != NULL; i++) {
        if (vplWord_Is(name, names[i])) {
            h->ply->format = (vplPlyFormat)i;
            h->hasFormat = true;
            return vplWord_Is(version, "1.0") ? VPL_SUCCESS
                                              : vplText_FailWord(&h->ply->text, version, "the version 1.0");
        }
    }
    return vplText_FailWord(&h->ply->text, name, "ascii, binary_little_endian or binary_big_endian");
}

static vplResult readElement(Header* h, vplWord line)
{
    vplPly* ply = h->ply;
    vplWord name, count;
    vplNextWord(&line, &name);
    if (name.start == name.end || ply->elementCount == VPL_PLY_MAX_ELEMENTS) {
        return vplText_FailWord(&ply->text, name, "the name of one of at most %d elements",
                                VPL_PLY_MAX_ELEMENTS);
    }
    vplNextWord(&line, &count);
    vplPlyElement* e = &ply->elements[ply->elementCount];
    const char* p = count.start;
    *e = (vplPlyElement){.name = name, .first = ply->propertyCount};
    if (!vplReadInteger(&p, count.end, &e->count) || p != count.end || e->count < 0) {
        return vplText_FailWord(&ply->text, count, "the number of elements");
    }
    ply->elementCount++;
    return VPL_SUCCESS;
}

static vplResult readProperty(Header* h, vplWord line, vplWord keyword)
{
    vplPly* ply = h->ply;
    vplPlyProperty p = {0};
    vplWord word;
    if (ply->elementCount == 0) {
        return vplText_FailWord(&ply->text, keyword, "an element before its properties");
    }
    vplNextWord(&line, &word);
    p.list = vplWord_Is(word, "list");
    if (p.list) {
        vplNextWord(&line, &word);
        if (!readType(word, &p.countType) || p.countType >= VPL_PLY_FLOAT) {
            return vplText_FailWord(&ply->text, word, "an integer type for the length of a list");
        }
        vplNextWord(&line, &word);
    }
    if (!readType(word, &p.type)) {
        return vplText_FailWord(&ply->text, word, "a type such as float, int or uchar");
    }
    vplNextWord(&line, &p.name);
    if (p.name.start == p.name.end || ply->propertyCount == VPL_PLY_MAX_PROPERTIES) {
        return vplText_FailWord(&ply->text, p.name, "the name of one of at most %d properties",
                                VPL_PLY_MAX_PROPERTIES);
    }
    ply->properties[ply->propertyCount++] = p;
    ply->elements[ply->elementCount - 1].propertyCount++;
    return VPL_SUCCESS;
}

// Reads one line; *last is true for the end of the header.
static vplResult readLine(Header* h, vplWord line, bool* last)
{
    vplWord keyword;
    *last = false;
    if (!vplNextWord(&line, &keyword) || vplWord_Is(keyword, "comment") || vplWord_Is(keyword, "obj_info")) {
        return VPL_SUCCESS;
    }
    if (vplWord_Is(keyword, "format")) {
        return readFormat(h, line);
    }
    if (!h->hasFormat) {
        return vplText_FailWord(&h->ply->text, keyword, "the format");
    }
    if (vplWord_Is(keyword, "element")) {
        return readElement(h, line);
    }
    if (vplWord_Is(keyword, "property")) {
        return readProperty(h, line, keyword);
    }
    *last = vplWord_Is(keyword, "end_header");
    if (!*last) {
        vplTally_Add(&h->unknown, keyword.start);
    }
    return VPL_SUCCESS;
}

// The first line decides how lines end: behind "\r" alone, a byte 10 is data.
static vplResult readFirstLine(Header* h)
{
    const vplText* t = &h->ply->text;
    const char* p = t->bytes + 3;
    if (t->size < 4 || memcmp(t->bytes, "ply", 3) != 0) {
        const int length = t->size < 16 ? (int)t->size : 16;
        return vplText_FailAt(t, t->bytes, "found \"%.*s\", expected a PLY file, which begins with \"ply\"",
                              length, t->bytes);
    }
    while (*p == ' ' || *p == '\t') { // the byte behind the file is 0
        p++;
    }
    if (*p != '\n' && *p != '\r') {
        return vplText_FailAt(t, t->bytes, "found \"%.*s\", expected a line of only \"ply\"",
                              t->size < 16 ? (int)t->size : 16, t->bytes);
    }
    h->mark = *p == '\n' ? "\n" : p[1] == '\n' ? "\r\n" : "\r";
    h->at = p + strlen(h->mark);
    return VPL_SUCCESS;
}

vplResult vplPly_ReadHeader(vplPly* ply)
{
    Header h = {.ply = ply};
    bool last = false;
    ply->data = ply->text.bytes + ply->text.size;
    TRY(readFirstLine(&h));
    while (!last) {
        vplWord line;
        if (!nextLine(&h, &line)) {
            return vplText_FailAt(&ply->text, line.start, "found the end of the file, expected end_header");
        }
        TRY(readLine(&h, line, &last));
    }
    vplText_WarnTally(&ply->text, &h.unknown, "this line of the header has no effect", "lines");
    ply->data = ply->at = h.at;
    return VPL_SUCCESS;
}
