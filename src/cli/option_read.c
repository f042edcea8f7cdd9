// SPDX-License-Identifier: MIT
// One function per kind of value.
#include "cli/option.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static bool isPast(const char* value, const char* end)
{
    return end == value || *end != 0;
}

bool readInt(const Option* o, const char* value, Arguments* a)
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

bool readSeed(const Option* o, const char* value, Arguments* a)
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

bool readFloat(const Option* o, const char* value, Arguments* a)
{
    double number;
    if (!parseNumber(o, value, "", &number)) {
        return false;
    }
    float stored = (float)number;
    memcpy((char*)a + o->offset, &stored, sizeof stored);
    return true;
}

bool readDouble(const Option* o, const char* value, Arguments* a)
{
    double number;
    if (!parseNumber(o, value, "", &number)) {
        return false;
    }
    memcpy((char*)a + o->offset, &number, sizeof number);
    return true;
}

// A float, or "auto" for -1.
bool readFloatOrAuto(const Option* o, const char* value, Arguments* a)
{
    double number = -1;
    if (strcmp(value, "auto") != 0 && !parseNumber(o, value, " or auto", &number)) {
        return false;
    }
    float stored = (float)number;
    memcpy((char*)a + o->offset, &stored, sizeof stored);
    return true;
}

bool readReflectivity(const Option* o, const char* value, Arguments* a)
{
    double number = -1;
    if (strcmp(value, "auto") != 0 && (!parseNumber(o, value, " or auto", &number) || number >= 1)) {
        if (number >= 1) {
            complain("%s is \"%s\", must be less than 1: with 1 no particle would ever stop", o->name, value);
        }
        return false;
    }
    a->render.particles.reflectivity = number;
    return true;
}

bool readBias(const Option* o, const char* value, Arguments* a)
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

bool readBiasSlope(const Option* o, const char* value, Arguments* a)
{
    double number;
    if (!parseNumber(o, value, "", &number)) {
        return false;
    }
    a->render.shadow.biasRule = VPL_BIAS_PAIR;
    a->render.shadow.biasDynamic = (float)number;
    return true;
}

bool readFlag(const Option* o, const char* value, Arguments* a)
{
    (void)value;
    bool on = true;
    memcpy((char*)a + o->offset, &on, sizeof on);
    return true;
}

bool readText(const Option* o, const char* value, Arguments* a)
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

bool readChoice(const Option* o, const char* value, Arguments* a)
{
    int choice = findChoice(o->choices, value);
    if (choice < 0) {
        complain("%s is \"%s\", must be one of %s", o->name, value, o->choices);
        return false;
    }
    memcpy((char*)a + o->offset, &choice, sizeof choice); // enums are ints
    return true;
}

bool readTonemap(const Option* o, const char* value, Arguments* a)
{
    a->tonemapGiven = readChoice(o, value, a);
    return a->tonemapGiven;
}

// The K of "light:K": >= 0 and at most `most`, else -1.
static int readIndex(const char* value, const char* prefix, long most)
{
    size_t length = strlen(prefix);
    char* end;
    errno = 0;
    long index = strtol(value + length, &end, 10);
    return isPast(value + length, end) || errno == ERANGE || index < 0 || index > most ? -1 : (int)index;
}

