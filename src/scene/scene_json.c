// SPDX-License-Identifier: MIT
// Scene files. There is one function for each type of thing, and it fills the same def that a C program
// would, so that files and programs share every check. Angles are in degrees in files and in radians in defs.
#include "scene/model.h"
#include "scene/scene_json.h"

#include <string.h>

static const double DEGREE = VPL_PI / 180;

// The key in a scene file for a def's field: another name, if the file uses that.
static const char* keyOf(const vplJson* object, const char* field)
{
    static const char* const pairs[][2] = {{"fovY", "fov_y"},
                                           {"innerAngle", "inner_angle"},
                                           {"outerAngle", "outer_angle"},
                                           {"transform", "matrix"},
                                           {"alphaCutoff", "alpha_cutoff"},
                                           {"alphaFromTexture", "alpha_from_texture"},
                                           {"intensity", "irradiance"}}; // of a directional emitter
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        if (strcmp(field, pairs[i][0]) == 0 && json_object_get(object->value, pairs[i][1]) != NULL) {
            return pairs[i][1];
        }
    }
    // The file may leave these two out, and the default of one may not fit the other.
    return strcmp(field, "nearPlane") == 0 ? "near" : strcmp(field, "farPlane") == 0 ? "far" : field;
}

vplResult vplJson_ReportFault(const vplJson* object, vplFault fault)
{
    if (fault.field == NULL) {
        return VPL_SUCCESS;
    }
    const vplJson member = vplJson_Member(object, keyOf(object, fault.field));
    const vplJson component = vplJson_Element(&member, fault.index);
    return vplJson_Fail(fault.index >= 0 ? &component : &member, "%s", fault.text);
}

vplResult vplJson_ReadAngle(const vplJson* object, const char* key, double above, double below, double* out)
{
    const vplJson member = vplJson_Member(object, key);
    double degrees = 0;
    TRY(vplJson_ReadNumber(object, key, &degrees));
    if (member.value == NULL) {
        return VPL_SUCCESS;
    }
    if (!(degrees > above && degrees < below)) {
        return vplJson_Fail(&member, "is %g, must be in %s0, %g) degrees", degrees, above < 0 ? "[" : "(",
                            below);
    }
    *out = degrees * DEGREE;
    return VPL_SUCCESS;
}

static vplResult readCamera(vplSceneLoader* l, const vplJson* camera)
{
    static const char* const keys[] = {"!eye", "!target", "up", "fov_y", "near", "far", "path", NULL};
    vplCameraDef def = vplDefaultCameraDef();
    TRY(vplJson_CheckKeys(camera, keys));
    TRY(vplJson_ReadPosition(camera, "eye", &def.eye));
    TRY(vplJson_ReadPosition(camera, "target", &def.target));
    TRY(vplJson_ReadFloats(camera, "up", 3, &def.up));
    TRY(vplJson_ReadAngle(camera, "fov_y", 0, 180, &def.fovY));
    TRY(vplJson_ReadNumber(camera, "near", &def.nearPlane));
    TRY(vplJson_ReadNumber(camera, "far", &def.farPlane));
    TRY(vplJson_ReportFault(camera, vplCheckCamera(&def)));
    int index;
    TRY(vplScene_AddCamera(l->scene, &def, &index));
    return vplSceneLoader_ReadCameraPath(l, camera, index);
}

static vplResult readMaterials(vplSceneLoader* l, const vplJson* root)
{
    static const char* const keys[] = {
        "diffuse", "emission",     "texture", "alpha_texture", "alpha_from_texture",
        "opacity", "alpha_cutoff", NULL};
    const vplJson materials = vplJson_Member(root, "materials");
    if (materials.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_RequireObject(&materials));
    const char* name;
    json_t* value;
    json_object_foreach(materials.value, name, value)
    {
        const vplJson material = vplJson_Member(&materials, name);
        vplMaterialDef def = vplDefaultMaterialDef();
        def.name = name;
        TRY(vplJson_CheckKeys(&material, keys));
        TRY(vplJson_ReadFloats(&material, "diffuse", 3, &def.diffuse));
        TRY(vplJson_ReadFloats(&material, "emission", 3, &def.emission));
        TRY(vplSceneLoader_ReadTextures(l, &material, &def));
        TRY(vplJson_ReportFault(&material, vplCheckMaterial(&def, l->scene->textureCount)));
        TRY(vplScene_AddMaterial(l->scene, &def, NULL));
    }
    return VPL_SUCCESS;
}

