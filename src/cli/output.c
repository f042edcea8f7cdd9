// SPDX-License-Identifier: MIT
// Files and JSON that the program itself writes. Paths are checked early; files appear whole or not at all.
#include "cli/cli.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool isFolderWritable(const char* folder)
{
    struct stat info;
    if (stat(folder, &info) == 0 && !S_ISDIR(info.st_mode)) {
        errno = ENOTDIR;
        return false;
    }
    return access(folder, W_OK | X_OK) == 0;
}

bool isStdout(const char* path)
{
    return path[0] == '-' && (path[1] == 0 || path[1] == '.');
}

bool checkOutput(const char* path)
{
    struct stat info;
    if (isStdout(path)) {
        return true;
    }
    bool exists = stat(path, &info) == 0;
    const int cause = errno;
    if (exists && S_ISDIR(info.st_mode)) {
        complain("%s: cannot write: it is a directory", path);
        return false;
    }
    if (!exists && lstat(path, &info) == 0) {
        complain("%s: cannot write: symbolic link: %s", path, strerror(cause));
        return false;
    }
    if (exists && !S_ISREG(info.st_mode)) {
        return true; // a device or a pipe
    }
    char* target = exists ? realpath(path, NULL) : NULL; // a symbolic link stays, its target is replaced
    const char* name = target ? target : path;
    const char* slash = strrchr(name, '/');
    char folder[PATH_MAX];
    int length = slash == NULL || slash == name ? 1 : (int)(slash - name); // "." or "/" itself
    snprintf(folder, sizeof folder, "%.*s", length, slash ? name : ".");
    bool good = isFolderWritable(folder);
    if (!good) {
        complain("%s: cannot write: directory %s: %s", path, folder, strerror(errno));
    }
    free(target);
    return good;
}

bool numberName(const char* name, int number, int last, char* out, size_t size)
{
    if (last < 0) {
        return (size_t)snprintf(out, size, "%s", name) < size;
    }
    int digits = 4;
    for (int rest = last / 10000; rest > 0; rest /= 10) {
        digits++;
    }
    const char* slash = strrchr(name, '/');
    const char* base = slash ? slash + 1 : name;
    const char* dot = strrchr(base, '.');
    const int stem = (int)(dot != NULL && dot != base ? dot - name : (long)strlen(name));
    const int length = snprintf(out, size, "%.*s-%0*d%s", stem, name, digits, number, name + stem);
    return length >= 0 && (size_t)length < size;
}

bool writeTextFile(const char* path, const char* text)
{
    const Arguments quiet = {.context = vplDefaultContextDef(), .quiet = true};
    vplContext* context;
    const bool written = openContext(&quiet, &context) == VPL_SUCCESS &&
                         vplWriteFile(context, path, text, strlen(text)) == VPL_SUCCESS;
    vplContext_Destroy(context);
    return written;
}

json_t* numberJson(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t* integersJson(const int* values, int count)
{
    json_t* array = json_array();
    for (int i = 0; i < count; i++) {
        json_array_append_new(array, json_integer(values[i]));
    }
    return array;
}

static void* allocateJson(size_t size)
{
    void* block = malloc(size);
    if (block == NULL) {
        complain("out of memory: %zu bytes wanted for JSON", size);
        exit(EXIT_COULD_NOT);
    }
    return block;
}

void guardJson(void)
{
    json_set_alloc_funcs(allocateJson, free);
}

int writeJson(json_t* root, int digits, const char* path)
{
    char* text = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION((size_t)digits));
    json_decref(root);
    bool written = text != NULL;
    if (!written) {
        complain("%s: out of memory while writing JSON", path != NULL ? path : "standard output");
    } else if (path != NULL) {
        written = writeTextFile(path, text);
    } else {
        puts(text);
    }
    free(text);
    return written ? EXIT_DONE : EXIT_COULD_NOT;
}
