// SPDX-License-Identifier: MIT
#include "scene/json_reader.h"
#include "base/arena.h"
#include "base/file.h"
#include "base/file_kind.h"
#include "base/numbers.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char* typeName(const json_t* value)
{
    static const char* const names[] = {
        [JSON_OBJECT] = "an object", [JSON_ARRAY] = "an array", [JSON_STRING] = "a string",
        [JSON_INTEGER] = "a number", [JSON_REAL] = "a number",  [JSON_TRUE] = "a boolean",
        [JSON_FALSE] = "a boolean",  [JSON_NULL] = "null",
    };
    return names[json_typeof(value)];
}

// jansson ignores a NUL byte behind a number: its lexer takes it for an empty buffer.
static vplResult rejectNul(const vplJsonFile* file)
{
    const char* nul = memchr(file->text, 0, file->size);
    if (nul == NULL) {
        return VPL_SUCCESS;
    }
    const vplJsonPlace place = vplJson_PlaceOf(file->text, (size_t)(nul - file->text));
    return vplFail(file->context, VPL_PARSE_ERROR, "%s:%d:%d: a NUL byte, must be text (JSON in UTF-8)",
                   file->name, place.line, place.column);
}

static vplResult parse(vplJsonFile* file)
{
    TRY(vplCheckFileKind(file->context, file->name, file->text, file->size, ".json", "JSON"));
    TRY(rejectNul(file));
    json_error_t error;
    // Reads integers as reals, so that those beyond 64 bits are no error.
    const size_t flags = JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL;
    errno = 0;
    file->root = json_loadb(file->text, file->size, flags, &error);
    // jansson calls a string that it has no memory for a syntax error, or silently leaves out its end. malloc's errno tells.
    if (errno == ENOMEM || (file->root == NULL && error.text[0] == 0)) {
        json_decref(file->root);
        return vplFail(file->context, VPL_OUT_OF_MEMORY, "%s: out of memory while reading JSON", file->name);
    }
    if (file->root != NULL) {
        return VPL_SUCCESS;
    }
    return vplFail(file->context, VPL_PARSE_ERROR, "%s:%d:%d: %s", file->name,
                   error.line > 0 ? error.line : 1, error.column > 0 ? error.column : 1, error.text);
}

vplResult vplJsonFile_FromText(vplContext* context, const char* name, char* text, size_t size,
                               vplJsonFile* fileOut)
{
    vplJsonFile file = {.context = context, .name = name, .text = text, .size = size};
    const vplResult result = parse(&file);
    if (result != VPL_SUCCESS) {
        vplFree(context, text);
        return result;
    }
    *fileOut = file;
    return VPL_SUCCESS;
}

vplResult vplJsonFile_Open(vplContext* context, const char* name, vplJsonFile* fileOut)
{
    char* text;
    size_t size;
    TRY(vplReadFile(context, name, &text, &size));
    return vplJsonFile_FromText(context, name, text, size, fileOut);
}

void vplJsonFile_Close(vplJsonFile* file)
{
    json_decref(file->root);
    vplFree(file->context, file->text);
}

vplJson vplJson_Root(const vplJsonFile* file)
{
    return (vplJson){.file = file, .value = file->root};
}

// The path to a value; NULL for the root.
static const vplJsonPath* pathOf(const vplJson* at)
{
    return at->value == at->file->root ? NULL : &at->path;
}

vplJson vplJson_Member(const vplJson* parent, const char* key)
{
    return (vplJson){parent->file, json_object_get(parent->value, key), {pathOf(parent), key, 0}};
}

vplJson vplJson_Element(const vplJson* parent, int index)
{
    return (vplJson){
        parent->file, json_array_get(parent->value, (size_t)index), {pathOf(parent), NULL, index}};
}

static vplResult failAt(const vplJson* at, bool atKey, const char* message)
{
    const vplJsonFile* file = at->file;
    char path[256];
    vplJson_FormatPath(pathOf(at), path, sizeof path);
    const vplJsonPlace place = vplJson_Locate(file->text, file->size, pathOf(at), atKey);
    return vplFail(file->context, VPL_PARSE_ERROR, "%s:%d:%d: %s %s", file->name, place.line, place.column,
                   path[0]                 ? path
                   : file->subject != NULL ? file->subject
                                           : "the scene",
                   message);
}

void vplJson_FormatPlace(const vplJson* at, char* out, size_t size)
{
    const vplJsonPlace place = vplJson_Locate(at->file->text, at->file->size, &at->path, false);
    snprintf(out, size, "%s:%d:%d", at->file->name, place.line, place.column);
}

