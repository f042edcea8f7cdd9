// SPDX-License-Identifier: MIT
// Files that the program itself writes or is about to: asked for before the work, whole or not at all after it.
#include "cli/cli.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
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

bool checkOutput(const char* path)
{
    struct stat info;
    bool exists = stat(path, &info) == 0;
    if (exists && S_ISDIR(info.st_mode)) {
        complain("%s: cannot write: it is a directory", path);
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

// Writes all of `text` to an open file and closes it; errno tells why not.
static bool writeAndClose(int descriptor, const char* text)
{
    FILE* file = fdopen(descriptor, "w");
    if (file == NULL) {
        close(descriptor);
        return false;
    }
    bool written = fputs(text, file) >= 0 && fflush(file) == 0;
    int cause = errno;
    bool closed = fclose(file) == 0;
    errno = written ? errno : cause;
    return written && closed;
}

static bool writeBeside(const char* path, const char* text)
{
    char temporary[PATH_MAX];
    int length = snprintf(temporary, sizeof temporary, "%s.%ld.tmp", path, (long)getpid());
    if (length >= (int)sizeof temporary) {
        errno = ENAMETOOLONG;
        return false;
    }
    int descriptor = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) {
        return false;
    }
    if (writeAndClose(descriptor, text) && rename(temporary, path) == 0) {
        return true;
    }
    int cause = errno;
    unlink(temporary);
    errno = cause;
    return false;
}

bool writeTextFile(const char* path, const char* text)
{
    struct stat info;
    bool exists = stat(path, &info) == 0, good;
    if (exists && !S_ISREG(info.st_mode)) {
        int descriptor = open(path, O_WRONLY | O_CLOEXEC);
        good = descriptor >= 0 && writeAndClose(descriptor, text);
    } else {
        char* target = exists ? realpath(path, NULL) : NULL;
        good = writeBeside(target ? target : path, text);
        int cause = errno;
        free(target);
        errno = cause;
    }
    if (!good) {
        complain("%s: cannot write: %s", path, strerror(errno));
    }
    return good;
}
