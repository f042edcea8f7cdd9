// SPDX-License-Identifier: MIT
// Whole files in and out.
#ifndef VPL_BASE_FILE_H
#define VPL_BASE_FILE_H

#include "base/context.h"

// Most bytes that are read of what does not say its size: a device or a pipe.
enum { VPL_MAX_STREAM_BYTES = 256 << 20 };

// True if `path` names a regular file, not a folder, device or pipe.
bool vplIsRegularFile(const vplContext* context, const char* path);

// Resolves `name` (length bytes) relative to the folder of the file `from`; absolute names stay as they are.
// Freed with vplFree; NULL when out of memory.
char* vplPathBeside(vplContext* context, const char* from, const char* name, size_t length);

// The part of a path behind its last '/'.
const char* vplBaseName(const char* path);

// A growing buffer of bytes, for encoders. Initialise with {.context = context}.
typedef struct vplByteBuffer {
    vplContext* context;
    uint8_t* bytes;
    size_t size, capacity;
    bool failed; // out of memory: later appends do nothing
} vplByteBuffer;

// Takes memory for `size` more bytes, so that appending them does not copy what is there.
void vplByteBuffer_Reserve(vplByteBuffer* buffer, size_t size);

void vplByteBuffer_Append(vplByteBuffer* buffer, const void* bytes, size_t size);

#endif
