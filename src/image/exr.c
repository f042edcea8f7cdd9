// SPDX-License-Identifier: MIT
#include "image/exr.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

bool vplHasExr(void)
{
    return VPL_EXR;
}

#if VPL_EXR

// ---- reading from and writing to memory

static void keepReason(exr_const_context_t exr, exr_result_t code, const char* message)
{
    (void)code;
    void* user;
    if (exr == NULL || exr_get_user_data(exr, &user) != EXR_ERR_SUCCESS || user == NULL) {
        return;
    }
    vplExrStream* s = user;
    if (s->reason[0] != 0) {
        return;
    }
    // The message quotes names from the file, which may contain any byte.
    size_t length = 0;
    for (; message[length] != 0 && length + 1 < sizeof s->reason; length++) {
        bool printable = message[length] >= 0x20 && message[length] < 0x7F;
        s->reason[length] = (char)(printable ? message[length] : '?');
    }
    s->reason[length] = 0;
}

// OpenEXRCore holds the lock of a file that is written while it reports that memory ran out, so this must ask the file nothing.
static void ignoreReason(exr_const_context_t exr, exr_result_t code, const char* message)
{
    (void)exr;
    (void)code;
    (void)message;
}

static int64_t readStream(exr_const_context_t exr, void* user, void* to, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t fail)
{
    (void)exr;
    (void)fail;
    const vplExrStream* s = user;
    if (offset >= s->size) {
        return 0;
    }
    const size_t left = s->size - (size_t)offset, count = left < size ? left : (size_t)size;
    memcpy(to, s->bytes + offset, count);
    return (int64_t)count;
}

static int64_t sizeStream(exr_const_context_t exr, void* user)
{
    (void)exr;
    return (int64_t)((const vplExrStream*)user)->size;
}

// Appends, except for the table of chunks, which is overwritten at the end.
static int64_t writeStream(exr_const_context_t exr, void* user, const void* from, uint64_t size,
                           uint64_t offset, exr_stream_error_func_ptr_t fail)
{
    (void)exr;
    (void)fail;
    static const uint8_t zeros[256];
    vplByteBuffer* buffer = ((vplExrStream*)user)->buffer;
    while (buffer->size < offset && !buffer->failed) {
        const uint64_t gap = offset - buffer->size;
        vplByteBuffer_Append(buffer, zeros, gap < sizeof zeros ? (size_t)gap : sizeof zeros);
    }
    if (buffer->failed) {
        return -1;
    }
    const size_t left = buffer->size - (size_t)offset, over = left < size ? left : (size_t)size;
    if (over > 0) {
        memcpy(buffer->bytes + (size_t)offset, from, over);
    }
    vplByteBuffer_Append(buffer, (const uint8_t*)from + over, (size_t)size - over);
    return buffer->failed ? -1 : (int64_t)size;
}

static void closeStream(exr_const_context_t exr, void* user, int failed)
{
    (void)exr;
    (void)user;
    (void)failed;
}

exr_context_initializer_t vplDescribeExrStream(vplExrStream* s)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = s->buffer ? ignoreReason : keepReason;
    init.user_data = s;
    init.read_fn = s->buffer ? NULL : readStream;
    init.size_fn = s->buffer ? NULL : sizeStream;
    init.write_fn = s->buffer ? writeStream : NULL;
    init.destroy_fn = closeStream;
    init.max_image_width = init.max_image_height = VPL_MAX_IMAGE_SIZE;
    return init;
}

bool vplExrLacksMemory(exr_result_t result)
{
    return result == EXR_ERR_OUT_OF_MEMORY || (result != EXR_ERR_SUCCESS && errno == ENOMEM);
}

// ---- channels

int vplFindExrChannel(const char* name, const char* channel)
{
    static const char letters[] =
        "RGBXYZ"; // X, Y and Z only behind a name, where they are no grey and no depth
    const size_t length = strlen(name);
    if (strcmp(channel, length > 0 ? name : "Y") == 0) {
        return 0;
    }
    if (length > 0 && (strncmp(channel, name, length) != 0 || channel[length] != '.')) {
        return -1;
    }
    const char* last = channel + length + (length > 0);
    const char* at = last[0] != 0 && last[1] == 0 ? strchr(letters, last[0]) : NULL;
    return at != NULL && (length > 0 || at < letters + 3) ? (int)(at - letters) % 3 : -1;
}

void vplDescribeExrChannel(exr_coding_channel_info_t* channel, int width)
{
    channel->user_bytes_per_element = 4;
    channel->user_data_type = EXR_PIXEL_FLOAT; // OpenEXRCore converts indices
    channel->user_pixel_stride = 3 * 4;
    channel->user_line_stride = 3 * 4 * width;
}

#endif
