// SPDX-License-Identifier: MIT
// Passes arbitrary bytes as the MTL file of a fixed OBJ file; what must hold is that of obj_fuzz.c.
#define _GNU_SOURCE
#include "fuzz.h"

#define LLVMFuzzerTestOneInput fuzzObj
int fuzzObj(const uint8_t* bytes, size_t size);
#include "obj_fuzz.c"
#undef LLVMFuzzerTestOneInput

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    static const char obj[] = "mtllib 100\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 2 -1\nusemtl a\nf 1/1 2/2 "
                              "3/1\nusemtl b c\nf 1 3/-1 2\n\x1F";
    const size_t start = sizeof obj - 1;
    uint8_t* all = malloc(start + size);
    MUST(all != NULL);
    memcpy(all, obj, start);
    if (size > 0) {
        memcpy(all + start, bytes, size);
    }
    fuzzObj(all, start + size);
    free(all);
    return 0;
}
