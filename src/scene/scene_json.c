// SPDX-License-Identifier: MIT
// Scene files: one function per kind of thing, each filling the same def that a C program would, so that files
// and programs share every check. Angles are degrees here and radians there.
#include "scene/scene_json.h"

#include <stdio.h>
#include <string.h>

static const double DEGREE = VPL_PI / 180;

// The key in a scene file of a def's field.
static const char* keyOf(const char* field)
{
    static const char* const pairs[][2] = {{"fovY", "fov_y"},
                                           {"innerAngle", "inner_angle"},
                                           {"outerAngle", "outer_angle"},
                                           {"transform", "matrix"}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        if (strcmp(field, pairs[i][0]) == 0) {
            return pairs[i][1];
        }
    }
    return field;
}

vplResult vplSceneLoader_ReportFault(const vplSceneLoader* l, const vplJsonPath* path, const char* key,
                                     const vplFault* fault)
{
    if (fault->field == NULL) {
        return VPL_SUCCESS;
    }
    vplJsonPath member = {path, key ? key : keyOf(fault->field), 0};
    vplJsonPath component = {&member, NULL, fault->index};
    return vplJsonReader_Fail(&l->json, fault->index >= 0 ? &component : &member, "%s", fault->text);
}

vplResult vplSceneLoader_ReportEmitterFault(const vplSceneLoader* l, const vplJsonPath* path,
                                            vplEmitterType type, const vplFault* fault)
{
    const bool ofStrength = fault->field != NULL && strcmp(fault->field, "intensity") == 0;
    return vplSceneLoader_ReportFault(
        l, path, ofStrength && type == VPL_EMITTER_DIRECTIONAL ? "irradiance" : NULL, fault);
}

// An angle in degrees, read into radians. Open or closed bounds as the sentence says.
static vplResult readAngle(const vplSceneLoader* l, const json_t* object, const vplJsonPath* path,
                           const char* key, double above, double below, const char* range, double* out)
{
    const json_t* value = json_object_get(object, key);
    double degrees = 0;
    vplResult result = vplJsonReader_Number(&l->json, object, path, key, &degrees);
    if (result != VPL_SUCCESS || value == NULL) {
        return result;
    }
    if (!(degrees > above && degrees < below)) {
        vplJsonPath member = {path, key, 0};
        return vplJsonReader_Fail(&l->json, &member, "is %g, must be in %s degrees", degrees, range);
    }
    *out = degrees * DEGREE;
    return VPL_SUCCESS;
}

vplResult vplSceneLoader_ReadFieldOfView(const vplSceneLoader* l, const json_t* object,
                                         const vplJsonPath* path, double* out)
{
    return readAngle(l, object, path, "fov_y", 0, 180, "(0, 180)", out);
}

static vplResult readCamera(vplSceneLoader* l, const json_t* value, const vplJsonPath* path)
{
    static const char* const keys[] = {"!eye", "!target", "up", "fov_y", "near", "far", "path", NULL};
    vplCameraDef def = vplDefaultCameraDef();
    const vplJsonReader* json = &l->json;
    TRY(vplJsonReader_CheckKeys(json, value, path, keys));
    TRY(vplJsonReader_Floats(json, value, path, "eye", 3, &def.eye.x));
    TRY(vplJsonReader_Floats(json, value, path, "target", 3, &def.target.x));
    TRY(vplJsonReader_Floats(json, value, path, "up", 3, &def.up.x));
    TRY(vplSceneLoader_ReadFieldOfView(l, value, path, &def.fovY));
    TRY(vplJsonReader_Number(json, value, path, "near", &def.near));
    TRY(vplJsonReader_Number(json, value, path, "far", &def.far));
    vplFault fault = vplCheckCamera(&def);
    TRY(vplSceneLoader_ReportFault(l, path, NULL, &fault));
    int index;
    TRY(vplScene_AddCamera(l->scene, &def, &index));
    return vplSceneLoader_ReadCameraPath(l, value, path, index);
}

static vplResult readCameras(vplSceneLoader* l)
{
    const json_t* one = json_object_get(l->json.root, "camera");
    const json_t* many = json_object_get(l->json.root, "cameras");
    vplJsonPath path = {NULL, one ? "camera" : "cameras", 0};
    if (one != NULL && many != NULL) {
        return vplJsonReader_Fail(&l->json, &path, "and \"cameras\" are both given, must be one of them");
    }
    if (one != NULL) {
        return readCamera(l, one, &path);
    }
    if (many == NULL) {
        return vplJsonReader_Fail(&l->json, NULL, "lacks the key \"camera\"");
    }
    TRY(vplJsonReader_RequireArray(&l->json, many, &path));
    if (json_array_size(many) == 0) {
        return vplJsonReader_Fail(&l->json, &path, "is empty, must hold at least one camera");
    }
    for (size_t i = 0; i < json_array_size(many); i++) {
        vplJsonPath element = {&path, NULL, (int)i};
        TRY(readCamera(l, json_array_get(many, i), &element));
    }
    return VPL_SUCCESS;
}

