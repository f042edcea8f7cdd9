// SPDX-License-Identifier: MIT
#include "scene/obj_text.h"
#include "base/arena.h"
#include "base/file.h"
#include "base/file_kind.h"
#include "scene/obj_number.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static bool isBlank(char c)
{
    return c == ' ' || c == '\t' || c == '\v';
}

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
            behindBlank = isBlank(c);
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

vplResult vplText_Open(vplContext* context, const char* file, vplText* textOut)
{
    vplText text = {context, file, NULL, 0};
    TRY(vplReadFile(context, file, &text.bytes, &text.size));
    vplResult result =
        vplCheckFileKind(context, file, text.bytes, text.size, ".obj.mtl", "an OBJ or MTL file");
    result = result == VPL_SUCCESS ? vplText_Normalise(&text) : result;
    if (result != VPL_SUCCESS) {
        vplText_Close(&text);
        return result;
    }
    *textOut = text;
    return VPL_SUCCESS;
}

void vplText_Close(vplText* text)
{
    vplFree(text->context, text->bytes);
}

static vplWord skipBlanks(vplWord line)
{
    while (line.start < line.end && isBlank(*line.start)) {
        line.start++;
    }
    return line;
}

bool vplText_NextLine(const vplText* text, const char** at, vplWord* lineOut)
{
    const char* end = text->bytes + text->size;
    const char* start = *at ? *at : text->bytes;
    while (start < end) {
        const char* newline = memchr(start, '\n', (size_t)(end - start));
        vplWord line = skipBlanks((vplWord){start, newline ? newline : end});
        start = newline ? newline + 1 : end;
        if (line.start < line.end && *line.start != '#') {
            *at = start;
            *lineOut = line;
            return true;
        }
    }
    return false;
}

vplResult vplText_Ask(const vplText* text, vplWord line, const char* at)
{
    const ptrdiff_t from = line.start - text->bytes, to = at - text->bytes;
    return from >> 20 != to >> 20 ? vplAsk(text->context) : VPL_SUCCESS;
}

bool vplNextWord(vplWord* line, vplWord* wordOut)
{
    *line = skipBlanks(*line);
    const char* start = line->start;
    if (start == line->end || *start == '#') {
        *wordOut = (vplWord){start, start};
        return false;
    }
    const char* end = start;
    while (end < line->end && !isBlank(*end)) {
        end++;
    }
    line->start = end;
    *wordOut = (vplWord){start, end};
    return true;
}

vplWord vplRestOfLine(vplWord line)
{
    line = skipBlanks(line);
    while (line.end > line.start && isBlank(line.end[-1])) {
        line.end--;
    }
    return line;
}

static bool isSame(vplWord a, vplWord b)
{
    return a.end - a.start == b.end - b.start && memcmp(a.start, b.start, (size_t)(a.end - a.start)) == 0;
}

bool vplWord_Is(vplWord word, const char* text)
{
    return isSame(word, (vplWord){text, text + strlen(text)});
}

bool vplWord_IsAmong(vplWord word, const char* const* texts)
{
    while (*texts != NULL && !vplWord_Is(word, *texts)) {
        texts++;
    }
    return *texts != NULL;
}

// Line and column from 1; columns count bytes.
static void locate(const vplText* text, const char* at, long long* line, long long* column)
{
    const char* start = text->bytes;
    *line = 1;
    for (const char* p = text->bytes; p < at; p++) {
        if (*p == '\n' || *p == '\v' || (*p == '\r' && p[1] != '\n')) { // '\r': not yet normalised
            ++*line;
            start = p + 1;
        }
    }
    *column = at - start + 1;
}

static void logAt(const vplText* text, const char* at, vplLogLevel level, const char* format,
                  va_list arguments)
{
    char message[512];
    long long line, column;
    vsnprintf(message, sizeof message, format, arguments);
    locate(text, at, &line, &column);
    vplLog(text->context, level, "%s:%lld:%lld: %s", text->file, line, column, message);
}

void vplText_Locate(const vplText* text, const char* at, char* out, size_t size)
{
    long long line, column;
    locate(text, at, &line, &column);
    snprintf(out, size, "%s:%lld:%lld", text->file, line, column);
}

vplResult vplText_FailAt(const vplText* text, const char* at, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    logAt(text, at, VPL_LOG_ERROR, format, arguments);
    va_end(arguments);
    return VPL_PARSE_ERROR;
}

void vplText_WarnAt(const vplText* text, const char* at, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    logAt(text, at, VPL_LOG_WARNING, format, arguments);
    va_end(arguments);
}

// The number of bytes that messages show of a word.
static int shownLength(vplWord word)
{
    return word.end - word.start > 60 ? 60 : (int)(word.end - word.start);
}

vplResult vplText_FailWord(const vplText* text, vplWord word, const char* format, ...)
{
    char expected[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(expected, sizeof expected, format, arguments);
    va_end(arguments);
    if (word.start == word.end) {
        return vplText_FailAt(text, word.start, "found the end of the line, expected %s", expected);
    }
    return vplText_FailAt(text, word.start, "found \"%.*s\", expected %s", shownLength(word), word.start,
                          expected);
}

vplResult vplText_Number(const vplText* text, vplWord* line, const char* what, float low, float high,
                         float* out)
{
    vplWord word;
    float value;
    vplNextWord(line, &word);
    if (!vplReadNumber(word.start, word.end, &value)) {
        return vplText_FailWord(text, word, "%s", what);
    }
    if (!(value >= low && value <= high)) {
        return vplText_FailWord(text, word, "%s in [%g, %g]", what, (double)low, (double)high);
    }
    *out = value;
    return VPL_SUCCESS;
}

vplResult vplText_RequireEnd(const vplText* text, vplWord line)
{
    vplWord word;
    return vplNextWord(&line, &word) ? vplText_FailWord(text, word, "the end of the line") : VPL_SUCCESS;
}

void vplTally_Add(vplTally* tally, const char* at)
{
    tally->first = tally->count++ == 0 ? at : tally->first;
}

void vplText_WarnTally(const vplText* text, const vplTally* tally, const char* sentence, const char* things)
{
    if (tally->count > 0) {
        vplText_WarnAt(text, tally->first, "%s (%lld such %s)", sentence, tally->count, things);
    }
}

void vplText_WarnOnce(const vplText* text, vplUnknownWords* unknown, vplWord word)
{
    for (int i = 0; i < unknown->count; i++) {
        if (isSame(unknown->words[i], word)) {
            return;
        }
    }
    if (unknown->count == VPL_MOST_UNKNOWN) {
        return;
    }
    unknown->words[unknown->count++] = word;
    vplText_WarnAt(text, word.start, "%.*s is not supported and has no effect%s", shownLength(word),
                   word.start,
                   unknown->count == VPL_MOST_UNKNOWN ? "; further such statements are not reported" : "");
}
