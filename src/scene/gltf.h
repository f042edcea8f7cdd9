// SPDX-License-Identifier: MIT
// Reads glTF 2.0 files (.gltf and .glb).
// Based on: Khronos Group, glTF 2.0 Specification, version 2.0.1, 2021, and the extensions that its files name.
#ifndef VPL_SCENE_GLTF_H
#define VPL_SCENE_GLTF_H

#include "scene/hash_index.h"
#include "scene/json_reader.h"
#include "scene/model.h"

// The arrays at the top of a file.
typedef enum vplGltfList {
    VPL_GLTF_ACCESSORS,
    VPL_GLTF_ANIMATIONS,
    VPL_GLTF_BUFFERS,
    VPL_GLTF_VIEWS,
    VPL_GLTF_CAMERAS,
    VPL_GLTF_IMAGES,
    VPL_GLTF_MATERIALS,
    VPL_GLTF_MESHES,
    VPL_GLTF_NODES,
    VPL_GLTF_SAMPLERS,
    VPL_GLTF_SCENES,
    VPL_GLTF_TEXTURES,
    VPL_GLTF_LIGHTS, // of KHR_lights_punctual
    VPL_GLTF_LISTS
} vplGltfList;

// What is left out or changed, each with one warning for the file.
typedef enum vplGltfLoss {
    VPL_GLTF_POINTS,
    VPL_GLTF_EMPTY,
    VPL_GLTF_METALS,
    VPL_GLTF_SKINS,
    VPL_GLTF_MORPHS,
    VPL_GLTF_FLAT,
    VPL_GLTF_RANGES,
    VPL_GLTF_ORTHOGRAPHIC,
    VPL_GLTF_NO_CAMERA,
    VPL_GLTF_UNUSED,
    VPL_GLTF_FLAT_FRAMES,
    VPL_GLTF_EMITS_ONE_SIDED,
    VPL_GLTF_EMISSIVE_TEXTURES,
    VPL_GLTF_NO_PICTURE,
    VPL_GLTF_OTHER_SET,
    VPL_GLTF_LOSSES
} vplGltfLoss;

typedef struct vplGltfBuffer {
    const uint8_t* bytes; // NULL: not read yet
    size_t size;
} vplGltfBuffer;

typedef struct vplGltfMean {
    bool known;
    double mean[3];
} vplGltfMean;

typedef struct vplGltfNode {
    int parent; // -1: none
    int mesh, camera, light;
    bool inScene, moves; // moves: by a curve of its own
    vplAffine toParent, toModel;
} vplGltfNode;

typedef struct vplGltf {
    vplScene* scene;
    vplContext* context;
    vplArena* scratch;
    const char* path;
    char* file; // a .glb file, which the chunk is in
    const uint8_t* chunk;
    size_t chunkSize;
    vplJsonFile json;
    vplJson root, extensions, punctual, lists[VPL_GLTF_LISTS];
    vplGltfBuffer* buffers;
    vplGltfNode* nodes;
    int* order; // nodes, parents before children
    int orderCount;
    int *meshOf, *materialOf, *textureOf; // of the scene, by the file's; -1: none, -2: not read yet
    vplGltfMean* means;                   // two for each image: of numbers, of colours
    int defaultMaterial;                  // of the scene; -2: not read yet
    const char* prefix;                   // of names of materials
    vplNames names;                       // of materials so far
    long long losses[VPL_GLTF_LOSSES];
} vplGltf;

enum { VPL_GLTF_NOT_READ = -2 };

// Adds what a glTF file places, as vplScene_ReadModel says.
vplResult vplScene_ReadGltf(vplScene* scene, const char* path, bool whole, vplModel* model);

// ---- the file

// Reads the JSON of a file, checks its version and the extensions that it requires. Close it, also on failure.
vplResult vplGltf_Open(vplGltf* g);
void vplGltf_Close(vplGltf* g);

int vplGltf_Count(const vplGltf* g, vplGltfList list);
vplJson vplGltf_Item(const vplGltf* g, vplGltfList list, int index);

// Each reads a member of an object; a missing one leaves *out as it is. An index is below `count`; a whole number is
// in [0, 2^53].
vplResult vplGltf_ReadIndex(const vplJson* object, const char* key, int count, int* out);
vplResult vplGltf_ReadWhole(const vplJson* object, const char* key, int64_t* out);

// Reads an index that is an element of an array.
vplResult vplGltf_ReadElement(const vplJson* element, int count, int* out);

