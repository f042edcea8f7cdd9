// SPDX-License-Identifier: MIT
// Scene files: one function per kind of thing, each filling the same def that a C program would, so that files
// and programs share every check. Angles are degrees here and radians there.
#include "scene/json_reader.h"
#include "base/file.h"
#include "math/matrix.h"
#include "scene/obj_index.h"
#include "scene/scene.h"

#include <stdio.h>
#include <string.h>

typedef struct Loader {
    vplJsonReader json;
    vplScene* scene;
    int materialCount;  // of the scene file itself; those of meshes follow
    vplNames meshFiles; // paths of the scene's meshes, in their order
} Loader;

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

// Turns what the checks found into "file:line:column: path sentence"; `key` overrides the field's own.
static vplResult reportFault(const Loader* l, const vplJsonPath* path, const char* key, const vplFault* fault)
{
    if (fault->field == NULL) {
        return VPL_SUCCESS;
    }
    vplJsonPath member = {path, key ? key : keyOf(fault->field), 0};
    vplJsonPath component = {&member, NULL, fault->index};
    return vplJsonReader_Fail(&l->json, fault->index >= 0 ? &component : &member, "%s", fault->text);
}

// An angle in degrees, read into radians. Open or closed bounds as the sentence says.
static vplResult readAngle(const Loader* l, const json_t* object, const vplJsonPath* path, const char* key,
                           double above, double below, const char* range, double* out)
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

#define TRY(call)                                                                                            \
    do {                                                                                                     \
        vplResult tryResult = (call);                                                                        \
        if (tryResult != VPL_SUCCESS) {                                                                      \
            return tryResult;                                                                                \
        }                                                                                                    \
    } while (0)

static vplResult readCamera(Loader* l, const json_t* value, const vplJsonPath* path)
{
    static const char* const keys[] = {"!eye", "!target", "up", "fov_y", "near", "far", NULL};
    vplCameraDef def = vplDefaultCameraDef();
    const vplJsonReader* json = &l->json;
    TRY(vplJsonReader_CheckKeys(json, value, path, keys));
    TRY(vplJsonReader_Floats(json, value, path, "eye", 3, &def.eye.x));
    TRY(vplJsonReader_Floats(json, value, path, "target", 3, &def.target.x));
    TRY(vplJsonReader_Floats(json, value, path, "up", 3, &def.up.x));
    TRY(readAngle(l, value, path, "fov_y", 0, 180, "(0, 180)", &def.fovY));
    TRY(vplJsonReader_Number(json, value, path, "near", &def.near));
    TRY(vplJsonReader_Number(json, value, path, "far", &def.far));
    vplFault fault = vplCheckCamera(&def);
    TRY(reportFault(l, path, NULL, &fault));
    return vplScene_AddCamera(l->scene, &def, NULL);
}

static vplResult readCameras(Loader* l)
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

static vplResult readMaterials(Loader* l)
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
        TRY(reportFault(l, &member, NULL, &fault));
        TRY(vplScene_AddMaterial(l->scene, &def, NULL));
    }
    return VPL_SUCCESS;
}

static vplResult readMaterialReference(Loader* l, const json_t* object, const vplJsonPath* path, int* out)
{
    const char* name = NULL;
    TRY(vplJsonReader_String(&l->json, object, path, "material", &name));
    for (int i = 0; name != NULL && i < l->materialCount; i++) {
        if (strcmp(l->scene->materials[i].name, name) == 0) {
            *out = i;
            return VPL_SUCCESS;
        }
    }
    vplJsonPath member = {path, "material", 0};
    return vplJsonReader_Fail(&l->json, &member, "is \"%.80s\", which is not among the materials",
                              name ? name : "");
}

// Translate, rotate and scale. A flaw of the matrix they make is named by the key that caused it.
static vplResult readParts(Loader* l, const json_t* object, const vplJsonPath* path, vplMat4* out)
{
    const vplJsonReader* json = &l->json;
    const json_t* scaleValue = json_object_get(object, "scale");
    float translate[3] = {0, 0, 0}, scale[3] = {1, 1, 1};
    double quarters[3] = {0, 0, 0};
    TRY(vplJsonReader_Floats(json, object, path, "translate", 3, translate));
    TRY(vplJsonReader_Doubles(json, object, path, "rotate", 3, quarters));
    if (json_is_number(scaleValue)) {
        double uniform = 1;
        TRY(vplJsonReader_Number(json, object, path, "scale", &uniform));
        scale[0] = scale[1] = scale[2] = (float)uniform;
    } else {
        TRY(vplJsonReader_Floats(json, object, path, "scale", 3, scale));
    }
    for (int i = 0; i < 3; i++) {
        vplJsonPath rotate = {path, "rotate", 0}, angle = {&rotate, NULL, i};
        if (!(quarters[i] >= -1e6 && quarters[i] <= 1e6)) {
            return vplJsonReader_Fail(json, &angle, "is %g, must be in [-1e6, 1e6] degrees", quarters[i]);
        }
        quarters[i] /= 90;
    }
    vplAffine a = vplAffine_FromParts((vplVec3){translate[0], translate[1], translate[2]}, quarters,
                                      (vplVec3){scale[0], scale[1], scale[2]});
    *out = vplAffine_ToMat4(&a);
    vplFault fault = vplCheckTransform(out);
    bool translation = fault.index >= 12; // the matrix's last column
    fault.index = translation ? fault.index - 12 : -1;
    return reportFault(l, path, translation ? "translate" : "scale", &fault);
}

