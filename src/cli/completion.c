// SPDX-License-Identifier: MIT
// Completions of command lines for three shells, from the tables of commands and options.
#include "cli/options.h"

#include <stdio.h>
#include <string.h>

// Files are what an option takes whose value is written as FILE, FILE|R,G,B, FILES or DIR.
static bool takesFile(const Option* o)
{
    return o->value != NULL && (strncmp(o->value, "FILE", 4) == 0 || strcmp(o->value, "DIR") == 0);
}

// Prints the choices of "a|b|c", with spaces between; nothing for other values, such as N.
static void printChoices(const Option* o)
{
    for (const char* at = o->value; at != NULL && strchr(o->value, '|') != NULL;) {
        const int length = (int)strcspn(at, "|");
        if (strspn(at, "abcdefghijklmnopqrstuvwxyz-0123456789") >= (size_t)length) {
            printf("%.*s ", length, at);
        }
        at = at[length] != 0 ? at + length + 1 : NULL;
    }
}

static void printCommands(void)
{
    for (int i = 0; i < COMMAND_COUNT; i++) {
        printf("%s ", COMMANDS[i].name);
    }
    printf("help completion");
}

// ---- bash, and zsh by way of it

static void printBash(void)
{
    puts("_vpl()\n{\n    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} words=\n"
         "    if [ \"$COMP_CWORD\" -eq 1 ]; then");
    printf("        words=\"");
    printCommands();
    puts("\"\n    else\n        case ${COMP_WORDS[1]}:$before in");
    for (const Option* o = getOptions(); o->name != NULL; o++) {
        if (o->value != NULL && !takesFile(o)) {
            printf("        *:%s%s) words=\"", dashesOf(o), o->name);
            printChoices(o);
            puts("\" ;;");
        }
    }
    puts("        help:help) words=\"options \" ;;\n        *)\n            case ${COMP_WORDS[1]} in");
    for (int i = 0; i < COMMAND_COUNT; i++) {
        printf("            %s) words=\"", COMMANDS[i].name);
        for (const Option* o = getOptions(); o->name != NULL; o++) {
            if ((o->commands & COMMANDS[i].bit) != 0) {
                printf("%s%s ", dashesOf(o), o->name);
            }
        }
        puts("\" ;;");
    }
    puts("            completion) words=\"bash zsh fish\" ;;\n            esac\n"
         "            [ \"${word#-}\" != \"$word\" ] || [ \"${COMP_WORDS[1]}\" = completion ] || words= ;;\n"
         "        esac\n    fi\n    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n}\n"
         "complete -o default -F _vpl vpl");
}

// ---- fish

// Prints text within single quotes, up to the first semicolon: fish shows one short line.
static void printQuoted(const char* text)
{
    putchar('\'');
    for (const char* end = text + strcspn(text, ";"); text < end; text++) {
        printf(*text == '\'' || *text == '\\' ? "\\%c" : "%c", *text);
    }
    putchar('\'');
}

static void printFish(void)
{
    for (int i = 0; i < COMMAND_COUNT; i++) {
        printf("complete -c vpl -n __fish_use_subcommand -a %s -d ", COMMANDS[i].name);
        printQuoted(COMMANDS[i].summary);
        putchar('\n');
    }
    puts("complete -c vpl -n __fish_use_subcommand -a 'help completion'\n"
         "complete -c vpl -n '__fish_seen_subcommand_from completion' -f -a 'bash zsh fish'");
    for (const Option* o = getOptions(); o->name != NULL; o++) {
        printf("complete -c vpl -n '__fish_seen_subcommand_from");
        for (int i = 0; i < COMMAND_COUNT; i++) {
            if ((o->commands & COMMANDS[i].bit) != 0) {
                printf(" %s", COMMANDS[i].name);
            }
        }
        printf("' -%s %s%s", o->name[1] == 0 ? "s" : "l", o->name,
               o->value == NULL ? ""
               : takesFile(o)   ? " -r"
                                : " -x");
        if (o->value != NULL && strchr(o->value, '|') != NULL && !takesFile(o)) {
            printf(" -a '");
            printChoices(o);
            putchar('\'');
        }
        printf(" -d ");
        printQuoted(o->help);
        putchar('\n');
    }
}

bool printCompletion(const char* shell)
{
    if (strcmp(shell, "bash") == 0) {
        printBash();
    } else if (strcmp(shell, "zsh") == 0) {
        puts("#compdef vpl\nautoload -U +X bashcompinit && bashcompinit");
        printBash();
        // zsh reads the file of a completion at the first Tab and expects what it offers.
        puts("[ \"${funcstack[1]}\" != _vpl ] || _bash_complete -o default -F _vpl");
    } else if (strcmp(shell, "fish") == 0) {
        printFish();
    } else {
        complain("completion is for bash, zsh or fish, not \"%s\"", shell);
        return false;
    }
    return true;
}
