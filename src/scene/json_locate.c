// SPDX-License-Identifier: MIT
// Walks a text without NUL bytes that jansson has accepted. The syntax is valid, so only brackets and strings,
// which may contain brackets, matter. Runs when an error is reported.
#include "scene/json_locate.h"

#include <stdio.h>
#include <string.h>

typedef struct Cursor {
    const char* at;
    const char* end;
} Cursor;

static void skipSpace(Cursor* c)
{
    while (c->at < c->end && strchr(" \t\r\n", *c->at) != NULL) {
        c->at++;
    }
}

static void skipString(Cursor* c)
{
    c->at++; // the opening quote
    while (c->at < c->end && *c->at != '"') {
        c->at += *c->at == '\\' ? 2 : 1;
    }
    c->at++;
}

// Moves to the comma or bracket behind a value.
static void skipValue(Cursor* c)
{
    int depth = 0;
    while (c->at < c->end && (depth > 0 || strchr(",]}", *c->at) == NULL)) {
        if (*c->at == '"') {
            skipString(c);
        } else {
            depth += (*c->at == '{' || *c->at == '[') - (*c->at == '}' || *c->at == ']');
            c->at++;
        }
    }
}

// Compares keys as written: the keys of scene files have no escapes.
static bool keyEquals(const char* at, const char* end, const char* key)
{
    size_t length = strlen(key);
    return (size_t)(end - at) > length + 1 && strncmp(at + 1, key, length) == 0 && at[length + 1] == '"';
}

// Moves from a value to one of its children, or to the key of the child. False if there is no such child.
static bool enter(Cursor* c, const vplJsonPath* step, bool atKey)
{
    const bool object = step->key != NULL;
    Cursor child = *c;
    if (child.at >= child.end || *child.at != (object ? '{' : '[')) {
        return false;
    }
    for (int i = 0;; i++) {
        child.at++; // the bracket or comma
        skipSpace(&child);
        if (child.at >= child.end || *child.at == '}' || *child.at == ']') {
            return false;
        }
        const char* start = child.at;
        if (object) {
            skipString(&child);
            skipSpace(&child);
            child.at++; // the colon
            skipSpace(&child);
        }
        if (object ? keyEquals(start, c->end, step->key) : i == step->index) {
            c->at = atKey ? start : child.at;
            return true;
        }
        skipValue(&child);
        if (child.at >= child.end || *child.at != ',') {
            return false;
        }
    }
}

// Moves from the root to the value at `path`. Stops where there is no such child.
static bool descend(Cursor* c, const vplJsonPath* path, bool atKey)
{
    return path == NULL || (descend(c, path->parent, false) && enter(c, path, atKey));
}

vplJsonPlace vplJson_Locate(const char* text, size_t size, const vplJsonPath* path, bool atKey)
{
    Cursor c = {text, text + size};
    skipSpace(&c);
    descend(&c, path, atKey);
    return vplJson_PlaceOf(text, (size_t)((c.at < c.end ? c.at : c.end) - text));
}

vplJsonPlace vplJson_PlaceOf(const char* text, size_t offset)
{
    vplJsonPlace place = {1, 1};
    for (const char* p = text; p < text + offset; p++) {
        if (*p == '\n') {
            place.line++;
            place.column = 1;
        } else if ((*p & 0xC0) != 0x80) { // counts characters, as jansson and editors do, not bytes
            place.column++;
        }
    }
    return place;
}

void vplJson_FormatPath(const vplJsonPath* path, char* buffer, size_t size)
{
    if (path == NULL) {
        buffer[0] = 0;
        return;
    }
    vplJson_FormatPath(path->parent, buffer, size);
    size_t used = strlen(buffer);
    if (path->key != NULL) {
        snprintf(buffer + used, size - used, "%s%s", used ? "." : "", path->key);
    } else {
        snprintf(buffer + used, size - used, "[%d]", path->index);
    }
}
