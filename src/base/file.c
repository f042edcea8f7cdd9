// SPDX-License-Identifier: MIT
#include "base/file.h"

#include "base/arena.h" // TRY

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// Waits until there is something to read, or the end. A pipe may stay silent for ever.
static vplResult awaitBytes(vplContext* context, int fd)
{
    struct pollfd wanted = {.fd = fd, .events = POLLIN};
    int ready;
    do {
        TRY(vplAsk(context));
        ready = poll(&wanted, 1, 50);
    } while (ready == 0 || (ready < 0 && errno == EINTR));
    return VPL_SUCCESS;
}

// Reads to the end of the file: pipes and /dev/stdin have no size, and some devices no end.
static vplResult readAll(vplContext* context, const char* path, int fd, vplByteBuffer* buffer)
{
    const size_t most = buffer->capacity > VPL_MAX_STREAM_BYTES ? buffer->capacity : VPL_MAX_STREAM_BYTES;
    char chunk[1 << 16];
    for (;;) {
        TRY(awaitBytes(context, fd));
        ssize_t got = read(fd, chunk, sizeof chunk);
        if (got < 0 && (errno == EINTR || errno == EAGAIN)) {
            continue;
        }
        if (got < 0) {
            return vplFail(context, VPL_FILE_ERROR, "%s: cannot read: %s", path, strerror(errno));
        }
        if ((size_t)got > most - buffer->size) {
            return vplFail(context, VPL_LIMIT,
                           "%s: cannot read: it has no end within %d MiB, the most for a device or a pipe",
                           path, VPL_MAX_STREAM_BYTES >> 20);
        }
        vplByteBuffer_Append(buffer, chunk, (size_t)got);
        if (buffer->failed) {
            return VPL_OUT_OF_MEMORY;
        }
        if (got == 0) {
            return VPL_SUCCESS;
        }
    }
}

void vplContext_SetFiles(vplContext* context, const vplMemoryFile* files, int count)
{
    if (context == NULL) {
        return;
    }
    context->files = files;
    context->fileCount = files != NULL ? count : 0;
}

void vplContext_SetFileObserver(vplContext* context, vplFileFcn* fcn, void* user)
{
    if (context == NULL) {
        return;
    }
    context->fileObserver = fcn;
    context->fileUser = user;
}

static const vplMemoryFile* findInMemory(const vplContext* context, const char* path)
{
    for (int i = 0; i < context->fileCount; i++) {
        if (strcmp(context->files[i].path, path) == 0) {
            return &context->files[i];
        }
    }
    return NULL;
}

static vplResult readFromMemory(vplContext* context, const vplMemoryFile* file, char** bytesOut,
                                size_t* sizeOut)
{
    char* bytes = vplAlloc(context, file->size + 1, 1);
    if (bytes == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    if (file->size > 0) {
        memcpy(bytes, file->bytes, file->size);
    }
    bytes[file->size] = 0;
    *bytesOut = bytes;
    *sizeOut = file->size;
    return VPL_SUCCESS;
}

static int openToRead(const char* path)
{
#ifdef _WIN32
    if (strcmp(path, "/dev/stdin") == 0) {
        _setmode(STDIN_FILENO, O_BINARY);
        return dup(STDIN_FILENO);
    }
#endif
    return open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); // a pipe may have no writer yet
}

vplResult vplReadFile(vplContext* context, const char* path, char** bytesOut, size_t* sizeOut)
{
    REQUIRE(context, context, path, bytesOut, sizeOut);
    const vplMemoryFile* held = findInMemory(context, path);
    if (held != NULL) {
        return readFromMemory(context, held, bytesOut, sizeOut);
    }
    int fd = openToRead(path);
    if (fd < 0) {
        return vplFail(context, VPL_FILE_ERROR, "%s: cannot open: %s", path, strerror(errno));
    }
    vplByteBuffer buffer = {.context = context};
    struct stat info;
    if (fstat(fd, &info) == 0 && S_ISREG(info.st_mode)) { // one allocation for a regular file
        buffer.failed =
            vplReserve(context, &buffer.bytes, &buffer.capacity, (size_t)info.st_size + 1, 1) != VPL_SUCCESS;
    }
    vplResult result = buffer.failed ? VPL_OUT_OF_MEMORY : readAll(context, path, fd, &buffer);
    close(fd);
    size_t size = buffer.size;
    if (result == VPL_SUCCESS) {
        vplByteBuffer_Append(&buffer, "", 1);
        result = buffer.failed ? VPL_OUT_OF_MEMORY : VPL_SUCCESS;
    }
    if (result != VPL_SUCCESS) {
        vplFree(context, buffer.bytes);
        return result;
    }
    if (context->fileObserver != NULL) {
        context->fileObserver(context->fileUser, &(vplMemoryFile){path, buffer.bytes, size});
    }
    *bytesOut = (char*)buffer.bytes;
    *sizeOut = size;
    return VPL_SUCCESS;
}

bool vplIsRegularFile(const vplContext* context, const char* path)
{
    struct stat info;
    return findInMemory(context, path) != NULL || (stat(path, &info) == 0 && S_ISREG(info.st_mode));
}

