// SPDX-License-Identifier: MIT
#include "cli/cli.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>

static int runCommand(const Command* command, int count, const char* const* words)
{
    Arguments arguments;
    if (!parseArguments(count, words, &arguments)) {
        return arguments.failure;
    }
    if (arguments.help) {
        printHelp(command->name, NULL);
        return finishOutput(EXIT_DONE);
    }
    if (arguments.positionalCount < (command->bit == MERGE ? 1 : command->positionals)) {
        complain("%s needs %s; vpl help %s", command->name,
                 command->bit == MERGE     ? "parts of a picture"
                 : command->bit == COMPARE ? "two pictures"
                                           : "a scene file",
                 command->name);
        return EXIT_USAGE;
    }
    return finishOutput(command->run(&arguments));
}

int main(int count, char** words)
{
    signal(SIGPIPE, SIG_IGN); // writing to a closed pipe then fails, and is reported
    signal(SIGXFSZ, SIG_IGN); // so is writing beyond the file size limit
    guardJson();
#ifdef _WIN32
    _setmode(STDOUT_FILENO, O_BINARY); // pictures go there, too
#endif
    const char* word = count > 1 ? words[1] : NULL;
    if (word == NULL) {
        complain("no command; vpl help lists them");
        return EXIT_USAGE;
    }
    if (strcmp(word, "--version") == 0) {
        printf("vpl %s\n", vplGetVersion());
        return finishOutput(EXIT_DONE);
    }
    if (strcmp(word, "help") == 0 || strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) {
        const bool done = printHelp(count > 2 ? words[2] : NULL, count > 3 ? words[3] : NULL);
        return finishOutput(done ? EXIT_DONE : EXIT_USAGE);
    }
    if (strcmp(word, "completion") == 0) {
        return finishOutput(printCompletion(count > 2 ? words[2] : "") ? EXIT_DONE : EXIT_USAGE);
    }
    const Command* command = findCommand(word);
    if (command == NULL) {
        const char* nearest = nearestCommand(word);
        complain(nearest != NULL ? "no command \"%s\", did you mean %s?"
                                 : "no command \"%s\"; vpl help lists them",
                 word, nearest);
        return EXIT_USAGE;
    }
    return runCommand(command, count, (const char* const*)words);
}
