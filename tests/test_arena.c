// SPDX-License-Identifier: MIT
// Tests of the arena: destroying it frees everything, failed allocations are reported, memory is aligned.
#include "test.h"

#include "base/arena.h"

#include <stdlib.h>

// An allocator that allows a number of allocations, then fails.
typedef struct Quota {
    int left;
    int held; // blocks not yet freed
} Quota;

static void* quotaAlloc(void* user, void* memory, size_t oldSize, size_t newSize)
{
    Quota* quota = user;
    assert_true((memory == NULL) == (oldSize == 0));
    if (newSize == 0) {
        quota->held -= memory != NULL;
        free(memory);
        return NULL;
    }
    if (quota->left-- <= 0) {
        return NULL;
    }
    quota->held++;
    return realloc(memory, newSize);
}

static vplContext* openQuota(Quota* quota)
{
    vplContextDef def = vplDefaultContextDef();
    def.alloc = quotaAlloc;
    def.allocUser = quota;
    vplContext* context = NULL;
    assert_int_equal(vplContext_Create(&def, &context), VPL_SUCCESS);
    return context;
}

static void closeQuota(vplContext* context, const Quota* quota)
{
    assert_int_equal(vplContext_GetBytes(context), 0);
    vplContext_Destroy(context);
    assert_int_equal(quota->held, 0);
}

TEST_ALONE(DestroyingAnArenaFreesEverythingInIt)
{
    vplContext* context = openTestContext(1);
    vplArena* arena = vplArena_Create(context);
    for (size_t i = 0; i < 100; i++) {
        char* bytes = vplArena_Alloc(arena, i, 7);
        assert_non_null(bytes);
        memset(bytes, 0xCD, 7 * i); // overwriting a block must not damage the links between blocks
    }
    assert_int_equal(vplArena_Check(arena), VPL_SUCCESS);
    vplArena_Destroy(arena);
    vplArena_Destroy(NULL);
    closeTestContext(context); // fails if memory is still held
}

TEST(MemoryOfAnArenaIsAligned, 1)
{
    vplArena* arena = vplArena_Create(context);
    for (size_t size = 0; size < 200; size++) {
        assert_int_equal((uintptr_t)vplArena_Alloc(arena, 1, size) % 64, 0);
    }
    const char* zeros = vplArena_AllocZero(arena, 1000, 3);
    for (int i = 0; i < 3000; i++) {
        assert_int_equal(zeros[i], 0);
    }
    vplArena_Destroy(arena);
}

TEST(BlocksCanBeFreedInAnyOrder, 1)
{
    vplArena* arena = vplArena_Create(context);
    const size_t empty = vplContext_GetBytes(context);
    void* blocks[5];
    for (int i = 0; i < 5; i++) {
        blocks[i] = vplArena_Alloc(arena, 1, 100);
    }
    static const int order[5] = {2, 0, 4, 3, 1};
    for (int i = 0; i < 5; i++) {
        vplArena_Free(arena, blocks[order[i]]);
    }
    vplArena_Free(arena, NULL);
    assert_int_equal(vplContext_GetBytes(context), empty);
    assert_non_null(vplArena_Alloc(arena, 1, 100));
    vplArena_Destroy(arena);
}

TEST(ReservingKeepsElements, 1)
{
    vplArena* arena = vplArena_Create(context);
    int* numbers = NULL;
    size_t capacity = 0;
    for (int i = 0; i < 1000; i++) {
        assert_int_equal(vplArena_Reserve(arena, &numbers, &capacity, (size_t)i + 1, sizeof *numbers),
                         VPL_SUCCESS);
        numbers[i] = i;
    }
    for (int i = 0; i < 1000; i++) {
        assert_int_equal(numbers[i], i);
    }
    const int* copy = vplArena_Copy(arena, numbers, 1000, sizeof *numbers);
    assert_memory_equal(copy, numbers, 1000 * sizeof *numbers);
    assert_string_equal(vplArena_CopyString(arena, "name"), "name");
    assert_true(vplContext_GetBytes(context) < 4 * 1000 * sizeof *numbers); // old blocks are freed
    vplArena_Destroy(arena);
}

TEST(AnAbsorbedArenaIsFreedWithTheOther, 1)
{
    for (int blocks = 0; blocks < 4; blocks++) { // no, one or two blocks in either arena
        vplArena *arena = vplArena_Create(context), *source = vplArena_Create(context);
        void* first = NULL;
        for (int i = 0; i < blocks; i++) {
            first = vplArena_Alloc(i % 2 ? arena : source, 1, 10);
        }
        vplArena_Absorb(arena, source);
        vplArena_Free(arena, first);
        assert_non_null(vplArena_Alloc(arena, 1, 10));
        vplArena_Destroy(arena);
    }
}

// Creates an object of one arena, two arrays and a growing array: 6 allocations.
static vplResult makeObject(vplContext* context, void** objectOut)
{
    vplArena* arena = vplArena_Create(context);
    size_t capacity = 0;
    int* growing = NULL;
    int* object = vplArena_AllocZero(arena, 1, sizeof *object);
    vplArena_Alloc(arena, 10, 8);
    vplArena_CopyString(arena, "text");
    vplResult result = vplArena_Check(arena);
    for (size_t i = 1; i < 10 && result == VPL_SUCCESS; i++) {
        result = vplArena_Reserve(arena, &growing, &capacity, i, sizeof *growing);
    }
    assert_int_equal(result, vplArena_Check(arena));
    result = vplArena_Deliver(arena, result, object, objectOut);
    if (result == VPL_SUCCESS) {
        vplArena_Destroy(arena);
    }
    return result;
}

TEST_ALONE(EveryFailedAllocationIsReportedAndNothingLeaks)
{
    for (int allowed = 0; allowed <= 6; allowed++) {
        Quota quota = {1 + allowed, 0}; // one more for the context
        vplContext* context = openQuota(&quota);
        void* object = NULL;
        const vplResult result = makeObject(context, &object);
        assert_int_equal(result, allowed < 6 ? VPL_OUT_OF_MEMORY : VPL_SUCCESS);
        assert_int_equal(object != NULL, allowed == 6); // the output is untouched on failure
        closeQuota(context, &quota);
    }
}

TEST(ImpossibleSizesAreRefused, 1)
{
    vplArena* arena = vplArena_Create(context);
    assert_null(vplArena_Alloc(arena, SIZE_MAX / 2, 4));
    assert_int_equal(vplArena_Check(arena), VPL_OUT_OF_MEMORY);
    assert_null(vplArena_Alloc(arena, SIZE_MAX, 1));
    assert_non_null(strstr(takeMessage(), "out of memory"));
    vplArena_Destroy(arena);
    assert_null(vplArena_Alloc(NULL, 1, 1));
    assert_null(vplArena_AllocZero(NULL, 1, 1));
    assert_int_equal(vplArena_Check(NULL), VPL_OUT_OF_MEMORY);
}

static vplResult passOn(vplResult first, int* callsOut)
{
    *callsOut = 1;
    TRY(first);
    *callsOut = 2;
    return VPL_SUCCESS;
}

TEST_ALONE(TryReturnsTheFirstFailure)
{
    int calls;
    assert_int_equal(passOn(VPL_CANCELLED, &calls), VPL_CANCELLED);
    assert_int_equal(calls, 1);
    assert_int_equal(passOn(VPL_SUCCESS, &calls), VPL_SUCCESS);
    assert_int_equal(calls, 2);
}
