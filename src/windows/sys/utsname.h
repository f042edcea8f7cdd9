// SPDX-License-Identifier: MIT
// The architecture that the program was compiled for.
#ifndef VPL_WINDOWS_UTSNAME_H
#define VPL_WINDOWS_UTSNAME_H

struct utsname {
    const char* machine;
};

static inline int uname(struct utsname* name)
{
    name->machine = sizeof(void*) == 8 ? "x86_64" : "i686";
    return 0;
}

#endif