static vplResult readTransform(Loader* l, const json_t* object, const vplJsonPath* path, vplMat4* out)
{
    const vplJsonReader* json = &l->json;
    if (json_object_get(object, "matrix") != NULL) {
        if (json_object_get(object, "translate") || json_object_get(object, "rotate") ||
            json_object_get(object, "scale")) {
            vplJsonPath member = {path, "matrix", 0};
            return vplJsonReader_Fail(json, &member, "excludes \"translate\", \"rotate\" and \"scale\"");
        }
        TRY(vplJsonReader_Floats(json, object, path, "matrix", 16, out->m));
        vplFault fault = vplCheckTransform(out);
        return reportFault(l, path, NULL, &fault);
    }
    return readParts(l, object, path, out);
}

// The type comes before all other keys, because it decides which of them are known.
static vplResult readType(Loader* l, const json_t* value, const vplJsonPath* path, const char** out)
{
    TRY(vplJsonReader_RequireObject(&l->json, value, path));
    TRY(vplJsonReader_String(&l->json, value, path, "type", out));
    return *out != NULL ? VPL_SUCCESS : vplJsonReader_Fail(&l->json, path, "lacks the key \"type\"");
}

// Reads the file of a mesh, unless an object above has it, too.
static vplResult readMeshFile(Loader* l, const char* path, int* out)
{
    size_t length = strlen(path);
    *out = vplNames_Find(&l->meshFiles, path, length);
    if (*out >= 0) {
        return VPL_SUCCESS;
    }
    int mesh;
    TRY(vplScene_LoadObj(l->scene, path, &mesh));
    return vplNames_Add(&l->meshFiles, path, length, out);
}

static vplResult readMesh(Loader* l, const json_t* object, const vplJsonPath* path, int* out)
{
    const char* name = NULL;
    vplJsonPath member = {path, "file", 0};
    TRY(vplJsonReader_String(&l->json, object, path, "file", &name));
    char* whole = vplPathBeside(l->json.context, l->json.file, name, strlen(name));
    if (whole == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplResult result =
        vplIsRegularFile(whole)
            ? readMeshFile(l, whole, out)
            : vplJsonReader_Fail(&l->json, &member, "is \"%.80s\", but there is no file %.200s", name, whole);
    vplFree(l->json.context, whole);
    return result;
}

static vplResult readObjectType(Loader* l, const json_t* value, const vplJsonPath* path, vplObjectType* out)
{
    static const char* const types[] = {"quad", "box", "mesh"};
    const char* type = NULL;
    TRY(readType(l, value, path, &type));
    for (int i = 0; i < 3; i++) {
        if (strcmp(type, types[i]) == 0) {
            *out = (vplObjectType)i;
            return VPL_SUCCESS;
        }
    }
    vplJsonPath member = {path, "type", 0};
    return vplJsonReader_Fail(&l->json, &member, "is \"%.80s\", must be \"quad\", \"box\" or \"mesh\"", type);
}

static vplResult readObject(Loader* l, const json_t* value, const vplJsonPath* path)
{
    static const char* const shapeKeys[] = {"!type",  "name",  "!material", "translate",
                                            "rotate", "scale", "matrix",    NULL};
    static const char* const meshKeys[] = {"!type",  "name",  "material", "!file", "translate",
                                           "rotate", "scale", "matrix",   NULL};
    vplObjectDef def = vplDefaultObjectDef();
    TRY(readObjectType(l, value, path, &def.type));
    bool mesh = def.type == VPL_OBJECT_MESH;
    TRY(vplJsonReader_CheckKeys(&l->json, value, path, mesh ? meshKeys : shapeKeys));
    TRY(vplJsonReader_String(&l->json, value, path, "name", &def.name));
    if (!mesh || json_object_get(value, "material") != NULL) {
        TRY(readMaterialReference(l, value, path, &def.material));
    } else {
        def.material = -1;
    }
    TRY(readTransform(l, value, path, &def.transform));
    if (mesh) {
        TRY(readMesh(l, value, path, &def.mesh));
    }
    return vplScene_AddObject(l->scene, &def, NULL);
}

static vplResult readEmitter(Loader* l, const json_t* value, const vplJsonPath* path)
{
    static const char* const pointKeys[] = {"!type", "name", "!position", "!intensity", NULL};
    static const char* const spotKeys[] = {"!type",      "name",        "!position",   "!direction",
                                           "!intensity", "inner_angle", "outer_angle", NULL};
    static const char* const directionalKeys[] = {"!type", "name", "!direction", "!irradiance", NULL};
    const vplJsonReader* json = &l->json;
    const char* type = NULL;
    const char* name = NULL;
    TRY(readType(l, value, path, &type));
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
    bool ofStrength = fault.field != NULL && strcmp(fault.field, "intensity") == 0;
    TRY(reportFault(l, path, ofStrength ? strength : NULL, &fault));
    return vplScene_AddEmitter(l->scene, &def, NULL);
}

// Reads every element of the array at the root's `key`, if there is one.
static vplResult readArray(Loader* l, const char* key,
                           vplResult (*read)(Loader*, const json_t*, const vplJsonPath*))
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

static vplResult readScene(Loader* l)
{
    static const char* const keys[] = {"camera", "cameras", "materials", "!objects", "lights", NULL};
    TRY(vplJsonReader_CheckKeys(&l->json, l->json.root, NULL, keys));
    TRY(readCameras(l));
    TRY(readMaterials(l));
    l->materialCount = l->scene->materialCount;
    TRY(readArray(l, "objects", readObject));
    return readArray(l, "lights", readEmitter);
}

vplResult vplScene_LoadJson(vplContext* context, const char* path, vplScene** sceneOut)
{
    Loader loader = {.meshFiles = {.index = {.context = context}}};
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
