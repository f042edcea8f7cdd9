// SPDX-License-Identifier: MIT
// Running out of memory: the n-th allocation fails, for every n, and each time the answer is
// VPL_OUT_OF_MEMORY, one sentence is logged, nothing leaks and no file is left. New memory is filled with
// junk, so success cannot depend on it.
#ifndef VPL_TESTS_FAILING_H
#define VPL_TESTS_FAILING_H

#include "shadow_maps.h"

#include "base/arena.h" // TRY

// One run of a scenario. It stores what it makes here, and the fixture destroys it.
typedef struct Attempt {
    vplContext* context;
    const char* path; // the file to write, if the scenario writes one
    int variant;
    vplScene* scene;
    vplGeometry* geometry;
    vplImage *image, *other, *heatmap;
    vplLightSet* lights;
    vplLightClusters *clusters, *nextClusters;
    vplHistory* history;
    vplPatches *patches, *finer;
    vplPatchSides *sides, *handMade; // by the library, and by openSides
    vplPatchMesh* mesh;
    vplFormFactors* factors;
    vplReflectiveMap* reflective;
    vplParaboloidMaps* paraboloids;
    vplCubeMap* cube;
    ShadowMap map;
    Shape shape;
    void* blocks[4]; // of malloc
} Attempt;

typedef vplResult Scenario(Attempt* attempt);

// Runs each variant of a scenario until no allocation is left to fail, in two ways: only the n-th fails, or
// all from the n-th on. `extension` is that of the file.
void failEveryAllocation(const char* name, Scenario* scenario, const char* extension, int variants);

// A context whose n-th allocation fails (-1: none) and, if stayEmpty, all after it. NULL if already its own
// does.
typedef struct Failing {
    long allocations; // so far
    long failAt;
    bool stayEmpty;
    long held;  // blocks not yet freed
    int errors; // sentences logged
} Failing;

vplContext* openFailing(Failing* failing);

#endif
