// SPDX-License-Identifier: MIT
// One table describes every option: how it is read, its range, its help and the commands that take it.
#include "cli/cli.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RENDER = 1, LIGHTS = 2, COMPARE = 4, INFO = 8, BENCH = 16, SCENE = RENDER | LIGHTS | INFO };

typedef struct Option Option;
typedef bool ReadFcn(const Option* option, const char* value, Arguments* arguments);

struct Option {
    const char* name;
    const char* value; // shown in the help; NULL for a flag
    int commands;
    ReadFcn* read;
    size_t offset;
    double low, high;    // numbers
    const char* choices; // "a|b|c", in the order of the enum
    const char* help;
};

static bool isPast(const char* value, const char* end)
{
    return end == value || *end != 0;
}

static bool readInt(const Option* o, const char* value, Arguments* a)
{
    char* end;
    errno = 0;
    long long number = strtoll(value, &end, 10);
    if (isPast(value, end) || errno == ERANGE || (double)number < o->low || (double)number > o->high) {
        complain("%s is \"%s\", must be a whole number in [%.0f, %.0f]", o->name, value, o->low, o->high);
        return false;
    }
    int stored = (int)number;
    memcpy((char*)a + o->offset, &stored, sizeof stored);
    return true;
}

static bool readSeed(const Option* o, const char* value, Arguments* a)
{
    char* end;
    errno = 0;
    unsigned long long number = strtoull(value, &end, 10);
    if (isPast(value, end) || errno == ERANGE || strchr(value, '-') != NULL) {
        complain("%s is \"%s\", must be a whole number in [0, 2^64)", o->name, value);
        return false;
    }
    a->render.seed = number;
    return true;
}

static bool parseNumber(const Option* o, const char* value, const char* also, double* number)
{
    char* end;
    *number = strtod(value, &end);
    if (isPast(value, end) || !(*number >= o->low && *number <= o->high)) {
        complain("%s is \"%s\", must be a number in [%g, %g]%s", o->name, value, o->low, o->high, also);
        return false;
    }
    return true;
}

static bool readFloat(const Option* o, const char* value, Arguments* a)
{
    double number;
    if (!parseNumber(o, value, "", &number)) {
        return false;
    }
    float stored = (float)number;
    memcpy((char*)a + o->offset, &stored, sizeof stored);
    return true;
}

static bool readDouble(const Option* o, const char* value, Arguments* a)
{
    double number;
    if (!parseNumber(o, value, "", &number)) {
        return false;
    }
    memcpy((char*)a + o->offset, &number, sizeof number);
    return true;
}

// A float, or "auto" for -1.
static bool readFloatOrAuto(const Option* o, const char* value, Arguments* a)
{
    double number = -1;
    if (strcmp(value, "auto") != 0 && !parseNumber(o, value, " or auto", &number)) {
        return false;
    }
    float stored = (float)number;
    memcpy((char*)a + o->offset, &stored, sizeof stored);
    return true;
}

static bool readReflectivity(const Option* o, const char* value, Arguments* a)
{
    double number = -1;
    if (strcmp(value, "auto") != 0 && (!parseNumber(o, value, " or auto", &number) || number >= 1)) {
        if (number >= 1) {
            complain("%s is \"%s\", must be less than 1: with 1 no particle would ever stop", o->name, value);
        }
        return false;
    }
    a->render.reflectivity = number;
    return true;
}

static bool readBias(const Option* o, const char* value, Arguments* a)
{
    if (strcmp(value, "exact") == 0) {
        a->render.shadow.biasRule = VPL_BIAS_EXACT;
        return true;
    }
    if (strcmp(value, "auto") == 0) {
        return true;
    }
    double number;
    if (!parseNumber(o, value, ", auto or exact", &number)) {
        return false;
    }
    a->render.shadow.biasRule = VPL_BIAS_PAIR;
    a->render.shadow.biasStatic = (float)number;
    return true;
}

static bool readBiasSlope(const Option* o, const char* value, Arguments* a)
{
    double number;
    if (!parseNumber(o, value, "", &number)) {
        return false;
    }
    a->render.shadow.biasRule = VPL_BIAS_PAIR;
    a->render.shadow.biasDynamic = (float)number;
    return true;
}

static bool readFlag(const Option* o, const char* value, Arguments* a)
{
    (void)value;
    bool on = true;
    memcpy((char*)a + o->offset, &on, sizeof on);
    return true;
}

static bool readText(const Option* o, const char* value, Arguments* a)
{
    if (*value == 0) {
        complain("%s is empty, must be %s", o->name, o->value);
        return false;
    }
    memcpy((char*)a + o->offset, &value, sizeof value);
    return true;
}

// Position of `value` in "a|b|c", or -1.
static int findChoice(const char* choices, const char* value)
{
    size_t length = strlen(value);
    for (int i = 0; choices != NULL; i++) {
        if (strncmp(choices, value, length) == 0 && (choices[length] == '|' || choices[length] == 0)) {
            return length ? i : -1;
        }
        choices = strchr(choices, '|');
        choices = choices ? choices + 1 : NULL;
    }
    return -1;
}