vplResult vplJson_ReadType(const vplJson* object, const char* const* names, const char* expected, int* out)
{
    const char* type = NULL;
    TRY(vplJson_RequireObject(object));
    TRY(vplJson_ReadString(object, "type", &type));
    if (type == NULL) {
        return vplJson_Fail(object, "lacks the key \"type\"");
    }
    for (*out = 0; names[*out] != NULL; ++*out) {
        if (strcmp(type, names[*out]) == 0) {
            return VPL_SUCCESS;
        }
    }
    const vplJson member = vplJson_Member(object, "type");
    return vplJson_Fail(&member, "is \"%.80s\", must be %s", type, expected);
}

static vplResult readEmitter(vplSceneLoader* l, const vplJson* emitter)
{
    static const char* const types[] = {"point", "spot", "directional", NULL};
    static const char* const keys[][9] = {
        [VPL_EMITTER_POINT] = {"!type", "name", "!position", "!intensity", "path", NULL},
        [VPL_EMITTER_SPOT] = {"!type", "name", "!position", "!direction", "!intensity", "inner_angle",
                              "outer_angle", "path", NULL},
        [VPL_EMITTER_DIRECTIONAL] = {"!type", "name", "!direction", "!irradiance", "path", NULL}};
    const char* name = NULL;
    int type = 0, index;
    TRY(vplJson_ReadType(emitter, types, "\"point\", \"spot\" or \"directional\"", &type));
    vplEmitterDef def = vplDefaultEmitterDef();
    def.type = (vplEmitterType)type;
    TRY(vplJson_CheckKeys(emitter, keys[type]));
    TRY(vplJson_ReadString(emitter, "name", &name));
    TRY(vplJson_ReadPosition(emitter, "position", &def.position));
    TRY(vplJson_ReadFloats(emitter, "direction", 3, &def.direction));
    TRY(vplJson_ReadFloats(emitter, "intensity", 3, &def.intensity));
    TRY(vplJson_ReadFloats(emitter, "irradiance", 3, &def.intensity));
    TRY(vplJson_ReadAngle(emitter, "outer_angle", 0, 90, &def.outerAngle));
    TRY(vplJson_ReadAngle(emitter, "inner_angle", -1e-300, 90, &def.innerAngle));
    if (def.type == VPL_EMITTER_SPOT && def.innerAngle > def.outerAngle) { // vplCheckEmitter reports radians
        const vplJson member = vplJson_Member(emitter, "inner_angle");
        return vplJson_Fail(&member, "is %g degrees, must be at most outer_angle (%g)",
                            def.innerAngle / DEGREE, def.outerAngle / DEGREE);
    }
    TRY(vplJson_ReportFault(emitter, vplCheckEmitter(&def)));
    TRY(vplScene_AddEmitter(l->scene, &def, &index));
    return vplSceneLoader_ReadEmitterPath(l, emitter, index);
}

typedef vplResult ReadFcn(vplSceneLoader* l, const vplJson* at);

// Reads every element of the root's array `key`, if there is one.
static vplResult readArray(vplSceneLoader* l, const vplJson* root, const char* key, ReadFcn* read)
{
    const vplJson array = vplJson_Member(root, key);
    if (array.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_RequireArray(&array));
    for (size_t i = 0; i < json_array_size(array.value); i++) {
        const vplJson element = vplJson_Element(&array, (int)i);
        TRY(read(l, &element));
    }
    return VPL_SUCCESS;
}

static vplResult readCameras(vplSceneLoader* l, const vplJson* root)
{
    const vplJson one = vplJson_Member(root, "camera"), many = vplJson_Member(root, "cameras");
    if (one.value != NULL && many.value != NULL) {
        return vplJson_Fail(&one, "and \"cameras\" are both given, must be one of them");
    }
    if (one.value != NULL) {
        return readCamera(l, &one);
    }
    if (many.value == NULL) {
        return vplJson_Fail(root, "lacks the key \"camera\"");
    }
    if (json_is_array(many.value) && json_array_size(many.value) == 0) {
        return vplJson_Fail(&many, "is empty, must hold at least one camera");
    }
    return readArray(l, root, "cameras", readCamera);
}

