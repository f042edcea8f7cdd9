// SPDX-License-Identifier: MIT
// Random renders that are valid but extreme, for the fuzzer `valid` and for soak.c.
#ifndef VPL_TESTS_FUZZ_VALID_H
#define VPL_TESTS_FUZZ_VALID_H

#include "fuzz.h"

// Options of small work.
#define SMALL                                                                                                \
    "--size 8x6 --shadow-map 16 --particles 6 --spp 2 --area-light-samples 4 --sky-samples 4 --light-map 8 " \
    "--rsm-size 8 "                                                                                          \
    "--clusters 4 --first-bounce 12 --second-bounce 12 --paraboloid 8 --patches 30 --form-samples 2 "        \
    "--iterations 10 --oversampling 2 --pcf 4 --subdivisions 6 --max-bounces 8 --passes 1"

// Makes a scene and options from bytes (any number of them), plans and renders a tiny picture of bounded work, and
// requires what holds for every render: the plan foresees a refusal in the same words, a failure has one sentence, and a
// picture is finite. Returns a hash of all that was seen, which depends on the bytes alone. `log` is the context's.
uint64_t renderValid(vplContext* context, FuzzLog* log, const uint8_t* bytes, size_t size);

#endif