static bool readChoice(const Option* o, const char* value, Arguments* a)
{
    int choice = findChoice(o->choices, value);
    if (choice < 0) {
        complain("%s is \"%s\", must be one of %s", o->name, value, o->choices);
        return false;
    }
    memcpy((char*)a + o->offset, &choice, sizeof choice); // enums are ints
    return true;
}

static bool readShow(const Option* o, const char* value, Arguments* a)
{
    int choice = findChoice(o->choices, value);
    if (strncmp(value, "light:", 6) == 0) {
        char* end;
        errno = 0;
        long index = strtol(value + 6, &end, 10);
        if (isPast(value + 6, end) || errno == ERANGE || index < 0 || index > VPL_MAX_LIGHTS) {
            complain("%s is \"%s\", must be light: and the index of a virtual light, from 0", o->name, value);
            return false;
        }
        a->render.showLight = (int)index;
        choice = VPL_SHOW_LIGHT;
    } else if (choice == VPL_SHOW_LIGHT) {
        choice = -1; // "light:K" itself
    }
    if (choice < 0) {
        complain("%s is \"%s\", must be one of %s", o->name, value, o->choices);
        return false;
    }
    a->render.show = (vplShow)choice;
    return true;
}

static bool readSize(const Option* o, const char* value, Arguments* a)
{
    char* end;
    errno = 0;
    long width = strtol(value, &end, 10), height = 0;
    bool good = end != value && *end == 'x';
    if (good) {
        char* start = end + 1;
        height = strtol(start, &end, 10);
        good = !isPast(start, end) && errno == 0;
    }
    if (!good || width < 1 || width > VPL_MAX_IMAGE_SIZE || height < 1 || height > VPL_MAX_IMAGE_SIZE) {
        complain("%s is \"%s\", must be WIDTHxHEIGHT, each in [1, %d]", o->name, value, VPL_MAX_IMAGE_SIZE);
        return false;
    }
    a->render.width = (int)width;
    a->render.height = (int)height;
    a->sizeGiven = true;
    return true;
}

// One thread count, or for bench several: 1,2,4.
static bool readThreads(const Option* o, const char* value, Arguments* a)
{
    bool several = strcmp(a->command, "bench") == 0;
    const char* at = value;
    a->threadsCount = 0;
    for (;;) {
        char* end;
        long number = strtol(at, &end, 10);
        if (end == at || number < 0 || number > VPL_MAX_WORKERS || (*end != 0 && (*end != ',' || !several)) ||
            a->threadsCount == MAX_THREAD_COUNTS) {
            complain("%s is \"%s\", must be %s in [0, %d]", o->name, value,
                     several ? "whole numbers with commas between," : "a whole number", VPL_MAX_WORKERS);
            return false;
        }
        a->threads[a->threadsCount++] = (int)number;
        a->context.workerCount = (int)number;
        if (*end == 0) {
            return true;
        }
        at = end + 1;
    }
}

#define AT(field) offsetof(Arguments, field)

