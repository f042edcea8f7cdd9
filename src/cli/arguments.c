// SPDX-License-Identifier: MIT
// Parses the words of the command line.
#include "cli/options.h"
#include "cli/tradeoff/tradeoff.h"

#include <stdio.h>
#include <string.h>

// ---- names

// The edit distance of two words, to suggest an option for a misspelt one.
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

const char* nearestCommand(const char* word)
{
    const char* nearest = NULL;
    for (int i = 0, least = 3; i < COMMAND_COUNT; i++) {
        const bool begun = strlen(word) > 1 && strncmp(word, COMMANDS[i].name, strlen(word)) == 0;
        const int far = begun ? 1 : distance(word, COMMANDS[i].name);
        if (far < least) {
            least = far;
            nearest = COMMANDS[i].name;
        }
    }
    return nearest;
}

// Returns the command's option that a word, "--name" or "--name=value", names; NULL after complaining.
static const Option* findOption(const Command* command, const char* word)
{
    char name[48], candidate[48], nearest[48] = "";
    int least = 3;
    bool elsewhere = false;
    snprintf(name, sizeof name, "%.*s", (int)(word[1] == '-' ? strcspn(word, "=") : strlen(word)), word);
    for (const Option* o = getOptions(); o->name != NULL; o++) {
        snprintf(candidate, sizeof candidate, "%s%s", dashesOf(o), o->name);
        const bool equal = strcmp(candidate, name) == 0;
        const bool begun = strncmp(name, candidate, strlen(name)) == 0; // "--reflect" for "--reflectivity"
        const int far = begun ? 1 : distance(name, candidate);
        elsewhere |= equal;
        if ((o->commands & command->bit) == 0) {
            continue;
        }
        if (equal) {
            return o;
        }
        if (strlen(name) > 3 && far < least) {
            least = far;
            strcpy(nearest, candidate);
        }
    }
    if (elsewhere) {
        complain("%s has no option %s", command->name, name);
    } else {
        complain("unknown option %s%s%s%s", name, nearest[0] ? ", did you mean " : "", nearest,
                 nearest[0] ? "?" : "");
    }
    return NULL;
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
    Arguments a = {
        .command = findCommand(command), .failure = EXIT_USAGE, .frames = {0, -1}, .ppd = VPL_DEFAULT_PPD};
    a.render = vplDefaultRenderOptions();
    a.context = vplDefaultContextDef();
    for (const Option* o = getOptions(); o->name != NULL; o++) {
        if (o->default_ != NULL && (o->commands & a.command->bit) != 0) {
            o->read(o, o->default_, &a);
        }
    }
    if (a.command->bit == TRADEOFF) {
        setOptions(&a.render, TRADEOFF_BASE);
    }
    a.render.method = a.command->bit == BAKE ? VPL_METHOD_RADIOSITY : a.render.method;
    return a;
}

// Reads the option at word *i, and its value if that is the next word. Presets and plans are read before all
// others, so that options beside one change it wherever they stand.
static bool readOption(Arguments* a, int* i, bool presets)
{
    const char* word = a->words[*i];
    const Option* o = findOption(a->command, word);
    if (o == NULL) {
        return false;
    }
    const char* equals = word[1] == '-' ? strchr(word, '=') : NULL;
    if (o->value == NULL && equals != NULL) {
        complain("--%s takes no value", o->name);
        return false;
    }
    const bool sets = strcmp(o->name, "preset") == 0 || strcmp(o->name, "plan") == 0;
    const bool now = sets == presets;
    if (o->value == NULL || equals != NULL) {
        return !now || o->read(o, equals != NULL ? equals + 1 : NULL, a);
    }
    if (*i + 1 >= a->wordCount || strncmp(a->words[*i + 1], "--", 2) == 0) { // a file so named: --name=--file
        complain("%s%s needs a value: %s", dashesOf(o), o->name, o->value);
        return false;
    }
    *i += 1;
    return !now || o->read(o, a->words[*i], a);
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

bool parseArguments(int count, const char* const* words, Arguments* a)
{
    *a = defaultArguments(words[1]);
    a->words = words;
    a->wordCount = count;
    for (int i = 2; i < count; i++) {
        if (words[i][0] == '-' && words[i][1] != 0 && !readOption(a, &i, true)) {
            return false;
        }
    }
    for (int i = 2; i < count; i++) {
        if (words[i][0] == '-' && words[i][1] != 0) {
            if (!readOption(a, &i, false)) {
                return false;
            }
        } else if (a->positionalCount == a->command->positionals) {
            complain("%s: one word too many: \"%s\"", a->command->name, words[i]);
            return false;
        } else {
            a->positionals[a->positionalCount++] = words[i];
        }
    }
    if (a->output != NULL && strcmp(a->output, "-") == 0 && a->command->bit == RENDER) {
        a->output = "-.png";
    }
    if (a->positionalCount > 0 && strcmp(a->positionals[0], "-") == 0) {
        a->positionals[0] = "/dev/stdin";
    }
    if (a->environment != NULL && a->sky != NULL) {
        complain("--environment and --sky are both given, must be one of them");
        return false;
    }
    warnOfUnused(a);
    if (a->noGround && !a->quiet && a->positionalCount > 0 && !vplIsModelPath(a->positionals[0])) {
        complain(
            "warning: --no-ground has no effect with %s, only with a model (.obj, .ply, .stl, .gltf, .glb)",
            a->positionals[0]);
    }
    return true;
}

bool setOptions(vplRenderOptions* options, const char* words)
{
    if (vplRenderOptions_SetAll(options, words) != VPL_SUCCESS) {
        complain("--%s", options->problem);
        return false;
    }
    return true;
}
