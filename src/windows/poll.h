// SPDX-License-Identifier: MIT
// poll() for files, which are always ready; reading from a pipe of Windows waits, and cannot be cancelled meanwhile.
#ifndef VPL_WINDOWS_POLL_H
#define VPL_WINDOWS_POLL_H

#define POLLIN 1

struct pollfd {
    int fd;
    short events, revents;
};

static inline int poll(struct pollfd* files, int count, int milliseconds)
{
    (void)files;
    (void)milliseconds;
    return count;
}

#endif
