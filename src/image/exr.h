// SPDX-License-Identifier: MIT
// OpenEXR pictures by OpenEXRCore: what the writer and the reader share. Pixels and the encoded file are in context memory. The scratch memory of
// OpenEXRCore, a few scanlines, is not, because its allocation hooks take no user data. OpenEXRCore reads and writes memory only: vplWriteFile
// writes files whole or not at all.
#ifndef VPL_IMAGE_EXR_H
#define VPL_IMAGE_EXR_H

#include "base/arena.h"
#include "image/image_file.h"

#if VPL_EXR

#include <OpenEXR/openexr.h>

// Returns from the calling function with the result of `expression` unless it succeeded.
#define TRY_EXR(expression)                                                                                  \
    do {                                                                                                     \
        const exr_result_t tryResult = (expression);                                                         \
        if (tryResult != EXR_ERR_SUCCESS) {                                                                  \
            return tryResult;                                                                                \
        }                                                                                                    \
    } while (0)

// The user data of OpenEXRCore's callbacks.
typedef struct vplExrStream {
    const uint8_t* bytes; // to read
    size_t size;
    vplByteBuffer* buffer; // to write
    char reason[160];      // of the first error of reading, which OpenEXRCore would print
} vplExrStream;

// The set-up of an OpenEXRCore context that uses the stream, to write if the stream has a buffer, else to read.
exr_context_initializer_t vplDescribeExrStream(vplExrStream* stream);

// Returns true if OpenEXRCore ran out of memory. The caller sets errno to 0 before its calls of OpenEXRCore; `result` is that of the last one.
// OpenEXRCore reports corrupt data where zlib ran out of memory, and then only the errno of malloc tells.
bool vplExrLacksMemory(exr_result_t result);

// Finds the place of a channel of the layer `name` in our pixels: 0 for red to 2 for blue, or -1. Grey and single channels are stored in red
// first.
// Source: layers and the names of channels are those of "Channel Names" and "Layers" in OpenEXR's Technical
// Introduction.
int vplFindExrChannel(const char* name, const char* channel);

// Describes one of the three values of our pixels to OpenEXRCore.
void vplDescribeExrChannel(exr_coding_channel_info_t* channel, int width);

#endif

#endif
