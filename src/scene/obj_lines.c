// SPDX-License-Identifier: MIT
// Makes the text of OBJ and MTL files uniform: UTF-16 becomes UTF-8, and all line ends are alike.
#include "base/arena.h"
#include "scene/obj_text.h"

#include <string.h>

// Replaces the line end at bytes[i] by `mark` and returns the index of its last byte.
static size_t endLine(vplText* t, size_t i, char mark)
{
    char* b = t->bytes;
    if (b[i] == '\r' && b[i + 1] == '\n') { // the byte behind the file is 0
        b[i++] = ' ';
    }
    b[i] = mark;
    return i;
}

// Makes line ends uniform in place, so that offsets still give lines and columns. A backslash does not
// continue a comment: one that ends in a Windows path would swallow the next line.
static vplResult normalise(vplText* t)
{
    char* b = t->bytes;
    bool comment = false, behindBlank = true;
    for (size_t i = 0; i < t->size; i++) {
        char c = b[i];
        if (c > '#' && c != '\\') { // nearly all bytes
            behindBlank = false;
        } else if (c == '\n' || c == '\r') {
            i = endLine(t, i, '\n');
            comment = false;
            behindBlank = true;
        } else if (c == '\\' && !comment && (b[i + 1] == '\n' || b[i + 1] == '\r' || i + 1 == t->size)) {
            b[i] = ' ';
            i = i + 1 < t->size ? endLine(t, i + 1, '\v') : i;
            behindBlank = true;
        } else if (c == 0) {
            return vplText_FailAt(t, b + i, "found a NUL byte, expected text");
        } else if (c == '\v' || c == '\f') {
            b[i] = ' ';
            behindBlank = true;
        } else {
            comment = comment || (c == '#' && behindBlank);
            behindBlank = vplIsBlank(c);
        }
    }
    return VPL_SUCCESS;
}

// ---- UTF-16

// The code unit at bytes[i], in the order of bytes that `big` says.
static unsigned unitAt(const vplText* t, size_t i, bool big)
{
    const unsigned first = (unsigned char)t->bytes[i], second = (unsigned char)t->bytes[i + 1];
    return big ? first << 8 | second : second << 8 | first;
}

// Appends a character as UTF-8.
static size_t putUtf8(char* out, size_t at, unsigned c)
{
    if (c < 0x80) {
        out[at++] = (char)c;
    } else if (c < 0x800) {
        out[at++] = (char)(0xC0 | c >> 6);
        out[at++] = (char)(0x80 | (c & 0x3F));
    } else {
        if (c < 0x10000) {
            out[at++] = (char)(0xE0 | c >> 12);
        } else {
            out[at++] = (char)(0xF0 | c >> 18);
            out[at++] = (char)(0x80 | (c >> 12 & 0x3F));
        }
        out[at++] = (char)(0x80 | (c >> 6 & 0x3F));
        out[at++] = (char)(0x80 | (c & 0x3F));
    }
    return at;
}

// Replaces UTF-16 text, as some programs of Windows write, by UTF-8. It begins with a byte order mark, or with a
// character of ASCII.
static vplResult decodeUtf16(vplText* t)
{
    const bool two = t->size >= 2,
               mark = two && (unitAt(t, 0, true) == 0xFEFF || unitAt(t, 0, false) == 0xFEFF);
    const bool big = two && (unitAt(t, 0, true) == 0xFEFF || (t->bytes[0] == 0 && t->bytes[1] > 0));
    if (!two || (!mark && !big && !(t->bytes[0] > 0 && t->bytes[1] == 0))) {
        return VPL_SUCCESS;
    }
    char* out = vplAlloc(t->context, t->size / 2 * 3 + 1, 1);
    if (out == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    size_t length = 0;
    for (size_t i = mark ? 2 : 0; i + 1 < t->size; i += 2) {
        unsigned c = unitAt(t, i, big);
        const unsigned low = c >> 10 == 0x36 && i + 3 < t->size ? unitAt(t, i + 2, big) : 0;
        if (low >> 10 == 0x37) { // a surrogate pair
            c = 0x10000 + ((c & 0x3FF) << 10) + (low & 0x3FF);
            i += 2;
        }
        length = putUtf8(out, length, c);
    }
    out[length] = 0;
    vplFree(t->context, t->bytes);
    t->bytes = out;
    t->size = length;
    return VPL_SUCCESS;
}

vplResult vplText_Normalise(vplText* text)
{
    if (text->size >= 3 && memcmp(text->bytes, "\xEF\xBB\xBF", 3) == 0) { // a byte order mark
        memset(text->bytes, ' ', 3);
    }
    TRY(decodeUtf16(text));
    return normalise(text);
}
