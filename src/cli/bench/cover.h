// SPDX-License-Identifier: MIT
// A triangle over the whole picture, with trivial shaders: measures fill rate, here and in bench/roofline.
#ifndef VPL_CLI_BENCH_COVER_H
#define VPL_CLI_BENCH_COVER_H

#include <vpl/raster.h>

// One triangle over the whole picture.
extern const vplMesh COVER;

// Its corners are (-1, -1), (3, -1) and (-1, 3). The uniforms are its depth, a float.
void coverVertices(const void* uniforms, int first, int count, const vplVertices* out);

// Writes 1, 2, 3 and 4 to planes 0 to 3.
void coverFragments(const void* uniforms, vplFragments* f);

#endif
