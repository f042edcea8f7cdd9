// SPDX-License-Identifier: MIT
// Tests of files in and out, and of the sentences about them.
#include "test.h"

#include "base/file.h"

#include <stdlib.h>
#include <unistd.h>

#ifndef _WIN32 // whose users may not make symbolic links
TEST(ADanglingLinkIsNotReplaced, 1)
{
    const char* path = temporaryName(".txt");
    char target[64];
    assert_int_equal(symlink("/tmp/vpl-files-nothing", path), 0);
    assert_int_equal(vplWriteFile(context, path, "abc", 3), VPL_FILE_ERROR);
    assert_non_null(strstr(takeMessage(), "symbolic link: No such file"));
    assert_int_equal(readlink(path, target, sizeof target), strlen("/tmp/vpl-files-nothing"));
    unlink(path);
}
#endif

// ---- sentences

typedef struct Log {
    char message[20000];
    bool empty; // the allocator gives nothing
} Log;

static void keep(void* user, vplLogLevel level, const char* message)
{
    (void)level;
    snprintf(((Log*)user)->message, sizeof((Log*)user)->message, "%s", message);
}

static void* allocate(void* user, void* memory, size_t oldSize, size_t newSize)
{
    (void)oldSize;
    if (newSize == 0) {
        free(memory);
        return NULL;
    }
    return ((Log*)user)->empty ? NULL : realloc(memory, newSize);
}

// A sentence is never cut off before its reason, unless there is no memory for it.
TEST_ALONE(LongNamesKeepTheReasonBehindThem)
{
    Log log = {.empty = false};
    vplContextDef def = vplDefaultContextDef();
    vplContext* context;
    def.log = keep;
    def.alloc = allocate;
    def.logUser = def.allocUser = &log;
    assert_int_equal(vplContext_Create(&def, &context), VPL_SUCCESS);
    for (int length = 900; length <= 16000; length += length < 1100 ? 1 : 2980) {
        char* name = malloc((size_t)length + 1);
        memset(name, 'n', (size_t)length);
        name[length] = 0;
        log.empty = false;
        vplFail(context, VPL_FILE_ERROR, "%s: the reason", name);
        assert_int_equal(strlen(log.message), (size_t)length + strlen(": the reason"));
        assert_string_equal(log.message + length, ": the reason");
        log.empty = true;
        vplFail(context, VPL_FILE_ERROR, "%s: the reason", name);
        assert_memory_equal(log.message, name, length < 1023 ? (size_t)length : 1023);
        free(name);
    }
    vplContext_Destroy(context);
}

// ---- devices

TEST(ADeviceWithoutAnEndIsRefused, 1)
{
    char* bytes = NULL;
    size_t size = 7;
    assert_int_equal(vplReadFile(context, "/dev/zero", &bytes, &size), VPL_LIMIT);
    assert_non_null(strstr(takeMessage(), "/dev/zero: cannot read: it has no end within 256 MiB"));
    assert_true(bytes == NULL && size == 7);
    assert_int_equal(vplReadFile(context, "/dev/null", &bytes, &size), VPL_SUCCESS);
    assert_true(size == 0 && bytes[0] == 0);
    vplFree(context, bytes);
}

// ---- pictures

// stb takes the absolute value of a BMP's height, which -2^31 has not.
TEST(ABmpOfTheLeastHeightIsRefused, 1)
{
    uint8_t bytes[54 + 16] = {'B', 'M', [10] = 54, [14] = 40, [18] = 1, [26] = 1, [28] = 24};
    const char* path = temporaryName(".bmp");
    static const uint32_t heights[] = {1, 0xFFFFFFFF, 0x80000001, 0x80000000};
    for (int i = 0; i < 4; i++) {
        vplImage* image = NULL;
        for (int b = 0; b < 4; b++) {
            bytes[22 + b] = (uint8_t)(heights[i] >> 8 * b);
        }
        assert_int_equal(vplWriteFile(context, path, bytes, sizeof bytes), VPL_SUCCESS);
        assert_int_equal(vplImage_Read(context, path, &image), i < 2 ? VPL_SUCCESS : VPL_PARSE_ERROR);
        assert_int_equal(i < 2, image != NULL && image->height == 1);
        vplImage_Destroy(image);
    }
    assert_non_null(strstr(takeMessage(), "its height is -2147483648"));
    unlink(path);
}
