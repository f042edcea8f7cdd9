// SPDX-License-Identifier: MIT
// Helpers that the tests of glTF files share: files made of a text and a buffer.
#ifndef VPL_TESTS_GLTF_SUPPORT_H
#define VPL_TESTS_GLTF_SUPPORT_H

#include "obj_support.h"

typedef struct Blob {
    unsigned char bytes[8192];
    size_t size;
} Blob;

// Appends bytes or floats, aligned to 4; returns where they begin.
int addBytes(Blob* blob, const void* bytes, size_t size);
int addFloats(Blob* blob, const float* values, int count);

// Writes a file whose "buffers" are the blob. `json` is what stands behind "asset" and "buffers", a format for what
// follows. The buffer is in base64, or in the second chunk if the path ends in .glb.
void writeGltf(const char* path, const Blob* blob, const char* json, ...)
    __attribute__((format(printf, 3, 4)));

// Loads folder/a.gltf or another file of the desk's folder as a scene and removes it; fails the test if that fails.
vplScene* loadGltf(Desk* desk, const char* name);

// Writes the path of a file in the desk's folder.
const char* deskPath(const Desk* desk, const char* name);

// The parts of a file with one triangle, and its corners.
#define TRIANGLE                                                                                             \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{"               \
    "\"bufferView\":0,\"componentType\":"                                                                    \
    "5126,\"count\":3,\"type\":\"VEC2\"}"

#define VIEWS "],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}"

static const float POINTS[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};

#define NODES_HEAD "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"

void assertAround(double value, double wanted, double tolerance);

#endif
