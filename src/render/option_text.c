// SPDX-License-Identifier: MIT
// Options as text: vplRenderOptions_Set and its inverse.
#include "base/arena.h"
#include "base/numbers.h"
#include "render/options.h"
#include "render/planner/planner.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A value to set, and the options that receive it or the reason why it is refused.
typedef struct Setting {
    vplRenderOptions* options;
    const vplOption* option;
    const char* value;
} Setting;

__attribute__((format(printf, 2, 3))) static vplResult refuse(const Setting* s, const char* format, ...)
{
    char* problem = s->options->problem;
    const size_t size = sizeof s->options->problem;
    const int length = snprintf(problem, size, "%s is \"%.60s\", must be ", s->option->name, s->value);
    va_list arguments;
    va_start(arguments, format);
    vplFormatList(problem + length, size - (size_t)length, format, arguments);
    va_end(arguments);
    return VPL_INVALID_ARGUMENT;
}

static void store(const Setting* s, const void* value, size_t size)
{
    memcpy((char*)s->options + s->option->offset, value, size);
}

// True if strtol or strtod stopped before the end, or skipped blanks at the beginning.
static bool isPast(const char* value, const char* end)
{
    return end == value || *end != 0 || *value == ' ' || (*value >= '\t' && *value <= '\r');
}

// ---- numbers

static vplResult setInt(const Setting* s)
{
    const bool automatic = s->option->kind == VPL_OPTION_INT_AUTO;
    char* end;
    errno = 0;
    const long long number = strtoll(s->value, &end, 10);
    const bool outside = (double)number < s->option->low || (double)number > s->option->high;
    if (automatic && strcmp(s->value, "auto") == 0) {
        store(s, &(int){-1}, sizeof(int));
        return VPL_SUCCESS;
    }
    if (isPast(s->value, end) || errno == ERANGE || outside) {
        return refuse(s, "a whole number in [%.0f, %.0f]%s", s->option->low, s->option->high,
                      automatic ? " or auto" : "");
    }
    store(s, &(int){(int)number}, sizeof(int));
    return VPL_SUCCESS;
}

static vplResult setSeed(const Setting* s)
{
    char* end;
    errno = 0;
    const unsigned long long number = strtoull(s->value, &end, 10);
    const uint64_t stored = number;
    if (isPast(s->value, end) || errno == ERANGE || strchr(s->value, '-') != NULL) {
        return refuse(s, "a whole number in [0, 2^64)");
    }
    store(s, &stored, sizeof stored);
    return VPL_SUCCESS;
}

static vplResult setReal(const Setting* s)
{
    const vplOption* o = s->option;
    const bool below = o->kind == VPL_OPTION_BELOW_AUTO, bias = o->kind == VPL_OPTION_BIAS;
    const bool automatic = below || bias || o->kind == VPL_OPTION_FLOAT_AUTO;
    char* end;
    double number = vplParseDouble(s->value, &end);
    if (automatic && strcmp(s->value, "auto") == 0) {
        number = -1;
    } else if (below && strcmp(s->value, "usual") == 0) {
        number = -2;
    } else if (bias && strcmp(s->value, "exact") == 0) {
        number = (double)VPL_BIAS_OPTION_EXACT;
    } else if (isPast(s->value, end) || !(number >= o->low && number <= o->high)) {
        return refuse(s, "a number in [%g, %g%s%s", o->low, o->high, below ? ")" : "]",
                      bias        ? ", auto or exact"
                      : below     ? ", auto or usual"
                      : automatic ? " or auto"
                                  : "");
    } else if (below && number >= o->high) {
        return refuse(s, "less than %g: with %g no particle would ever stop", o->high, o->high);
    }
    const float single = (float)number;
    const bool wide = below || o->kind == VPL_OPTION_DOUBLE;
    store(s, wide ? (const void*)&number : &single, wide ? sizeof number : sizeof single);
    return VPL_SUCCESS;
}

static vplResult setSize(const Setting* s)
{
    int size[2], length = 0;
    const bool read = strspn(s->value, "0123456789x") == strlen(s->value) && strlen(s->value) < 16 &&
                      sscanf(s->value, "%9dx%9d%n", &size[0], &size[1], &length) == 2 &&
                      s->value[length] == 0;
    for (int i = 0; i < 2; i++) {
        if (!read || size[i] < s->option->low || size[i] > s->option->high) {
            return refuse(s, "WIDTHxHEIGHT, each in [1, %d]", VPL_MAX_IMAGE_SIZE);
        }
    }
    store(s, size, sizeof size); // width and height follow each other
    return VPL_SUCCESS;
}

// ---- choices

