// SPDX-License-Identifier: MIT
// The objects of scene files: quads, boxes and meshes with their materials and transforms.
#include "base/file.h"
#include "math/matrix.h"
#include "scene/scene_json.h"

#include <string.h>

static vplResult readMaterialReference(vplSceneLoader* l, const json_t* object, const vplJsonPath* path,
                                       int* out)
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
static vplResult readParts(vplSceneLoader* l, const json_t* object, const vplJsonPath* path, vplMat4* out)
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
    return vplSceneLoader_ReportFault(l, path, translation ? "translate" : "scale", &fault);
}

static vplResult readTransform(vplSceneLoader* l, const json_t* object, const vplJsonPath* path, vplMat4* out)
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
        return vplSceneLoader_ReportFault(l, path, NULL, &fault);
    }
    return readParts(l, object, path, out);
}

// Reads the file of a mesh, unless an object above has it, too.
static vplResult readMeshFile(vplSceneLoader* l, const char* path, int* out)
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

static vplResult readMesh(vplSceneLoader* l, const json_t* object, const vplJsonPath* path, int* out)
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

static vplResult readObjectType(vplSceneLoader* l, const json_t* value, const vplJsonPath* path,
                                vplObjectType* out)
{
    static const char* const types[] = {"quad", "box", "mesh"};
    const char* type = NULL;
    TRY(vplSceneLoader_ReadType(l, value, path, &type));
    for (int i = 0; i < 3; i++) {
        if (strcmp(type, types[i]) == 0) {
            *out = (vplObjectType)i;
            return VPL_SUCCESS;
        }
    }
    vplJsonPath member = {path, "type", 0};
    return vplJsonReader_Fail(&l->json, &member, "is \"%.80s\", must be \"quad\", \"box\" or \"mesh\"", type);
}

vplResult vplSceneLoader_ReadObject(vplSceneLoader* l, const json_t* value, const vplJsonPath* path)
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
