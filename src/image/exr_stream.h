// SPDX-License-Identifier: MIT
// OpenEXRCore reading from and writing to memory.
#ifndef VPL_IMAGE_EXR_STREAM_H
#define VPL_IMAGE_EXR_STREAM_H

#include "base/file.h"

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
    char reason[160];      // of the first error, which OpenEXRCore would print
} vplExrStream;

// The set-up of an OpenEXRCore context that uses the stream.
exr_context_initializer_t vplExrStream_Describe(vplExrStream* stream);

#endif
