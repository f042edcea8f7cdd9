// SPDX-License-Identifier: MIT
// A file to which finished units are appended. Whatever ends the job, the units before stay.
#include "mpi/ranks.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Reads a file to memory; false after complaining. *bytesOut is freed with free.
static bool readWhole(const char* path, uint8_t** bytesOut, size_t* sizeOut)
{
    FILE* file = fopen(path, "rb");
    uint8_t* bytes = NULL;
    size_t size = 0, room = 0, got = 1;
    bool good = file != NULL;
    while (good && got > 0) {
        if (room - size < 1 << 16) {
            room = 2 * room + (1 << 17);
            uint8_t* grown = realloc(bytes, room);
            good = grown != NULL;
            bytes = good ? grown : bytes;
        }
        got = good ? fread(bytes + size, 1, room - size, file) : 0;
        size += got;
    }
    if (!good || ferror(file)) {
        complain("%s: cannot read: %s", path, strerror(errno));
        free(bytes);
        good = false;
    }
    if (file != NULL) {
        fclose(file);
    }
    *bytesOut = good ? bytes : NULL;
    *sizeOut = size;
    return good;
}

// Makes the file begin with `bytes`. What it has beyond them is cut off last, so that nothing is lost if the job ends here.
static bool beginFile(Journal* j, const char* path, const void* bytes, size_t size)
{
    *j = (Journal){.file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666), .path = path};
    if (j->file >= 0 && !appendJournal(j, bytes, size)) {
        return false;
    }
    if (j->file < 0 || ftruncate(j->file, (off_t)size) != 0) {
        complain("%s: cannot write: %s", path, strerror(errno));
        return false;
    }
    return true;
}

int openJournal(Journal* j, const Arguments* a, const char* title, ReadUnits* read, void* user)
{
    const char *from = a->resume, *to = a->checkpoint;
    uint8_t* bytes = NULL;
    size_t size = 0, kept = 0;
    int code = EXIT_DONE;
    if (from != NULL) {
        code = readWhole(from, &bytes, &size) ? read(user, from, bytes, size, &kept) : EXIT_USAGE;
    }
    const bool same = from != NULL && to != NULL && strcmp(from, to) == 0;
    if (code == EXIT_DONE && to != NULL && !same && access(to, F_OK) == 0) {
        complain("%s: is there already; go on with --resume %s, or delete it", to, to);
        code = EXIT_USAGE;
    }
    if (code == EXIT_DONE && to != NULL) {
        const bool fresh = kept == 0 && title != NULL;
        code = beginFile(j, to, fresh ? (const void*)title : bytes, fresh ? strlen(title) : kept)
                   ? EXIT_DONE
                   : EXIT_COULD_NOT;
    }
    free(bytes);
    return code;
}

bool appendJournal(Journal* j, const void* bytes, size_t size)
{
    if (j->file < 0 || j->failed) {
        return !j->failed;
    }
    for (size_t at = 0; at < size;) {
        const ssize_t put = write(j->file, (const char*)bytes + at, size - at);
        if (put < 0 && errno == EINTR) {
            continue;
        }
        if (put <= 0) {
            j->failed = true;
            complain("%s: cannot write: %s; it keeps what was finished before", j->path, strerror(errno));
            if (ftruncate(j->file, (off_t)j->size) == 0) {
                lseek(j->file, (off_t)j->size, SEEK_SET);
            }
            return false;
        }
        at += (size_t)put;
    }
    j->size += (int64_t)size;
    return true;
}

bool closeJournal(Journal* j)
{
    const bool good = j->file < 0 || ((fsync(j->file) == 0 || errno == EINVAL) && close(j->file) == 0);
    if (!good) {
        complain("%s: cannot write: %s", j->path, strerror(errno));
    }
    j->file = -1;
    return good;
}
