// SPDX-License-Identifier: MIT
// Values behind the header of a PLY file: words of a text, or bytes in either order.
#include "scene/ply.h"

#include "base/numbers.h"
#include "scene/obj_number.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static const int SIZES[] = {1, 1, 2, 2, 4, 4, 4, 8}; // of types, in bytes

static const char* endOf(const vplPly* ply)
{
    return ply->text.bytes + ply->text.size;
}

static void logAt(const vplPly* ply, const char* at, vplLogLevel level, const char* message)
{
    if (ply->format != VPL_PLY_ASCII && at >= ply->data) {
        vplLog(ply->text.context, level, "%s: byte %td: %s", ply->text.file, at - ply->text.bytes, message);
    } else if (level == VPL_LOG_ERROR) {
        vplText_FailAt(&ply->text, at, "%s", message);
    } else {
        vplText_WarnAt(&ply->text, at, "%s", message);
    }
}

vplResult vplPly_Fail(const vplPly* ply, const char* at, const char* format, ...)
{
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vplFormatList(message, sizeof message, format, arguments);
    va_end(arguments);
    logAt(ply, at, VPL_LOG_ERROR, message);
    return VPL_PARSE_ERROR;
}

void vplPly_WarnTally(const vplPly* ply, const vplTally* tally, const char* sentence, const char* things)
{
    char message[512];
    if (tally->count > 0) {
        snprintf(message, sizeof message, "%s (%lld such %s)", sentence, tally->count, things);
        logAt(ply, tally->first, VPL_LOG_WARNING, message);
    }
}

