// SPDX-License-Identifier: MIT
// OBJ and MTL files as text: logical lines, words, numbers, and sentences that name file, line and column.
#ifndef VPL_SCENE_OBJ_TEXT_H
#define VPL_SCENE_OBJ_TEXT_H

#include "base/context.h"

// A whole file with its line ends made alike (see vplText_Open).
typedef struct vplText {
    vplContext* context;
    const char* file; // its name in messages
    char* bytes;
    size_t size;
} vplText;

// A piece of a text: one word, or what is left of a line.
typedef struct vplWord {
    const char* start;
    const char* end;
} vplWord;

// Reads a file. Afterwards every line ends with '\n', whatever it was; where a backslash continued a line, '\v'
// stands, which is a blank to readers and a line to those who count. A NUL byte is an error.
vplResult vplText_Open(vplContext* context, const char* file, vplText* textOut);
void vplText_Close(vplText* text);

// The next line with something on it but blanks and comment; *at starts at NULL. False at the end.
bool vplText_NextLine(const vplText* text, const char** at, vplWord* lineOut);

// Cuts the next word off a line. False, with an empty word where the line ends, if there is none.
bool vplNextWord(vplWord* line, vplWord* wordOut);

// All that is left of a line, for names that may hold blanks.
vplWord vplRestOfLine(vplWord line);

bool vplWord_Is(vplWord word, const char* text);

// "file:line:column: found ..., expected ..." for a word, or the end of the line if it is empty. Returns
// VPL_PARSE_ERROR.
vplResult vplText_FailWord(const vplText* text, vplWord word, const char* format, ...) VPL_PRINTF(3, 4);

// "file:line:column: sentence" for a place in the text.
vplResult vplText_FailAt(const vplText* text, const char* at, vplResult result, const char* format, ...)
    VPL_PRINTF(4, 5);
void vplText_WarnAt(const vplText* text, const char* at, const char* format, ...) VPL_PRINTF(3, 4);

// Reads the next word as a number in [low, high]; `what` completes "expected ...".
vplResult vplText_Number(const vplText* text, vplWord* line, const char* what, float low, float high,
                         float* out);

// Nothing may be left of the line.
vplResult vplText_RequireEnd(const vplText* text, vplWord line);

// Words that were met and not understood: each is told once.
enum { VPL_MOST_UNKNOWN = 16 };
typedef struct vplUnknownWords {
    vplWord words[VPL_MOST_UNKNOWN];
    int count;
} vplUnknownWords;

// Warns "file:line:column: WORD ..." unless it did so before; after VPL_MOST_UNKNOWN words it stays silent.
void vplText_WarnOnce(const vplText* text, vplUnknownWords* unknown, vplWord word);

#endif
