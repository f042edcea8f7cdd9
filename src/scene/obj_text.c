// SPDX-License-Identifier: MIT
// Lines, words and numbers of a text that obj_lines.c made uniform, and messages about them.
#include "scene/obj_text.h"
#include "base/arena.h"
#include "base/file.h"
#include "base/file_kind.h"
#include "base/numbers.h"
#include "scene/obj_number.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

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
    while (line.start < line.end && vplIsBlank(*line.start)) {
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
    while (end < line->end && !vplIsBlank(*end)) {
        end++;
    }
    line->start = end;
    *wordOut = (vplWord){start, end};
    return true;
}

vplWord vplRestOfLine(vplWord line)
{
    line = skipBlanks(line);
    while (line.end > line.start && vplIsBlank(line.end[-1])) {
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
    vplFormatList(message, sizeof message, format, arguments);
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
    vplFormatList(expected, sizeof expected, format, arguments);
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