static bool isSpace(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

const char* vplPly_Place(vplPly* ply)
{
    while (ply->format == VPL_PLY_ASCII && ply->at < endOf(ply) && isSpace(*ply->at)) {
        ply->at++;
    }
    return ply->at;
}

// Cuts the next word off a text; an empty one at its end.
static vplWord nextWord(vplPly* ply)
{
    const char* end = endOf(ply);
    const char* start = vplPly_Place(ply);
    while (ply->at < end && !isSpace(*ply->at)) {
        ply->at++;
    }
    return (vplWord){start, ply->at};
}

static bool isNoNumber(vplWord word)
{
    const char* p = word.start + (word.start < word.end && (*word.start == '-' || *word.start == '+'));
    return word.end - p >= 3 && (strncasecmp(p, "nan", 3) == 0 || strncasecmp(p, "inf", 3) == 0);
}

static vplResult readWord(vplPly* ply, vplPlyType type, const char* what, double* out)
{
    const vplWord word = nextWord(ply);
    const char* p = word.start;
    int64_t integer = 0;
    float real = 0;
    if (word.start == word.end) {
        return vplPly_Fail(ply, word.start, "found the end of the file, expected %s", what);
    }
    if (type < VPL_PLY_FLOAT && vplReadInteger(&p, word.end, &integer) && p == word.end) {
        *out = (double)integer;
        return VPL_SUCCESS;
    }
    if (type >= VPL_PLY_FLOAT && vplReadNumber(word.start, word.end, &real)) {
        *out = (double)real;
        return VPL_SUCCESS;
    }
    if (type >= VPL_PLY_FLOAT && isNoNumber(word)) {
        *out = NAN;
        return VPL_SUCCESS;
    }
    return vplText_FailWord(&ply->text, word, "%s", what);
}

static double decode(vplPlyType type, uint64_t bits)
{
    float real;
    double wide;
    const uint32_t word = (uint32_t)bits;
    switch (type) {
    case VPL_PLY_INT8:
        return (int8_t)bits;
    case VPL_PLY_INT16:
        return (int16_t)bits;
    case VPL_PLY_INT32:
        return (int32_t)bits;
    case VPL_PLY_FLOAT:
        memcpy(&real, &word, sizeof real);
        return (double)real;
    case VPL_PLY_DOUBLE:
        memcpy(&wide, &bits, sizeof wide);
        return wide;
    default:
        return (double)bits;
    }
}

vplResult vplPly_ReadValue(vplPly* ply, vplPlyType type, const char* what, double* out)
{
    if (ply->format == VPL_PLY_ASCII) {
        return readWord(ply, type, what, out);
    }
    const int size = SIZES[type];
    uint64_t bits = 0;
    if (endOf(ply) - ply->at < size) {
        return vplPly_Fail(ply, ply->at, "found the end of the file, expected %s", what);
    }
    for (int i = 0; i < size; i++) {
        const uint64_t byte = (unsigned char)ply->at[ply->format == VPL_PLY_BIG ? size - 1 - i : i];
        bits |= byte << (8 * i);
    }
    ply->at += size;
    *out = decode(type, bits);
    return VPL_SUCCESS;
}

vplResult vplPly_ReadCount(vplPly* ply, const vplPlyProperty* list, int64_t* out)
{
    double count = 0;
    const char* at = vplPly_Place(ply);
    TRY(vplPly_ReadValue(ply, list->countType, "the length of a list", &count));
    const int64_t room = endOf(ply) - ply->at;
    const int64_t most = ply->format == VPL_PLY_ASCII ? room / 2 + 1 : room / SIZES[list->type];
    if (!(count >= 0 && count <= (double)most)) {
        return vplPly_Fail(
            ply, at,
            "found a list of %.0f numbers, expected a length from 0 to %lld, what is left of the file", count,
            (long long)most);
    }
    *out = (int64_t)count;
    return VPL_SUCCESS;
}

static vplResult skipValue(vplPly* ply, vplPlyType type)
{
    double ignored;
    if (ply->format != VPL_PLY_ASCII) {
        return vplPly_ReadValue(ply, type, "a number", &ignored);
    }
    const vplWord word = nextWord(ply);
    return word.start < word.end
               ? VPL_SUCCESS
               : vplPly_Fail(ply, word.start, "found the end of the file, expected a number");
}

vplResult vplPly_SkipProperty(vplPly* ply, const vplPlyProperty* property)
{
    int64_t count = 1;
    TRY(property->list ? vplPly_ReadCount(ply, property, &count) : VPL_SUCCESS);
    if (property->list && ply->format != VPL_PLY_ASCII) { // the length was checked
        ply->at += count * SIZES[property->type];
        return VPL_SUCCESS;
    }
    for (int64_t i = 0; i < count; i++) {
        TRY(skipValue(ply, property->type));
    }
    return VPL_SUCCESS;
}

vplResult vplPly_SkipElement(vplPly* ply, const vplPlyElement* element)
{
    TRY(vplPly_RequireRoom(ply, element));
    for (int64_t i = 0; i < element->count && element->propertyCount > 0; i++) {
        TRY(i % 65536 == 65535 ? vplAsk(ply->text.context) : VPL_SUCCESS);
        for (int p = 0; p < element->propertyCount; p++) {
            TRY(vplPly_SkipProperty(ply, &ply->properties[element->first + p]));
        }
    }
    return VPL_SUCCESS;
}

vplResult vplPly_RequireRoom(const vplPly* ply, const vplPlyElement* element)
{
    int64_t least = 0; // bytes of one element
    const int64_t room = endOf(ply) - ply->at;
    for (int i = 0; i < element->propertyCount; i++) {
        const vplPlyProperty* p = &ply->properties[element->first + i];
        least += ply->format == VPL_PLY_ASCII ? 2 : SIZES[p->list ? p->countType : p->type];
    }
    const int64_t most = least > 0 ? (room + 1) / least : INT64_MAX; // the last word of a text needs no blank
    return element->count <= most
               ? VPL_SUCCESS
               : vplPly_Fail(
                     ply, element->name.start,
                     "found %lld elements \"%.*s\", expected at most %lld, what the file has room for",
                     (long long)element->count,
                     element->name.end - element->name.start > 60
                         ? 60
                         : (int)(element->name.end - element->name.start),
                     element->name.start, (long long)most);
}
