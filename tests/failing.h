// SPDX-License-Identifier: MIT
// Tests of out-of-memory behaviour: the n-th allocation fails, for every n, and each time the call returns
// VPL_OUT_OF_MEMORY, logs one sentence, leaks nothing and leaves no file. New memory is filled with junk, so
// that no code can rely on zeroed memory.
#ifndef VPL_TESTS_FAILING_H
#define VPL_TESTS_FAILING_H

#include "shadow_maps.h"

#include "base/arena.h" // TRY

// One run of a scenario. The scenario stores here what it makes, and the fixture destroys it.
typedef struct Attempt {
    vplContext* context;
    const char* path; // the file to write, if the scenario writes one
    int variant;
    vplScene* scene;
    vplGeometry* geometry;
    vplImage *image, *other, *heatmap;
    vplLayers* layers;
    vplLightSet* lights;
    vplLightClusters *clusters, *nextClusters;
    vplHistory* history;
    vplPatches *patches, *finer;
    vplPatchSides *sides, *handMade; // `sides` by the library, `handMade` by openSides
    vplPatchMesh* mesh;
    vplFormFactors* factors;
    vplReflectiveMap* reflective;
    vplParaboloidMaps* paraboloids;
    vplCubeMap* cube;
    ShadowMap map;
    Shape shape;
    void* blocks[4]; // from malloc
} Attempt;

typedef vplResult Scenario(Attempt* attempt);

// Returns whether the environment has VPL_EVERY_FAULT, as make faults sets it. Without it tests try the first faults one by one and
// later ones at growing distances.
bool everyFault(void);

// Runs each variant of a scenario until no allocation is left to fail, in two ways: only the n-th allocation
// fails, or all from the n-th on fail. `extension` is the extension of the file that the scenario writes.
void failEveryAllocation(const char* name, Scenario* scenario, const char* extension, int variants);

// The same for scenarios without a file and with many variants. Unless everyFault, fewer allocations fail, and each variant runs in one
// of the two ways.
void failSomeAllocations(const char* name, Scenario* scenario, int variants);

// State of an allocator whose n-th allocation fails (-1: none) and, with stayEmpty, all after it. openFailing
// returns NULL if the context's own allocation fails.
typedef struct Failing {
    long allocations; // so far
    long failAt;
    bool stayEmpty;
    long held;  // blocks not yet freed
    int errors; // sentences logged
} Failing;

vplContext* openFailing(Failing* failing);

#endif
