// SPDX-License-Identifier: MIT
// Passes arbitrary bytes as an OBJ file and, after the first byte 0x1F, as the MTL file that it may name
// "100". The reader must either log one sentence with file, line and column and leave the scene unchanged, or
// make a valid mesh, which a second reading reproduces.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "fuzz.h"

#include "base/hash.h"
#include "scene/obj_number.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { OBJ_FILE = 99, MTL_FILE = 100 };

#define FOLDER "/proc/self/fd/"

// Gives bytes in memory a file name under /proc, because the reader opens files by name.
static void writeMemoryFile(int number, const uint8_t* bytes, size_t size)
{
    int fd = memfd_create("obj", MFD_CLOEXEC);
    MUST(fd >= 0 && dup2(fd, number) == number);
    MUST(write(number, bytes, size) == (ssize_t)size);
    close(fd);
}

static void requireSentence(const FuzzLog* log)
{
    int line, column, used = 0;
    const char* place = log->message + strcspn(log->message, ":"); // an mtllib may name any open file
    MUST(log->errors == 1 && isPrintable(log->message));
    MUST(strncmp(log->message, FOLDER, strlen(FOLDER)) == 0);
    MUST(sscanf(place, ":%d:%d: found %n", &line, &column, &used) == 2 && used > 0);
    MUST(line >= 1 && column >= 1 && strstr(place + used, "expected ") != NULL);
}

static void requireMesh(const vplScene* scene)
{
    const vplMeshDef* mesh = vplScene_GetMesh(scene, 0);
    vplFault fault = vplCheckMesh(mesh, vplScene_GetMaterialCount(scene));
    MUST(fault.field == NULL && mesh->triangleCount > 0 && mesh->materials != NULL);
    for (int i = 0; mesh->normals != NULL && i < mesh->vertexCount; i++) {
        vplVec3 n = mesh->normals[i];
        MUST(fabsf(n.x * n.x + n.y * n.y + n.z * n.z - 1) < 1e-5f);
    }
    for (int i = 0; i < vplScene_GetMaterialCount(scene); i++) {
        MUST(vplCheckMaterial(vplScene_GetMaterial(scene, i), vplScene_GetTextureCount(scene)).field == NULL);
    }
}

static uint64_t hashMesh(const vplScene* scene)
{
    const vplMeshDef* mesh = vplScene_GetMesh(scene, 0);
    size_t vertices = (size_t)mesh->vertexCount, triangles = (size_t)mesh->triangleCount;
    uint64_t hash = vplHashFloats(0, &mesh->positions[0].x, 3 * vertices);
    hash = mesh->normals ? vplHashFloats(hash, &mesh->normals[0].x, 3 * vertices) : hash;
    hash = vplHashWords(hash, mesh->indices, 3 * triangles);
    return vplHashWords(hash, (const uint32_t*)mesh->materials, triangles);
}

// Loads the file and returns the hash of its mesh, 0 if the file was refused.
static uint64_t load(void)
{
    FuzzLog log = {{0}, 0};
    vplContext* context = openFuzzContext(&log);
    vplScene* scene = NULL;
    uint64_t hash = 0;
    int mesh = -1;
    char name[32];
    snprintf(name, sizeof name, FOLDER "%d", OBJ_FILE);
    MUST(vplScene_Create(context, &scene) == VPL_SUCCESS);
    vplResult result = vplScene_LoadObj(scene, name, &mesh);
    if (result == VPL_SUCCESS) {
        MUST(mesh == 0 && log.errors == 0 && isPrintable(log.message));
        requireMesh(scene);
        hash = hashMesh(scene);
    } else {
        MUST(result == VPL_PARSE_ERROR && mesh == -1);
        MUST(vplScene_GetMeshCount(scene) == 0 && vplScene_GetMaterialCount(scene) == 0);
        requireSentence(&log);
    }
    vplScene_Destroy(scene);
    closeFuzzContext(context);
    return hash;
}

// Requires that strtof accepts every number that libvpl accepts, with the same bits.
static void requireNumber(const uint8_t* bytes, size_t size)
{
    char text[512], *end;
    float value;
    size = size < sizeof text - 1 ? size : sizeof text - 1;
    memcpy(text, bytes, size);
    text[size] = 0;
    size_t length = strcspn(text, " \n");
    text[length] = 0;
    if (vplReadNumber(text, text + length, &value)) {
        float wanted = strtof(text, &end);
        MUST(end == text + length && wanted == value);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    const uint8_t* split = size ? memchr(bytes, 0x1F, size) : NULL;
    size_t objSize = split ? (size_t)(split - bytes) : size;
    writeMemoryFile(OBJ_FILE, bytes, objSize);
    writeMemoryFile(MTL_FILE, split ? split + 1 : bytes, split ? size - objSize - 1 : 0);
    uint64_t hash = load();
    MUST(load() == hash);
    close(OBJ_FILE);
    close(MTL_FILE);
    requireNumber(bytes, size);
    return 0;
}
