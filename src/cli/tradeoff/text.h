// SPDX-License-Identifier: MIT
// Text that grows: the report, the plot and the table are put together in memory and written at once.
#ifndef VPL_CLI_TRADEOFF_TEXT_H
#define VPL_CLI_TRADEOFF_TEXT_H

#include <vpl/image.h>

// Start with {0}; bytes is NULL while empty and is freed with free. Once `failed` (out of memory) it stays
// so.
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

// Adds words of a command line such that lines break between options only: half a word cannot be copied.
void addWords(Text* html, const char* words);

// Adds a cell of a CSV row, in quotes where it needs them, and a comma behind it.
void addCell(Text* text, const char* plain);

// Adds a picture as data:image/png;base64,... (RFC 2397), so that a page needs no other file.
void addPicture(Text* text, const vplImage* image, const vplWriteOptions* options);

#endif
