// SPDX-License-Identifier: MIT
// A file to which finished units are appended. Whatever ends the job, the units before stay.
#include "mpi/ranks.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

// Reads a file; an exit code. *bytesOut is freed by vplBytes_Free.
static int readWhole(vplContext* context, const char* path, char** bytesOut, size_t* sizeOut)
{
    vplContext_SetProgress(context, askInterrupts, NULL);
    const vplResult result = vplReadFile(context, path, bytesOut, sizeOut);
    vplContext_SetProgress(context, NULL, NULL);
    return exitCode(result, true);
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

int openJournal(Journal* j, vplContext* context, const Arguments* a, const char* title, ReadUnits* read,
                void* user)
{
    const char *from = a->resume, *to = a->checkpoint;
    char* bytes = NULL;
    size_t size = 0, kept = 0;
    int code = EXIT_DONE;
    if (from != NULL) {
        code = readWhole(context, from, &bytes, &size);
        code = code == EXIT_DONE ? read(user, from, (uint8_t*)bytes, size, &kept) : code;
    }
    const bool same = from != NULL && to != NULL && strcmp(from, to) == 0;
    if (code == EXIT_DONE && to != NULL && !same && access(to, F_OK) == 0) {
        complain("%s: is there already; go on with --resume %s, or delete it", to, to);
        code = EXIT_USAGE;
    }
    if (code == EXIT_DONE && to != NULL) {
        const bool fresh = kept == 0 && title != NULL;
        code = beginFile(j, to, fresh ? title : bytes, fresh ? strlen(title) : kept) ? EXIT_DONE
                                                                                     : EXIT_COULD_NOT;
    }
    vplBytes_Free(context, (uint8_t*)bytes);
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
