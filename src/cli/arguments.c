// SPDX-License-Identifier: MIT
// Words of the command line to options.
#include "cli/option.h"

#include <stdio.h>
#include <string.h>

void printOptions(const char* command)
{
    int bit = commandBit(command);
    for (int i = 0; i < OPTION_COUNT; i++) {
        if (OPTIONS[i].commands & bit) {
            char left[40];
            snprintf(left, sizeof left, "%s%s%s", OPTIONS[i].name, OPTIONS[i].value ? " " : "",
                     OPTIONS[i].value ? OPTIONS[i].value : "");
            printf("  %-20s %s\n", left, OPTIONS[i].help);
        }
    }
}

// Edit distance, to guess what was meant by a misspelt option.
static int distance(const char* a, const char* b)
{
    int row[32];
    int n = (int)strlen(b);
    if (n > 30) {
        return 99;
    }
    for (int j = 0; j <= n; j++) {
        row[j] = j;
    }
    for (int i = 1; a[i - 1] != 0; i++) {
        int diagonal = row[0];
        row[0] = i;
        for (int j = 1; j <= n; j++) {
            int best = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            best = row[j] + 1 < best ? row[j] + 1 : best;
            row[j] = row[j - 1] + 1 < best ? row[j - 1] + 1 : best;
        }
    }
    return row[n];
}

static const Option* findOption(const char* command, const char* word, size_t length)
{
    const Option *nearest = NULL, *elsewhere = NULL;
    int bit = commandBit(command), least = 3;
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)length, word);
    for (int i = 0; i < OPTION_COUNT; i++) {
        const Option* o = &OPTIONS[i];
        bool equal = strcmp(o->name, name) == 0;
        if (equal && (o->commands & bit) != 0) {
            return o;
        }
        elsewhere = equal ? o : elsewhere;
        bool begun = strncmp(name, o->name, strlen(name)) == 0; // "--reflect" for "--reflectivity"
        int far = begun ? 1 : distance(name, o->name);
        if ((o->commands & bit) != 0 && strlen(name) > 3 && far < least) {
            least = far;
            nearest = o;
        }
    }
    if (elsewhere != NULL) {
        complain("%s has no option %s", command, name);
        return NULL;
    }
    complain("unknown option %s%s%s%s", name, nearest ? ", did you mean " : "", nearest ? nearest->name : "",
             nearest ? "?" : "");
    return NULL;
}

static Arguments defaultArguments(const char* command)
{
    Arguments a = {.command = command};
    a.render = vplDefaultRenderOptions();
    a.context = vplDefaultContextDef();
    a.write = vplDefaultWriteOptions();
    a.heat = vplDefaultHeatmapDef();
    a.runs = 5;
    a.frames[1] = -1;
    a.seeds = 3;
    a.seconds = 300;
    if (strcmp(command, "tradeoff") == 0) {
        changeArguments(TRADEOFF_BASE, &a);
    }
    return a;
}

bool parseArguments(int count, char** words, Arguments* arguments)
{
    Arguments a = defaultArguments(words[1]);
    int bit = commandBit(words[1]);
    int most = commandBit("compare") == bit ? 2 : commandBit("bench") == bit ? 0 : 1;
    for (int i = 2; i < count; i++) {
        const char* word = words[i];
        if (word[0] != '-' || word[1] == 0) {
            if (a.positionalCount == most) {
                complain("%s: one word too many: \"%s\"", a.command, word);
                return false;
            }
            a.positionals[a.positionalCount++] = word;
            continue;
        }
        const char* equals = word[1] == '-' ? strchr(word, '=') : NULL;
        const Option* o = findOption(a.command, word, equals ? (size_t)(equals - word) : strlen(word));
        if (o == NULL) {
            return false;
        }
        const char* value = equals ? equals + 1 : NULL;
        if (o->value == NULL && value != NULL) {
            complain("%s takes no value", o->name);
            return false;
        }
        if (o->value != NULL && value == NULL) {
            if (i + 1 >= count || strncmp(words[i + 1], "--", 2) == 0) { // a file so named: --name=--file
                complain("%s needs a value: %s", o->name, o->value);
                return false;
            }
            value = words[++i];
        }
        if (!o->read(o, value, &a)) {
            return false;
        }
    }
    *arguments = a;
    return true;
}

bool changeArguments(const char* words, Arguments* arguments)
{
    char name[64], value[64];
    int length;
    while (sscanf(words, " %63s %63s%n", name, value, &length) == 2) {
        const Option* o = findOption("render", name, strlen(name));
        if (o == NULL || !o->read(o, value, arguments)) {
            return false;
        }
        words += length;
    }
    return true;
}