// The bytes of a buffer view, whose stride is 0 if it has none.
vplResult vplGltf_ReadView(vplGltf* g, int index, const uint8_t** bytesOut, size_t* sizeOut,
                           size_t* strideOut);

// The path of a file beside this one that a URI names.
vplResult vplGltf_FindBeside(vplGltf* g, const char* uri, const char** pathOut);

// Reads a URI: data in base64, or a file beside. *bytesOut is in the scratch arena.
vplResult vplGltf_ReadUri(vplGltf* g, const vplJson* owner, const uint8_t** bytesOut, size_t* sizeOut);

// ---- accessors

typedef struct vplGltfAccessor {
    int64_t count;
    int components; // 1 to 4
    int type;       // of a component, 5120 to 5126
    bool normalized;
    const uint8_t* bytes; // NULL: zeros
    size_t stride;
    int64_t sparseCount;
    const uint8_t *sparseIndices, *sparseValues;
    int sparseType; // of the indices
} vplGltfAccessor;

// Opens the accessor that `object` names under `key`, whose value may be missing (then count is -1). It must have one
// of the numbers of components whose bits (1 << components) are set. All its bytes are inside their buffers.
vplResult vplGltf_OpenAccessor(vplGltf* g, const vplJson* object, const char* key, unsigned components,
                               vplGltfAccessor* out);

// Writes count * components numbers, each times 1 / the largest of its type if normalized.
void vplGltfAccessor_CopyFloats(const vplGltfAccessor* accessor, float* out);

// Writes the numbers of a scalar accessor of unsigned integers.
void vplGltfAccessor_CopyIndices(const vplGltfAccessor* accessor, uint32_t* out);

// ---- meshes and materials

// The mesh of the scene for one of the file, which it reads when it is first asked for; -1 if it has no triangles.
vplResult vplGltf_GetMesh(vplGltf* g, int index, int* out);

// Reads the texture that `key` of an object names into a material.
vplResult vplGltf_ReadTexture(vplGltf* g, const vplJson* object, const char* key, vplMaterialDef* def);

// The mean of such a texture's channels, of linear light if it has colours; 1 if there is none.
vplResult vplGltf_ReadMean(vplGltf* g, const vplJson* object, const char* key, bool colours,
                           double meanOut[3]);

// The material of the scene for one of the file, or for -1, the default material.
vplResult vplGltf_GetMaterial(vplGltf* g, int index, int* out);

// ---- nodes

// Finds parents, order and places of all nodes, and which of them are in the scene that the file shows.
vplResult vplGltf_ReadNodes(vplGltf* g);

// The place of a node in its parent. The members that a node has replace those of *out.
typedef struct vplGltfPlace {
    double translation[3], rotation[4], scale[3]; // rotation: a quaternion x, y, z, w
} vplGltfPlace;
vplResult vplGltf_ReadPlace(const vplJson* node, vplGltfPlace* out);
vplAffine vplGltfPlace_ToAffine(const vplGltfPlace* place);

// Adds the cameras and lights of the nodes in the scene, with their paths.
struct vplGltfMotion;
vplResult vplGltf_AddCameras(vplGltf* g, const vplModel* model, const struct vplGltfMotion* motion);
vplResult vplGltf_AddLights(vplGltf* g, const struct vplGltfMotion* motion);

// ---- animations

// A sampled curve of a node's translation, rotation or scale.
typedef struct vplGltfCurve {
    int node, part; // 0: translation, 1: rotation, 2: scale
    int form;       // 0: linear, 1: step, 2: cubic spline
    int count;
    const float *times, *values;
} vplGltfCurve;

typedef struct vplGltfMotion {
    vplGltfCurve* curves;
    size_t count, capacity;
} vplGltfMotion;

// Reads the curves of all animations, which play together.
vplResult vplGltf_ReadMotion(vplGltf* g, vplGltfMotion* out);

// Finds the first and last whole frame of the motion of a node or of those above it. VPL_LIMIT.
vplResult vplGltfMotion_FindFrames(vplGltf* g, const vplGltfMotion* m, int node, int64_t* firstOut,
                                   int64_t* lastOut, bool* movesOut);

// The place of a node in the model at a frame.
vplAffine vplGltfMotion_Place(const vplGltf* g, const vplGltfMotion* m, int node, double frame);

// Frames in a second of a glTF file's time.
#define VPL_GLTF_FRAME_RATE 24.0

enum { VPL_GLTF_MAX_FRAMES = 100000 }; // 69 minutes

#endif
