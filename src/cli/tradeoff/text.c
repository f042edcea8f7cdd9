// SPDX-License-Identifier: MIT
#include "cli/tradeoff/text.h"

#include <vpl/imagetools.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Makes room for `more` bytes and a 0 behind them.
static bool reserve(Text* text, size_t more)
{
    size_t needed = text->size + more + 1;
    if (!text->failed && needed > text->capacity) {
        size_t capacity = needed + needed / 2;
        char* bytes = realloc(text->bytes, capacity);
        text->failed = bytes == NULL;
        text->bytes = bytes ? bytes : text->bytes;
        text->capacity = bytes ? capacity : text->capacity;
    }
    return !text->failed;
}

void addText(Text* text, const char* format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, arguments);
    if (length >= 0 && reserve(text, (size_t)length)) {
        vsnprintf(text->bytes + text->size, (size_t)length + 1, format, again);
        text->size += (size_t)length;
    }
    va_end(again);
    va_end(arguments);
}

void addEscaped(Text* text, const char* plain)
{
    for (; *plain; plain++) {
        const char* entity = *plain == '&'   ? "&amp;"
                             : *plain == '<' ? "&lt;"
                             : *plain == '>' ? "&gt;"
                             : *plain == '"' ? "&quot;"
                                             : (char[]){*plain, 0};
        addText(text, "%s", entity);
    }
}

void addWords(Text* html, const char* words)
{
    while (*words != 0) {
        size_t length = strcspn(words, " ");
        char word[256];
        snprintf(word, sizeof word, "%.*s", (int)length, words);
        addText(html, "<span>");
        addEscaped(html, word);
        addText(html, "</span>%s", words[length] ? " " : "");
        words += length + (words[length] == ' ');
    }
}

void addCell(Text* text, const char* plain)
{
    bool quoted = strpbrk(plain, ",\"\r\n") != NULL;
    addText(text, "%s", quoted ? "\"" : "");
    for (; *plain; plain++) {
        addText(text, "%s%c", *plain == '"' ? "\"" : "", *plain); // RFC 4180: a quote is doubled
    }
    addText(text, "%s,", quoted ? "\"" : "");
}

static void addBase64(Text* text, const uint8_t* bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    if (!reserve(text, 4 * (size / 3 + 1))) {
        return;
    }
    char* out = text->bytes + text->size;
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        unsigned group = (unsigned)bytes[i] << 16 | (left > 1 ? (unsigned)bytes[i + 1] << 8 : 0) |
                         (left > 2 ? (unsigned)bytes[i + 2] : 0);
        *out++ = digits[group >> 18];
        *out++ = digits[group >> 12 & 63];
        *out++ = (char)(left > 1 ? digits[group >> 6 & 63] : '=');
        *out++ = (char)(left > 2 ? digits[group & 63] : '=');
    }
    *out = 0;
    text->size = (size_t)(out - text->bytes);
}

void addPicture(Text* text, const vplImage* image, const vplWriteOptions* options)
{
    uint8_t* bytes = NULL;
    size_t size = 0;
    if (vplImage_Encode(image, ".png", options, &bytes, &size) != VPL_SUCCESS) {
        text->failed = true;
        return;
    }
    addText(text, "data:image/png;base64,");
    addBase64(text, bytes, size);
    vplBytes_Free(image->context, bytes);
}