static vplResult readMaterials(vplSceneLoader* l)
{
    static const char* const keys[] = {"diffuse", "emission", NULL};
    json_t* materials = json_object_get(l->json.root, "materials");
    vplJsonPath path = {NULL, "materials", 0};
    if (materials == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJsonReader_RequireObject(&l->json, materials, &path));
    const char* name;
    json_t* value;
    json_object_foreach(materials, name, value)
    {
        vplJsonPath member = {&path, name, 0};
        vplMaterialDef def = vplDefaultMaterialDef();
        def.name = name;
        TRY(vplJsonReader_CheckKeys(&l->json, value, &member, keys));
        TRY(vplJsonReader_Floats(&l->json, value, &member, "diffuse", 3, &def.diffuse.r));
        TRY(vplJsonReader_Floats(&l->json, value, &member, "emission", 3, &def.emission.r));
        vplFault fault = vplCheckMaterial(&def);
        TRY(vplSceneLoader_ReportFault(l, &member, NULL, &fault));
        TRY(vplScene_AddMaterial(l->scene, &def, NULL));
    }
    return VPL_SUCCESS;
}

vplResult vplSceneLoader_ReadType(vplSceneLoader* l, const json_t* value, const vplJsonPath* path,
                                  const char** out)
{
    TRY(vplJsonReader_RequireObject(&l->json, value, path));
    TRY(vplJsonReader_String(&l->json, value, path, "type", out));
    return *out != NULL ? VPL_SUCCESS : vplJsonReader_Fail(&l->json, path, "lacks the key \"type\"");
}

static vplResult readEmitter(vplSceneLoader* l, const json_t* value, const vplJsonPath* path)
{
    static const char* const pointKeys[] = {"!type", "name", "!position", "!intensity", "path", NULL};
    static const char* const spotKeys[] = {
        "!type", "name", "!position", "!direction", "!intensity", "inner_angle", "outer_angle", "path", NULL};
    static const char* const directionalKeys[] = {"!type", "name", "!direction", "!irradiance", "path", NULL};
    const vplJsonReader* json = &l->json;
    const char* type = NULL;
    const char* name = NULL;
    TRY(vplSceneLoader_ReadType(l, value, path, &type));
    vplEmitterDef def = vplDefaultEmitterDef();
    const char* const* keys = pointKeys;
    if (strcmp(type, "spot") == 0) {
        def.type = VPL_EMITTER_SPOT;
        keys = spotKeys;
    } else if (strcmp(type, "directional") == 0) {
        def.type = VPL_EMITTER_DIRECTIONAL;
        keys = directionalKeys;
    } else if (strcmp(type, "point") != 0) {
        vplJsonPath member = {path, "type", 0};
        return vplJsonReader_Fail(json, &member,
                                  "is \"%.80s\", must be \"point\", \"spot\" or \"directional\"", type);
    }
    TRY(vplJsonReader_CheckKeys(json, value, path, keys));
    TRY(vplJsonReader_String(json, value, path, "name", &name));
    TRY(vplJsonReader_Floats(json, value, path, "position", 3, &def.position.x));
    TRY(vplJsonReader_Floats(json, value, path, "direction", 3, &def.direction.x));
    const char* strength = def.type == VPL_EMITTER_DIRECTIONAL ? "irradiance" : "intensity";
    TRY(vplJsonReader_Floats(json, value, path, strength, 3, &def.intensity.r));
    TRY(readAngle(l, value, path, "outer_angle", 0, 90, "(0, 90)", &def.outerAngle));
    TRY(readAngle(l, value, path, "inner_angle", -1e-300, 90, "[0, 90)", &def.innerAngle));
    if (def.type == VPL_EMITTER_SPOT && def.innerAngle > def.outerAngle) { // said in degrees here
        vplJsonPath member = {path, "inner_angle", 0};
        return vplJsonReader_Fail(json, &member, "is %g degrees, must be at most outer_angle (%g)",
                                  def.innerAngle / DEGREE, def.outerAngle / DEGREE);
    }
    vplFault fault = vplCheckEmitter(&def);
    int index;
    TRY(vplSceneLoader_ReportEmitterFault(l, path, def.type, &fault));
    TRY(vplScene_AddEmitter(l->scene, &def, &index));
    return vplSceneLoader_ReadEmitterPath(l, value, path, index);
}

// Reads every element of the array at the root's `key`, if there is one.
static vplResult readArray(vplSceneLoader* l, const char* key,
                           vplResult (*read)(vplSceneLoader*, const json_t*, const vplJsonPath*))
{
    const json_t* array = json_object_get(l->json.root, key);
    vplJsonPath path = {NULL, key, 0};
    if (array == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJsonReader_RequireArray(&l->json, array, &path));
    for (size_t i = 0; i < json_array_size(array); i++) {
        vplJsonPath element = {&path, NULL, (int)i};
        TRY(read(l, json_array_get(array, i), &element));
    }
    return VPL_SUCCESS;
}

static vplResult readScene(vplSceneLoader* l)
{
    static const char* const keys[] = {"camera", "cameras", "materials", "!objects", "lights", NULL};
    TRY(vplJsonReader_CheckKeys(&l->json, l->json.root, NULL, keys));
    TRY(readCameras(l));
    TRY(readMaterials(l));
    l->materialCount = l->scene->materialCount;
    TRY(readArray(l, "objects", vplSceneLoader_ReadObject));
    return readArray(l, "lights", readEmitter);
}

vplResult vplScene_LoadJson(vplContext* context, const char* path, vplScene** sceneOut)
{
    vplSceneLoader loader = {.meshFiles = {.index = {.context = context}}};
    TRY(vplJsonReader_Open(context, path, &loader.json));
    vplResult result = vplScene_Create(context, &loader.scene);
    if (result == VPL_SUCCESS) {
        result = readScene(&loader);
    }
    vplNames_Close(&loader.meshFiles);
    vplJsonReader_Close(&loader.json);
    if (result != VPL_SUCCESS) {
        vplScene_Destroy(loader.scene);
        return result;
    }
    *sceneOut = loader.scene;
    return VPL_SUCCESS;
}
