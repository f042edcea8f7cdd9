// SPDX-License-Identifier: MIT
#include "scene/json_reader.h"
#include "base/file.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char* typeName(const json_t* value)
{
    switch (json_typeof(value)) {
    case JSON_OBJECT:
        return "an object";
    case JSON_ARRAY:
        return "an array";
    case JSON_STRING:
        return "a string";
    case JSON_INTEGER:
    case JSON_REAL:
        return "a number";
    case JSON_TRUE:
    case JSON_FALSE:
        return "a boolean";
    case JSON_NULL:
        break;
    }
    return "null";
}

// jansson skips a NUL byte behind a number as if it were not there (its lexer takes it for an empty buffer).
static vplResult rejectNul(const vplJsonReader* reader)
{
    const char* nul = memchr(reader->text, 0, reader->size);
    if (nul == NULL) {
        return VPL_SUCCESS;
    }
    int line, column;
    vplJson_CountLines(reader->text, (size_t)(nul - reader->text), &line, &column);
    return vplFail(reader->context, VPL_PARSE_ERROR, "%s:%d:%d: a NUL byte, must be text (JSON in UTF-8)",
                   reader->file, line, column);
}

static vplResult failSyntax(vplContext* context, const char* file, json_error_t* error)
{
    if (error->text[0] == 0 || json_error_code(error) == json_error_out_of_memory) {
        return vplFail(context, VPL_OUT_OF_MEMORY, "%s: out of memory while reading JSON", file);
    }
    return vplFail(context, VPL_PARSE_ERROR, "%s:%d:%d: %s", file, error->line > 0 ? error->line : 1,
                   error->column > 0 ? error->column : 1, error->text);
}

vplResult vplJsonReader_Open(vplContext* context, const char* file, vplJsonReader* readerOut)
{
    vplJsonReader reader = {context, file, NULL, 0, NULL};
    vplResult result = vplReadFile(context, file, &reader.text, &reader.size);
    if (result != VPL_SUCCESS) {
        return result;
    }
    result = rejectNul(&reader);
    if (result == VPL_SUCCESS) {
        json_error_t error;
        // Integers as real: 64 bits are no limit of a scene's numbers.
        const size_t flags = JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL;
        reader.root = json_loadb(reader.text, reader.size, flags, &error);
        result = reader.root != NULL ? VPL_SUCCESS : failSyntax(context, file, &error);
    }
    if (result != VPL_SUCCESS) {
        vplFree(context, reader.text);
        return result;
    }
    *readerOut = reader;
    return VPL_SUCCESS;
}

void vplJsonReader_Close(vplJsonReader* reader)
{
    json_decref(reader->root);
    vplFree(reader->context, reader->text);
}

static vplResult failAt(const vplJsonReader* reader, const vplJsonPath* path, bool atKey, char* message)
{
    char name[256];
    int line, column;
    vplJson_FormatPath(path, name, sizeof name);
    vplJson_Locate(reader->text, reader->size, path, atKey, &line, &column);
    return vplFail(reader->context, VPL_PARSE_ERROR, "%s:%d:%d: %s %s", reader->file, line, column,
                   name[0] ? name : "the scene", message);
}

vplResult vplJsonReader_Fail(const vplJsonReader* reader, const vplJsonPath* path, const char* format, ...)
{
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return failAt(reader, path, false, message);
}

vplResult vplJsonReader_RequireObject(const vplJsonReader* reader, const json_t* value,
                                      const vplJsonPath* path)
{
    return json_is_object(value)
               ? VPL_SUCCESS
               : vplJsonReader_Fail(reader, path, "is %s, must be an object", typeName(value));
}