// The number of the choice in "a|b|c:K" that `value` names, or -1. A choice that ends with ":K" takes an
// index, whose text is stored in *indexOut; else it is NULL.
static int findChoice(const char* choices, const char* value, const char** indexOut)
{
    for (int i = 0;; i++) {
        const size_t length = strcspn(choices, "|");
        const char* colon = memchr(choices, ':', length);
        const size_t fixed = colon != NULL ? (size_t)(colon - choices) + 1 : length;
        *indexOut = colon != NULL ? value + fixed : NULL;
        if (strncmp(choices, value, fixed) == 0 && (colon != NULL || value[fixed] == 0)) {
            return i;
        }
        if (choices[length] == 0) {
            return -1;
        }
        choices += length + 1;
    }
}

static vplResult setChoice(const Setting* s)
{
    const char* indexText;
    const int choice = findChoice(s->option->value, s->value, &indexText);
    if (choice < 0) {
        return refuse(s, "one of %s", s->option->value);
    }
    if (indexText != NULL) {
        char* end;
        errno = 0;
        const long index = strtol(indexText, &end, 10);
        const long most = choice == VPL_SHOW_BOUNCE ? VPL_MAX_BOUNCES : VPL_MAX_LIGHTS;
        if (isPast(indexText, end) || errno == ERANGE || index < 0 || index > most) {
            return refuse(s, "%.*s and an index in [0, %ld]", (int)(indexText - s->value), s->value, most);
        }
        s->options->output.showIndex = (int)index;
    }
    store(s, &choice, sizeof choice);
    return VPL_SUCCESS;
}

// Words of the choices with commas between. The first stands for no bits, the last for all.
static vplResult setBits(const Setting* s)
{
    const int all = (int)s->option->high;
    int stored = 0;
    for (const char* at = s->value;; at++) {
        char word[32];
        const char* index;
        const size_t length = strcspn(at, ",");
        snprintf(word, sizeof word, "%.*s", (int)length, at);
        const int choice = findChoice(s->option->value, word, &index);
        if (choice < 0) {
            return refuse(s, "one or more of %s with commas between", s->option->value);
        }
        stored |= choice == 0 ? 0 : 1 << (choice - 1) > all ? all : 1 << (choice - 1);
        at += length;
        if (*at == 0) {
            store(s, &stored, sizeof stored);
            return VPL_SUCCESS;
        }
    }
}

// ---- presets

// The numbers that the documents print. Of Keller's only the rules are given; the number of particles is that
// of the simulation which Franchi and Ferrante show. Bias, PCF and the numbers of SSVP's lights are not
// printed: they stay as they are.
static const char* const PRESETS[] = {
    "", // none
    "--method instant-radiosity --lighting documented --particles 10 --reflectivity 0.5 --sampler random"
    " --bounce reflect --placement particles --pipeline multipass --light-shadows none --min-distance 0"
    " --antialias 1",
    "--method keller --lighting documented --particles 10 --reflectivity auto --sampler halton"
    " --bounce diffuse --placement particles --pipeline multipass --light-shadows map --compensation none"
    " --min-distance 0 --antialias 1",
    "--method radiosity --patches 784 --form-factors incentre --row-sums keep --hierarchy off --patch-light 1"
    " --patch-cuts off"
    " --solver gauss-seidel --iterations 100 --residual 0 --interpolation gouraud --vertex-weight equal"
    " --sharpen 0 --antialias 1",
    "--method ssvp --clusters 8 --max-clusters 8 --oversampling 1 --w1 0.6 --w2 0.4 --cluster-metric printed"
    " --cluster-place mean --next-bounce maps --second-weight printed --paraboloid 128"
    " --pipeline interleaved --interleave 4"
    " --light-shadows cluster --max-bounces 2 --antialias 1"};

static vplResult setPreset(const Setting* s)
{
    TRY(setChoice(s));
    return vplRenderOptions_SetAll(s->options, PRESETS[s->options->preset]);
}

vplResult vplRenderOptions_SetAll(vplRenderOptions* options, const char* words)
{
    char name[64], value[64];
    int length;
    REQUIRE(NULL, options, words);
    for (; sscanf(words, " --%63s %63s%n", name, value, &length) == 2; words += length) {
        TRY(vplRenderOptions_Set(options, name, value));
    }
    return VPL_SUCCESS;
}

vplResult vplRenderOptions_Set(vplRenderOptions* options, const char* name, const char* value)
{
    REQUIRE(NULL, options);
    options->problem[0] = 0;
    if (name == NULL || value == NULL) {
        snprintf(options->problem, sizeof options->problem, "%s is NULL", name == NULL ? "name" : "value");
        return VPL_INVALID_ARGUMENT;
    }
    const Setting s = {options, vplFindOption(name), value};
    if (s.option == NULL || s.option->kind == VPL_OPTION_PART) {
        snprintf(options->problem, sizeof options->problem, "there is no option \"%.60s\"", name);
        return VPL_INVALID_ARGUMENT;
    }
    switch (s.option->kind) {
    case VPL_OPTION_INT:
    case VPL_OPTION_INT_AUTO:
        return setInt(&s);
    case VPL_OPTION_PRESET:
        return setPreset(&s);
    case VPL_OPTION_SEED:
        return setSeed(&s);
    case VPL_OPTION_SIZE:
        return setSize(&s);
    case VPL_OPTION_CHOICE:
    case VPL_OPTION_SHOW:
        return setChoice(&s);
    case VPL_OPTION_SET:
        return setBits(&s);
    default:
        return setReal(&s);
    }
}

