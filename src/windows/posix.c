// SPDX-License-Identifier: MIT
// See posix.h. Empty unless it is compiled for Windows.
#ifdef _WIN32
#include <errno.h>
#include <string.h>
#include <windows.h>

int vplWindows_Rename(const char* from, const char* to)
{
    if (MoveFileExA(from, to, MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH)) {
        return 0;
    }
    const DWORD cause = GetLastError();
    errno = cause == ERROR_FILE_NOT_FOUND || cause == ERROR_PATH_NOT_FOUND ? ENOENT : EACCES;
    return -1;
}

char* vplWindows_MakeFolder(char* path)
{
    char* end = path + strlen(path) - strlen("XXXXXX");
    for (unsigned attempt = 0; attempt < 1000; attempt++) {
        snprintf(end, sizeof "XXXXXX", "%06x", (unsigned)(GetCurrentProcessId() * 1000 + attempt) & 0xffffff);
        if (_mkdir(path) == 0) {
            return path;
        }
    }
    return NULL;
}

// Returns the name of the locale before, which lasts until the next call by the same thread.
locale_t vplWindows_UseLocale(locale_t locale)
{
    static __thread char before[512];
    char next[sizeof before];
    snprintf(next, sizeof next, "%s", locale);
    _configthreadlocale(_ENABLE_PER_THREAD_LOCALE);
    snprintf(before, sizeof before, "%s", setlocale(LC_ALL, NULL));
    setlocale(LC_ALL, next);
    return before;
}

long vplWindows_Ask(int name)
{
    SYSTEM_INFO system;
    MEMORYSTATUSEX memory = {.dwLength = sizeof memory};
    GetSystemInfo(&system);
    switch (name) {
    case _SC_PAGESIZE:
        return (long)system.dwPageSize;
    case _SC_PHYS_PAGES:
        return GlobalMemoryStatusEx(&memory) ? (long)(memory.ullTotalPhys / system.dwPageSize) : -1;
    default:
        return (long)system.dwNumberOfProcessors;
    }
}
#endif
