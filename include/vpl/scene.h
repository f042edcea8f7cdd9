// SPDX-License-Identifier: MIT
// The declared scene: cameras, textures, materials, meshes, objects, emitters and environment. Each addition checks all its
// numbers.
#ifndef VPL_SCENE_H
#define VPL_SCENE_H

#include <vpl/vecmath.h>

VPL_HEADER_BEGIN

// Largest magnitude of a coordinate, size, intensity or radiance. Squares of distances stay finite in float.
#define VPL_MAX_MAGNITUDE 1e15f

typedef struct vplCameraDef {
    vplVec3 eye;      // metres; default (0, 0, 5)
    vplVec3 target;   // metres, not the eye; default (0, 0, 0)
    vplVec3 up;       // any length but 0, not parallel to the view; default (0, 1, 0)
    double fovY;      // full vertical angle of view, radians, (0, pi); default 40 degrees
    double nearPlane; // metres, > 0; default 0.1
    double farPlane;  // metres, > nearPlane; default 100
    uint32_t cookie;  // set by vplDefaultCameraDef
} vplCameraDef;

vplCameraDef vplDefaultCameraDef(void);

// What lies beyond the edges of a texture: the picture again, its edge texels, or its mirror image.
typedef enum vplTextureWrap { VPL_WRAP_REPEAT = 0, VPL_WRAP_CLAMP, VPL_WRAP_MIRROR } vplTextureWrap;

// A picture that colours surfaces. The first texel is the left one of the top row. Texture coordinates have
// (0, 0) at the bottom left corner of the picture and (1, 1) at the top right one, as in OBJ files. Exactly one
// of `texels` and `linear` must be given.
typedef struct vplTextureDef {
    const char* name; // a file name or label, for messages; copied; NULL (default): unnamed
    // width x height x channels values of 8 bits: sRGB colours or greys, linear alpha. Copied.
    const unsigned char* texels;
    // The same as linear floats in [0, 1]. Copied.
    const float* linear;
    int width, height;           // texels, [1, VPL_MAX_IMAGE_SIZE]
    int channels;                // 1: grey, 2: grey and alpha, 3: RGB, 4: RGB and alpha; default 3
    vplTextureWrap wrapU, wrapV; // default VPL_WRAP_REPEAT
    uint32_t cookie;             // set by vplDefaultTextureDef
} vplTextureDef;

vplTextureDef vplDefaultTextureDef(void);

// The opacity of a point is `opacity`, times the alpha of `texture` if alphaFromTexture, times the grey of
// `alphaTexture` if there is one. Surfaces have no colour of their own where they let light through, and let it
// through straight and from both sides alike.
typedef struct vplMaterialDef {
    const char* name;       // copied; unique within the scene; NULL (default): unnamed
    vplRgb diffuse;         // reflectance of both sides, [0, 1] per channel; default 0.5
    vplRgb emission;        // radiance of the front side, W/(m^2 sr), >= 0; default 0
    int texture;            // as vplScene_AddTexture gives it; multiplies the reflectance; default -1: none
    float textureScale[2];  // of texture coordinates, before they are rotated; default 1
    float textureOffset[2]; // added to texture coordinates after they are rotated; default 0
    double textureRotation; // of texture coordinates, radians, from u towards v; default 0
    int alphaTexture;       // its grey (the mean of its colours) multiplies the opacity; default -1: none
    bool
        alphaFromTexture; // the alpha of `texture`, which must be given, multiplies the opacity; default false
    float opacity;        // share of the light that the surface stops, [0, 1]; default 1
    // 0 (default): the opacity is a share. Above 0: the surface is solid where the opacity is at least
    // alphaCutoff, and is not there elsewhere. [0, 1].
    float alphaCutoff;
    uint32_t cookie; // set by vplDefaultMaterialDef
} vplMaterialDef;

vplMaterialDef vplDefaultMaterialDef(void);

// Triangles whose corners are counter-clockwise seen from the front. The arrays are copied.
typedef struct vplMeshDef {
    // vertexCount points, in object space.
    const vplVec3* positions;
    // vertexCount shading normals of any length but 0; NULL (default): flat shading.
    const vplVec3* normals;
    // Three per triangle, each < vertexCount.
    const uint32_t* indices;
    // One per triangle, as vplScene_AddMaterial gives them; NULL (default): the object's material.
    const int* materials;
    // u and v of each vertex; NULL (default): textures of the mesh show their bottom left texel only.
    const float* texcoords;
    // One per vertex, [0, 1] per channel; multiplies the reflectance; NULL (default): none.
    const vplRgb* colors;
    int vertexCount;   // [0, VPL_MAX_TRIANGLES]; default 0
    int triangleCount; // [0, VPL_MAX_TRIANGLES]; default 0
    uint32_t cookie;   // set by vplDefaultMeshDef
} vplMeshDef;

