// SPDX-License-Identifier: MIT
// The functions of POSIX that libvpl uses and mingw-w64 lacks. The Makefile includes this file before every source that it
// compiles for Windows, so that the sources themselves are those of POSIX.
#ifndef VPL_WINDOWS_POSIX_H
#define VPL_WINDOWS_POSIX_H

#include <direct.h>
#include <fcntl.h>
#include <io.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <time.h>

// ---- files

// Every open() of libvpl has this flag. Files are opened as they are on disk: without O_BINARY, bytes 13 are lost and a byte 26
// ends the file.
#define O_CLOEXEC              (O_NOINHERIT | O_BINARY)
#define O_NONBLOCK             0
#define fsync(file)            _commit(file)
#define lstat(path, info)      stat(path, info)
#define mkdir(path, mode)      _mkdir(path)
#define realpath(path, buffer) _fullpath(buffer, path, 0)

// Names of folders end at either slash.
#define strrchr(text, mark) vplWindows_FindLast(text, mark)
static inline char* vplWindows_FindLast(const char* text, int mark)
{
    char* slash = (strrchr)(text, mark);
    char* back = mark == '/' ? (strrchr)(text, '\\') : NULL;
    return slash == NULL || (back != NULL && back > slash) ? back : slash;
}

// access() of Windows refuses to be asked whether a folder can be entered; all can.
#undef X_OK
#define X_OK 0

// Replaces a file of the new name, which rename() of Windows refuses to do.
#define rename(from, to) vplWindows_Rename(from, to)
int vplWindows_Rename(const char* from, const char* to);

#define mkdtemp(path) vplWindows_MakeFolder(path)
char* vplWindows_MakeFolder(char* path);

// ---- the locale of a thread, by its name

typedef const char* locale_t;
#define LC_ALL_MASK                 0
#define newlocale(mask, name, base) ((void)(base), (locale_t)(name))
#define uselocale(locale)           vplWindows_UseLocale(locale)
#define freelocale(locale)          ((void)(locale))
locale_t vplWindows_UseLocale(locale_t locale);

// ---- signals

// Numbers that no signal of Windows has: writing to a closed pipe fails without one.
#define SIGPIPE 13
#define SIGXFSZ 25

typedef struct vplWindowsMask {
    int unused; // Windows blocks the signal that is being handled, and no other
} vplWindowsMask;

struct sigaction {
    void (*sa_handler)(int number);
    vplWindowsMask sa_mask;
};

#define sigaddset(mask, number)           ((void)(mask))
#define sigaction(number, action, before) signal(number, (action)->sa_handler)

// ---- the machine

enum { _SC_PHYS_PAGES, _SC_PAGESIZE, _SC_NPROCESSORS_ONLN };
#define sysconf(name) vplWindows_Ask(name)
long vplWindows_Ask(int name);

#define localtime_r(time, out)   (localtime_s(out, time) == 0 ? (out) : NULL)
#define getloadavg(loads, count) ((void)(loads), -1)

#endif
