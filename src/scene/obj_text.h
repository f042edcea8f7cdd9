// SPDX-License-Identifier: MIT
// OBJ and MTL files as text: logical lines, words, numbers, and messages that name file, line and column.
#ifndef VPL_SCENE_OBJ_TEXT_H
#define VPL_SCENE_OBJ_TEXT_H

#include "base/context.h"

// A whole file with uniform line ends (see vplText_Open).
typedef struct vplText {
    vplContext* context;
    const char* file; // its name in messages
    char* bytes;
    size_t size;
} vplText;

// A part of a text: one word, or the rest of a line.
typedef struct vplWord {
    const char* start;
    const char* end;
} vplWord;

static inline bool vplIsBlank(char c)
{
    return c == ' ' || c == '\t' || c == '\v';
}

// Reads a file. Afterwards every line ends with '\n'. A '\v' replaces the end of a line that a backslash
// continues: it is a blank to readers, but counts as a line. A NUL byte is an error.
vplResult vplText_Open(vplContext* context, const char* file, vplText* textOut);

// Does the same to a file whose bytes were read.
vplResult vplText_Normalise(vplText* text);
void vplText_Close(vplText* text);

// Finds the next line that is not blank or a comment; *at starts at NULL. False at the end.
bool vplText_NextLine(const vplText* text, const char** at, vplWord* lineOut);

// Asks once per MiB of text whether to go on. `line` and `at` are those of vplText_NextLine.
vplResult vplText_Ask(const vplText* text, vplWord line, const char* at);

// Cuts the next word off a line. If there is none, returns false and an empty word at the end of the line.
bool vplNextWord(vplWord* line, vplWord* wordOut);

// The rest of a line without blanks around it, for names that may contain blanks.
vplWord vplRestOfLine(vplWord line);

bool vplWord_Is(vplWord word, const char* text);

// True if the word is one of the texts, which NULL ends.
bool vplWord_IsAmong(vplWord word, const char* const* texts);

// Logs "file:line:column: found ..., expected ..." for a word, or for the end of the line if it is empty.
// Returns VPL_PARSE_ERROR.
vplResult vplText_FailWord(const vplText* text, vplWord word, const char* format, ...) VPL_PRINTF(3, 4);

// Logs "file:line:column: sentence" for a place in the text. FailAt returns VPL_PARSE_ERROR.
vplResult vplText_FailAt(const vplText* text, const char* at, const char* format, ...) VPL_PRINTF(3, 4);
void vplText_WarnAt(const vplText* text, const char* at, const char* format, ...) VPL_PRINTF(3, 4);

// Writes "file:line:column" of a place in the text.
void vplText_Locate(const vplText* text, const char* at, char* out, size_t size);

// Reads the next word as a number in [low, high]; `what` completes "expected ...".
vplResult vplText_Number(const vplText* text, vplWord* line, const char* what, float low, float high,
                         float* out);

// Fails if anything is left of the line.
vplResult vplText_RequireEnd(const vplText* text, vplWord line);

// Counts places of one kind in a text, of which only the first is reported.
typedef struct vplTally {
    const char* first;
    long long count;
} vplTally;

void vplTally_Add(vplTally* tally, const char* at);

// Warns "file:line:column: sentence (3 such things)", unless there is no such place.
void vplText_WarnTally(const vplText* text, const vplTally* tally, const char* sentence, const char* things);

// Unknown words that were reported.
enum { VPL_MOST_UNKNOWN = 16 };
typedef struct vplUnknownWords {
    vplWord words[VPL_MOST_UNKNOWN];
    int count;
} vplUnknownWords;

// Warns "file:line:column: WORD ...", once per word and for VPL_MOST_UNKNOWN words at most.
void vplText_WarnOnce(const vplText* text, vplUnknownWords* unknown, vplWord word);

#endif
