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

typedef enum vplObjectType {
    VPL_OBJECT_QUAD = 0, // [-0.5, 0.5]^2 at z = 0, front towards +z
    VPL_OBJECT_BOX       // [-0.5, 0.5]^3, front outwards
} vplObjectType;

typedef struct vplObjectDef {
    const char* name;   // copied; NULL (default): unnamed
    vplObjectType type; // default VPL_OBJECT_QUAD
    int material;       // index given by vplScene_AddMaterial; default 0
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

// Everything that a render needs to know of the world. Not changed by rendering.
typedef struct vplScene vplScene;

vplResult vplScene_Create(vplContext* context, vplScene** sceneOut);

// NULL is allowed.
void vplScene_Destroy(vplScene* scene);

// Reads a scene file (see README: Scene files). A mistake is logged as file:line:column: what was found, what
// was expected.
vplResult vplScene_Load(vplContext* context, const char* path, vplScene** sceneOut);

// Each checks the def, copies it and gives its index (indexOut may be NULL).
vplResult vplScene_AddCamera(vplScene* scene, const vplCameraDef* def, int* indexOut);
vplResult vplScene_AddMaterial(vplScene* scene, const vplMaterialDef* def, int* indexOut);
vplResult vplScene_AddObject(vplScene* scene, const vplObjectDef* def, int* indexOut);
vplResult vplScene_AddEmitter(vplScene* scene, const vplEmitterDef* def, int* indexOut);

int vplScene_GetCameraCount(const vplScene* scene);
int vplScene_GetMaterialCount(const vplScene* scene);
int vplScene_GetObjectCount(const vplScene* scene);
int vplScene_GetEmitterCount(const vplScene* scene);

// The declared things, with names owned by the scene. The index must be in range.
const vplCameraDef* vplScene_GetCamera(const vplScene* scene, int index);
const vplMaterialDef* vplScene_GetMaterial(const vplScene* scene, int index);
const vplObjectDef* vplScene_GetObject(const vplScene* scene, int index);
const vplEmitterDef* vplScene_GetEmitter(const vplScene* scene, int index);

vplContext* vplScene_GetContext(const vplScene* scene);

#ifdef __cplusplus
}
#endif

#endif