static vplResult readRoot(vplSceneLoader* l)
{
    static const char* const keys[] = {"camera", "cameras",     "materials", "!objects",
                                       "lights", "environment", NULL};
    const vplJson root = vplJson_Root(&l->json), asset = vplJson_Member(&root, "asset");
    if (asset.value != NULL) {
        return vplJson_Fail(&asset,
                            "is a key of glTF files, whose names end in .gltf; expected a scene of libvpl");
    }
    TRY(vplJson_CheckKeys(&root, keys));
    TRY(readCameras(l, &root));
    TRY(readMaterials(l, &root));
    l->materialCount = l->scene->materialCount;
    TRY(readArray(l, &root, "objects", vplSceneLoader_ReadObject));
    TRY(readArray(l, &root, "lights", readEmitter));
    return vplSceneLoader_ReadEnvironment(l, &root);
}

static vplResult readFile(vplSceneLoader* l, const char* path)
{
    TRY(vplArena_Check(l->scratch));
    TRY(vplJsonFile_Open(l->scene->context, path, &l->json));
    vplFindOrigin(l->json.root, l->json.origin);
    vplResult result = vplScene_SetOrigin(l->scene, l->json.origin);
    result = result == VPL_SUCCESS ? readRoot(l) : result;
    vplJsonFile_Close(&l->json);
    return result;
}

static vplResult loadJson(vplContext* context, const char* path, vplScene** sceneOut)
{
    vplScene* scene;
    TRY(vplScene_Create(context, &scene));
    vplArena* scratch = vplArena_Create(context);
    vplSceneLoader loader = {.scene = scene, .scratch = scratch, .modelFiles = {.index = {.arena = scratch}}};
    const vplResult result = readFile(&loader, path);
    vplArena_Destroy(scratch);
    return vplScene_Deliver(scene, result, sceneOut);
}

vplResult vplScene_LoadFor(vplContext* context, const char* path, const vplModelSceneDef* def,
                           vplScene** sceneOut)
{
    REQUIRE(context, context, path, def, sceneOut);
    if (vplIsModelPath(path)) {
        return vplScene_LoadModelAlone(context, path, def, sceneOut);
    }
    if (vplForeignEnding(path) != NULL) {
        return vplFail(context, VPL_PARSE_ERROR,
                       "%s: %s files are not read; a scene is a JSON file, or a model that ends in %s", path,
                       vplForeignEnding(path), VPL_MODEL_ENDINGS);
    }
    return loadJson(context, path, sceneOut);
}

vplResult vplScene_Load(vplContext* context, const char* path, vplScene** sceneOut)
{
    REQUIRE(context, context, path, sceneOut);
    const vplModelSceneDef def = vplDefaultModelSceneDef();
    return vplScene_LoadFor(context, path, &def, sceneOut);
}

vplResult vplScene_LoadMemory(vplContext* context, const vplMemoryFile* files, int count,
                              const vplModelSceneDef* def, vplScene** sceneOut)
{
    REQUIRE(context, context, def, sceneOut);
    REQUIRE_ARRAY(context, files, count);
    if (files == NULL || count < 1) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "the number of files is %d, must be at least 1",
                       files == NULL ? 0 : count);
    }
    for (int i = 0; i < count; i++) {
        if (files[i].path == NULL || files[i].path[0] == 0) {
            return vplFail(context, VPL_INVALID_ARGUMENT, "files[%d].path is empty, must be a name", i);
        }
        if (files[i].bytes == NULL && files[i].size > 0) {
            return vplFail(context, VPL_INVALID_ARGUMENT, "files[%d].bytes is NULL, must be %zu bytes", i,
                           files[i].size);
        }
    }
    const vplMemoryFile* before = context->files;
    const int beforeCount = context->fileCount;
    vplContext_SetFiles(context, files, count);
    const vplResult result = vplScene_LoadFor(context, files[0].path, def, sceneOut);
    vplContext_SetFiles(context, before, beforeCount);
    return result;
}
