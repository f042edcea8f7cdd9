// SPDX-License-Identifier: MIT
// Words of the command line to options.
#include "cli/options.h"
#include "cli/tradeoff/tradeoff.h"

#include <stdio.h>
#include <string.h>

// ---- names

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

// A word that names an option: one of the program's own, or one of rendering, or neither.
typedef struct Found {
    const Option* own;
    const vplOption* render;
} Found;

typedef struct Guess {
    const char* name; // as typed
    char nearest[48];
    int least;
} Guess;

static void consider(Guess* g, const char* dashes, const char* candidate)
{
    char name[48];
    snprintf(name, sizeof name, "%s%s", dashes, candidate);
    const bool begun = strncmp(g->name, name, strlen(g->name)) == 0; // "--reflect" for "--reflectivity"
    const int far = begun ? 1 : distance(g->name, name);
    if (strlen(g->name) > 3 && far < g->least) {
        g->least = far;
        strcpy(g->nearest, name);
    }
}

// `word` is the name and perhaps "=value". Complains if the command has no such option.
static Found findOption(const Command* command, const char* word)
{
    char name[48];
    snprintf(name, sizeof name, "%.*s", (int)(word[1] == '-' ? strcspn(word, "=") : strlen(word)), word);
    Found found = {NULL, NULL};
    Guess guess = {.name = name, .least = 3};
    bool elsewhere = false;
    for (int i = 0; i < OPTION_COUNT; i++) {
        const bool equal = strcmp(OPTIONS[i].name, name) == 0;
        if ((OPTIONS[i].commands & command->bit) != 0) {
            found.own = equal ? &OPTIONS[i] : found.own;
            consider(&guess, "", OPTIONS[i].name);
        }
        elsewhere |= equal;
    }
    int count;
    const vplOption* options = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        const bool equal = strncmp(name, "--", 2) == 0 && strcmp(options[i].name, name + 2) == 0;
        if (takesOption(command, &options[i])) {
            found.render = equal ? &options[i] : found.render;
            consider(&guess, "--", options[i].name);
        }
        elsewhere |= equal && options[i].kind != VPL_OPTION_PART;
    }
    if (found.own == NULL && found.render == NULL && elsewhere) {
        complain("%s has no option %s", command->name, name);
    } else if (found.own == NULL && found.render == NULL) {
        complain("unknown option %s%s%s%s", name, guess.nearest[0] ? ", did you mean " : "", guess.nearest,
                 guess.nearest[0] ? "?" : "");
    }
    return found;
}

bool isGiven(const Arguments* a, const char* name)
{
    const size_t length = strlen(name);
    for (int i = 2; i < a->wordCount; i++) { // values do not begin with two dashes
        const char* word = a->words[i];
        if (strncmp(word, "--", 2) == 0 && strncmp(word + 2, name, length) == 0 &&
            (word[2 + length] == 0 || word[2 + length] == '=')) {
            return true;
        }
    }
    return false;
}

// ---- words

static Arguments defaultArguments(const char* command)
{
    Arguments a = {.command = findCommand(command), .frames = {0, -1}, .ppd = VPL_DEFAULT_PPD};
    a.render = vplDefaultRenderOptions();
    a.context = vplDefaultContextDef();
    for (int i = 0; i < OPTION_COUNT; i++) {
        if (OPTIONS[i].default_ != NULL) {
            OPTIONS[i].read(&OPTIONS[i], OPTIONS[i].default_, &a);
        }
    }
    if (a.command->bit == TRADEOFF) {
        setOptions(&a.render, TRADEOFF_BASE);
    }
    a.render.method = a.command->bit == BAKE ? VPL_METHOD_RADIOSITY : a.render.method;
    return a;
}

static bool setOption(Arguments* a, const Found* found, const char* value)
{
    if (found->own != NULL) {
        return found->own->read(found->own, value, a);
    }
    if (vplRenderOptions_Set(&a->render, found->render->name, value) != VPL_SUCCESS) {
        complain("--%s", a->render.problem);
        return false;
    }
    return true;
}

// Reads the option at word *i, and its value if that is the next word.
static bool readOption(Arguments* a, int* i)
{
    const char* word = a->words[*i];
    const Found found = findOption(a->command, word);
    if (found.own == NULL && found.render == NULL) {
        return false;
    }
    const char* equals = word[1] == '-' ? strchr(word, '=') : NULL;
    const char* wanted = found.own != NULL ? found.own->value : found.render->value;
    const int length = equals != NULL ? (int)(equals - word) : (int)strlen(word);
    if (wanted == NULL && equals != NULL) {
        complain("%.*s takes no value", length, word);
        return false;
    }
    if (wanted == NULL || equals != NULL) {
        return setOption(a, &found, equals != NULL ? equals + 1 : NULL);
    }
    if (*i + 1 >= a->wordCount || strncmp(a->words[*i + 1], "--", 2) == 0) { // a file so named: --name=--file
        complain("%.*s needs a value: %s", length, word, wanted);
        return false;
    }
    *i += 1;
    return setOption(a, &found, a->words[*i]);
}

static void warnOfUnused(const Arguments* a)
{
    int count;
    const vplOption* options = vplGetOptions(&count);
    for (int i = 0; i < count && !a->quiet; i++) {
        const char* name = options[i].name;
        char reason[64], padded[48];
        if ((a->command->bit & (ON_SCENES & ~TRADEOFF)) == 0 || !isGiven(a, name)) {
            continue;
        }
        snprintf(padded, sizeof padded, " %s ", name);
        if (!vplRenderOptions_IsUsed(&a->render, name, reason, sizeof reason)) {
            complain("warning: --%s has no effect with %s", name, reason);
        } else if (a->command->unused != NULL && strstr(a->command->unused, padded) != NULL) {
            complain("warning: --%s has no effect with vpl %s", name, a->command->name);
        }
    }
}

bool parseArguments(int count, const char* const* words, Arguments* arguments)
{
    Arguments a = defaultArguments(words[1]);
    a.words = words;
    a.wordCount = count;
    for (int i = 2; i < count; i++) {
        if (words[i][0] == '-' && words[i][1] != 0) {
            if (!readOption(&a, &i)) {
                return false;
            }
        } else if (a.positionalCount == a.command->positionals) {
            complain("%s: one word too many: \"%s\"", a.command->name, words[i]);
            return false;
        } else {
            a.positionals[a.positionalCount++] = words[i];
        }
    }
    warnOfUnused(&a);
    *arguments = a;
    return true;
}

bool setOptions(vplRenderOptions* options, const char* words)
{
    char name[64], value[64];
    int length;
    for (; sscanf(words, " --%63s %63s%n", name, value, &length) == 2; words += length) {
        if (vplRenderOptions_Set(options, name, value) != VPL_SUCCESS) {
            complain("--%s", options->problem);
            return false;
        }
    }
    return true;
}
