// SPDX-License-Identifier: MIT
#include "failing.h"

#include "patch_support.h"

#include <limits.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

bool everyFault(void)
{
    return getenv("VPL_EVERY_FAULT") != NULL;
}

static void* failingAlloc(void* user, void* memory, size_t oldSize, size_t newSize)
{
    Failing* f = user;
    if (newSize == 0) {
        f->held -= memory != NULL;
        free(memory);
        return NULL;
    }
    long number = f->allocations++;
    if (number == f->failAt || (f->stayEmpty && f->failAt >= 0 && number > f->failAt)) {
        return NULL;
    }
    char* block = realloc(memory, newSize);
    f->held += memory == NULL && block != NULL;
    if (block != NULL && newSize > oldSize) {
        memset(block + oldSize, 0xCD, newSize - oldSize);
    }
    return block;
}

static void countErrors(void* user, vplLogLevel level, const char* message)
{
    Failing* f = user;
    f->errors += level == VPL_LOG_ERROR && message[0] != 0;
}

vplContext* openFailing(Failing* f)
{
    vplContextDef def = vplDefaultContextDef();
    def.alloc = failingAlloc;
    def.allocUser = f;
    def.log = countErrors;
    def.logUser = f;
    def.workerCount = 2;
    vplContext* context = NULL;
    vplContext_Create(&def, &context);
    return context;
}

static void discard(Attempt* a)
{
    vplHistory_Destroy(a->history);
    vplFormFactors_Destroy(a->factors);
    vplPatchMesh_Destroy(a->mesh);
    vplPatchSides_Destroy(a->sides);
    if (a->handMade != NULL) {
        closeSides(a->handMade);
    }
    vplPatches_Destroy(a->finer);
    vplPatches_Destroy(a->patches);
    vplCubeMap_Destroy(a->cube);
    closeMap(&a->map);
    vplParaboloidMaps_Destroy(a->paraboloids);
    vplReflectiveMap_Destroy(a->reflective);
    vplLightClusters_Destroy(a->nextClusters);
    vplLightClusters_Destroy(a->clusters);
    vplLightSet_Destroy(a->lights);
    vplLayers_Destroy(a->layers);
    vplImage_Destroy(a->image);
    vplImage_Destroy(a->other);
    vplImage_Destroy(a->heatmap);
    vplGeometry_Destroy(a->geometry);
    vplScene_Destroy(a->scene);
    freeShape(&a->shape);
    for (size_t i = 0; i < sizeof a->blocks / sizeof *a->blocks; i++) {
        free(a->blocks[i]);
    }
}

// Runs a scenario once. Returns whether an allocation failed; if none did, the scenario must succeed.
static bool failOne(const char* name, Scenario* scenario, const char* path, int variant, long n,
                    bool stayEmpty)
{
    Failing failing = {.failAt = n, .stayEmpty = stayEmpty};
    Attempt attempt = {.context = openFailing(&failing), .path = path, .variant = variant};
    const vplResult result = attempt.context != NULL ? scenario(&attempt) : VPL_OUT_OF_MEMORY;
    discard(&attempt);
    const bool intact = attempt.context == NULL || vplContext_GetBytes(attempt.context) == 0;
    vplContext_Destroy(attempt.context);
    struct stat info;
    const bool written = stat(path, &info) == 0, failed = failing.allocations > n;
    const bool right = failed ? result == VPL_OUT_OF_MEMORY && !written &&
                                    (stayEmpty ? failing.errors >= 1 : failing.errors == 1)
                              : result == VPL_SUCCESS && failing.errors == 0;
    if (!right || failing.held != 0 || !intact) {
        fail_msg("%s, variant %d, allocation %ld: %s, %d sentences%s, %ld blocks leaked", name, variant, n,
                 vplResult_GetName(result), failing.errors, written ? ", a file" : "", failing.held);
    }
    unlink(path);
    return failed;
}

// Makes allocation n fail, n + 1 + n / thin and so on, until none is left. Returns how many failed.
static long failThese(const char* name, Scenario* scenario, const char* path, int way, long thin)
{
    long n = 0, count = 0;
    while (failOne(name, scenario, path, way / 2, n, way % 2 != 0)) {
        n += 1 + n / thin;
        count++;
    }
    assert_true(count > 4);
    return count;
}

void failEveryAllocation(const char* name, Scenario* scenario, const char* extension, int variants)
{
    const long thin = everyFault() ? LONG_MAX : 16;
    char folder[] = "/tmp/vpl-memory-XXXXXX", path[64];
    long allocations = 0;
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.%s", folder, extension);
    for (int way = 0; way < 2 * variants; way++) {
        allocations += failThese(name, scenario, path, way, thin);
    }
    assert_int_equal(rmdir(folder), 0); // fails if a temporary file stayed behind
    printf("# %s: %ld failed allocations\n", name, allocations);
}

void failSomeAllocations(const char* name, Scenario* scenario, int variants)
{
    long allocations = 0;
    if (everyFault()) {
        failEveryAllocation(name, scenario, "none", variants);
        return;
    }
    for (int i = 0; i < variants; i++) {
        allocations += failThese(name, scenario, "/tmp/vpl-memory-none", 2 * i + i % 2, 4);
    }
    printf("# %s: %ld failed allocations\n", name, allocations);
}
