// SPDX-License-Identifier: MIT
// Growing text: the report, the plot and the table are composed in memory and then written whole.
#ifndef VPL_CLI_TRADEOFF_TEXT_H
#define VPL_CLI_TRADEOFF_TEXT_H

#include <vpl/image.h>

// Starts as {0}. The owner frees bytes, which is NULL while empty. `failed` (out of memory) is final.
typedef struct Text {
    char* bytes;
    size_t size, capacity;
    bool failed;
} Text;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void addText(Text* text, const char* format, ...);

// Adds text with the characters of HTML markup as entities.
void addEscaped(Text* text, const char* plain);

// Adds words of a command line so that lines break between words only.
void addWords(Text* html, const char* words);

// Adds a cell of a CSV row, in quotes if necessary, and a comma.
void addCell(Text* text, const char* plain);

// Adds a picture as data:image/png;base64,... (RFC 2397), so that a page needs no other file.
void addPicture(Text* text, const vplImage* image, const vplWriteOptions* options);

#endif
