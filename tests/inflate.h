// SPDX-License-Identifier: MIT
// Decompresses zlib streams for tests, with code that no library has in common with ours.
#ifndef VPL_TESTS_INFLATE_H
#define VPL_TESTS_INFLATE_H

#include <stddef.h>
#include <stdint.h>

// Decompresses a zlib stream into out[0 .. capacity). Returns the number of bytes, or -1 if the stream is broken, does not fit or
// has another checksum.
long inflateBytes(const uint8_t* in, size_t size, uint8_t* out, size_t capacity);

#endif
