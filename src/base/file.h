// SPDX-License-Identifier: MIT
// Whole files in and out.
#ifndef VPL_BASE_FILE_H
#define VPL_BASE_FILE_H

#include "base/context.h"

// Reads a whole file and adds a 0 byte behind it. *bytesOut is freed with vplFree.
vplResult vplReadFile(vplContext* context, const char* path, char** bytesOut, size_t* sizeOut);

// A buffer that grows as an encoder appends to it. Start with {context}.
typedef struct vplByteBuffer {
    vplContext* context;
    uint8_t* bytes;
    size_t size, capacity;
    bool failed; // out of memory: later appends do nothing
} vplByteBuffer;

void vplByteBuffer_Append(vplByteBuffer* buffer, const void* bytes, size_t size);

#endif
