// SPDX-License-Identifier: MIT
// Helpers that the fuzz targets share. Each target is linked with libFuzzer, or with replay.c, which runs a
// corpus once.
#ifndef VPL_TESTS_FUZZ_FUZZ_H
#define VPL_TESTS_FUZZ_FUZZ_H

#include <vpl/stages.h>

#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size);

// States a condition that must hold for every input; both libFuzzer and the replay notice abort().
#define MUST(condition)                                                                                      \
    do {                                                                                                     \
        if (!(condition)) {                                                                                  \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);                                  \
            abort();                                                                                         \
        }                                                                                                    \
    } while (0)

// Refuses blocks over 64 MB, which only corrupt headers request, so that fuzzing stays fast and needs little
// memory.
static inline void* fuzzAlloc(void* user, void* memory, size_t oldSize, size_t newSize)
{
    (void)user;
    (void)oldSize;
    if (newSize == 0) {
        free(memory);
        return NULL;
    }
    return newSize > ((size_t)64 << 20) ? NULL : realloc(memory, newSize);
}

// Keeps the last message, so that the target finds failures without a message.
typedef struct FuzzLog {
    char message[1200];
    int errors;
} FuzzLog;

static inline void fuzzLog(void* user, vplLogLevel level, const char* message)
{
    FuzzLog* log = user;
    log->errors += level == VPL_LOG_ERROR;
    snprintf(log->message, sizeof log->message, "%s", message);
}

static inline vplContext* openFuzzContext(FuzzLog* log)
{
    vplContextDef def = vplDefaultContextDef();
    def.alloc = fuzzAlloc;
    def.log = fuzzLog;
    def.logUser = log;
    def.workerCount = 1;
    vplContext* context = NULL;
    MUST(vplContext_Create(&def, &context) == VPL_SUCCESS);
    return context;
}

// A floor under a lamp.
static inline vplScene* makeFuzzScene(vplContext* context)
{
    vplScene* scene;
    vplMaterialDef material = vplDefaultMaterialDef();
    vplObjectDef object = vplDefaultObjectDef();
    vplCameraDef camera = vplDefaultCameraDef();
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.position = (vplVec3){0, 0, 2};
    MUST(vplScene_Create(context, &scene) == VPL_SUCCESS);
    MUST(vplScene_AddMaterial(scene, &material, NULL) == VPL_SUCCESS);
    MUST(vplScene_AddObject(scene, &object, NULL) == VPL_SUCCESS);
    MUST(vplScene_AddCamera(scene, &camera, NULL) == VPL_SUCCESS);
    MUST(vplScene_AddEmitter(scene, &emitter, NULL) == VPL_SUCCESS);
    return scene;
}

static inline void closeFuzzContext(vplContext* context)
{
    MUST(vplContext_GetBytes(context) == 0);
    vplContext_Destroy(context);
}

// Returns whether the text is one line of valid UTF-8 without control characters, which any terminal can
// show.
static inline bool isPrintable(const char* text)
{
    for (const unsigned char* p = (const unsigned char*)text; *p != 0; p++) {
        int more = *p < 0x80 ? 0 : *p >= 0xF0 ? 3 : *p >= 0xE0 ? 2 : *p >= 0xC2 ? 1 : -1;
        if (*p < 0x20 || *p == 0x7F || more < 0) {
            return false;
        }
        for (; more > 0; more--) {
            if ((*++p & 0xC0) != 0x80) {
                return false;
            }
        }
    }
    return true;
}

// The bytes that choices are made from. After the last one every choice is 0, the usual value.
typedef struct Bytes {
    const uint8_t* at;
    size_t left;
} Bytes;

// A number below `count`.
static inline unsigned pick(Bytes* b, unsigned count)
{
    if (b->left == 0) {
        return 0;
    }
    b->left--;
    return *b->at++ % count;
}

// A number in [0, 1].
static inline double unit(Bytes* b)
{
    return (pick(b, 256) + 256.0 * pick(b, 256)) / 65535;
}

// Runs the last task first, and each on another worker than the one before.
static inline void backwards(void* user, int taskCount, int workerCount, vplTaskFcn* task, void* data)
{
    (void)user;
    for (int i = taskCount - 1; i >= 0; i--) {
        task(data, i, i % workerCount);
    }
}

#endif