vplResult vplJsonReader_RequireArray(const vplJsonReader* reader, const json_t* value,
                                     const vplJsonPath* path)
{
    return json_is_array(value)
               ? VPL_SUCCESS
               : vplJsonReader_Fail(reader, path, "is %s, must be an array", typeName(value));
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

vplResult vplJsonReader_CheckKeys(const vplJsonReader* reader, const json_t* object, const vplJsonPath* path,
                                  const char* const* keys)
{
    vplResult result = vplJsonReader_RequireObject(reader, object, path);
    if (result != VPL_SUCCESS) {
        return result;
    }
    const char* key;
    json_t* value;
    json_object_foreach((json_t*)object, key, value)
    {
        if (!isListed(keys, key)) {
            char message[256] = "is not a known key; known here:";
            for (int i = 0; keys[i] != NULL; i++) {
                size_t used = strlen(message);
                snprintf(message + used, sizeof message - used, "%s %s", i ? "," : "",
                         keys[i] + (keys[i][0] == '!'));
            }
            vplJsonPath member = {path, key, 0};
            return failAt(reader, &member, true, message);
        }
    }
    for (int i = 0; keys[i] != NULL; i++) {
        if (keys[i][0] == '!' && json_object_get(object, keys[i] + 1) == NULL) {
            return vplJsonReader_Fail(reader, path, "lacks the key \"%s\"", keys[i] + 1);
        }
    }
    return VPL_SUCCESS;
}

static vplResult readNumber(const vplJsonReader* reader, const json_t* value, const vplJsonPath* path,
                            double* out)
{
    if (!json_is_number(value)) {
        return vplJsonReader_Fail(reader, path, "is %s, must be a number", typeName(value));
    }
    double number = json_number_value(value);
    if (!(fabs(number) <= FLT_MAX)) {
        return vplJsonReader_Fail(reader, path, "is %g, beyond the range of a float (%g)", number,
                                  (double)FLT_MAX);
    }
    *out = number;
    return VPL_SUCCESS;
}

vplResult vplJsonReader_Number(const vplJsonReader* reader, const json_t* object, const vplJsonPath* path,
                               const char* key, double* out)
{
    const json_t* value = json_object_get(object, key);
    vplJsonPath member = {path, key, 0};
    return value == NULL ? VPL_SUCCESS : readNumber(reader, value, &member, out);
}

vplResult vplJsonReader_Doubles(const vplJsonReader* reader, const json_t* object, const vplJsonPath* path,
                                const char* key, int count, double* out)
{
    const json_t* value = json_object_get(object, key);
    vplJsonPath member = {path, key, 0};
    if (value == NULL) {
        return VPL_SUCCESS;
    }
    if (!json_is_array(value)) {
        return vplJsonReader_Fail(reader, &member, "is %s, must be an array of %d numbers", typeName(value),
                                  count);
    }
    if (json_array_size(value) != (size_t)count) {
        return vplJsonReader_Fail(reader, &member, "has %zu elements, must be an array of %d numbers",
                                  json_array_size(value), count);
    }
    for (int i = 0; i < count; i++) {
        vplJsonPath element = {&member, NULL, i};
        vplResult result = readNumber(reader, json_array_get(value, (size_t)i), &element, &out[i]);
        if (result != VPL_SUCCESS) {
            return result;
        }
    }
    return VPL_SUCCESS;
}

vplResult vplJsonReader_Floats(const vplJsonReader* reader, const json_t* object, const vplJsonPath* path,
                               const char* key, int count, float* out)
{
    double values[16];
    for (int i = 0; i < count; i++) {
        values[i] = out[i];
    }
    vplResult result = vplJsonReader_Doubles(reader, object, path, key, count, values);
    for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
        out[i] = (float)values[i];
    }
    return result;
}

vplResult vplJsonReader_String(const vplJsonReader* reader, const json_t* object, const vplJsonPath* path,
                               const char* key, const char** out)
{
    const json_t* value = json_object_get(object, key);
    vplJsonPath member = {path, key, 0};
    if (value == NULL) {
        return VPL_SUCCESS;
    }
    if (!json_is_string(value)) {
        return vplJsonReader_Fail(reader, &member, "is %s, must be a string", typeName(value));
    }
    *out = json_string_value(value);
    return VPL_SUCCESS;
}