static const Option OPTIONS[] = {
    {"-o", "FILE", RENDER, readText, AT(output), 0, 0, NULL,
     "picture to write: .png, .hdr or .pfm (required)"},
    {"--size", "WxH", RENDER | INFO | BENCH, readSize, 0, 0, 0, NULL, "pixels; default 1280x720"},
    {"--camera", "I", RENDER, readInt, AT(render.camera), 0, 1e9, NULL,
     "index of the scene's camera; default 0"},
    {"--method", "M", SCENE, readChoice, AT(render.method), 0, 0, "instant-radiosity|direct",
     "instant-radiosity (default) or direct"},
    {"--lighting", "L", SCENE, readChoice, AT(render.lighting), 0, 0, "physical|documented",
     "physical (default) or documented: the formulas as printed"},
    {"--particles", "N", SCENE, readInt, AT(render.particles), 0, VPL_MAX_LIGHTS, NULL,
     "particles shot from the light; default 10"},
    {"--reflectivity", "R", SCENE, readReflectivity, 0, 0, 1, NULL,
     "share of particles that go on at each step, [0, 1), or auto: the scene's mean; default 0.5"},
    {"--sampler", "S", SCENE, readChoice, AT(render.sampler), 0, 0, "random|halton|hammersley",
     "random (default), halton or hammersley"},
    {"--bounce", "B", SCENE, readChoice, AT(render.bounce), 0, 0, "auto|reflect|diffuse",
     "auto (default): reflect for documented lighting, diffuse for physical"},
    {"--seed", "S", SCENE, readSeed, 0, 0, 0, NULL, "of all random numbers; default 0"},
    {"--pipeline", "P", RENDER | INFO, readChoice, AT(render.accumulation), 0, 0,
     "multipass|batched|deferred",
     "multipass, batched or deferred (default): how virtual lights are added; the same bits"},
    {"--batch", "M", RENDER | INFO, readInt, AT(render.batch), 1, VPL_MAX_LIGHTS, NULL,
     "virtual lights per pass of --pipeline batched; default 64"},
    {"--min-distance", "D", RENDER, readFloatOrAuto, AT(render.minDistance), 0, 1e15, NULL,
     "metres: cos cos / d^2 is bounded as cos cos / max(d^2, D^2); 0: unbounded; default auto"},
    {"--shadow-map", "N", RENDER | INFO, readInt, AT(render.shadowMapSize), 1, VPL_MAX_SHADOW_MAP, NULL,
     "texels along a face of the cube shadow map; default 1024"},
    {"--bias", "B", RENDER, readBias, 0, 0, 1e15, NULL,
     "static bias in metres, auto (default) or exact: what a plane needs at its angle"},
    {"--bias-slope", "B", RENDER, readBiasSlope, 0, 0, 1e15, NULL, "largest dynamic bias in metres"},
    {"--pcf", "S", RENDER, readInt, AT(render.shadow.pcfSamples), 1, VPL_MAX_PCF_SAMPLES, NULL,
     "shadow map samples per pixel; 1 gives hard shadows; default 16"},
    {"--pcf-offset", "O", RENDER, readFloatOrAuto, AT(render.shadow.pcfOffset), 0, 1e15, NULL,
     "radius of the disc of samples in metres, or auto (default)"},
    {"--show", "WHAT", RENDER, readShow, 0, 0, 0,
     "picture|depth|normals|shadow-map|shadow-factor|direct|indirect|light:K|overlay",
     "picture (default), depth, normals, shadow-map, shadow-factor, direct, indirect, light:K (K as in vpl "
     "lights), overlay"},
    {"--exposure", "EV", RENDER, readFloat, AT(write.exposure), -64, 64, NULL,
     "stops, PNG only: pixels times 2^EV; default 0"},
    {"--tonemap", "T", RENDER, readChoice, AT(write.tonemap), 0, 0, "none|reinhard",
     "none (default) or reinhard, PNG only"},
    {"--stats", "FILE", RENDER, readText, AT(stats), 0, 0, NULL, "write statistics as JSON"},
    {"--heatmap", "FILE", COMPARE, readText, AT(heatmap), 0, 0, NULL, "write a picture of the differences"},
    {"--heat-scale", "X", COMPARE, readDouble, AT(heatScale), 0, 1e30, NULL,
     "difference shown as white; default: the largest"},
    {"--json", NULL, COMPARE | BENCH | INFO, readFlag, AT(json), 0, 0, NULL, "print JSON"},
    {"--runs", "N", BENCH, readInt, AT(runs), 1, 1000, NULL,
     "runs of which the median is printed; default 5"},
    {"--threads", "T", RENDER | LIGHTS | BENCH, readThreads, 0, 0, 0, NULL,
     "worker threads, 0 (default): one per processor; bench takes several: 1,2"},
    {"--isa", "I", RENDER | LIGHTS | BENCH, readChoice, AT(context.isa), 0, 0, "auto|scalar|sse2|avx2|avx512",
     "auto (default), scalar, sse2, avx2, avx512: the same bits"},
    {"--quiet", NULL, ~0, readFlag, AT(quiet), 0, 0, NULL, "no progress bar, no warnings"},
    {"-v", NULL, ~0, readFlag, AT(verbose), 0, 0, NULL, "say more"},
    {"--help", NULL, ~0, readFlag, AT(help), 0, 0, NULL, "print this"},
};

enum { OPTION_COUNT = sizeof OPTIONS / sizeof *OPTIONS };

static int commandBit(const char* command)
{
    static const char* const names[] = {"render", "lights", "compare", "info", "bench"};
    for (int i = 0; i < 5; i++) {
        if (strcmp(names[i], command) == 0) {
            return 1 << i;
        }
    }
    return 0;
}

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
    const Option* nearest = NULL;
    int bit = commandBit(command), least = 3;
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)length, word);
    for (int i = 0; i < OPTION_COUNT; i++) {
        const Option* o = &OPTIONS[i];
        bool equal = strcmp(o->name, name) == 0;
        if (equal && (o->commands & bit) == 0) {
            complain("%s has no option %s", command, name);
            return NULL;
        }
        if (equal) {
            return o;
        }
        bool begun = strncmp(name, o->name, strlen(name)) == 0; // "--reflect" for "--reflectivity"
        int far = begun ? 1 : distance(name, o->name);
        if ((o->commands & bit) != 0 && strlen(name) > 3 && far < least) {
            least = far;
            nearest = o;
        }
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
    a.runs = 5;
    return a;
}

bool parseArguments(int count, char** words, Arguments* arguments)
{
    Arguments a = defaultArguments(words[1]);
    int bit = commandBit(words[1]);
    int most = bit == COMPARE ? 2 : bit == BENCH ? 0 : 1;
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