vplMeshDef vplDefaultMeshDef(void);

typedef enum vplObjectType {
    VPL_OBJECT_QUAD = 0, // [-0.5, 0.5]^2 at z = 0; its front faces +z
    VPL_OBJECT_BOX,      // [-0.5, 0.5]^3; its front faces outwards
    VPL_OBJECT_MESH      // the triangles of a mesh
} vplObjectType;

typedef struct vplObjectDef {
    const char* name;   // copied; NULL (default): unnamed
    vplObjectType type; // default VPL_OBJECT_QUAD
    int material;       // as vplScene_AddMaterial gives it; -1: those of the mesh; default 0
    int mesh;           // as vplScene_AddMesh gives it, for VPL_OBJECT_MESH; default 0
    vplMat4 transform;  // object to world space, affine, not singular; default identity
    uint32_t cookie;    // set by vplDefaultObjectDef
} vplObjectDef;

vplObjectDef vplDefaultObjectDef(void);

typedef enum vplEmitterType {
    VPL_EMITTER_POINT = 0,  // the same intensity in all directions
    VPL_EMITTER_SPOT,       // full intensity inside innerAngle, none outside outerAngle
    VPL_EMITTER_DIRECTIONAL // parallel light from infinity
} vplEmitterType;

typedef struct vplEmitterDef {
    vplEmitterType type; // default VPL_EMITTER_POINT
    vplVec3 position;    // metres; point and spot; default 0
    vplVec3 direction;   // of the light's travel, any length but 0; spot and directional; default (0, -1, 0)
    vplRgb intensity;    // W/sr (point, spot) or irradiance in W/m^2 (directional), >= 0; default 1
    double innerAngle;   // half-angle of the cone, radians, [0, outerAngle]; spot; default 20 degrees
    double outerAngle;   // half-angle of the cone, radians, (0, pi / 2); spot; default 30 degrees
    uint32_t cookie;     // set by vplDefaultEmitterDef
} vplEmitterDef;

vplEmitterDef vplDefaultEmitterDef(void);

typedef enum vplEnvironmentType {
    VPL_ENVIRONMENT_NONE = 0, // nothing but darkness
    VPL_ENVIRONMENT_CONSTANT, // the same radiance from all directions
    VPL_ENVIRONMENT_PICTURE,  // radiance from a picture of all directions
    VPL_ENVIRONMENT_SKY       // a clear sky, and its sun
} vplEnvironmentType;

// Light from infinitely far away; y is up.
typedef struct vplEnvironmentDef {
    vplEnvironmentType type; // default VPL_ENVIRONMENT_NONE
    vplRgb radiance;         // W/(m^2 sr), >= 0; constant; default 1
    // Picture: radiance in W/(m^2 sr), >= 0, 3 * width * height floats, copied. Rows are of equal height in the angle
    // from straight up (row 0) to straight down, columns of equal width in the angle about y; the middle of the picture
    // is the direction -z, and +x is to its right. Default NULL.
    const float* pixels;
    int width, height; // of the picture, [1, VPL_MAX_IMAGE_SIZE]; default 0
    double scale;      // factor of the radiance, and of the sun, [0, VPL_MAX_MAGNITUDE]; default 1
    double rotate;     // about +y, counter-clockwise seen from above, radians, [-1e6, 1e6]; default 0
    double elevation;  // of the sun above the horizon, radians, [0, pi / 2]; sky; default 45 degrees
    double turbidity;  // haze: 2 very clear, 3 clear, 6 warm and moist, 10 hazy, [2, 10]; sky; default 3
    uint32_t cookie;   // set by vplDefaultEnvironmentDef
} vplEnvironmentDef;

vplEnvironmentDef vplDefaultEnvironmentDef(void);

// A declared scene. Rendering does not change it.
typedef struct vplScene vplScene;

// Creates an empty scene. VPL_OUT_OF_MEMORY.
vplResult vplScene_Create(vplContext* context, vplScene** sceneOut);

// NULL is allowed.
void vplScene_Destroy(vplScene* scene);

// Additions to a model file (OBJ, PLY, STL, glTF) that is a scene by itself: a camera that fits its vertices, a ground
// and a light. A glTF file keeps its own cameras and lights; with a camera of its own it gets no ground.
typedef struct vplModelSceneDef {
    double aspect;   // of the picture that the vertices fill: width / height, [1e-6, 1e6]; default 16 / 9
    bool ground;     // true (default): a grey ground under the lowest vertex, y being up
    bool areaLight;  // light, if nothing emits; true (default): two square lamps; false: a point light
    bool unlit;      // true: no light is added; default false
    uint32_t cookie; // set by vplDefaultModelSceneDef
} vplModelSceneDef;