vplResult vplJson_Fail(const vplJson* at, const char* format, ...)
{
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vplFormatList(message, sizeof message, format, arguments);
    va_end(arguments);
    return failAt(at, false, message);
}

static vplResult require(const vplJson* at, bool right, const char* expected)
{
    return right ? VPL_SUCCESS : vplJson_Fail(at, "is %s, must be %s", typeName(at->value), expected);
}

vplResult vplJson_RequireObject(const vplJson* at)
{
    return require(at, json_is_object(at->value), "an object");
}

vplResult vplJson_RequireArray(const vplJson* at)
{
    return require(at, json_is_array(at->value), "an array");
}

static bool isListed(const char* const* keys, const char* key)
{
    for (; *keys != NULL; keys++) {
        if (strcmp(*keys + (**keys == '!'), key) == 0) {
            return true;
        }
    }
    return false;
}

vplResult vplJson_CheckKeys(const vplJson* object, const char* const* keys)
{
    TRY(vplJson_RequireObject(object));
    const char* key;
    json_t* value;
    json_object_foreach(object->value, key, value)
    {
        if (!isListed(keys, key)) {
            char message[256] = "is not a known key; known here:";
            for (int i = 0; keys[i] != NULL; i++) {
                size_t used = strlen(message);
                snprintf(message + used, sizeof message - used, "%s %s", i ? "," : "",
                         keys[i] + (keys[i][0] == '!'));
            }
            const vplJson member = vplJson_Member(object, key);
            return failAt(&member, true, message);
        }
    }
    for (int i = 0; keys[i] != NULL; i++) {
        if (keys[i][0] == '!' && json_object_get(object->value, keys[i] + 1) == NULL) {
            return vplJson_Fail(object, "lacks the key \"%s\"", keys[i] + 1);
        }
    }
    return VPL_SUCCESS;
}

static vplResult readNumber(const vplJson* at, double* out)
{
    TRY(require(at, json_is_number(at->value), "a number"));
    double number = json_number_value(at->value);
    if (!(fabs(number) <= FLT_MAX)) {
        return vplJson_Fail(at, "is %g, beyond the range of a float (%g)", number, (double)FLT_MAX);
    }
    *out = number;
    return VPL_SUCCESS;
}

vplResult vplJson_ReadNumber(const vplJson* object, const char* key, double* out)
{
    const vplJson member = vplJson_Member(object, key);
    return member.value == NULL ? VPL_SUCCESS : readNumber(&member, out);
}

vplResult vplJson_ReadDoubles(const vplJson* object, const char* key, int count, double* out)
{
    const vplJson member = vplJson_Member(object, key);
    if (member.value == NULL) {
        return VPL_SUCCESS;
    }
    if (!json_is_array(member.value)) {
        return vplJson_Fail(&member, "is %s, must be an array of %d numbers", typeName(member.value), count);
    }
    if (json_array_size(member.value) != (size_t)count) {
        return vplJson_Fail(&member, "has %zu elements, must be an array of %d numbers",
                            json_array_size(member.value), count);
    }
    for (int i = 0; i < count; i++) {
        const vplJson element = vplJson_Element(&member, i);
        TRY(readNumber(&element, &out[i]));
    }
    return VPL_SUCCESS;
}

vplResult vplJson_ReadFloats(const vplJson* object, const char* key, int count, void* out)
{
    double values[16] = {0};
    float floats[16];
    if (vplJson_Member(object, key).value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_ReadDoubles(object, key, count, values));
    for (int i = 0; i < count; i++) {
        floats[i] = (float)values[i];
    }
    memcpy(out, floats, (size_t)count * sizeof *floats);
    return VPL_SUCCESS;
}

vplResult vplJson_ReadPosition(const vplJson* object, const char* key, void* out)
{
    double at[3] = {0};
    if (vplJson_Member(object, key).value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_ReadDoubles(object, key, 3, at));
    float floats[3];
    for (int i = 0; i < 3; i++) {
        floats[i] = (float)(at[i] - object->file->origin[i]);
    }
    memcpy(out, floats, sizeof floats);
    return VPL_SUCCESS;
}

vplResult vplJson_ReadString(const vplJson* object, const char* key, const char** out)
{
    const vplJson member = vplJson_Member(object, key);
    if (member.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(require(&member, json_is_string(member.value), "a string"));
    *out = json_string_value(member.value);
    return VPL_SUCCESS;
}
