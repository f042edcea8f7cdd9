// SPDX-License-Identifier: MIT
// Passes arbitrary bytes as a glTF file; those that begin with "glTF" are a .glb file.
// The reader must either log one sentence with the place, or make a valid scene, which a
// second reading reproduces.
#include "model_fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    fuzzModel(bytes, size, "glb"); // the bytes decide
    return 0;
}
