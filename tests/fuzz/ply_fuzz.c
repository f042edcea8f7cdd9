// SPDX-License-Identifier: MIT
// Passes arbitrary bytes as a PLY file, or as an STL file where they do not begin with "ply". The reader must either log
// one sentence with the place and leave the scene unchanged, or make a valid mesh, which a second reading reproduces.
#include "model_fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    const bool ply = size >= 3 && memcmp(bytes, "ply", 3) == 0;
    fuzzModel(bytes, size, ply ? "ply" : "stl");
    return 0;
}
