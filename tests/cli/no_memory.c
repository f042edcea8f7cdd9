// SPDX-License-Identifier: MIT
// A library for LD_PRELOAD that makes one allocation of a program and its libraries fail: number VPL_FAIL_AT, from 0 on. With VPL_FAIL_ON all
// later ones fail, too. The file VPL_FAILED is created when an allocation fails.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void* (*allocate)(size_t);
static void* (*resize)(void*, size_t);
static int (*align)(void**, size_t, size_t);
static long failAt = -1, count;
static bool failOn;

__attribute__((constructor)) static void start(void)
{
    const char *at = getenv("VPL_FAIL_AT"), *on = getenv("VPL_FAIL_ON");
    failOn = on != NULL && *on != 0;
    failAt = at != NULL ? atol(at) : -1;
}

static void find(void)
{
    if (allocate == NULL) {
        *(void**)&resize = dlsym(RTLD_NEXT, "realloc");
        *(void**)&align = dlsym(RTLD_NEXT, "posix_memalign");
        *(void**)&allocate = dlsym(RTLD_NEXT, "malloc");
    }
}

static bool fails(void)
{
    find();
    const long number = failAt >= 0 ? __atomic_fetch_add(&count, 1, __ATOMIC_RELAXED) : -1;
    if (number < 0 || !(number == failAt || (failOn && number > failAt))) {
        return false;
    }
    const int file = open(getenv("VPL_FAILED"), O_CREAT | O_WRONLY, 0600);
    if (file >= 0) {
        close(file);
    }
    errno = ENOMEM;
    return true;
}

void* malloc(size_t size)
{
    return fails() ? NULL : allocate(size);
}

void* realloc(void* memory, size_t size)
{
    return size > 0 && fails() ? NULL : resize(memory, size);
}

int posix_memalign(void** memory, size_t alignment, size_t size)
{
    return fails() ? ENOMEM : align(memory, alignment, size);
}

void* calloc(size_t number, size_t size)
{
    if (number > 0 && size > SIZE_MAX / number) {
        return NULL;
    }
    void* memory = fails() ? NULL : allocate(number * size);
    return memory != NULL ? memset(memory, 0, number * size) : NULL;
}