const char* vplBaseName(const char* path)
{
    const char* slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

static bool isAbsolute(const char* path, size_t length)
{
#ifdef _WIN32
    if (length > 0 && (path[0] == '\\' || (length > 1 && path[1] == ':'))) {
        return true;
    }
#endif
    return length > 0 && path[0] == '/';
}

char* vplPathBeside(vplContext* context, const char* from, const char* name, size_t length)
{
    size_t folder = isAbsolute(name, length) ? 0 : (size_t)(vplBaseName(from) - from);
    char* path = vplAlloc(context, folder + length + 1, 1);
    if (path != NULL) {
        memcpy(path, from, folder);
        memcpy(path + folder, name, length);
        path[folder + length] = 0;
    }
    return path;
}

// Bytes that one call of write() is given: Linux writes less than 2^31, and Windows takes their number as an unsigned int.
enum { MOST_WRITTEN = 1 << 30 };

// Writes and closes; on failure errno tells why.
static bool writeAndClose(int fd, const void* bytes, size_t size, bool flush)
{
    const char* at = bytes;
    bool written = true;
    while (written && size > 0) {
        ssize_t put = write(fd, at, size < MOST_WRITTEN ? (unsigned)size : MOST_WRITTEN);
        written = put > 0 || (put < 0 && errno == EINTR);
        at += put > 0 ? put : 0;
        size -= put > 0 ? (size_t)put : 0;
    }
    // A full disk may show only when the pages are flushed.
    written = written && (!flush || fsync(fd) == 0 || errno == EINVAL);
    const int cause = errno;
    const bool closed = close(fd) == 0;
    errno = written ? errno : cause;
    return written && closed;
}

static vplResult writeDirectly(vplContext* context, const char* path, const void* bytes, size_t size)
{
    int fd = open(path, O_WRONLY | O_CLOEXEC);
    if (fd < 0) {
        return vplFail(context, VPL_FILE_ERROR, "%s: cannot open for writing: %s", path, strerror(errno));
    }
    return writeAndClose(fd, bytes, size, false)
               ? VPL_SUCCESS
               : vplFail(context, VPL_FILE_ERROR, "%s: cannot write: %s", path, strerror(errno));
}

// Opens a new file beside `path` and writes its name to `name`. The umask decides its mode, unlike with
// mkstemp.
static int openBeside(const char* path, char* name, size_t size)
{
    int fd = -1;
    for (int attempt = 0; attempt < 100 && fd < 0; attempt++) {
        snprintf(name, size, "%s.%ld-%d.tmp", path, (long)getpid(), attempt);
        fd = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd < 0 && errno != EEXIST) {
            break;
        }
    }
    return fd;
}

static vplResult writeBeside(vplContext* context, const char* path, const void* bytes, size_t size)
{
    size_t capacity = strlen(path) + 40;
    char* temporary = vplAlloc(context, capacity, 1);
    if (temporary == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplResult result = VPL_SUCCESS;
    int fd = openBeside(path, temporary, capacity);
    if (fd < 0) {
        result = vplFail(context, VPL_FILE_ERROR, "%s: cannot create: %s", path, strerror(errno));
    } else if (!writeAndClose(fd, bytes, size, true) || rename(temporary, path) != 0) {
        result = vplFail(context, VPL_FILE_ERROR, "%s: cannot write: %s", path, strerror(errno));
        unlink(temporary);
    }
    vplFree(context, temporary);
    return result;
}

vplResult vplWriteFile(vplContext* context, const char* path, const void* bytes, size_t size)
{
    REQUIRE(context, context, path);
    REQUIRE_ARRAY(context, bytes, size);
    struct stat info;
    bool exists = stat(path, &info) == 0;
    const int cause = errno;
    if (exists && S_ISDIR(info.st_mode)) {
        return vplFail(context, VPL_FILE_ERROR, "%s: cannot write: it is a directory", path);
    }
    if (!exists && lstat(path, &info) == 0) { // renaming would replace the link
        return vplFail(context, VPL_FILE_ERROR, "%s: cannot write: symbolic link: %s", path, strerror(cause));
    }
    if (exists && !S_ISREG(info.st_mode)) {
        return writeDirectly(context, path, bytes, size);
    }
    char* resolved = exists ? realpath(path, NULL) : NULL; // keep symbolic links: rename their target
    vplResult result = writeBeside(context, resolved ? resolved : path, bytes, size);
    free(resolved);
    return result;
}

void vplByteBuffer_Reserve(vplByteBuffer* buffer, size_t size)
{
    buffer->failed = buffer->failed || vplReserve(buffer->context, &buffer->bytes, &buffer->capacity,
                                                  buffer->size + size, 1) != VPL_SUCCESS;
}

void vplByteBuffer_Append(vplByteBuffer* buffer, const void* bytes, size_t size)
{
    if (size == 0) {
        return;
    }
    vplByteBuffer_Reserve(buffer, size);
    if (!buffer->failed) {
        memcpy(buffer->bytes + buffer->size, bytes, size);
        buffer->size += size;
    }
}
