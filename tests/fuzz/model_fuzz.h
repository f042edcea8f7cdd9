// SPDX-License-Identifier: MIT
// What the fuzzers of model files share: bytes as a file of a given ending, read twice.
#ifndef VPL_TESTS_FUZZ_MODEL_FUZZ_H
#define VPL_TESTS_FUZZ_MODEL_FUZZ_H

#include "fuzz.h"

#include "scene/scene.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

static inline void requireMeshes(const vplScene* scene)
{
    for (int m = 0; m < vplScene_GetMeshCount(scene); m++) {
        const vplMeshDef* mesh = vplScene_GetMesh(scene, m);
        MUST(vplCheckMesh(mesh, vplScene_GetMaterialCount(scene)).field == NULL && mesh->triangleCount > 0);
        for (int i = 0; mesh->normals != NULL && i < mesh->vertexCount; i++) {
            const vplVec3 n = mesh->normals[i];
            MUST(fabsf(n.x * n.x + n.y * n.y + n.z * n.z - 1) < 1e-5f);
        }
    }
    for (int i = 0; i < vplScene_GetMaterialCount(scene); i++) {
        MUST(vplCheckMaterial(vplScene_GetMaterial(scene, i), vplScene_GetTextureCount(scene)).field == NULL);
    }
    for (int i = 0; i < vplScene_GetObjectCount(scene); i++) {
        MUST(vplCheckTransform(&vplScene_GetObject(scene, i)->transform).field == NULL);
    }
    for (int i = 0; i < vplScene_GetEmitterCount(scene); i++) {
        MUST(vplCheckEmitter(vplScene_GetEmitter(scene, i)).field == NULL);
    }
    for (int i = 0; i < vplScene_GetCameraCount(scene); i++) {
        MUST(vplCheckCamera(vplScene_GetCamera(scene, i)).field == NULL);
    }
}

// Loads the file as a scene and returns its hash; 0 if it was refused.
static inline uint64_t loadModelScene(const char* path)
{
    FuzzLog log = {{0}, 0};
    vplContext* context = openFuzzContext(&log);
    vplScene* scene = NULL;
    uint64_t hash = 0;
    const vplResult result = vplScene_Load(context, path, &scene);
    if (result == VPL_SUCCESS) {
        MUST(log.errors == 0 && isPrintable(log.message));
        requireMeshes(scene);
        hash = vplScene_GetHash(scene) | 1;
    } else {
        MUST(result == VPL_PARSE_ERROR || result == VPL_OUT_OF_MEMORY || result == VPL_LIMIT);
        MUST(scene == NULL && log.errors >= 1 && isPrintable(log.message));
        MUST(result != VPL_PARSE_ERROR || (log.errors == 1 && strncmp(log.message, path, strlen(path)) == 0));
    }
    vplScene_Destroy(scene);
    closeFuzzContext(context);
    return hash;
}

static inline void fuzzModel(const uint8_t* bytes, size_t size, const char* ending)
{
    char path[64];
    snprintf(path, sizeof path, "/tmp/vpl-fuzz-%ld.%s", (long)getpid(), ending);
    FILE* file = fopen(path, "wb");
    MUST(file != NULL && fwrite(bytes, 1, size, file) == size);
    fclose(file);
    const uint64_t hash = loadModelScene(path);
    MUST(loadModelScene(path) == hash);
    unlink(path);
}

#endif
