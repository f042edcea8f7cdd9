// SPDX-License-Identifier: MIT
// Options back to words: the inverse of option_read.c, so that a report can print a command to copy.
#include "cli/option.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The shortest decimal that is read back as the same float.
static void writeFloat(float value, char* text, size_t size)
{
    for (int digits = 6; digits <= 9; digits++) {
        snprintf(text, size, "%.*g", digits, (double)value);
        if (strtof(text, NULL) == value) {
            return;
        }
    }
}

static void writeDouble(double value, char* text, size_t size)
{
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, size, "%.*g", digits, value);
        if (strtod(text, NULL) == value) {
            return;
        }
    }
}

static void writeChoice(const char* choices, int index, char* text, size_t size)
{
    for (; index > 0; index--) {
        choices = strchr(choices, '|') + 1;
    }
    snprintf(text, size, "%.*s", (int)strcspn(choices, "|"), choices);
}

// --bias and --bias-slope share a rule; what cannot be written is at its default.
static void writeBias(const vplShadowDef* shadow, bool slope, char* text, size_t size)
{
    float value = slope ? shadow->biasDynamic : shadow->biasStatic;
    if (shadow->biasRule == VPL_BIAS_PAIR && value >= 0) {
        writeFloat(value, text, size);
    } else {
        snprintf(text, size, "%s", !slope && shadow->biasRule == VPL_BIAS_EXACT ? "exact" : "");
    }
}

bool writeOption(const Option* o, const Arguments* a, char* text, size_t size)
{
    const char* field = (const char*)a + o->offset;
    int whole;
    float single;
    double wide;
    memcpy(&whole, field, sizeof whole);
    memcpy(&single, field, sizeof single);
    memcpy(&wide, field, sizeof wide);
    text[0] = 0;
    if (o->read == readSize) {
        snprintf(text, size, "%dx%d", a->render.output.width, a->render.output.height);
    } else if (o->read == readSeed) {
        snprintf(text, size, "%llu", (unsigned long long)a->render.seed);
    } else if (o->read == readReflectivity && a->render.particles.reflectivity < 0) {
        snprintf(text, size, "auto");
    } else if (o->read == readReflectivity) {
        writeDouble(a->render.particles.reflectivity, text, size);
    } else if (o->read == readBias || o->read == readBiasSlope) {
        writeBias(&a->render.shadow, o->read == readBiasSlope, text, size);
    } else if (o->offset < offsetof(Arguments, render) ||
               o->offset >= offsetof(Arguments, render) + sizeof a->render) {
        return false; // not of the picture
    } else if (o->read == readInt) {
        snprintf(text, size, "%d", whole);
    } else if (o->read == readDouble) {
        writeDouble(wide, text, size);
    } else if (o->read == readChoice) {
        writeChoice(o->choices, whole, text, size);
    } else if (o->read == readFloatOrAuto && single < 0) {
        snprintf(text, size, "auto");
    } else if (o->read == readFloat || o->read == readFloatOrAuto) {
        writeFloat(single, text, size);
    } else {
        return false;
    }
    return true;
}

void writeNamedOption(const char* name, const Arguments* a, char* text, size_t size)
{
    text[0] = 0;
    for (int i = 0; i < OPTION_COUNT; i++) {
        if (strcmp(OPTIONS[i].name, name) == 0) {
            writeOption(&OPTIONS[i], a, text, size);
        }
    }
}
