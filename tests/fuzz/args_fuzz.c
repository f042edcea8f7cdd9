// SPDX-License-Identifier: MIT
// Passes arbitrary bytes, one word per line, as the command line of vpl: each is refused in one sentence, or gives options
// that are all in their ranges. Nothing is run or written.
#define _GNU_SOURCE
#include "fuzz.h"

#define main vplMain
int vplMain(int count, char** words);
#include "cli/main.c"
#undef main

enum { MOST_WORDS = 40 };

// Cuts text into words, the first of which is the program's. Returns their number.
static int cut(char* text, const char** words)
{
    int count = 1;
    words[0] = "vpl";
    for (char* at = text; at != NULL && count < MOST_WORDS; count++) {
        words[count] = strsep(&at, "\n");
    }
    return count;
}

static void requireOptions(vplRenderOptions options)
{
    int count;
    const vplOption* rows = vplGetOptions(&count);
    for (int i = 0; i < count; i++) { // what was set can be written and set again
        char text[64];
        MUST(rows[i].kind == VPL_OPTION_PART ||
             (vplRenderOptions_Get(&options, rows[i].name, text, sizeof text) == VPL_SUCCESS &&
              vplRenderOptions_Set(&options, rows[i].name, text) == VPL_SUCCESS));
    }
}

// Requires sentences, each a line that starts with the program's name: one for a refusal, or any number of warnings.
static void requireSentences(const char* text, bool parsed)
{
    int lines = 0;
    for (const char* line = text; *line != 0; lines++) {
        MUST(strncmp(line, "vpl: ", 5) == 0 && line[5] != 0);
        MUST(!parsed || strncmp(line, "vpl: warning: ", 14) == 0);
        MUST(strchr(line, '\n') != NULL);
        line = strchr(line, '\n') + 1;
    }
    MUST(parsed || lines == 1);
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    const char* words[MOST_WORDS + 1] = {NULL};
    char *copy = strndup((const char*)bytes, size), *said = NULL;
    size_t length = 0;
    FILE* usual = stderr;
    Arguments arguments;
    MUST(copy != NULL);
    const int count = cut(copy, words);
    FILE* kept = open_memstream(&said, &length);
    MUST(kept != NULL);
    stderr = kept;
    if (findCommand(words[1]) != NULL) {
        const bool parsed = parseArguments(count, words, &arguments);
        stderr = usual;
        fclose(kept);
        requireSentences(said, parsed);
        if (parsed) {
            requireOptions(arguments.render);
        }
    } else { // its first word is the topic of the help
        char* help[] = {"vpl", "help", copy, NULL};
        FILE* screen = stdout;
        stdout = kept;
        const int code = vplMain(3, help);
        stdout = screen;
        stderr = usual;
        fclose(kept);
        MUST((code == EXIT_DONE || code == EXIT_USAGE) && length > 0);
    }
    free(said);
    free(copy);
    return 0;
}
