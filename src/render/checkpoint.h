// SPDX-License-Identifier: MIT
// Files of renders between two passes.
#ifndef VPL_RENDER_CHECKPOINT_H
#define VPL_RENDER_CHECKPOINT_H

#include <stddef.h>
#include <stdint.h>

// The checksum of the first `size` bytes, a multiple of 4, which the file has behind them.
uint64_t vplState_Checksum(const uint8_t* bytes, size_t size);

#endif
