// SPDX-License-Identifier: MIT
// Scenes from the inside: what a scene holds, movement along keyframes, parts of model files, and the origin.
#ifndef VPL_SCENETOOLS_H
#define VPL_SCENETOOLS_H

#include <vpl/scene.h>

VPL_HEADER_BEGIN

int vplScene_GetTextureCount(const vplScene* scene);
int vplScene_GetMaterialCount(const vplScene* scene);
int vplScene_GetMeshCount(const vplScene* scene);
int vplScene_GetObjectCount(const vplScene* scene);
int vplScene_GetEmitterCount(const vplScene* scene);

// The declared defs; the scene owns their names and arrays. The index must be in range.
const vplTextureDef* vplScene_GetTexture(const vplScene* scene, int index); // without `texels` and `linear`
const vplMaterialDef* vplScene_GetMaterial(const vplScene* scene, int index);
const vplMeshDef* vplScene_GetMesh(const vplScene* scene, int index);
const vplObjectDef* vplScene_GetObject(const vplScene* scene, int index);
const vplEmitterDef* vplScene_GetEmitter(const vplScene* scene, int index);

// The environment as it was set, with a copy of the picture that the scene owns; of a sky, the picture is the one that
// was made of it, without the sun.
const vplEnvironmentDef* vplScene_GetEnvironment(const vplScene* scene);

// True for a path that ends in .obj, .ply, .stl, .gltf or .glb, in either case.
bool vplIsModelPath(const char* path);

// Reads an OBJ file, with the MTL files that it names, as one mesh (see examples/scenes/README.md). Adds the
// materials that its faces use (Kd reflectance, Ke emission) under the names "file.obj:name", and a grey one
// for faces without a material. Unsupported statements are logged once each, as warnings. VPL_FILE_ERROR,
// VPL_OUT_OF_MEMORY, VPL_LIMIT, or VPL_PARSE_ERROR with "file:line:column:" in its message. indexOut may be NULL.
vplResult vplScene_LoadObj(vplScene* scene, const char* path, int* indexOut);

// Reads an OBJ, PLY or STL file, by its ending, as one mesh. A PLY or STL file adds one unnamed grey material, or a white
// one if the vertices have colours. VPL_INVALID_ARGUMENT for another ending; otherwise as vplScene_LoadObj; indexOut may be NULL.
vplResult vplScene_LoadMesh(vplScene* scene, const char* path, int* indexOut);

// Adds what a model file places as objects: one for an OBJ, PLY or STL file, one for each node of a glTF file that has a
// mesh, which all nodes that name it share. Each is as the def says (type and mesh have no effect), its own place in the
// file inside the def's transform; material -1: those of the file. Cameras and lights of the file are left out. The
// objects are countOut many from *firstOut on (both may be NULL). As vplScene_LoadMesh.
vplResult vplScene_LoadModel(vplScene* scene, const char* path, const vplObjectDef* def, int* firstOut,
                             int* countOut);

// Where the scene's own (0, 0, 0) lies in the caller's space, metres; (0, 0, 0) in a new scene. All positions
// of the scene, of its geometry and of its lights are relative to it, in float: a scene far from (0, 0, 0),
// such as 1e6 m, keeps its digits only if its positions are given relative to a near origin. Setting it moves
// nothing; it is added, in double, to positions that are written: by vpl lights, vpl info and in PLY files,
// which then hold doubles, good to 2^-24 of the distance from the origin. Each component in [-1e15, 1e15].
//
// vplScene_Load sets it where the middle of what a scene file places is more than 32 times as far from (0, 0,
// 0), along some axis, as from the outermost thing; then to the middle, rounded to a multiple of a power of
// two that is at least the scene's size. Else it stays 0, and scenes keep their bits. What it places are eyes,
// targets and their keys, translations of objects, and positions of lights; not the vertices of meshes.
vplResult vplScene_SetOrigin(vplScene* scene, const double origin[3]);
void vplScene_GetOrigin(const vplScene* scene, double originOut[3]);

// A keyframe of a camera; the fields are those of vplCameraDef.
typedef struct vplCameraKey {
    double frame; // [-VPL_MAX_FRAME, VPL_MAX_FRAME]
    vplVec3 eye, target, up;
    double fovY;
} vplCameraKey;

// A keyframe of an emitter; the fields are those of vplEmitterDef.
typedef struct vplEmitterKey {
    double frame; // [-VPL_MAX_FRAME, VPL_MAX_FRAME]
    vplVec3 position, direction;
    vplRgb intensity;
} vplEmitterKey;

// A keyframe of an object.
typedef struct vplTransformKey {
    double frame;      // [-VPL_MAX_FRAME, VPL_MAX_FRAME]
    vplMat4 transform; // as vplObjectDef.transform
} vplTransformKey;

// Most keys of a path, and the largest magnitude of a frame.
enum { VPL_MAX_KEYS = 1 << 20, VPL_MAX_FRAME = 1000000000 };

// A key with the values of the def. Change those that the path changes.
vplCameraKey vplMakeCameraKey(const vplCameraDef* def, double frame);
vplEmitterKey vplMakeEmitterKey(const vplEmitterDef* def, double frame);

// Makes a camera or an emitter move along keyframes: linear interpolation between two keys, constant before
// the first and after the last. Frames must increase, and the values at each key must be valid for a def.
// Replaces the path that was set before; with 0 keys it stands still, as declared. VPL_INVALID_ARGUMENT,
// VPL_OUT_OF_MEMORY.
vplResult vplScene_SetCameraPath(vplScene* scene, int index, const vplCameraKey* keys, int count);
vplResult vplScene_SetEmitterPath(vplScene* scene, int index, const vplEmitterKey* keys, int count);

// Makes an object move along keyframes, as above; between two keys the numbers of the matrices are interpolated. Rendering
// changes no scene, so an object stands where its path is at frame 0 until vplScene_SetFrame moves it. The index must be in
// range. VPL_INVALID_ARGUMENT, VPL_OUT_OF_MEMORY.
vplResult vplScene_SetObjectPath(vplScene* scene, int object, const vplTransformKey* keys, int count);

// Moves all objects that have a path to where it is at a frame, a finite number: as vplScene_SetTransform does, but they keep
// their paths, and nothing changes where no object moves. Call it before frames are rendered with
// vplRenderOptions.sequence.frame, which moves cameras and emitters. VPL_INVALID_ARGUMENT if a matrix between two keys cannot
// be inverted; a failure changes nothing.
vplResult vplScene_SetFrame(vplScene* scene, double frame);

// The keys of a path, which the scene owns; NULL and 0 if there is none. The index must be in range.
const vplCameraKey* vplScene_GetCameraPath(const vplScene* scene, int index, int* countOut);
const vplEmitterKey* vplScene_GetEmitterPath(const vplScene* scene, int index, int* countOut);
const vplTransformKey* vplScene_GetObjectPath(const vplScene* scene, int object, int* countOut);

// The camera or emitter at a frame, a finite number. VPL_INVALID_ARGUMENT if the interpolated values are
// invalid: the eye meets the target, the view meets the up vector, or opposite directions cancel.
vplResult vplScene_PoseCamera(const vplScene* scene, int index, double frame, vplCameraDef* defOut);
vplResult vplScene_PoseEmitter(const vplScene* scene, int index, double frame, vplEmitterDef* defOut);

// Hash of all that a picture depends on: cameras and emitters with their paths, textures, materials, meshes and objects where
// they stand now, in their order, without names, and the environment. The same in every process and on every machine; it takes
// a pass over the scene's data.
uint64_t vplScene_GetHash(const vplScene* scene);

VPL_HEADER_END

#endif