// ---- the inverse

// The shortest decimal that is read back as the same number.
static void writeNumber(double value, bool single, char text[32])
{
    for (int digits = 6; digits <= 17; digits++) {
        vplFormat(text, 32, "%.*g", digits, value);
        if (single ? vplParseFloat(text, NULL) == (float)value : vplParseDouble(text, NULL) == value) {
            return;
        }
    }
}

static void writeChoice(const vplOption* option, const vplRenderOptions* o, char text[64])
{
    const char* at = option->value;
    for (int i = (int)vplOption_GetNumber(option, o); i > 0; i--) {
        at = strchr(at, '|') + 1;
    }
    const int length = (int)strcspn(at, ":|");
    snprintf(text, 64, at[length] == ':' ? "%.*s:%d" : "%.*s", length, at, o->output.showIndex);
}

static void writeBits(const vplOption* option, int bits, char text[64])
{
    const char* at = option->value;
    text[0] = 0;
    if (bits == 0 || bits == (int)option->high) {
        strcpy(text, bits == 0 ? "none" : "all");
        return;
    }
    for (int bit = 1; bit <= bits; bit <<= 1) {
        at = strchr(at, '|') + 1;
        if ((bits & bit) != 0) {
            const size_t length = strlen(text);
            snprintf(text + length, 64 - length, "%s%.*s", length > 0 ? "," : "", (int)strcspn(at, "|"), at);
        }
    }
}

vplResult vplRenderOptions_Get(const vplRenderOptions* o, const char* name, char* textOut, size_t size)
{
    REQUIRE(NULL, o, name, textOut);
    const vplOption* option = vplFindOption(name);
    char text[64] = "";
    if (option == NULL || option->kind == VPL_OPTION_PART) {
        return VPL_INVALID_ARGUMENT;
    }
    const double value = vplOption_GetNumber(option, o);
    switch (option->kind) {
    case VPL_OPTION_INT:
    case VPL_OPTION_INT_AUTO:
        snprintf(text, sizeof text, option->kind == VPL_OPTION_INT_AUTO && value < 0 ? "auto" : "%d",
                 (int)value);
        break;
    case VPL_OPTION_SEED:
        snprintf(text, sizeof text, "%llu", (unsigned long long)o->seed);
        break;
    case VPL_OPTION_SIZE:
        snprintf(text, sizeof text, "%dx%d", o->output.width, o->output.height);
        break;
    case VPL_OPTION_CHOICE:
    case VPL_OPTION_PRESET:
    case VPL_OPTION_SHOW:
        writeChoice(option, o, text);
        break;
    case VPL_OPTION_SET:
        writeBits(option, (int)value, text);
        break;
    case VPL_OPTION_FLOAT:
    case VPL_OPTION_DOUBLE:
        writeNumber(value, option->kind == VPL_OPTION_FLOAT, text);
        break;
    default:
        if (value >= 0) {
            writeNumber(value, option->kind != VPL_OPTION_BELOW_AUTO, text);
        } else {
            const bool exact = option->kind == VPL_OPTION_BIAS && value == (double)VPL_BIAS_OPTION_EXACT;
            const bool usual = option->kind == VPL_OPTION_BELOW_AUTO && value == -2;
            strcpy(text, exact ? "exact" : usual ? "usual" : "auto");
        }
    }
    return snprintf(textOut, size, "%s", text) < (int)size ? VPL_SUCCESS : VPL_INVALID_ARGUMENT;
}

// ---- use

bool vplRenderOptions_IsUsed(const vplRenderOptions* o, const char* name, char* reasonOut, size_t size)
{
    if (o == NULL || name == NULL) {
        return false;
    }
    const vplOption* option = vplFindOption(name);
    const int pipelines = option != NULL ? option->users & ~VPL_USE_ALL : 0;
    const char* against = NULL;
    vplRenderOptions resolved = *o;
    resolved.method = o->method == VPL_METHOD_AUTO ? vplFirstMethodFor(o) : o->method;
    const vplAccumulation kind =
        o->pipeline.kind == VPL_ACCUMULATE_USUAL ? vplUsualPipeline(&resolved) : o->pipeline.kind;
    resolved.pipeline.kind = kind;
    if (option != NULL && (option->users & 1 << resolved.method) == 0) {
        against = "method";
    } else if (pipelines != 0 && (pipelines & 256 << kind) == 0) {
        against = "pipeline";
    }
    if (against != NULL && reasonOut != NULL) {
        char value[32] = "";
        vplRenderOptions_Get(&resolved, against, value, sizeof value);
        snprintf(reasonOut, size, "--%s %s", against, value);
    }
    return against == NULL;
}
