// SPDX-License-Identifier: MIT
// Walks a text without NUL bytes that jansson has accepted: the syntax is valid, so only strings, which may
// contain any bracket, and nesting matter. Runs when an error is reported.
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

static void skipValue(Cursor* c)
{
    int depth = 0;
    do {
        skipSpace(c);
        if (c->at >= c->end) {
            return;
        }
        if (*c->at == '"') {
            skipString(c);
        } else if (*c->at == '{' || *c->at == '[') {
            depth++;
            c->at++;
        } else if (*c->at == '}' || *c->at == ']') {
            depth--;
            c->at++;
        } else if (*c->at == ',' || *c->at == ':') {
            c->at++;
        } else {
            while (c->at < c->end && strchr(" \t\r\n,:]}", *c->at) == NULL) {
                c->at++;
            }
        }
    } while (depth > 0 && c->at < c->end);
}

// Compares keys as written: the keys of scene files have no escapes.
static bool keyEquals(const char* at, const char* end, const char* key)
{
    size_t length = strlen(key);
    return (size_t)(end - at) > length + 1 && strncmp(at + 1, key, length) == 0 && at[length + 1] == '"';
}

// Moves from an opening bracket to the value, or the key, of one of its children. False if there is no such
// child.
static bool enter(Cursor* c, const vplJsonPath* step, bool atKey)
{
    bool object = *c->at == '{';
    if (object != (step->key != NULL)) {
        return false;
    }
    c->at++;
    for (int i = 0;; i++) {
        skipSpace(c);
        if (c->at >= c->end || *c->at == '}' || *c->at == ']') {
            return false;
        }
        const char* start = c->at;
        if (object) {
            skipString(c);
            skipSpace(c);
            c->at++; // the colon
            skipSpace(c);
        }
        if (object ? keyEquals(start, c->end, step->key) : i == step->index) {
            c->at = atKey ? start : c->at;
            return true;
        }
        skipValue(c);
        skipSpace(c);
        if (c->at < c->end && *c->at == ',') {
            c->at++;
        }
    }
}

static bool descend(Cursor* c, const vplJsonPath* path, bool atKey)
{
    if (path == NULL) {
        return true;
    }
    if (!descend(c, path->parent, false)) {
        return false;
    }
    Cursor found = *c;
    if (c->at >= c->end || (*c->at != '{' && *c->at != '[') || !enter(&found, path, atKey)) {
        return false;
    }
    *c = found;
    return true;
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
    if (path == NULL || size < 2) {
        if (size > 0) {
            buffer[0] = 0;
        }
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
