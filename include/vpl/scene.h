// SPDX-License-Identifier: MIT
// What the user declares: cameras, materials, objects and emitters. Adding a thing checks every number of it.
#ifndef VPL_SCENE_H
#define VPL_SCENE_H

#include <vpl/vecmath.h>

#ifdef __cplusplus
extern "C" {
#endif

// Largest magnitude of a coordinate, size, intensity or radiance: squares of distances stay finite in float.
#define VPL_MAX_MAGNITUDE 1e15f

typedef struct vplCameraDef {
    vplVec3 eye;     // metres; default (0, 0, 5)
    vplVec3 target;  // metres, not the eye; default (0, 0, 0)
    vplVec3 up;      // any length, not along the view; default (0, 1, 0)
    double fovY;     // full vertical angle of view, radians, (0, pi); default 40 degrees
    double near;     // metres, > 0; default 0.1
    double far;      // metres, > near; default 100
    uint32_t cookie; // set by vplDefaultCameraDef
} vplCameraDef;

vplCameraDef vplDefaultCameraDef(void);

typedef struct vplMaterialDef {
    const char* name; // copied; unique within the scene; NULL (default): unnamed
    vplRgb diffuse;   // reflectance, [0, 1] per channel; default 0.5; both sides of a surface reflect
    vplRgb emission;  // radiance, W/(m^2 sr), >= 0; default 0; only the front side emits
    uint32_t cookie;  // set by vplDefaultMaterialDef
} vplMaterialDef;

vplMaterialDef vplDefaultMaterialDef(void);

// Triangles with an order of corners that is counter-clockwise seen from the front.
typedef struct vplMeshDef {
    const vplVec3* positions; // vertexCount points in object space
    const vplVec3* normals; // vertexCount shading normals of any length but 0; NULL (default): flat triangles
    const uint32_t* indices; // three per triangle, each < vertexCount
    const int* materials; // one per triangle, as given by vplScene_AddMaterial; NULL (default): the object's
    int vertexCount;      // [0, VPL_MAX_TRIANGLES]; default 0
    int triangleCount;    // [0, VPL_MAX_TRIANGLES]; default 0
    uint32_t cookie;      // set by vplDefaultMeshDef
} vplMeshDef;

vplMeshDef vplDefaultMeshDef(void);

typedef enum vplObjectType {
    VPL_OBJECT_QUAD = 0, // [-0.5, 0.5]^2 at z = 0, front towards +z
    VPL_OBJECT_BOX,      // [-0.5, 0.5]^3, front outwards
    VPL_OBJECT_MESH      // triangles
} vplObjectType;

typedef struct vplObjectDef {
    const char* name;   // copied; NULL (default): unnamed
    vplObjectType type; // default VPL_OBJECT_QUAD
    int material;       // index given by vplScene_AddMaterial; -1: the mesh's own; default 0
    int mesh;           // index given by vplScene_AddMesh; mesh only; default 0
    vplMat4 transform;  // object to world, affine, not singular; default identity
    uint32_t cookie;    // set by vplDefaultObjectDef
} vplObjectDef;

vplObjectDef vplDefaultObjectDef(void);

typedef enum vplEmitterType {
    VPL_EMITTER_POINT = 0,  // the same intensity in all directions
    VPL_EMITTER_SPOT,       // a cone: full intensity inside innerAngle, none outside outerAngle
    VPL_EMITTER_DIRECTIONAL // parallel light from infinity
} vplEmitterType;

typedef struct vplEmitterDef {
    vplEmitterType type; // default VPL_EMITTER_POINT
    vplVec3 position;    // metres; point and spot; default 0
    vplVec3 direction;   // where light travels, any length but 0; spot and directional; default (0, -1, 0)
    vplRgb intensity;    // W/sr (point, spot) or irradiance in W/m^2 (directional), >= 0; default 1
    double innerAngle;   // half-angle of the cone, radians, [0, outerAngle]; spot; default 20 degrees
    double outerAngle;   // half-angle of the cone, radians, (0, pi / 2); spot; default 30 degrees
    uint32_t cookie;     // set by vplDefaultEmitterDef
} vplEmitterDef;

vplEmitterDef vplDefaultEmitterDef(void);

// What a camera is at one frame of its path.
typedef struct vplCameraKey {
    double frame; // any finite number within VPL_MAX_FRAME
    vplVec3 eye, target, up;
    double fovY;
} vplCameraKey;

// What an emitter is at one frame of its path.
typedef struct vplEmitterKey {
    double frame; // as in vplCameraKey
    vplVec3 position, direction;
    vplRgb intensity;
} vplEmitterKey;

// Most keys of a path, and the largest magnitude of their frames.
enum { VPL_MAX_KEYS = 1 << 20, VPL_MAX_FRAME = 1000000000 };

// A key at which all is as declared: set what the path changes.
vplCameraKey vplMakeCameraKey(const vplCameraDef* def, double frame);
vplEmitterKey vplMakeEmitterKey(const vplEmitterDef* def, double frame);

// Everything that a render needs to know of the world. Not changed by rendering.
typedef struct vplScene vplScene;

vplResult vplScene_Create(vplContext* context, vplScene** sceneOut);

// NULL is allowed.
void vplScene_Destroy(vplScene* scene);

// Reads a scene file (see README: Scene files). A mistake is logged as file:line:column: what was found, what
// was expected. A path that ends in .obj is read as one mesh with a camera that fits it in and, if nothing
// emits, a point light; both are logged.
vplResult vplScene_Load(vplContext* context, const char* path, vplScene** sceneOut);

// Each checks the def, copies it and gives its index (indexOut may be NULL).
vplResult vplScene_AddCamera(vplScene* scene, const vplCameraDef* def, int* indexOut);
vplResult vplScene_AddMaterial(vplScene* scene, const vplMaterialDef* def, int* indexOut);
vplResult vplScene_AddMesh(vplScene* scene, const vplMeshDef* def, int* indexOut);
vplResult vplScene_AddObject(vplScene* scene, const vplObjectDef* def, int* indexOut);
vplResult vplScene_AddEmitter(vplScene* scene, const vplEmitterDef* def, int* indexOut);

// Makes a camera or an emitter move: from key to key, all that they hold changes evenly with the frame; before the first
// and after the last it stays. Frames must increase, and at each key the camera or emitter must be one that could
// be declared. Replaces a path that was there; 0 keys: it stands still, as declared. The index must be in range.
vplResult vplScene_SetCameraPath(vplScene* scene, int index, const vplCameraKey* keys, int count);
vplResult vplScene_SetEmitterPath(vplScene* scene, int index, const vplEmitterKey* keys, int count);

// Reads an OBJ file with the MTL files it names (see README: Meshes) and adds one mesh of all its faces and the
// materials they use (Kd reflectance, Ke emission), named "file.obj:name". Faces without a material get a grey
// one. What is not understood is logged once as a warning; a damaged line is an error with file:line:column.
vplResult vplScene_LoadObj(vplScene* scene, const char* path, int* indexOut);

int vplScene_GetCameraCount(const vplScene* scene);
int vplScene_GetMaterialCount(const vplScene* scene);
int vplScene_GetMeshCount(const vplScene* scene);
int vplScene_GetObjectCount(const vplScene* scene);
int vplScene_GetEmitterCount(const vplScene* scene);

// The declared things, with names owned by the scene. The index must be in range.
const vplCameraDef* vplScene_GetCamera(const vplScene* scene, int index);
const vplMaterialDef* vplScene_GetMaterial(const vplScene* scene, int index);
const vplMeshDef* vplScene_GetMesh(const vplScene* scene, int index);
const vplObjectDef* vplScene_GetObject(const vplScene* scene, int index);
const vplEmitterDef* vplScene_GetEmitter(const vplScene* scene, int index);

// The keys of its path, owned by the scene; NULL and 0 where it stands still. The index must be in range.
const vplCameraKey* vplScene_GetCameraPath(const vplScene* scene, int index, int* countOut);
const vplEmitterKey* vplScene_GetEmitterPath(const vplScene* scene, int index, int* countOut);

// What it is at a frame (finite). VPL_INVALID_ARGUMENT where between two good keys the eye meets the target, the view
// its up vector, or opposite directions cancel.
vplResult vplScene_PoseCamera(const vplScene* scene, int index, double frame, vplCameraDef* defOut);
vplResult vplScene_PoseEmitter(const vplScene* scene, int index, double frame, vplEmitterDef* defOut);

vplContext* vplScene_GetContext(const vplScene* scene);

#ifdef __cplusplus
}
#endif

#endif