vplModelSceneDef vplDefaultModelSceneDef(void);

// Reads a scene file; examples/scenes/README.md describes the format. A model file (see
// vplIsModelPath) is a scene, too; what the def adds to it is logged. For other files the def has no effect. VPL_FILE_ERROR,
// VPL_OUT_OF_MEMORY, VPL_INVALID_ARGUMENT (the def), VPL_LIMIT (more than 256 MiB from a device or a
// pipe), or VPL_PARSE_ERROR, whose message is "file:line:column:", what was found and what was expected.
vplResult vplScene_LoadFor(vplContext* context, const char* path, const vplModelSceneDef* def,
                           vplScene** sceneOut);

// The same with the default def.
vplResult vplScene_Load(vplContext* context, const char* path, vplScene** sceneOut);

// Reads a scene whose files are in memory. The first file is the scene, in the format that its path's ending says, as for
// vplScene_LoadFor; the others are those that it names. A name is looked for beside the file that it stands in: a file
// "chair.gltf" that names "chair.bin" finds the path "chair.bin", and "a/chair.gltf" finds "a/chair.bin". What is not among
// them is read from disk. `files` need not outlive the call. VPL_INVALID_ARGUMENT also for a count below 1, a path that is
// NULL or empty, and bytes that are NULL with a size.
vplResult vplScene_LoadMemory(vplContext* context, const vplMemoryFile* files, int count,
                              const vplModelSceneDef* def, vplScene** sceneOut);

// Each checks a def, copies it and returns its index in *indexOut (may be NULL). VPL_INVALID_ARGUMENT for a
// value out of range, which the message names; VPL_OUT_OF_MEMORY; for textures VPL_CANCELLED (see vplContext_SetProgress).
vplResult vplScene_AddCamera(vplScene* scene, const vplCameraDef* def, int* indexOut);
vplResult vplScene_AddTexture(vplScene* scene, const vplTextureDef* def, int* indexOut);
vplResult vplScene_AddMaterial(vplScene* scene, const vplMaterialDef* def, int* indexOut);
vplResult vplScene_AddMesh(vplScene* scene, const vplMeshDef* def, int* indexOut);
vplResult vplScene_AddObject(vplScene* scene, const vplObjectDef* def, int* indexOut);
vplResult vplScene_AddEmitter(vplScene* scene, const vplEmitterDef* def, int* indexOut);

// Sets the environment, in place of the one that was set before. The sun of a sky becomes a directional emitter, the
// last of the scene so far: it stands in the direction of +x, turned by `rotate`. Setting another environment
// takes that emitter's light away, and the emitter too where it is still the last. VPL_INVALID_ARGUMENT,
// VPL_OUT_OF_MEMORY, VPL_CANCELLED (see vplContext_SetProgress).
// Source: Preetham, Shirley and Smits, A Practical Analytic Model for Daylight, SIGGRAPH 1999.
vplResult vplScene_SetEnvironment(vplScene* scene, const vplEnvironmentDef* def);

// The same with a picture from a file that vplImage_Read reads; `def` gives scale and rotation. Negative and not finite
// values of the file count as 0, with a warning. Errors also as vplImage_Read.
vplResult vplScene_LoadEnvironment(vplScene* scene, const char* path, const vplEnvironmentDef* def);

// Changes what was added, for programs that edit a scene and render it again with the same vplHistory: of its geometry
// only what changed is made anew, and nothing where only cameras and emitters changed. Pictures have the bits of a scene
// that was declared so. What had a path stands still afterwards. A renderer ends with the scene that
// it was created for: after a change its steps are VPL_INVALID_ARGUMENT. The index must be in range, and defs are checked
// as by the functions above; a failure changes nothing.
vplResult vplScene_SetCamera(vplScene* scene, int index, const vplCameraDef* def);
vplResult vplScene_SetMaterial(vplScene* scene, int index, const vplMaterialDef* def);
vplResult vplScene_SetEmitter(vplScene* scene, int index, const vplEmitterDef* def);
vplResult vplScene_SetTransform(vplScene* scene, int object, const vplMat4* transform);
vplResult vplScene_SetObjectMaterial(vplScene* scene, int object, int material);

int vplScene_GetCameraCount(const vplScene* scene);

// A camera as it was declared. The index must be in range.
const vplCameraDef* vplScene_GetCamera(const vplScene* scene, int index);

vplContext* vplScene_GetContext(const vplScene* scene);

VPL_HEADER_END

#endif
