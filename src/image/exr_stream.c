// SPDX-License-Identifier: MIT
#if VPL_EXR
#include "image/exr_stream.h"

#include <string.h>

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
        s->reason[length] = printable ? message[length] : '?';
    }
    s->reason[length] = 0;
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
    uint64_t count = s->size - offset < size ? s->size - offset : size;
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
        uint64_t gap = offset - buffer->size;
        vplByteBuffer_Append(buffer, zeros, gap < sizeof zeros ? gap : sizeof zeros);
    }
    if (buffer->failed) {
        return -1;
    }
    uint64_t over = buffer->size - offset < size ? buffer->size - offset : size;
    if (over > 0) {
        memcpy(buffer->bytes + offset, from, over);
    }
    vplByteBuffer_Append(buffer, (const uint8_t*)from + over, size - over);
    return buffer->failed ? -1 : (int64_t)size;
}

static void closeStream(exr_const_context_t exr, void* user, int failed)
{
    (void)exr;
    (void)user;
    (void)failed;
}

exr_context_initializer_t vplExrStream_Describe(vplExrStream* s)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = keepReason;
    init.user_data = s;
    init.read_fn = s->buffer ? NULL : readStream;
    init.size_fn = s->buffer ? NULL : sizeStream;
    init.write_fn = s->buffer ? writeStream : NULL;
    init.destroy_fn = closeStream;
    init.max_image_width = init.max_image_height = VPL_MAX_IMAGE_SIZE;
    return init;
}

#endif
