// SPDX-License-Identifier: MIT
// Small renders in passes, of every method that has them, and the pictures after each pass.
#ifndef VPL_TESTS_PASS_CASES_H
#define VPL_TESTS_PASS_CASES_H

#include "scenes.h"

enum { PASS_CASES = 6, MOST_PASSES = 4 };

// A picture or its layers as hashes.
typedef struct Seen {
    uint64_t images[VPL_MAX_LAYERS];
    int count;
} Seen;

// Loads the scene of case i and returns its options; all have MOST_PASSES passes.
vplRenderOptions passCase(vplContext* context, int i, vplScene** sceneOut);

// Looks at the picture so far.
Seen look(vplRenderer* renderer, vplRenderStats* statsOut);
void assertSeenSame(const Seen* a, const Seen* b);

// Renders case i without a stop; passes[k] is the picture of k passes, from 1.
void renderPasses(const vplScene* scene, const vplRenderOptions* options, Seen passes[MOST_PASSES + 1],
                  vplRenderStats* statsOut);

#endif