bool readShow(const Option* o, const char* value, Arguments* a)
{
    static const struct {
        const char *prefix, *of;
        vplShow show;
        long most;
        size_t offset;
    } indexed[] = {
        {"light:", "a virtual light", VPL_SHOW_LIGHT, VPL_MAX_LIGHTS, offsetof(Arguments, render.output.showIndex)},
        {"bounce:", "a bounce", VPL_SHOW_BOUNCE, VPL_MAX_BOUNCES, offsetof(Arguments, render.output.showIndex)},
        {"paraboloid:", "a cluster", VPL_SHOW_PARABOLOID, VPL_MAX_LIGHTS,
         offsetof(Arguments, render.output.showIndex)},
    };
    for (size_t i = 0; i < sizeof indexed / sizeof *indexed; i++) {
        if (strncmp(value, indexed[i].prefix, strlen(indexed[i].prefix)) == 0) {
            int index = readIndex(value, indexed[i].prefix, indexed[i].most);
            if (index < 0) {
                complain("%s is \"%s\", must be %s and the index of %s, from 0", o->name, value,
                         indexed[i].prefix, indexed[i].of);
                return false;
            }
            memcpy((char*)a + indexed[i].offset, &index, sizeof index);
            a->render.output.show = indexed[i].show;
            return true;
        }
    }
    int choice = findChoice(o->choices, value);
    if (choice < 0) {
        complain("%s is \"%s\", must be one of %s", o->name, value, o->choices);
        return false;
    }
    a->render.output.show = (vplShow)choice;
    return true;
}

// "AxB", both in [1, VPL_MAX_IMAGE_SIZE].
static bool parsePair(const char* value, int* first, int* second)
{
    char* end;
    errno = 0;
    long a = strtol(value, &end, 10), b = 0;
    bool good = end != value && *end == 'x';
    if (good) {
        char* start = end + 1;
        b = strtol(start, &end, 10);
        good = !isPast(start, end) && errno == 0;
    }
    if (!good || a < 1 || a > VPL_MAX_IMAGE_SIZE || b < 1 || b > VPL_MAX_IMAGE_SIZE) {
        return false;
    }
    *first = (int)a;
    *second = (int)b;
    return true;
}

bool readSize(const Option* o, const char* value, Arguments* a)
{
    if (!parsePair(value, &a->render.output.width, &a->render.output.height)) {
        complain("%s is \"%s\", must be WIDTHxHEIGHT, each in [1, %d]", o->name, value, VPL_MAX_IMAGE_SIZE);
        return false;
    }
    a->sizeGiven = true;
    return true;
}

bool readGrid(const Option* o, const char* value, Arguments* a)
{
    if (!parsePair(value, &a->columns, &a->rows)) {
        complain("%s is \"%s\", must be COLUMNSxROWS, each in [1, %d]", o->name, value, VPL_MAX_IMAGE_SIZE);
        return false;
    }
    return true;
}

// Whether it lies inside the pictures is asked when they are there.
bool readRegion(const Option* o, const char* value, Arguments* a)
{
    const char* at = value;
    for (int i = 0; i < 4; i++) {
        char* end;
        errno = 0;
        long number = strtol(at, &end, 10);
        bool good = end != at && errno == 0 && *end == (i < 3 ? ',' : 0) && number >= i / 2;
        if (!good || number > VPL_MAX_IMAGE_SIZE) {
            complain("%s is \"%s\", must be X,Y,WIDTH,HEIGHT in pixels, X and Y from 0", o->name, value);
            return false;
        }
        a->region[i] = (int)number;
        at = end + 1;
    }
    return true;
}

bool readFrames(const Option* o, const char* value, Arguments* a)
{
    long numbers[2] = {-1, -1};
    const char* at = value;
    for (int i = 0; i < 2; i++) {
        char* end;
        errno = 0;
        numbers[i] = *at >= '0' && *at <= '9' ? strtol(at, &end, 10) : -1;
        if (numbers[i] < 0 || errno != 0 || numbers[i] > VPL_MAX_FRAME || *end != (i ? 0 : ':')) {
            complain("%s is \"%s\", must be FIRST:LAST, two numbers in [0, %d]", o->name, value,
                     VPL_MAX_FRAME);
            return false;
        }
        at = end + 1;
    }
    if (numbers[0] > numbers[1] || numbers[1] - numbers[0] >= MAX_FRAMES) {
        complain("%s is \"%s\", must be 1 to %d frames", o->name, value, MAX_FRAMES);
        return false;
    }
    a->frames[0] = (int)numbers[0];
    a->frames[1] = (int)numbers[1];
    return true;
}

// One thread count, or for bench several: 1,2,4.
bool readThreads(const Option* o, const char* value, Arguments* a)
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
